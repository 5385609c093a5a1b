//! `andond name`: names the steps of a job. The job, its hash and what a PLC knows of it stay the same.

use andon_host::atomic;
use andon_host::exit::Code;
use andon_learn::job_file::JobFile;

use super::jobs::FoundJob;
use super::{ToolError, cannot_write, job, running_config};
use crate::cli::Name;

/// Runs the command.
///
/// # Errors
/// A job that is not there, names that are not one for each step, and a file that cannot be written.
pub fn run(arguments: &Name) -> Result<Code, ToolError> {
    let config = running_config(&arguments.config)?.config;
    let FoundJob { path, file, .. } = job::one(&arguments.job, &config)?;
    let named = JobFile { step_names: arguments.steps.clone(), ..file };
    let text = named.to_toml();
    // Whoever reads it next finds no fault in it.
    JobFile::parse(&path.display().to_string(), text.as_bytes())?;
    atomic::write(&path, text.as_bytes()).map_err(cannot_write(&path))?;
    for (number, name) in (1..).zip(&arguments.steps) {
        println!("step {number}: {name}");
    }
    println!("written: {}", path.display());
    Ok(Code::Stopped)
}
