//! The processes of the line, one file per role. What they share is in [`cycle`]: each waits, takes, steps and publishes alike.

mod audit;
mod capture;
mod clock;
mod cycle;
mod disabled;
mod encode;
mod error;
mod input;
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
mod twins;
mod upstream;
mod visibility;

use std::time::Duration;

use clap::ValueEnum as _;

use andon_ipc::{Node, Stop};
use shm_schemas::RoleId;

use crate::cli;
use crate::config::Config;
use crate::exit::Code;
use crate::log::{self, code, log};
use crate::taken::Taken;

pub(crate) use jobs::{job_files, load as load_job, read as read_job};

pub use cycle::{Cycle, Role, Turn};
pub use error::{RoleError, report_camera};
pub use input::{Flagged, Input};
pub use liveness::Liveness;
pub use output::{Output, Publish};
pub use player::{Played, Player, Recording};

/// How long a role waits for its steward: a station boots its units side by side.
const PATIENCE: Duration = Duration::from_secs(20);

/// A role whose fault will still be there at its next start waits this long before it ends.
const LASTING: Duration = Duration::from_secs(2);

/// Longest wait for a message: the heartbeat has to come around.
pub const WAIT: Duration = andon_ipc::Heartbeat::PERIOD;

/// Runs a role until it is asked to stop, and says how it ended.
pub fn run(role: cli::Role, taken: &Taken) -> Code {
    start_log(role, taken);
    let config = &taken.config;
    match role {
        cli::Role::Steward => finish_with(|stop| steward::run(&config.ipc_station()?, config, stop)),
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
pub fn start_log(role: cli::Role, taken: &Taken) {
    let config = &taken.config;
    let name = role.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned());
    // It fails where a test or a tool has started one: then that one is used.
    let _ = log::start(&name, &config.station.name, config.log.level);
    if let Some(changed) = &taken.changed {
        let hash = config.hash();
        log!(
            code::CONFIGURATION_CHANGED,
            "the line goes on with what it started with (hash {hash:016x}); {changed}"
        );
    }
}

/// Joins the station and runs a role's loop until it is asked to stop.
pub fn run_with(config: &Config, role: RoleId, body: impl FnOnce(&Node) -> Result<(), RoleError>) -> Code {
    finish_with(|stop| {
        let node = Node::open(&config.ipc_station()?, role, PATIENCE, stop)?;
        let node = node.with_configuration(config.hash()).with_deadline(config.health.deadline(role));
        body(&node)
    })
}

/// Does the work of a process that signals may stop.
fn finish_with(work: impl FnOnce(&Stop) -> Result<(), RoleError>) -> Code {
    let stop = match Stop::on_signals() {
        Ok(stop) => stop,
        Err(error) => return finish(Err(error.into())),
    };
    let outcome = work(&stop);
    let is_lasting = outcome.as_ref().is_err_and(RoleError::is_lasting);
    let code = finish(outcome);
    if is_lasting {
        // The unit starts it again at once, and would meet the same.
        stop.wait(LASTING);
    }
    code
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
