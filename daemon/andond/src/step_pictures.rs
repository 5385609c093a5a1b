//! One small picture of each step of a job, beside the job file: `andond teach --pictures` writes them, and the board shows them.
//!
//! Their names have the hash of the job, so that no job is shown with the pictures of another one. They show people at work, who have demonstrated it:
//! a job that is taught again leaves none of those before, and no recording of the station becomes one. So `andond forget --part` finds all that shows
//! a part, and `--before` removes those of jobs that were taught before.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use andon_host::atomic::{self, folder_of};
use andon_learn::file;
use andon_learn::job_file::JobFile;

use crate::made::is_hash;

/// A picture has fewer bytes.
const LARGEST: u64 = 256 << 10;

/// Where the picture of a step lies; steps count from 0, and people from 1.
fn path_of(job: &Path, model_hash: u64, step: usize) -> PathBuf {
    job.with_extension(format!("{model_hash:016x}.step-{}.jpg", step + 1))
}

/// The pictures of the steps of a job, as far as there are any.
pub(crate) fn read(path: &Path, job: &JobFile) -> Vec<Option<Vec<u8>>> {
    let picture = |step| file::read_up_to(&path_of(path, job.model_hash(), step), LARGEST).ok();
    (0..job.steps.len()).map(picture).collect()
}

/// Writes those of a job that has just been taught.
///
/// # Errors
/// The picture that cannot be written, and why.
pub(crate) fn write(
    path: &Path,
    job: &JobFile,
    pictures: &[Option<Vec<u8>>],
) -> Result<(), (PathBuf, io::Error)> {
    for (step, jpeg) in pictures.iter().enumerate() {
        if let Some(jpeg) = jpeg {
            let picture = path_of(path, job.model_hash(), step);
            atomic::write(&picture, jpeg).map_err(|error| (picture, error))?;
        }
    }
    Ok(())
}

/// A picture that lies in a folder of jobs.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct StepPicture {
    pub(crate) path: PathBuf,
    /// The file of its job.
    pub(crate) job: PathBuf,
    /// The hash of its job. Where the file has another one by now, or is gone, nobody looks for the picture.
    pub(crate) model_hash: u64,
}

impl StepPicture {
    fn at(path: PathBuf) -> Option<Self> {
        let (stem, rest) = path.file_name()?.to_str()?.strip_suffix(".jpg")?.rsplit_once('.')?;
        let (job, hash) = stem.rsplit_once('.')?;
        rest.strip_prefix("step-")?.parse::<u16>().ok()?;
        let model_hash = u64::from_str_radix(hash, 16).ok().filter(|_| is_hash(hash))?;
        Some(Self { job: path.with_file_name(format!("{job}.toml")), model_hash, path })
    }

    /// Removes it; one that is gone already is no error.
    ///
    /// # Errors
    /// The picture, and why it cannot be removed.
    pub(crate) fn remove(&self) -> Result<(), (PathBuf, io::Error)> {
        atomic::remove_file(&self.path).map_err(|error| (self.path.clone(), error))
    }
}

/// All pictures in a folder of jobs; none where it cannot be read.
pub(crate) fn in_folder(folder: &Path) -> Vec<StepPicture> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut pictures: Vec<_> = entries.filter_map(|entry| StepPicture::at(entry.path())).collect();
    pictures.sort();
    pictures
}

/// The pictures beside a job file, of whichever job it held when they were made.
pub(crate) fn beside(job: &Path) -> Vec<StepPicture> {
    let name = job.with_extension("toml");
    let mut pictures = in_folder(folder_of(job));
    pictures.retain(|picture| picture.job.file_name() == name.file_name());
    pictures
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn only_the_pictures_of_this_job_file_are_those_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let ours = ["polish.0123456789abcdef.step-1.jpg", "polish.fedcba9876543210.step-12.jpg"];
        let others =
            ["polish.toml", "polish.jpg", "polish.step-1.jpg", "polish2.0123456789abcdef.step-1.jpg"];
        for name in others.iter().chain(&ours) {
            fs::write(folder.path().join(name), "x").unwrap();
        }
        let pictures = beside(&folder.path().join("polish.toml"));
        assert_eq!(
            pictures.iter().map(|picture| picture.path.clone()).collect::<Vec<_>>(),
            ours.map(|name| folder.path().join(name))
        );
        assert_eq!(pictures[0].model_hash, 0x0123_4567_89ab_cdef);
        assert_eq!(in_folder(folder.path()).len(), 3);
        pictures.iter().for_each(|picture| picture.remove().unwrap());
        // It is gone already.
        pictures[0].remove().unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), others.len());
    }
}
