//! `andond status`: how every role of a running station is doing.

mod heard;
mod lines;
mod text;

use andon_host::taken::Taken;

use super::join::join;
use super::known_jobs::KnownJobs;
use super::{ToolError, running_config};
use crate::cli::Status;
use crate::clock::Clock;
use heard::Heard;
use lines::{ConfigurationLine, JobLine, RoleLine, StationLine};

/// Exit code: some role is not healthy.
const UNHEALTHY: u8 = 1;

/// Runs the command; the exit code says whether every role is healthy.
///
/// # Errors
/// A configuration with faults, or that the station cannot be joined.
pub fn run(arguments: &Status) -> Result<u8, ToolError> {
    let Taken { config, changed } = running_config(&arguments.config)?;
    let roles = config.roles();
    let heard = Heard::listen(&join(&config)?, &roles)?;
    let known = KnownJobs::of(&config);
    let line = |role| RoleLine::new(role, heard.newest(role), heard.core_share(role), config.hash());
    let lines: Vec<RoleLine> = roles.into_iter().map(line).collect();
    let station = StationLine {
        station: &config.station.name,
        healthy: lines.iter().all(|line| line.healthy),
        configuration: ConfigurationLine {
            hash: format!("{:016x}", config.hash()),
            changed: changed.as_ref().map(ToString::to_string),
        },
        job: heard.judging.as_ref().map(|judging| JobLine::new(judging, &known)),
        roles: &lines,
    };
    if arguments.json {
        println!("{}", serde_json::to_string(&station).map_err(|error| ToolError::Print(error.into()))?);
    } else {
        text::print(&station, &Clock::new(arguments.utc)).map_err(ToolError::Print)?;
    }
    Ok(if station.healthy { 0 } else { UNHEALTHY })
}
