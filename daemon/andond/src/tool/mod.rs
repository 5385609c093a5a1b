//! What a person runs, one file a command.

pub mod analyze;
pub mod calibrate;
pub mod check;
pub mod config;
pub mod demo;
pub mod experiment;
pub mod history;
mod job;
mod join;
pub mod record;
pub mod replay;
pub mod segment;
pub mod status;
pub mod tail;
pub mod teach;

use std::fmt;
use std::fs::File;
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressStyle};

use crate::cli::ConfigArgs;
use crate::config::{Config, Faults};
use crate::exit::Code;
use crate::recording::RecordingError;

/// Where a configuration is looked for when none is named: below the folder of a source tree, then of an installation.
const DEFAULT_CONFIGS: [&str; 2] = ["config/stations/demo.toml", "/etc/andon/andon.toml"];

/// Why a command ended, with the exit code that says so.
#[derive(Debug)]
pub struct Failure {
    code: Code,
    message: String,
}

impl Failure {
    /// A failure with its exit code.
    pub fn new(code: Code, message: impl fmt::Display) -> Self {
        Self { code, message: message.to_string() }
    }

    /// What the process ends with.
    pub fn code(&self) -> Code {
        self.code
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl From<RecordingError> for Failure {
    fn from(error: RecordingError) -> Self {
        let code = match error {
            RecordingError::Perception(_) | RecordingError::Setup(_) => Code::Configuration,
            _ => Code::Usage,
        };
        Self::new(code, error)
    }
}

impl From<Faults> for Failure {
    fn from(faults: Faults) -> Self {
        Self::new(Code::Configuration, faults)
    }
}

/// Whether a file can be written once it is known what to write: asked before the work, which takes minutes. Nothing of
/// what is there is changed.
///
/// # Errors
/// Why it cannot, with the file.
pub(crate) fn will_write(path: &Path) -> Result<(), Failure> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let tried = if path.exists() {
        File::options().append(true).open(path).map(|_| ())
    } else {
        tempfile::tempfile_in(folder).map(|_| ())
    };
    tried.map_err(|error| {
        let text =
            format!("{}: it cannot be written: {error}; name a file in a folder of yours", path.display());
        Failure::new(Code::Usage, text)
    })
}

/// Reads the configuration that the arguments name, or the one that lies where it is looked for.
///
/// # Errors
/// Every fault in it.
pub fn load_config(arguments: &ConfigArgs) -> Result<Config, Failure> {
    Ok(Config::load(&existing_config_files(arguments)?)?)
}

/// As [`load_config`], for the commands that make the job and the calibration: these need not be there yet.
///
/// # Errors
/// Every fault in it.
pub fn load_config_to_learn(arguments: &ConfigArgs) -> Result<Config, Failure> {
    Ok(Config::load_to_learn(&existing_config_files(arguments)?)?)
}

fn existing_config_files(arguments: &ConfigArgs) -> Result<Vec<PathBuf>, Failure> {
    let files = config_files(arguments);
    if files.is_empty() {
        let looked = DEFAULT_CONFIGS.join(" and ");
        let message = format!(
            "no configuration: name a station with --config FILE or $ANDON_CONFIG; there is none at {looked}"
        );
        return Err(Failure::new(Code::Configuration, message));
    }
    Ok(files)
}

/// The configuration files that are in force.
pub fn config_files(arguments: &ConfigArgs) -> Vec<PathBuf> {
    if !arguments.files.is_empty() {
        return arguments.files.clone();
    }
    if let Some(named) = std::env::var_os("ANDON_CONFIG") {
        return vec![named.into()];
    }
    DEFAULT_CONFIGS.iter().map(PathBuf::from).find(|path| path.exists()).into_iter().collect()
}

/// A bar on standard error, which shows nothing where that is no terminal.
pub fn progress(count: Option<u64>, what: &Path) -> ProgressBar {
    let name = what.file_name().unwrap_or(what.as_os_str()).to_string_lossy().into_owned();
    let (bar, template) = match count {
        Some(count) => {
            (ProgressBar::new(count), "{msg:28} [{bar:32}] {pos}/{len} frames, {per_sec}, {eta} left")
        }
        None => (ProgressBar::new_spinner(), "{msg:28} {spinner} {pos} frames, {per_sec}"),
    };
    // The templates above are constants that are well formed.
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    bar.with_style(style.progress_chars("=> ")).with_message(name)
}
