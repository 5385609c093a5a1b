//! `andond config`: the annotated reference, or the configuration in force.

use andon_host::config::{in_force, reference};
use andon_host::exit::Code;

use super::{ToolError, load_config};
use crate::cli::ConfigCommand;

/// Runs the command.
///
/// # Errors
/// Every fault of the configuration.
pub fn run(arguments: &ConfigCommand) -> Result<Code, ToolError> {
    let text = if arguments.default { reference() } else { in_force(&load_config(&arguments.config)?) };
    print!("{text}");
    Ok(Code::Stopped)
}
