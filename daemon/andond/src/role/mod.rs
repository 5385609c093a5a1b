//! The processes of the line, one file per role. What they share is in [`cycle`]: each waits, takes, steps and publishes alike.

mod capture;
mod clock;
mod cycle;
mod encode;
mod error;
mod jobs;
mod journal;
mod judge;
mod line;
mod liveness;
mod metrics;
mod output;
mod perceive;
mod player;
mod plc;
mod sight;
mod steward;
mod tracks;
mod visibility;

use std::time::Duration;

use clap::ValueEnum as _;

use andon_ipc::{Node, Station, Stop};
use shm_schemas::RoleId;

use crate::cli;
use crate::config::Config;
use crate::exit::Code;
use crate::log::{self, code, log};

pub use cycle::{Cycle, Ended, Flagged, Input, Role, Turn};
pub use error::{RoleError, report_camera};
pub use liveness::Liveness;
pub use output::{Output, Publish};
pub use player::{Played, Player, Recording};

/// How long a role waits for its steward: a station boots its units side by side.
const PATIENCE: Duration = Duration::from_secs(20);

/// Longest wait for a message: the heartbeat has to come around.
pub const WAIT: Duration = andon_ipc::Heartbeat::PERIOD;

/// Runs a role until it is asked to stop, and says how it ended.
pub fn run(role: cli::Role, config: &Config) -> Code {
    start_log(role, config);
    match role {
        cli::Role::Steward => finish(
            Stop::on_signals()
                .map_err(RoleError::from)
                .and_then(|stop| steward::run(&station(config)?, config, &stop)),
        ),
        cli::Role::Capture => finish(capture::replace_this_process()),
        cli::Role::Perceive => run_with(config, RoleId::Perceive, |node| perceive::run(node, config)),
        cli::Role::Encode => run_with(config, RoleId::Encode, |node| encode::run(node, config)),
        cli::Role::Judge => run_with(config, RoleId::Judge, |node| judge::run(node, config)),
        cli::Role::Journal => run_with(config, RoleId::Journal, |node| journal::run(node, config)),
        cli::Role::Plc => run_with(config, RoleId::Plc, |node| plc::run(node, config)),
        cli::Role::Metrics => run_with(config, RoleId::Metrics, |node| metrics::run(node, config)),
    }
}

/// Starts the log of a role's process.
pub fn start_log(role: cli::Role, config: &Config) {
    let name = role.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned());
    // It fails where a test or a tool has started one: then that one is used.
    let _ = log::start(&name, &config.station.name, config.log.level);
}

/// Joins the station and runs a role's loop until it is asked to stop.
pub fn run_with(config: &Config, role: RoleId, body: impl FnOnce(&Node) -> Result<(), RoleError>) -> Code {
    let join = || -> Result<Node, RoleError> {
        let node = Node::open(&station(config)?, role, PATIENCE, &Stop::on_signals()?)?;
        Ok(node.with_deadline(config.health.deadline(role)))
    };
    finish(join().and_then(|node| body(&node)))
}

/// Logs why a role ended and gives its exit code.
fn finish(outcome: Result<(), RoleError>) -> Code {
    match outcome {
        Ok(()) => {
            log!(code::ROLE_STOPPING, "stopped");
            Code::Stopped
        }
        Err(error) => error.report(),
    }
}

/// The station that the configuration names.
///
/// # Errors
/// A root that cannot be one.
pub fn station(config: &Config) -> Result<Station, RoleError> {
    Ok(Station::under(&config.station.name, &config.root())?)
}
