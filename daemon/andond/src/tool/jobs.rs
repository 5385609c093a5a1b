//! `andond jobs`: the jobs of a station, and which of them is in force.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use andon_host::config::Config;
use andon_host::exit::Code;
use andon_host::taken;
use andon_ipc::{Heartbeat, Reader, Wake};
use andon_learn::job_file::JobFile;
use serde::Serialize;
use shm_schemas::Judging;

use super::ToolError;
use super::check::neighbours;
use super::join::join;
use crate::cli::Jobs;
use crate::compatibility;
use crate::role;

/// How long a judge that runs may be silent: it says everything with every beat.
const LISTEN: Duration = Duration::from_millis(3 * Heartbeat::PERIOD.as_millis() as u64);

/// Runs the command.
///
/// # Errors
/// A configuration with faults, and a folder that cannot be read.
pub fn run(arguments: &Jobs) -> Result<Code, ToolError> {
    let config = match arguments.config.existing() {
        // A folder needs no station.
        Err(_) if arguments.folder.is_some() => None,
        files => Some(taken::running(&files?)?.config),
    };
    let jobs = match (&arguments.folder, &config) {
        (Some(folder), _) => in_folder(folder)?,
        (None, Some(config)) => of_station(config)?,
        // Without a configuration there is a folder.
        (None, None) => FoundJobs::default(),
    };
    let users = config.as_ref().map(Users::of).unwrap_or_default();
    let rows: Vec<JobRow<'_>> =
        jobs.jobs.iter().map(|job| JobRow::new(job, config.as_ref(), &users)).collect();
    let mut out = std::io::stdout().lock();
    let printed = if arguments.json { print_json(&rows, &mut out) } else { print_table(&rows, &mut out) };
    printed.map_err(ToolError::Print)?;
    for fault in &jobs.faults {
        eprintln!("{fault}");
    }
    if let Some(config) = config.filter(|_| rows.is_empty() && arguments.folder.is_none()) {
        let folder = config.station.jobs.display();
        eprintln!("the station has no job yet: write one there with `andond teach --out {folder}/NAME.toml`");
    }
    Ok(Code::Stopped)
}

/// A job file that could be read.
#[derive(Debug)]
pub(super) struct FoundJob {
    pub(super) path: PathBuf,
    pub(super) file: JobFile,
    pub(super) hash: u64,
}

impl FoundJob {
    fn new(path: PathBuf, file: JobFile) -> Self {
        Self { path, hash: file.model_hash(), file }
    }
}

/// Job files by number and name, and what was wrong with the others.
#[derive(Debug, Default)]
pub(super) struct FoundJobs {
    pub(super) jobs: Vec<FoundJob>,
    pub(super) faults: Vec<String>,
}

/// The jobs that a station can load: those of its folder, and that of its configuration, which may lie elsewhere.
///
/// # Errors
/// A folder that cannot be read.
pub(super) fn of_station(config: &Config) -> Result<FoundJobs, ToolError> {
    let configured = config.station.job.as_deref();
    let mut found = match in_folder(&config.station.jobs) {
        // A station with one job has perhaps no folder of them, and a new one has it with its first job.
        Err(ToolError::Read { source, .. }) if source.kind() == ErrorKind::NotFound => FoundJobs::default(),
        Err(_) if configured.is_some() => FoundJobs::default(),
        found => found?,
    };
    if let Some(path) = configured.filter(|path| !found.jobs.iter().any(|job| is_same(&job.path, path))) {
        found.add(path.to_owned());
        found.sort();
    }
    Ok(found)
}

/// The job files of a station, whatever is in them: that of its configuration, and those of its folder.
///
/// # Errors
/// A folder that cannot be read.
pub(super) fn files_of_station(config: &Config) -> Result<Vec<PathBuf>, ToolError> {
    let mut files: Vec<PathBuf> = config.station.job.iter().cloned().collect();
    let folder = &config.station.jobs;
    if folder.is_dir() {
        files.extend(role::job_files(folder).map_err(unread(folder))?);
    }
    Ok(files)
}

fn unread(folder: &Path) -> impl Fn(std::io::Error) -> ToolError {
    |source| ToolError::Read {
        path: folder.into(),
        source,
        remedy: "name a folder of job files, or set station.jobs",
    }
}

/// The jobs of a folder.
///
/// # Errors
/// A folder that cannot be read.
pub(super) fn in_folder(folder: &Path) -> Result<FoundJobs, ToolError> {
    let mut found = FoundJobs::default();
    role::job_files(folder).map_err(unread(folder))?.into_iter().for_each(|path| found.add(path));
    found.sort();
    Ok(found)
}

impl FoundJobs {
    fn add(&mut self, path: PathBuf) {
        // As a person would name it: a configuration has its paths from its own folder.
        let path = std::fs::canonicalize(&path).unwrap_or(path);
        match role::read_job(&path) {
            Ok(file) => self.jobs.push(FoundJob::new(path, file)),
            Err(fault) => self.faults.push(fault.to_string()),
        }
    }

    fn sort(&mut self) {
        self.jobs.sort_by(|one, other| (one.file.id, &one.path).cmp(&(other.file.id, &other.path)));
    }
}

/// Whether two paths are one file.
pub(super) fn is_same(one: &Path, other: &Path) -> bool {
    let file = |path: &Path| std::fs::canonicalize(path).ok();
    file(one).is_some_and(|one| Some(one) == file(other))
}

/// Which stations begin with which jobs, and what the judge of the running one says.
#[derive(Default)]
struct Users {
    /// Names of stations with their `station.job`.
    begin_with: Vec<(String, PathBuf)>,
    judging: Option<Judging>,
}

impl Users {
    fn of(config: &Config) -> Self {
        let own = Some(config.clone()).filter(|config| !config.station.name.is_empty());
        let stations = own.into_iter().chain(neighbours::stations(config).map(|(_, other)| other));
        let begin_with = stations.filter_map(|config| Some((config.station.name, config.station.job?)));
        Self { begin_with: begin_with.collect(), judging: judging(config) }
    }

    fn is_in_force(&self, job: &FoundJob) -> bool {
        self.judging.is_some_and(|judging| (judging.job_id, judging.model_hash) == (job.file.id, job.hash))
    }
}

/// What the judge says, where the station runs.
fn judging(config: &Config) -> Option<Judging> {
    // A station that does not run is not waited for.
    config.ipc_station().ok().filter(|station| station.is_in_use())?;
    let node = join(config).ok()?;
    let mut reader: Reader<Judging> = node.reader().ok()?;
    let began = Instant::now();
    while began.elapsed() < LISTEN {
        if let Some(state) = reader.take().ok()? {
            return Some(*state);
        }
        if node.wait(&mut [&mut reader], Heartbeat::PERIOD).ok()? == Wake::Stop {
            break;
        }
    }
    None
}

/// A job as it is listed. The names are an interface: programs outside read them.
#[derive(Serialize)]
struct JobRow<'a> {
    id: u32,
    name: &'a str,
    /// The hash of its file, 16 hexadecimal digits.
    hash: String,
    /// When it was taught.
    date: &'a str,
    /// How many recordings it was taught from.
    runs: usize,
    steps: usize,
    file: &'a Path,
    /// Whether the running station judges by it.
    in_force: bool,
    /// The stations that begin with it.
    stations: Vec<&'a str>,
    /// Why this station cannot use it; null where it can.
    misfit: Option<String>,
}

impl<'a> JobRow<'a> {
    fn new(job: &'a FoundJob, config: Option<&Config>, users: &'a Users) -> Self {
        let file = &job.file;
        // Without objects there is no bench that a job could fit.
        let station = config.filter(|config| !config.objects.is_empty());
        let used = users.begin_with.iter().filter(|(_, path)| is_same(path, &job.path));
        Self {
            id: file.id,
            name: &file.name,
            hash: format!("{:016x}", job.hash),
            date: &file.provenance.date,
            runs: file.provenance.sources.iter().filter(|source| !source.left_out).count(),
            steps: file.steps.len(),
            file: &job.path,
            in_force: users.is_in_force(job),
            stations: used.map(|(name, _)| name.as_str()).collect(),
            misfit: station
                .and_then(|config| compatibility::station(file, config).err())
                .map(|misfit| misfit.to_string()),
        }
    }

    /// Where it is used, in words.
    fn used(&self) -> String {
        let in_force = self.in_force.then(|| "in force".to_owned());
        let begins =
            (!self.stations.is_empty()).then(|| format!("first job of {}", self.stations.join(", ")));
        let misfit = self.misfit.as_ref().map(|misfit| format!("does not fit this station: {misfit}"));
        let used: Vec<String> = [in_force, begins, misfit].into_iter().flatten().collect();
        if used.is_empty() { "-".to_owned() } else { used.join("; ") }
    }
}

fn print_json(rows: &[JobRow<'_>], out: &mut impl Write) -> std::io::Result<()> {
    for row in rows {
        serde_json::to_writer(&mut *out, row)?;
        writeln!(out)?;
    }
    Ok(())
}

fn print_table(rows: &[JobRow<'_>], out: &mut impl Write) -> std::io::Result<()> {
    let name = rows.iter().map(|row| row.name.chars().count()).max().unwrap_or(0).max("name".len());
    let path = |row: &JobRow<'_>| row.file.display().to_string();
    let file = rows.iter().map(|row| path(row).chars().count()).max().unwrap_or(0).max("file".len());
    writeln!(
        out,
        "number  {:name$}  hash              taught      runs  steps  {:file$}  used",
        "name", "file"
    )?;
    for row in rows {
        writeln!(
            out,
            "{:>6}  {:name$}  {}  {:10}  {:>4}  {:>5}  {:file$}  {}",
            row.id,
            row.name,
            row.hash,
            row.date,
            row.runs,
            row.steps,
            path(row),
            row.used()
        )?;
    }
    Ok(())
}
