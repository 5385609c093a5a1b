//! The job that a command names: a file, or one of the station's by its name or its number.

use std::path::Path;

use andon_host::config::Config;
use andon_learn::file;
use andon_learn::job_file::JobFile;
use andon_learn::recording::Header;

use crate::compatibility;

use super::ToolError;
use super::jobs::{FoundJob, of_station};

/// Reads a job file.
///
/// # Errors
/// If it is missing, damaged or of another version.
pub(super) fn load(path: &Path) -> Result<JobFile, ToolError> {
    let bytes = file::read(path).map_err(|source| ToolError::NoJob { path: path.into(), source })?;
    Ok(JobFile::parse(&path.display().to_string(), &bytes)?)
}

/// Holds the job at a path against a recording, and names what of the job the recording never shows.
///
/// # Errors
/// If the job is for other recordings.
pub(super) fn check_recording(
    (path, job): (&Path, &JobFile),
    recording: &Path,
    header: &Header,
) -> Result<(), ToolError> {
    let unknown = compatibility::recording(job, header)
        .map_err(|misfit| ToolError::Misfit { path: path.into(), misfit })?;
    for object in unknown {
        let (recording, name, id) = (recording.display(), &object.name, object.shape.id);
        eprintln!("{recording} never shows the {name} (object {id}): what it is used for is not judged");
    }
    Ok(())
}

/// The jobs of the station that somebody means by a name, in any letters, a number or a file: at least one. Copies of one job count once.
///
/// # Errors
/// That there is none, with those that there are.
pub(super) fn meant(wanted: &str, config: &Config) -> Result<Vec<FoundJob>, ToolError> {
    let path = Path::new(wanted);
    let is_file = path.is_file();
    let given = is_file.then(|| load(path)).transpose()?.map(|file| (file.id, file.model_hash()));
    let is_meant = |job: &FoundJob| match given {
        Some(given) => given == (job.file.id, job.hash),
        None => job.file.name.to_lowercase() == wanted.to_lowercase() || wanted.parse() == Ok(job.file.id),
    };
    let (mut meant, others): (Vec<_>, Vec<_>) = of_station(config)?.jobs.into_iter().partition(is_meant);
    meant.dedup_by_key(|job| job.hash);
    if !meant.is_empty() {
        return Ok(meant);
    }
    let folder = config.station.jobs.clone();
    Err(match is_file {
        true => ToolError::ForeignJob { path: path.into(), folder },
        false => ToolError::UnknownJob {
            wanted: wanted.to_owned(),
            folder,
            names: others.iter().map(|job| format!("{} {:?}", job.file.id, job.file.name)).collect(),
        },
    })
}

/// The one job that somebody means.
///
/// # Errors
/// That there is none, or that there are several.
pub(super) fn one(wanted: &str, config: &Config) -> Result<FoundJob, ToolError> {
    let mut meant = meant(wanted, config)?;
    match meant.len() {
        1 => Ok(meant.remove(0)),
        _ => Err(several(wanted, &meant)),
    }
}

/// That a name stands for several jobs.
pub(super) fn several(wanted: &str, jobs: &[FoundJob]) -> ToolError {
    let files = jobs.iter().map(|job| job.path.display().to_string()).collect();
    ToolError::SeveralJobs { wanted: wanted.to_owned(), files }
}
