//! `andond check`: reads the configuration and reports every fault in it.

use super::{ToolError, config_files};
use crate::cli::Check;
use crate::config::Config;
use crate::exit::Code;

/// Runs the command.
///
/// # Errors
/// Every fault of the configuration.
pub fn run(arguments: &Check) -> Result<Code, ToolError> {
    let files = config_files(&arguments.config);
    let config = Config::load(&files)?;
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    println!("{}: station {:?}, no fault", names.join(", "), config.station.name);
    Ok(Code::Stopped)
}
