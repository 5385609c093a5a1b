//! Reads the job file that a command names.

use std::path::Path;

use andon_learn::job_file::JobFile;

use super::ToolError;

/// Reads a job file.
///
/// # Errors
/// If it is missing, damaged or of another version.
pub(super) fn load(path: &Path) -> Result<JobFile, ToolError> {
    let bytes = std::fs::read(path).map_err(|source| ToolError::NoJob { path: path.into(), source })?;
    Ok(JobFile::parse(&path.display().to_string(), &bytes)?)
}
