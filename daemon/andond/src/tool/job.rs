//! Reading the job file that a command names.

use std::path::Path;

use andon_learn::job_file::JobFile;

use super::Failure;
use crate::exit::Code;

/// Reads a job file.
///
/// # Errors
/// That it is not there, damaged or of another version.
pub(super) fn load(path: &Path) -> Result<JobFile, Failure> {
    let bytes = std::fs::read(path).map_err(|error| {
        Failure::new(
            Code::Configuration,
            format!("job {}: {error}; teach it with `andond teach`", path.display()),
        )
    })?;
    JobFile::parse(&path.display().to_string(), &bytes)
        .map_err(|error| Failure::new(Code::Configuration, error))
}
