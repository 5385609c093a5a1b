//! The processes of the line, one file per role. What they share is in [`andon_host::role`]: each waits, takes, steps and publishes alike.

mod audit;
mod board;
mod capture;
mod clock;
mod disabled;
mod duplicates;
mod encode;
mod error;
mod executor;
mod jobs;
mod journal;
mod judge;
mod line;
mod metrics;
mod perceive;
mod plc;
mod record;
mod sight;
mod steward;
mod tracks;
mod visibility;

use andon_host::cli;
use andon_host::exit::Code;
use andon_host::role::{finish, finish_with, run_with, start_log};
use andon_host::taken::Taken;
use shm_schemas::RoleId;

pub(crate) use jobs::{job_files, load as load_job, read as read_job};

pub(crate) use journal::retention;
pub(crate) use record::{CALIBRATION, CONFIGURATION, HASHES};

pub use error::RoleError;

/// Runs a role until it is asked to stop, and says how it ended.
pub fn run(role: cli::Role, taken: &Taken) -> Code {
    start_log(role.into(), taken);
    let config = &taken.config;
    match role {
        cli::Role::Steward => finish_with(|stop| steward::run(&config.ipc_station()?, config, stop)),
        cli::Role::Capture => finish(Err(capture::replace_this_process())),
        cli::Role::Perceive => run_with(config, RoleId::Perceive, |node| perceive::run(node, config)),
        cli::Role::Encode => run_with(config, RoleId::Encode, |node| encode::run(node, config)),
        cli::Role::Judge => run_with(config, RoleId::Judge, |node| judge::run(node, config)),
        cli::Role::Journal => run_with(config, RoleId::Journal, |node| journal::run(node, config)),
        cli::Role::Plc => run_with(config, RoleId::Plc, |node| plc::run(node, config)),
        cli::Role::Metrics => run_with(config, RoleId::Metrics, |node| metrics::run(node, config)),
        cli::Role::Record => run_with(config, RoleId::Record, |node| record::run(node, config)),
        cli::Role::Board => run_with(config, RoleId::Board, |node| board::run(node, config)),
        cli::Role::Executor => run_with(config, RoleId::Executor, |node| executor::run(node, config)),
    }
}
