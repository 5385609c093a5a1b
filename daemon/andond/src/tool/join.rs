//! Joins a running station, for the tools that only read.

use std::time::Duration;

use andon_host::config::Config;
use andon_ipc::{Node, Stop};
use shm_schemas::RoleId;

use super::ToolError;

/// How long a tool waits for a station that may just be starting.
const PATIENCE: Duration = Duration::from_secs(2);

/// Joins the station that the configuration names; Ctrl-C ends the waits.
///
/// # Errors
/// That no steward runs there, or that the station is of another version.
pub(super) fn join(config: &Config) -> Result<Node, ToolError> {
    let station = config.ipc_station().map_err(ToolError::Station)?;
    let stop = Stop::on_signals()?;
    Ok(Node::open(&station, RoleId::Tool, PATIENCE, &stop)?)
}
