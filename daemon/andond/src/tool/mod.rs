//! The commands that a person runs, one file per command.

pub mod analyze;
mod audit;
pub mod backup;
pub mod board;
pub mod calibrate;
pub mod check;
pub mod clip;
pub mod config;
pub mod confirm;
pub mod demo;
mod error;
pub mod experiment;
pub mod explain;
pub mod forget;
pub mod history;
pub mod idle;
pub mod install;
mod job;
pub mod jobs;
mod join;
mod known_jobs;
mod labelled;
pub mod look;
pub mod markers;
pub mod name;
pub mod new;
pub mod pages;
pub mod part;
mod progress;
pub mod record;
pub mod replay;
pub mod restore;
mod runs;
pub mod segment;
mod since;
pub mod status;
mod stills;
pub mod tail;
pub mod teach;
mod tell;
pub mod tracks;
pub mod use_job;
pub mod whatif;

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use andon_core::input::Frame;
use andon_host::atomic::{self, folder_of};
use andon_host::cli::{ConfigArgs, NoConfiguration};
use andon_host::config::Config;
use andon_host::taken::{self, Taken};

use crate::recording::Recording;

pub use error::ToolError;
use progress::progress;
pub use progress::working;

/// Checks before the work, which takes minutes, that its result can be written afterwards. A file that exists is not
/// changed.
///
/// # Errors
/// Why it cannot, with the file.
fn check_writable(path: &Path) -> Result<(), ToolError> {
    let tried = if path.exists() {
        File::options().append(true).open(path).map(|_| ())
    } else {
        tempfile::tempfile_in(folder_of(path)).map(|_| ())
    };
    tried.map_err(cannot_write(path))
}

/// As [`check_writable`], for a result that replaces an existing file only by force.
///
/// # Errors
/// That the file exists, and why it cannot be written.
fn new_or_forced(path: &Path, force: bool) -> Result<(), ToolError> {
    // A pipe or a terminal is there to be written to.
    if !force && path.metadata().is_ok_and(|there| there.is_file() || there.is_dir()) {
        return Err(ToolError::Exists(path.into()));
    }
    check_writable(path)
}

/// Names the file that the system refuses to write.
fn cannot_write(path: &Path) -> impl Fn(io::Error) -> ToolError {
    |source| ToolError::Write { path: path.into(), source }
}

/// Writes several results: all of them, or none where one cannot be written.
///
/// # Errors
/// The file that cannot be written, and why.
fn write_together<'a>(files: impl IntoIterator<Item = (&'a Path, &'a [u8])>) -> Result<(), ToolError> {
    let files: Vec<_> = files.into_iter().collect();
    atomic::write_together(&files).map_err(|(path, error)| cannot_write(path)(error))
}

/// Exit code: an anomaly was found.
const ANOMALY: u8 = 1;
/// Exit code: nothing wrong was found, and something could not be judged.
const NOT_JUDGED: u8 = 2;

/// The exit code of verdicts, whether an anomaly is among them and whether anything was left open; 0 where all was right.
fn code_of_verdicts(is_anomaly: bool, is_open: bool) -> u8 {
    match (is_anomaly, is_open) {
        (true, _) => ANOMALY,
        (false, true) => NOT_JUDGED,
        (false, false) => 0,
    }
}

/// Reads the configuration that the arguments name, or the one that lies where it is looked for.
///
/// # Errors
/// Every fault in it.
fn load_config(arguments: &ConfigArgs) -> Result<Config, ToolError> {
    Ok(arguments.load()?)
}

/// The configuration for a command that reads these recordings, and neither the job nor the recording of the station. Track files say themselves what
/// they show. For them the defaults do, where no configuration is named and none lies where it is looked for.
///
/// # Errors
/// Every fault in it.
fn load_config_for(arguments: &ConfigArgs, recordings: &[PathBuf]) -> Result<Config, ToolError> {
    let know_theirs =
        !recordings.is_empty() && recordings.iter().all(|path| Recording::knows_its_station(path));
    match arguments.existing() {
        Err(NoConfiguration) if know_theirs => Ok(Config::default()),
        files => Ok(Config::load_to_learn(&files?)?),
    }
}

/// The configuration of the running line, for the tools that look at it.
///
/// # Errors
/// Every fault of the files, where no line runs that has taken them.
fn running_config(arguments: &ConfigArgs) -> Result<Taken, ToolError> {
    Ok(taken::running(&arguments.existing()?)?)
}

/// As [`load_config`], for the commands that make what a station needs, or read films of their own. Job, calibration and the station's own recording
/// do not need to exist yet.
///
/// # Errors
/// Every fault in it.
fn load_config_to_learn(arguments: &ConfigArgs) -> Result<Config, ToolError> {
    Ok(Config::load_to_learn(&arguments.existing()?)?)
}

/// Shows `take` every frame of a recording, with a progress bar, and says at the end what the recording has to warn of.
fn each_frame(
    recording: &mut Recording,
    path: &Path,
    mut take: impl FnMut(Frame) -> Result<(), ToolError>,
) -> Result<(), ToolError> {
    let bar = progress(recording.count(), path);
    while let Some(frame) = recording.next_frame()? {
        bar.inc(1);
        take(frame)?;
    }
    bar.finish_and_clear();
    recording.warnings(path).iter().for_each(|warning| eprintln!("{warning}"));
    Ok(())
}
