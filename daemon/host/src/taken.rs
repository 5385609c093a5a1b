//! The configuration that all roles of a running line share. It is taken once, when the line starts. A role that is started again while somebody
//! edits the files goes on with what the others have.
//!
//! A role that crashes while somebody edits must not run with half of an edit. The steward keeps the copy, and its orderly stop ends it.

use std::path::{Path, PathBuf};

use crate::atomic;
use crate::config::{Config, Faults, in_force};

/// The copy in the station's directory, which the steward makes.
const COPY: &str = "configuration.toml";

/// A configuration, and how it stands to the files.
#[derive(Debug)]
pub struct Taken {
    /// What is in force.
    pub config: Config,
    /// Why the files are not what is in force, where they are not.
    pub changed: Option<Changed>,
}

/// How the files differ from what the line has taken.
#[derive(Debug)]
pub enum Changed {
    /// They say something else.
    Differs(u64),
    /// They have faults.
    Faulty(Faults),
}

impl std::fmt::Display for Changed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Differs(hash) => write!(f, "the files have changed since (hash {hash:016x})"),
            Self::Faulty(faults) => write!(f, "the files have changed since, and have faults: {faults}"),
        }
    }
}

/// What the running line has taken; the files themselves where no line runs.
///
/// # Errors
/// Every fault of the files.
pub fn running(files: &[PathBuf]) -> Result<Taken, Faults> {
    let (read, faults) = Config::read_leniently(files);
    match Config::load(&[copy_of(&read)]) {
        Ok(config) if config.station.name == read.station.name => {
            let changed = match faults {
                Some(faults) => Some(Changed::Faulty(faults)),
                None => (config.hash() != read.hash()).then(|| Changed::Differs(read.hash())),
            };
            Ok(Taken { config: Config { files: files.to_vec(), ..config }, changed })
        }
        // There is none, or nobody can use it.
        _ => faults.map_or(Ok(Taken { config: read, changed: None }), Err),
    }
}

/// What a steward takes: that of the others where the line runs already, else the files.
///
/// # Errors
/// Every fault of the files.
pub fn for_steward(files: &[PathBuf]) -> Result<Taken, Faults> {
    let (read, _) = Config::read_leniently(files);
    let is_in_use = read.ipc_station().is_ok_and(|station| station.is_in_use());
    if is_in_use {
        return running(files);
    }
    Ok(Taken { config: Config::load(files)?, changed: None })
}

/// Keeps the configuration for those who start later, unless it is kept already.
///
/// # Errors
/// What the system says.
pub fn keep(config: &Config) -> std::io::Result<()> {
    let copy = copy_of(config);
    if copy.exists() {
        return Ok(());
    }
    atomic::write(&copy, in_force(config).as_bytes())
}

/// The line ends: the next one takes the files again.
pub fn forget(config: &Config) {
    // What cannot be removed now is swept away by the next steward that is alone.
    let _ = std::fs::remove_file(copy_of(config));
}

fn copy_of(config: &Config) -> PathBuf {
    // A station without a name has no directory, and no file is called like that.
    let root =
        if config.station.name.is_empty() { Path::new("/nonexistent").to_owned() } else { config.root() };
    root.join(COPY)
}
