//! `andond check`: reads the configuration, opens what the roles will open, and reports every fault.

pub(super) mod neighbours;
pub(super) mod unit;

use std::fmt;
use std::io::Read as _;
use std::net::TcpListener;
use std::path::Path;
use std::process::{Command, Stdio};

use andon_host::atomic::folder_of;
use andon_host::config::{Config, Source};
use andon_host::exit::Code;
use andon_journal::{History, Query};
use andon_learn::file;
use andon_learn::recording::TrackReader;

use super::ToolError;
use crate::cli::Check;
use crate::made::Made;
use crate::metric::Placer;
use crate::role;
use crate::video::helper_path;
use crate::{boards, compatibility, perception};

/// What a database of SQLite begins with.
const SQLITE: &[u8] = b"SQLite format 3\0";

/// The section of the key that names the camera or the recording.
const CAMERA: &str = "camera";

/// What the configuration names and cannot be used, with the remedies.
#[derive(Debug, Default)]
pub struct Unusable {
    /// What a person must correct in the configuration, or in a file that it names.
    file: Vec<String>,
    /// What this machine lacks or does not give: the configuration may be right.
    machine: Vec<String>,
}

impl Unusable {
    /// What is wrong in the configuration alone.
    pub(super) fn of_files(file: Vec<String>) -> Self {
        Self { file, machine: Vec::new() }
    }

    /// A configuration that is right needs no other one, but a machine that can do what it says.
    pub(super) fn code(&self) -> Code {
        if self.file.is_empty() { Code::Fault } else { Code::Configuration }
    }
}

impl fmt::Display for Unusable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, faults) in [
            ("in the configuration, or in a file that it names", &self.file),
            ("on this machine", &self.machine),
        ] {
            if !faults.is_empty() {
                writeln!(f, "{place}:")?;
                faults.iter().try_for_each(|fault| writeln!(f, "  {fault}"))?;
            }
        }
        let faults = |count: usize| if count == 1 { "1 fault".to_owned() } else { format!("{count} faults") };
        match (self.file.len(), self.machine.len()) {
            (file, 0) => write!(f, "{} in the configuration", faults(file)),
            (0, machine) => write!(f, "no fault in the configuration, {} on this machine", faults(machine)),
            (file, machine) => {
                write!(f, "{} in the configuration, {} on this machine", faults(file), faults(machine))
            }
        }?;
        if self.file.is_empty() && matches!(self.machine.as_slice(), [one] if one.starts_with(CAMERA)) {
            write!(f, "; films can be taught from and judged without a camera")?;
        }
        Ok(())
    }
}

/// Runs the command.
///
/// # Errors
/// Every fault of the configuration, or else of what it names.
pub fn run(arguments: &Check) -> Result<Code, ToolError> {
    let files = arguments.config.existing()?;
    let config = Config::load(&files)?;
    let mut checks = Checks { config: &config, faults: Unusable::default() };
    checks.job();
    checks.jobs();
    checks.perception();
    checks.journal();
    checks.board();
    checks.executor();
    checks.faults.file.extend(neighbours::faults(&config));
    if config.ipc_station().is_ok_and(|station| station.is_in_use()) {
        println!("the line runs: its camera and its port are in use, and were not opened");
    } else {
        checks.source();
        checks.port();
    }
    for unseen in unit::unseen(&config, rustix::process::geteuid().is_root()) {
        println!("{unseen}");
    }
    if !(checks.faults.file.is_empty() && checks.faults.machine.is_empty()) {
        return Err(ToolError::Unusable(checks.faults));
    }
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    println!("{}: station {:?}, no fault", names.join(", "), config.station.name);
    Ok(Code::Stopped)
}

struct Checks<'c> {
    config: &'c Config,
    faults: Unusable,
}

impl Checks<'_> {
    fn fault(&mut self, key: &str, what: impl fmt::Display) {
        self.faults.file.push(format!("{key}: {what}"));
    }

    fn lacks(&mut self, key: &str, what: impl fmt::Display) {
        self.faults.machine.push(format!("{key}: {what}"));
    }

    /// The job must be one, and fit the station.
    fn job(&mut self) {
        if let Some(path) = &self.config.station.job
            && let Err(error) = role::load_job(path, self.config)
        {
            self.fault("station.job", error);
        }
    }

    /// The folder from which a PLC selects. A job that does not fit may be meant for another station that has the same folder.
    fn jobs(&mut self) {
        let folder = &self.config.station.jobs;
        if !(self.config.plc.enable && self.config.plc.writes) {
            return;
        }
        let files = match role::job_files(folder) {
            Ok(files) => files,
            Err(error) => {
                let what = format!("{}: {error}; a PLC selects jobs from there", folder.display());
                return self.fault("station.jobs", what);
            }
        };
        for file in files {
            match role::read_job(&file) {
                // It was removed since it was listed.
                Err(_) if !file.exists() => (),
                Err(error) => self.fault("station.jobs", error),
                Ok(job) => {
                    if let Err(misfit) = compatibility::station(&job, self.config) {
                        println!("{}: not for this station: {misfit}", file.display());
                    }
                }
            }
        }
    }

    /// The models, the library that runs them, and the calibration.
    fn perception(&mut self) {
        if self.config.camera.source == Source::Tracks {
            return;
        }
        match perception::perceiver(self.config) {
            Err(error) => self.lacks("perception", error),
            Ok(_) => {
                if let Err(error) = Placer::new(self.config) {
                    self.fault("bench.calibration", error);
                }
            }
        }
    }

    /// The database, or the folder in which the role will make it.
    fn journal(&mut self) {
        let path = self.config.journal_path();
        let problem = if path.is_dir() {
            Some("is a folder, and must be a file".to_owned())
        } else if path.metadata().is_ok_and(|there| !there.is_file()) {
            Some("is a pipe or a device, and must be a file".to_owned())
        } else if path.exists() {
            unusable_journal(&path)
        } else {
            let folder = folder_of(&path);
            let refused = tempfile::tempfile_in(folder).err();
            refused.map(|error| format!("cannot be made: {}: {error}", folder.display()))
        };
        if let Some(problem) = problem {
            self.fault("journal.path", format!("{} {problem}", path.display()));
        }
    }

    /// What makes the board safe where other machines reach it.
    fn board(&mut self) {
        if self.config.board.enable
            && let Err(error) = boards::check(self.config)
        {
            self.faults.file.push(error.to_string());
        }
    }

    /// The folders in which the commands of an engineer write. The role makes those that are missing.
    fn executor(&mut self) {
        let config = self.config;
        if !config.executor.enable {
            return;
        }
        let made = Made::new(config);
        let [own @ .., jobs] = made.folders();
        for (key, folders) in [("station.jobs", &[jobs][..]), ("executor.path", &own[..])] {
            if let Some(problem) = folders.iter().find_map(|folder| unwritable(folder)) {
                let remedy = "let the user of the units write there, or name a folder below /var/lib/andon";
                self.fault(key, format!("{problem}: an engineer's commands write there; {remedy}"));
            }
        }
        let films = made.films_folder();
        if let Some(problem) = Some(films).filter(|films| !films.is_dir()).and_then(unwritable) {
            self.fault("executor.films", format!("{problem}: make this folder, or name another one"));
        }
    }

    /// The camera or the recording.
    fn source(&mut self) {
        let opened = match (self.config.camera.source, &self.config.camera.path) {
            (Source::Tracks, Some(path)) => open_tracks(path),
            (Source::Tracks, None) => Ok(()),
            _ => open_with_helper(self.config),
        };
        match opened {
            Err(error) if self.config.camera.source.is_live() => self.lacks(CAMERA, error),
            Err(error) => self.fault(CAMERA, error),
            Ok(()) => (),
        }
    }

    fn port(&mut self) {
        let plc = &self.config.plc;
        if plc.enable
            && let Err(error) = TcpListener::bind((plc.bind, plc.port))
        {
            self.lacks("plc.port", format!("{}:{} cannot be listened on: {error}", plc.bind, plc.port));
        }
    }
}

/// Why nothing can be written in a folder, where it is there or has to be made.
fn unwritable(folder: &Path) -> Option<String> {
    let there = folder.ancestors().find(|folder| folder.exists()).unwrap_or(folder);
    let refused = tempfile::tempfile_in(there).err()?;
    let what = if there == folder { "written" } else { "made" };
    Some(format!("{} cannot be {what}: {}: {refused}", folder.display(), there.display()))
}

/// What is wrong with an existing database.
fn unusable_journal(path: &Path) -> Option<String> {
    let mut begin = Vec::new();
    let read = file::open(path).and_then(|file| file.take(SQLITE.len() as u64).read_to_end(&mut begin));
    if let Err(error) = read {
        return Some(format!("cannot be read: {error}"));
    }
    if !begin.is_empty() && begin != SQLITE {
        return Some(
            "is not a journal: it would be put aside, and a new one begun; name another file".into(),
        );
    }
    if begin.is_empty() {
        return None;
    }
    // One verdict is enough to see that the tables are there; a new database has none.
    let newest = Query { since_utc_ns: Some(u64::MAX >> 1), ..Query::default() };
    let opened = History::open(path).and_then(|history| history.visit(&newest, |_| Ok(())));
    opened.err().map(|error| format!("cannot be used: {error}"))
}

fn open_tracks(path: &Path) -> Result<(), String> {
    let file = file::open(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let mut reader = TrackReader::new(&path.display().to_string(), std::io::BufReader::new(file))
        .map_err(|error| error.to_string())?;
    reader.next().transpose().map(drop).map_err(|error| error.to_string())
}

/// Only `andond-video` can open pictures.
fn open_with_helper(config: &Config) -> Result<(), String> {
    let path = helper_path();
    let mut command = Command::new(&path);
    command.arg("check").envs([("OPENCV_LOG_LEVEL", "OFF"), ("OPENCV_FFMPEG_LOGLEVEL", "-8")]);
    for file in &config.files {
        command.arg("--config").arg(file);
    }
    let output = command
        .stdin(Stdio::null())
        .output()
        .map_err(|error| format!("cannot start {}: {error}", path.display()))?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    Err(said.trim().lines().last().unwrap_or("andond-video ended without a message").to_owned())
}
