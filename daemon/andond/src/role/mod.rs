//! The processes of the line, one file a role, in the order of the data path. Each receives, steps and publishes.

pub mod capture;
mod clock;
mod encode;
mod error;
mod job;
mod journal;
mod judge;
mod perceive;
mod plc;
mod pulse;
mod rate;
mod sight;
mod steward;

use std::time::Duration;

use clap::ValueEnum as _;

use andon_ipc::{Node, Station, Stop, Wake};
use shm_schemas::RoleId;

use crate::cli::Role;
use crate::config::Config;
use crate::exit::Code;
use crate::log::{self, code, log};

pub use error::RoleError;
pub use pulse::Pulse;

/// How long a role waits for its steward: a station boots its units side by side.
const PATIENCE: Duration = Duration::from_secs(20);

/// Longest wait for a message: the heartbeat has to come around.
const WAIT: Duration = andon_ipc::Heartbeat::PERIOD;

/// Runs a role until it is asked to stop, and says how it ended.
pub fn run(role: Role, config: &Config) -> Code {
    start_log(role, config);
    match role {
        Role::Steward => finish(
            Stop::on_signals()
                .map_err(RoleError::from)
                .and_then(|stop| steward::run(&station(config)?, config, &stop)),
        ),
        Role::Capture => finish(capture::replace_this_process()),
        Role::Perceive => run_with(config, RoleId::Perceive, |node| perceive::run(node, config)),
        Role::Encode => run_with(config, RoleId::Encode, |node| encode::run(node, config)),
        Role::Judge => run_with(config, RoleId::Judge, |node| judge::run(node, config)),
        Role::Journal => run_with(config, RoleId::Journal, |node| journal::run(node, config)),
        Role::Plc => run_with(config, RoleId::Plc, |node| plc::run(node, config)),
    }
}

/// Starts the log of a role's process.
pub fn start_log(role: Role, config: &Config) {
    let name = role.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned());
    // It fails where a test or a tool has started one: then that one is used.
    let _ = log::start(&name, &config.station.name, config.log.level);
}

/// Joins the station and runs a role's loop until it is asked to stop.
pub fn run_with(config: &Config, role: RoleId, body: impl FnOnce(&Node) -> Result<(), RoleError>) -> Code {
    let join = || -> Result<Node, RoleError> {
        Ok(Node::open(&station(config)?, role, PATIENCE, &Stop::on_signals()?)?)
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
        Err(RoleError::Stopped | RoleError::Ipc(andon_ipc::Error::Stopped(_))) => Code::Stopped,
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

/// How long a paced writer waits for a reader that does not go on: longer than any restart takes.
const STUCK: Duration = Duration::from_secs(30);

/// Waits until a paced writer may send; a live one never waits.
fn wait_for_room(
    node: &Node,
    writer: &mut impl andon_ipc::Paced,
    pulse: &mut Pulse,
) -> Result<(), RoleError> {
    let began = std::time::Instant::now();
    loop {
        match node.wait_for_room(writer, WAIT)? {
            Wake::Room => return Ok(()),
            Wake::Stop => return Err(RoleError::Stopped),
            wake => pulse.beat_after(&wake)?,
        }
        if began.elapsed() > STUCK {
            return Err(RoleError::NoProgress(STUCK));
        }
    }
}
