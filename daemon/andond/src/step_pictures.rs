//! One small picture of each step of a job, beside the job file: `andond teach --pictures` writes them, and the board shows them.
//!
//! Their names have the hash of the job, so that no job is shown with the pictures of another one.

use std::fs;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use andon_host::atomic::{self, folder_of};
use andon_learn::job_file::JobFile;

/// A picture has fewer bytes.
const LARGEST: u64 = 256 << 10;

/// Where the picture of a step lies; steps count from 0, and people from 1.
fn path_of(job: &Path, model_hash: u64, step: usize) -> PathBuf {
    job.with_extension(format!("{model_hash:016x}.step-{}.jpg", step + 1))
}

/// The pictures of the steps of a job, as far as there are any.
pub(crate) fn read(path: &Path, job: &JobFile) -> Vec<Option<Vec<u8>>> {
    let picture = |step| {
        let mut jpeg = Vec::new();
        let file = fs::File::open(path_of(path, job.model_hash(), step)).ok()?;
        file.take(LARGEST).read_to_end(&mut jpeg).ok()?;
        Some(jpeg)
    };
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

/// Removes those of every job that this file held before: nobody would look for them again, and they show people at work.
///
/// # Errors
/// The picture that cannot be removed, and why.
pub(crate) fn remove(path: &Path) -> Result<(), (PathBuf, io::Error)> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let is_ours = |name: &str| {
        let rest = name.strip_prefix(&stem).and_then(|rest| rest.strip_prefix('.'));
        let parts = rest.and_then(|rest| rest.strip_suffix(".jpg")?.split_once(".step-"));
        parts.is_some_and(|(hash, step)| {
            hash.len() == 16
                && hash.bytes().all(|byte| byte.is_ascii_hexdigit())
                && step.parse::<u16>().is_ok()
        })
    };
    let folder = folder_of(path);
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_name().to_str().is_some_and(is_ours) {
            fs::remove_file(entry.path()).map_err(|error| (entry.path(), error))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn only_the_pictures_of_this_job_file_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let kept = ["polish.toml", "polish.jpg", "polish.step-1.jpg", "polish2.0123456789abcdef.step-1.jpg"];
        let gone = ["polish.0123456789abcdef.step-1.jpg", "polish.fedcba9876543210.step-12.jpg"];
        for name in kept.iter().chain(&gone) {
            fs::write(folder.path().join(name), "x").unwrap();
        }
        remove(&folder.path().join("polish.toml")).unwrap();
        let mut names: Vec<String> = fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        let mut expected = kept.map(str::to_owned);
        expected.sort();
        assert_eq!(names, expected);
    }
}
