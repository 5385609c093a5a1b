//! `andond config`: the annotated reference, or the configuration in force.

use super::{ToolError, load_config};
use crate::cli::ConfigCommand;
use crate::config::{in_force, reference};
use crate::exit::Code;

/// Runs the command.
///
/// # Errors
/// Every fault of the configuration.
pub fn run(arguments: &ConfigCommand) -> Result<Code, ToolError> {
    let text = if arguments.default { reference() } else { in_force(&load_config(&arguments.config)?) };
    print!("{text}");
    Ok(Code::Stopped)
}
