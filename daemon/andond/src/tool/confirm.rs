//! `andond confirm`: what a person says of the work that a verdict is on.

use andon_host::exit::Code;
use shm_schemas::AuditKind;

use super::{ToolError, audit, clip, running_config};
use crate::cli::Confirm;
use crate::confirmed::Confirmed;

/// Runs the command; it ends when the journal has it.
///
/// # Errors
/// A row that the journal does not have, and a journal that does not answer.
pub fn run(arguments: &Confirm) -> Result<Code, ToolError> {
    let config = running_config(&arguments.config)?.config;
    let verdict = clip::verdict(&config, arguments.row)?;
    let confirmed = Confirmed { row: arguments.row, id: verdict.stamp.id(), was: arguments.was.into() };
    audit::keep(&config, AuditKind::Confirmation, &confirmed.text())?;
    println!("kept: verdict {} was on work that was {}", arguments.row, confirmed.was.name());
    Ok(Code::Stopped)
}
