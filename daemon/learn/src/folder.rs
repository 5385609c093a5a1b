//! A folder of recordings whose names say who did what: `p<person>_<what>_r<repetition>.tracks.jsonl`.

use crate::recording::TrackReader;
use crate::run::{Run, RunError};
use andon_core::config::Method;
use andon_core::input::Space;
use std::path::{Path, PathBuf};

/// The ending of a track file's name.
const ENDING: &str = ".tracks.jsonl";

/// What a person did who made no mistake, where others of the folder did.
pub(crate) const CORRECT: &str = "none";

/// A run whose name says who did what.
#[derive(Clone, Debug, PartialEq)]
pub struct Labelled {
    /// The number of the person.
    pub person: u32,
    /// What the person did: the middle part of the name, such as an activity or a flaw.
    pub what: String,
    /// Repetition number.
    pub repetition: u32,
    /// The run itself.
    pub run: Run,
}

/// Why a folder was not read.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// The folder or a file cannot be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The folder or file.
        path: PathBuf,
        /// Why it cannot be read.
        source: std::io::Error,
    },
    /// There is no recording in the folder.
    #[error("{}: there is no recording p<person>_<what>_r<repetition>{ENDING} in this folder", .0.display())]
    Empty(PathBuf),
    /// A recording was refused.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// Reads all recordings of a folder whose names say who did what, in the order of person, what and repetition. Files with other names are
/// ignored. `progress` is called with the share that is done, 0 to 1.
///
/// # Errors
/// The first file that cannot be read or is refused, or a folder without a recording.
pub fn read(
    folder: &Path,
    method: &Method,
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<Labelled>, FolderError> {
    let files = files(folder)?;
    let count = files.len() as f64;
    let mut runs = Vec::with_capacity(files.len());
    for (index, (path, (person, what, repetition))) in files.into_iter().enumerate() {
        let bytes = std::fs::read(&path).map_err(|source| FolderError::Io { path: path.clone(), source })?;
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        runs.push(Labelled { person, what, repetition, run: Run::read(&name, &bytes, method)? });
        progress((index + 1) as f64 / count);
    }
    Ok(runs)
}

/// The space that the coordinates of the first recording of a folder are in.
///
/// # Errors
/// If the folder has no recording, or the first one cannot be read.
pub fn space(folder: &Path) -> Result<Space, FolderError> {
    let files = files(folder)?;
    // `files` is never empty.
    let (path, _) = files.first().ok_or_else(|| FolderError::Empty(folder.to_owned()))?;
    let io = |source| FolderError::Io { path: path.clone(), source };
    let bytes = std::fs::read(path).map_err(io)?;
    let reader = TrackReader::new(&path.to_string_lossy(), bytes.as_slice()).map_err(RunError::from)?;
    Ok(reader.header().space)
}

/// Person, what was done, and repetition number.
pub type Label = (u32, String, u32);

/// The recordings of a folder with their labels, in the order of the labels; at least one.
fn files(folder: &Path) -> Result<Vec<(PathBuf, Label)>, FolderError> {
    let io = |source| FolderError::Io { path: folder.to_owned(), source };
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(io)? {
        let path = entry.map_err(io)?.path();
        if let Some(label) = path.file_name().and_then(|name| label(name.to_str()?)) {
            files.push((path, label));
        }
    }
    if files.is_empty() {
        return Err(FolderError::Empty(folder.to_owned()));
    }
    files.sort_by(|a, b| a.1.cmp(&b.1));
    Ok(files)
}

/// What the name of a file says; `None` if it is not the name of a labelled recording.
pub fn label(file: &str) -> Option<Label> {
    let (_, rest) = file.strip_suffix(ENDING)?.split_once('_')?;
    let (what, repetition) = rest.rsplit_once("_r")?;
    Some((person_of(file)?, what.to_owned(), repetition.parse().ok()?))
}

/// The words before the number of a person in the name of a recording, such as `p3_none_r1` or `subject3_run1`.
const PERSON: [&str; 4] = ["person", "subject", "worker", "p"];

/// The number of the person whom the name of a recording begins with.
pub(crate) fn person_of(file: &str) -> Option<u32> {
    let (person, _) = file.split_once('_')?;
    PERSON.iter().find_map(|word| person.strip_prefix(word)?.parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_says_who_did_what() {
        assert_eq!(label("p7_drilling_C2_r1.tracks.jsonl"), Some((7, "drilling_C2".to_owned(), 1)));
        assert_eq!(label("p1_none_r12.tracks.jsonl"), Some((1, "none".to_owned(), 12)));
        for other in ["notes.txt", "p_none_r1.tracks.jsonl", "p1_none.tracks.jsonl", "p1_none_r1.mp4"] {
            assert_eq!(label(other), None, "{other}");
        }
    }
}
