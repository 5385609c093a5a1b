//! The life of a process of the line. What all of them share is in `cycle`: each waits, takes, steps and publishes alike.
//!
//! A program that has a role calls [`start_log`], and then [`run_with`] with what the role does in its [`Cycle`].

mod consumer;
mod cycle;
mod error;
mod input;
mod liveness;
mod output;
mod player;
mod upstream;

use std::time::Duration;

use andon_ipc::{Node, Stop};
use shm_schemas::RoleId;

use crate::config::Config;
use crate::exit::Code;
use crate::log::{self, code, log};
use crate::taken::Taken;

pub use consumer::{Consumer, Row};
pub use cycle::{Cycle, Role, Turn};
pub use error::{CycleError, Ending, Failure};
pub use input::{Flagged, Input};
pub use liveness::Liveness;
pub use output::{Output, Publish};
pub use player::{Played, Player, Recording};

/// How long a role waits for its steward: a station boots its units side by side.
pub const PATIENCE: Duration = Duration::from_secs(20);

/// A role whose fault will still be there at its next start waits this long before it ends.
const LASTING: Duration = Duration::from_secs(2);

/// Longest wait for a message: the heartbeat has to come around.
pub const WAIT: Duration = andon_ipc::Heartbeat::PERIOD;

/// Starts the log of a role's process.
pub fn start_log(role: RoleId, taken: &Taken) {
    let config = &taken.config;
    // It fails where a test or a tool has started one: then that one is used.
    let _ = log::start(role.name(), &config.station.name, config.log.level);
    if let Some(changed) = &taken.changed {
        let hash = config.hash();
        log!(
            code::CONFIGURATION_CHANGED,
            "the line goes on with what it started with (hash {hash:016x}); {changed}"
        );
    }
}

/// Joins the station and runs a role's loop until it is asked to stop.
pub fn run_with<E: Failure>(
    config: &Config,
    role: RoleId,
    body: impl FnOnce(&Node) -> Result<(), E>,
) -> Code {
    finish_with(|stop| {
        let open = || {
            let node = Node::open(&config.ipc_station()?, role, PATIENCE, stop)?;
            Ok::<_, CycleError>(
                node.with_configuration(config.hash()).with_deadline(config.health.deadline(role)),
            )
        };
        body(&open()?)
    })
}

/// Does the work of a process that signals may stop.
pub fn finish_with<E: Failure>(work: impl FnOnce(&Stop) -> Result<(), E>) -> Code {
    let stop = match Stop::on_signals() {
        Ok(stop) => stop,
        Err(error) => return finish(Err(CycleError::from(error))),
    };
    let outcome = work(&stop);
    let is_lasting = outcome.as_ref().is_err_and(Failure::is_lasting);
    let code = finish(outcome);
    if is_lasting {
        // The unit starts it again at once, and would meet the same.
        stop.wait(LASTING);
    }
    code
}

/// Logs why a role ended and gives its exit code.
pub fn finish(outcome: Result<(), impl Failure>) -> Code {
    match outcome {
        Ok(()) => {
            log!(code::ROLE_STOPPING, "stopped");
            Code::Stopped
        }
        Err(error) => error.report(),
    }
}
