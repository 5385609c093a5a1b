//! The commands that a person runs, one file per command.

pub mod analyze;
pub mod backup;
pub mod calibrate;
pub mod check;
mod clock;
pub mod config;
pub mod demo;
mod error;
pub mod experiment;
pub mod explain;
pub mod history;
pub mod idle;
mod job;
pub mod jobs;
mod join;
mod known;
mod labelled;
pub mod look;
pub mod markers;
pub mod new;
pub mod pages;
pub mod part;
mod progress;
pub mod record;
mod recorder;
pub mod replay;
pub mod restore;
mod runs;
pub mod segment;
pub mod status;
mod stills;
pub mod tail;
pub mod teach;
mod tell;
pub mod tracks;
pub mod use_job;

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use andon_core::input::Frame;

use crate::atomic::{self, folder_of};
use crate::cli::{self, ConfigArgs};
use crate::config::Config;
use crate::recording::Recording;
use crate::taken::{self, Taken};

pub use error::ToolError;
use progress::progress;
pub use progress::working;

/// Where a configuration is looked for when none is named: in a source tree, then in an installation.
const DEFAULT_CONFIGS: [&str; 2] = ["config/stations/demo.toml", "/etc/andon/andon.toml"];

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

/// Reads the configuration that the arguments name, or the one that lies where it is looked for.
///
/// # Errors
/// Every fault in it.
pub fn load_config(arguments: &ConfigArgs) -> Result<Config, ToolError> {
    Ok(Config::load(&existing_config_files(arguments)?)?)
}

/// The configuration for a command that reads these recordings, and neither the job nor the recording of the station. Track files say themselves
/// what they show: for them the defaults do, where no configuration is named and none lies where it is looked for.
///
/// # Errors
/// Every fault in it.
fn load_config_for(arguments: &ConfigArgs, recordings: &[PathBuf]) -> Result<Config, ToolError> {
    let are_tracks = !recordings.is_empty() && recordings.iter().all(|path| Recording::is_tracks(path));
    match existing_config_files(arguments) {
        Err(ToolError::NoConfiguration) if are_tracks => Ok(Config::default()),
        files => Ok(Config::load_to_learn(&files?)?),
    }
}

/// The configuration that a role runs with: what the line has taken when it started, or what the files say.
///
/// # Errors
/// Every fault in it.
pub fn take_config(arguments: &cli::Run) -> Result<Taken, ToolError> {
    let files = existing_config_files(&arguments.config)?;
    Ok(match arguments.role {
        _ if arguments.as_given => Taken { config: Config::load(&files)?, changed: None },
        cli::Role::Steward => taken::for_steward(&files)?,
        _ => taken::running(&files)?,
    })
}

/// The configuration of the running line, for the tools that look at it.
///
/// # Errors
/// Every fault of the files, where no line runs that has taken them.
fn running_config(arguments: &ConfigArgs) -> Result<Taken, ToolError> {
    Ok(taken::running(&existing_config_files(arguments)?)?)
}

/// As [`load_config`], for the commands that make what a station needs, or read films of their own: job, calibration and the station's own
/// recording do not need to exist yet.
///
/// # Errors
/// Every fault in it.
fn load_config_to_learn(arguments: &ConfigArgs) -> Result<Config, ToolError> {
    Ok(Config::load_to_learn(&existing_config_files(arguments)?)?)
}

fn existing_config_files(arguments: &ConfigArgs) -> Result<Vec<PathBuf>, ToolError> {
    let files = config_files(arguments);
    if files.is_empty() {
        return Err(ToolError::NoConfiguration);
    }
    Ok(files)
}

/// The variable that names a configuration where no option does.
const CONFIG_VARIABLE: &str = "ANDON_CONFIG";

/// Whether somebody has named a configuration.
fn is_named(arguments: &ConfigArgs) -> bool {
    !arguments.files.is_empty() || std::env::var_os(CONFIG_VARIABLE).is_some()
}

/// The configuration files that are in force.
fn config_files(arguments: &ConfigArgs) -> Vec<PathBuf> {
    if !arguments.files.is_empty() {
        return arguments.files.clone();
    }
    if let Some(named) = std::env::var_os(CONFIG_VARIABLE) {
        return vec![named.into()];
    }
    DEFAULT_CONFIGS.iter().map(PathBuf::from).find(|path| path.exists()).into_iter().collect()
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
