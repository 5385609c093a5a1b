//! A folder of recordings, whose names say who did what: `p<person>_<what>_r<repetition>.tracks.jsonl`.

use crate::recording::TrackReader;
use crate::run::{Run, RunError};
use andon_core::config::Method;
use andon_core::input::Space;
use std::path::{Path, PathBuf};

/// The ending of a track file.
pub const ENDING: &str = ".tracks.jsonl";

/// A run whose name says who did what.
#[derive(Clone, Debug, PartialEq)]
pub struct Labelled {
    /// The person's number.
    pub person: u32,
    /// What was done.
    pub what: String,
    /// The how-manieth time.
    pub repetition: u32,
    /// The run.
    pub run: Run,
}

/// Why a folder was not read.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// The folder or a file cannot be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// There is no recording in the folder.
    #[error("{}: there is no file p<person>_<what>_r<repetition>{ENDING} in this folder", .0.display())]
    Empty(PathBuf),
    /// A recording was refused.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// Reads all recordings of a folder whose names say who did what, in the order of their names. `progress` is called with the
/// share that is done. Files of other names are left alone.
///
/// # Errors
/// The first file that cannot be read, or that is refused; a folder without any.
pub fn read(
    folder: &Path,
    method: &Method,
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<Labelled>, FolderError> {
    let files = files(folder)?;
    let count = files.len() as f64;
    let mut runs = Vec::with_capacity(files.len());
    for (place, (path, (person, what, repetition))) in files.into_iter().enumerate() {
        let bytes = std::fs::read(&path).map_err(|source| FolderError::Io { path: path.clone(), source })?;
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        runs.push(Labelled { person, what, repetition, run: Run::read(&name, &bytes, method)? });
        progress((place + 1) as f64 / count);
    }
    Ok(runs)
}

/// The space that the first recording of a folder is in.
///
/// # Errors
/// If it cannot be read, or there is none.
pub fn space(folder: &Path) -> Result<Space, FolderError> {
    let files = files(folder)?;
    // `files` is never empty.
    let (path, _) = files.first().ok_or_else(|| FolderError::Empty(folder.to_owned()))?;
    let io = |source| FolderError::Io { path: path.clone(), source };
    let bytes = std::fs::read(path).map_err(io)?;
    let reader = TrackReader::new(&path.to_string_lossy(), bytes.as_slice()).map_err(RunError::from)?;
    Ok(reader.header().space)
}

/// Person, what and repetition.
pub type Label = (u32, String, u32);

/// The recordings of a folder with what their names say, in the order of that.
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

/// Person, what and repetition of a file's name.
pub fn label(file: &str) -> Option<Label> {
    let (person, rest) = file.strip_suffix(ENDING)?.strip_prefix('p')?.split_once('_')?;
    let (what, repetition) = rest.rsplit_once("_r")?;
    Some((person.parse().ok()?, what.to_owned(), repetition.parse().ok()?))
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
