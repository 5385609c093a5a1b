//! The arguments that every program of a station has: which configuration, and which role.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use shm_schemas::RoleId;

use crate::config::{Config, Faults};
use crate::taken::{self, Taken};

/// Where a configuration is looked for when none is named: in a source tree, then in an installation.
const DEFAULT_CONFIGS: [&str; 2] = ["config/stations/demo.toml", "/etc/andon/andon.toml"];

/// The variable that names a configuration where no option does.
const CONFIG_VARIABLE: &str = "ANDON_CONFIG";

/// The configuration that most commands read.
#[derive(Clone, Debug, Default, Args)]
pub struct ConfigArgs {
    /// Configuration files; a later one overrides an earlier one [default: $ANDON_CONFIG, config/stations/demo.toml in
    /// the current folder, or /etc/andon/andon.toml]
    #[arg(short = 'c', long = "config", value_name = "FILE")]
    pub files: Vec<PathBuf>,
}

impl ConfigArgs {
    /// Whether somebody has named a configuration.
    #[must_use]
    pub fn is_named(&self) -> bool {
        !self.files.is_empty() || std::env::var_os(CONFIG_VARIABLE).is_some()
    }

    /// The configuration files that are in force; none where none is named and none lies where one is looked for.
    #[must_use]
    pub fn in_force(&self) -> Vec<PathBuf> {
        if !self.files.is_empty() {
            return self.files.clone();
        }
        if let Some(named) = std::env::var_os(CONFIG_VARIABLE) {
            return vec![named.into()];
        }
        DEFAULT_CONFIGS.iter().map(PathBuf::from).find(|path| path.exists()).into_iter().collect()
    }

    /// As [`Self::in_force`], for a command that needs one.
    ///
    /// # Errors
    /// That there is none.
    pub fn existing(&self) -> Result<Vec<PathBuf>, NoConfiguration> {
        let files = self.in_force();
        if files.is_empty() { Err(NoConfiguration) } else { Ok(files) }
    }

    /// Reads the configuration that is in force.
    ///
    /// # Errors
    /// That there is none, and every fault in it.
    pub fn load(&self) -> Result<Config, ConfigError> {
        Ok(Config::load(&self.existing()?)?)
    }
}

/// No configuration was named, and none lies where one is looked for.
#[derive(Debug, thiserror::Error)]
#[error(
    "no configuration: name a station with --config FILE or $ANDON_CONFIG; there is none at {}, and only track files need none",
    DEFAULT_CONFIGS.join(" and ")
)]
pub struct NoConfiguration;

/// Why there is no configuration to start with. A process that meets it ends with [`crate::exit::Code::Configuration`].
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// There is none.
    #[error(transparent)]
    Missing(#[from] NoConfiguration),
    /// It has faults.
    #[error(transparent)]
    Faults(#[from] Faults),
}

/// `andond run`
#[derive(Debug, Args)]
pub struct Run {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Use the files as they are, even if the running line uses others
    #[arg(long)]
    pub as_given: bool,
    /// The role
    #[arg(value_enum)]
    pub role: Role,
}

impl Run {
    /// The configuration that the role runs with: what the line has taken when it started, or what the files say.
    ///
    /// # Errors
    /// That there is none, and every fault in it.
    pub fn take_config(&self) -> Result<Taken, ConfigError> {
        let files = self.config.existing()?;
        Ok(match self.role {
            _ if self.as_given => Taken { config: Config::load(&files)?, changed: None },
            Role::Steward => taken::for_steward(&files)?,
            _ => taken::running(&files)?,
        })
    }
}

/// A role of the line, one process each, in the order of the data path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Role {
    /// Owns every channel and removes what dead processes leave behind
    Steward,
    /// Takes frames from the camera or the recording
    Capture,
    /// Turns frames into detections
    Perceive,
    /// Turns detections into feature couples
    Encode,
    /// Turns feature couples into verdicts
    Judge,
    /// Writes verdicts to the database
    Journal,
    /// Passes verdicts to the PLC, and its commands to the judge
    Plc,
    /// Counts what the line does, for a monitoring system
    Metrics,
    /// Records what the line sees and says, to be looked at again
    Record,
    /// Shows the station to people: worker, technician and engineer
    Board,
    /// Runs the commands that an engineer orders on the board
    Executor,
}

impl From<Role> for RoleId {
    fn from(role: Role) -> Self {
        match role {
            Role::Steward => Self::Steward,
            Role::Capture => Self::Capture,
            Role::Perceive => Self::Perceive,
            Role::Encode => Self::Encode,
            Role::Judge => Self::Judge,
            Role::Journal => Self::Journal,
            Role::Plc => Self::Plc,
            Role::Metrics => Self::Metrics,
            Role::Record => Self::Record,
            Role::Board => Self::Board,
            Role::Executor => Self::Executor,
        }
    }
}
