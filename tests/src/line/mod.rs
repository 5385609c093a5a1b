//! A whole line as its real processes, fed by a simulated worker's track file: a station of its own under /tmp.
//!
//! It is started and supervised as systemd would, and watched only from outside: by the channels, by Modbus, by `andond`'s
//! own commands and by `/proc`.
#![allow(clippy::unwrap_used, clippy::panic)]

mod client;
mod journalled;
mod process;
mod watcher;

pub use client::{Modbus, status};
pub use journalled::Journalled;
pub use process::{Process, andond, own_memory_kib};
pub use watcher::{Watcher, role_id};

use crate::simulator::{Flaw, Noise, Performance, perform};
use andon_core::input::Frame;
use andon_ipc::Station;
use andon_learn::recording::{self, Header};
use std::ffi::OsString;
use std::fs;
use std::io::BufWriter;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::OnceLock;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Prints the report of a long check and writes it to a file.
pub fn report(path: &str, text: &str) {
    println!("{text}");
    if let Some(folder) = Path::new(path).parent() {
        fs::create_dir_all(folder).unwrap();
    }
    fs::write(path, text).unwrap();
}

/// The roles of a line without pictures, in the order in which a target starts them.
pub const ROLES: [&str; 6] = ["steward", "perceive", "encode", "judge", "journal", "plc"];

/// How the worker is played.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// As fast as the readers go, instead of at the worker's own pace.
    pub at_full_speed: bool,
    /// Again and again.
    pub repeat: bool,
    /// Whether the PLC may write.
    pub writes: bool,
    /// What the worker does wrong.
    pub flaw: Flaw,
}

impl Default for Settings {
    fn default() -> Self {
        Self { at_full_speed: true, repeat: false, writes: false, flaw: Flaw::None }
    }
}

/// A station with its files. Dropped, it leaves nothing behind.
pub struct Line {
    /// Running roles; see [`Line::start`].
    pub roles: Vec<Process>,
    /// The station.
    pub station: Station,
    /// Where Modbus listens.
    pub port: u16,
    /// Variables that roles started from now on get.
    pub environment: Vec<(&'static str, OsString)>,
    folder: TempDir,
}

impl Line {
    /// Lays out the station; nothing runs yet.
    pub fn new(settings: Settings) -> Self {
        let line = Self::configured(|folder, port| {
            let (recording, _) = perform(&performance(9, 1), settings.flaw);
            save(&folder.join("work.tracks.jsonl"), &recording);
            configuration(settings, folder, port, &recording.header)
        });
        fs::write(line.path("job.toml"), job(&line.config())).unwrap();
        line
    }

    /// Lays out a station with a configuration of its own, made for its folder and for a free port.
    pub fn configured(configuration: impl FnOnce(&Path, u16) -> String) -> Self {
        // Under /tmp whatever TMPDIR says: the path must be short.
        let folder = tempfile::Builder::new().prefix("andon-").tempdir_in("/tmp").unwrap();
        let station = Station::under("line", &folder.path().join("line")).unwrap();
        let port = free_port();
        fs::write(folder.path().join("station.toml"), configuration(folder.path(), port)).unwrap();
        Self { roles: Vec::new(), station, port, environment: Vec::new(), folder }
    }

    /// A file of the station.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Its configuration file.
    pub fn config(&self) -> PathBuf {
        self.path("station.toml")
    }

    /// The worker's track file.
    pub fn tracks(&self) -> PathBuf {
        self.path("work.tracks.jsonl")
    }

    /// Starts a role.
    pub fn start(&mut self, role: &'static str) -> &mut Process {
        self.roles.retain(|running| running.role != role);
        self.roles.push(Process::start(role, &self.config(), &self.log_path(role), &self.environment));
        self.roles.last_mut().unwrap()
    }

    /// Starts every role; what is told from the beginning can be heard.
    pub fn launch(&mut self) -> Watcher {
        self.start("steward");
        let watcher = Watcher::join(&self.station);
        self.start_all_but(&["steward"]);
        watcher
    }

    /// Starts every role, and waits until each runs.
    pub fn up(&mut self) -> Watcher {
        let mut watcher = self.launch();
        for role in ROLES {
            let pid = self.role(role).pid();
            watcher.until(role, |watcher| watcher.runs(role_id(role), pid));
        }
        watcher
    }

    /// Changes the recording that will be played.
    pub fn edit_tracks(&self, edit: impl FnOnce(&mut [Frame])) {
        let mut recording = recording::read("work", &fs::read(self.tracks()).unwrap()).unwrap();
        edit(&mut recording.frames);
        save(&self.tracks(), &recording);
    }

    /// Starts every role but these.
    pub fn start_all_but(&mut self, without: &[&str]) {
        for role in ROLES.into_iter().filter(|role| !without.contains(role)) {
            self.start(role);
        }
    }

    /// A running role.
    pub fn role(&mut self, role: &str) -> &mut Process {
        self.roles.iter_mut().find(|running| running.role == role).unwrap()
    }

    /// What a role has logged since the station was laid out.
    pub fn log(&self, role: &str) -> String {
        fs::read_to_string(self.log_path(role)).unwrap_or_default()
    }

    /// Waits for a message in a role's log, which must end with what to do; panics after a minute.
    pub fn logs(&self, role: &str, code: &str, remedy: &str) {
        let until = Instant::now() + Duration::from_secs(60);
        loop {
            let log = self.log(role);
            if let Some(message) = log.lines().find(|message| message.contains(code)) {
                assert!(message.contains(remedy), "{message}");
                return;
            }
            assert!(Instant::now() < until, "{role} does not say {code}:\n{log}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    fn log_path(&self, role: &str) -> PathBuf {
        self.path(&format!("{role}.log"))
    }

    /// Runs a command of `andond` on this station.
    pub fn command(&self, command: &str, arguments: &[&str]) -> Output {
        process::run(command, &self.config(), arguments)
    }

    /// As [`Line::stop`], without the steward: it cleans up only after those who left before it.
    pub fn stop_all_but_steward(&mut self) -> Vec<String> {
        self.stop_these(&ROLES[1..])
    }

    /// Stops every role along the data path, so that each takes what the one before it has sent, and the steward last;
    /// says which did not end well.
    pub fn stop(&mut self) -> Vec<String> {
        let mut bad = self.stop_all_but_steward();
        bad.extend(self.stop_these(&ROLES[..1]));
        bad
    }

    fn stop_these(&mut self, names: &[&str]) -> Vec<String> {
        let mut bad = Vec::new();
        for &name in names {
            let Some(place) = self.roles.iter().position(|role| role.role == name) else { continue };
            if let Err(how) = self.roles.remove(place).stop() {
                bad.push(format!("{name}: {how}"));
            }
        }
        bad
    }

    /// What the journal holds, by the real command.
    pub fn journal(&self) -> Journalled {
        let output = self.command("history", &["--csv"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Journalled::read(&String::from_utf8(output.stdout).unwrap())
    }

    /// Files of this station in /dev/shm.
    pub fn shared_files(&self) -> Vec<String> {
        let prefix = self.station.shm_prefix();
        let names = fs::read_dir("/dev/shm").unwrap().flatten();
        let names = names.map(|entry| entry.file_name().to_string_lossy().into_owned());
        names.filter(|name| name.starts_with(&prefix)).collect()
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        self.roles.clear();
        for name in self.shared_files() {
            let _ = fs::remove_file(format!("/dev/shm/{name}"));
        }
    }
}

fn performance(person: u64, repetition: u64) -> Performance {
    Performance { seed: 4, person, repetition, noise: Noise::default() }
}

fn save(path: &Path, recording: &recording::Recording) {
    let file = BufWriter::new(fs::File::create(path).unwrap());
    let mut file = file;
    recording::write(&mut file, &recording.header, &recording.frames).unwrap();
}

/// A port that was free a moment ago.
fn free_port() -> u16 {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}

fn configuration(settings: Settings, root: &Path, port: u16, header: &Header) -> String {
    let Settings { at_full_speed, repeat, writes, .. } = settings;
    let speed = if at_full_speed { "max" } else { "file" };
    let mut text = format!(
        "[station]\nname = \"line\"\nroot = {root:?}\njob = \"job.toml\"\n\n\
         [camera]\nsource = \"tracks\"\npath = \"work.tracks.jsonl\"\nspeed = \"{speed}\"\nloop = {repeat}\n\n\
         [journal]\npath = \"journal.sqlite\"\n\n\
         [plc]\nenable = true\nport = {port}\nwrites = {writes}\n"
    );
    for object in &header.objects {
        let points: Vec<[f32; 3]> = object.shape.interaction_points.iter().copied().collect();
        text += &format!(
            "\n[[objects]]\nid = {}\nname = {:?}\nmarker_side_m = 0.03\ninteraction_points = {points:?}\n",
            object.shape.id, object.name
        );
    }
    text
}

/// The job, taught by the real command; once a process, because it is the same for every line.
fn job(config: &Path) -> &'static [u8] {
    static JOB: OnceLock<Vec<u8>> = OnceLock::new();
    JOB.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("job.toml");
        let mut arguments = vec!["--out".to_owned(), out.to_str().unwrap().to_owned()];
        for (person, repetition) in [(1, 1), (2, 1), (3, 1), (4, 1), (9, 2), (9, 3)] {
            let path = folder.path().join(format!("p{person}_r{repetition}.tracks.jsonl"));
            save(&path, &perform(&performance(person, repetition), Flaw::None).0);
            arguments.push(path.to_str().unwrap().to_owned());
        }
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let output = process::run("teach", config, &arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        fs::read(out).unwrap()
    })
}
