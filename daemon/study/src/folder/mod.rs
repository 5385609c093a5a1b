//! A folder of recordings, and who did what in each. The names of the files say it, by default `p<person>_<what>_r<repetition>`, or a table does.

mod pattern;
mod table;

pub use pattern::{Pattern, PatternError};
pub use table::{Table, TableError};

use andon_learn::recording::person_of;
use andon_learn::run::Run;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The ending of a track file's name.
const TRACKS: &str = ".tracks.jsonl";

/// The endings of films, which a folder may hold beside much else.
const FILMS: [&str; 7] = ["avi", "bag", "m4v", "mkv", "mov", "mp4", "webm"];

/// What a person did who made no mistake, where others of the folder did.
pub(crate) const CORRECT: &str = "none";

/// A run with who did what in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Labelled {
    /// The number of the person.
    pub person: u32,
    /// What the person did, such as an activity or a flaw.
    pub what: String,
    /// Repetition number.
    pub repetition: u32,
    /// The run itself.
    pub run: Run,
}

/// Where it is said who did what.
#[derive(Clone, Debug, Default)]
pub enum Naming {
    /// In the names: `p<person>_<what>_r<repetition>`, of track files and films.
    #[default]
    Standard,
    /// In the names, in another form.
    Pattern(Pattern),
    /// In a table; files that it does not list are ignored.
    Table(Table),
}

/// Person, what was done, and repetition number.
pub type Label = (u32, String, u32);

/// Who did what as it is written, before people and repetitions have numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Written {
    /// A number or a name.
    person: String,
    what: String,
    /// `None` where it must be counted.
    repetition: Option<u32>,
}

/// The recordings of a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recordings {
    /// Each file or folder of pictures with its label, in the order of the labels; at least one.
    pub files: Vec<(PathBuf, Label)>,
    /// The people who have names, by the numbers that they were given.
    pub people: Vec<(u32, String)>,
}

/// Why a folder was not read.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// The folder cannot be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The folder.
        path: PathBuf,
        /// Why it cannot be read.
        source: std::io::Error,
    },
    /// There is no recording in the folder.
    #[error(
        "{}: no recording in this folder is named {expected}; say with --names 'PATTERN' how they are named, or with --runs FILE who did what",
        folder.display()
    )]
    Empty {
        /// The folder.
        folder: PathBuf,
        /// How the names should be.
        expected: String,
    },
    /// The table cannot be used.
    #[error(transparent)]
    Table(#[from] TableError),
}

/// The recordings of a folder with who did what. Where a track file and a film have one name, the track file is taken: it was made of the film.
///
/// # Errors
/// A folder that cannot be read or has no recording of such a name. A table that names a file that is not there.
pub fn recordings(folder: &Path, naming: &Naming) -> Result<Recordings, FolderError> {
    let written = match naming {
        Naming::Table(table) => table.files(folder)?,
        Naming::Standard => named(folder, written, "p<person>_<what>_r<repetition>")?,
        Naming::Pattern(pattern) => named(folder, |stem| pattern.read(stem), pattern.text())?,
    };
    Ok(numbered(written))
}

/// The recordings of a folder whose names, without their endings, say who did what.
fn named(
    folder: &Path,
    read: impl Fn(&str) -> Option<Written>,
    expected: &str,
) -> Result<Vec<(PathBuf, Written)>, FolderError> {
    let io = |source| FolderError::Io { path: folder.to_owned(), source };
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
        .and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect())
        .map_err(io)?;
    paths.sort();
    let mut found: BTreeMap<String, (PathBuf, Written)> = BTreeMap::new();
    for path in paths {
        let Some(stem) = stem(&path) else { continue };
        let is_tracks = path.to_string_lossy().ends_with(TRACKS);
        if let Some(written) = read(&stem).filter(|_| is_tracks || !found.contains_key(&stem)) {
            found.insert(stem, (path, written));
        }
    }
    if found.is_empty() {
        return Err(FolderError::Empty { folder: folder.to_owned(), expected: expected.to_owned() });
    }
    Ok(found.into_values().collect())
}

/// The name of a recording without its ending; `None` if the file is no recording.
fn stem(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    if let Some(stem) = name.strip_suffix(TRACKS) {
        return Some(stem.to_owned());
    }
    if path.is_dir() {
        return Some(name.to_owned());
    }
    let (stem, ending) = name.rsplit_once('.')?;
    FILMS.contains(&ending.to_ascii_lowercase().as_str()).then(|| stem.to_owned())
}

/// Gives numbers to people who have names, and counts repetitions that have no number.
fn numbered(written: Vec<(PathBuf, Written)>) -> Recordings {
    let mut taken: Vec<u32> = written.iter().filter_map(|(_, one)| one.person.parse().ok()).collect();
    let mut people: Vec<(u32, String)> = Vec::new();
    let mut counts: BTreeMap<(u32, String), u32> = BTreeMap::new();
    let mut files: Vec<(PathBuf, Label)> = Vec::new();
    for (path, Written { person, what, repetition }) in written {
        let known = people.iter().find(|(_, name)| *name == person).map(|(number, _)| *number);
        let number = person.parse().ok().or(known).unwrap_or_else(|| {
            let free = (1..).find(|number| !taken.contains(number)).unwrap_or(u32::MAX);
            taken.push(free);
            people.push((free, person));
            free
        });
        let count = counts.entry((number, what.clone())).or_default();
        *count += 1;
        files.push((path, (number, what, repetition.unwrap_or(*count))));
    }
    files.sort_by(|a, b| a.1.cmp(&b.1));
    Recordings { files, people }
}

/// What the name of a track file says; `None` if it is not the name of a labelled recording.
pub fn label(file: &str) -> Option<Label> {
    let Written { person, what, repetition } = written(file.strip_suffix(TRACKS)?)?;
    Some((person.parse().ok()?, what, repetition?))
}

/// What the name of a recording says, without its ending.
fn written(stem: &str) -> Option<Written> {
    let (_, rest) = stem.split_once('_')?;
    let (what, repetition) = rest.rsplit_once("_r")?;
    let person = person_of(stem)?.to_string();
    Some(Written { person, what: what.to_owned(), repetition: Some(repetition.parse().ok()?) })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_name_says_who_did_what() {
        assert_eq!(label("p7_drilling_C2_r1.tracks.jsonl"), Some((7, "drilling_C2".to_owned(), 1)));
        assert_eq!(label("p1_none_r12.tracks.jsonl"), Some((1, "none".to_owned(), 12)));
        for other in ["notes.txt", "p_none_r1.tracks.jsonl", "p1_none.tracks.jsonl", "p1_none_r1.mp4"] {
            assert_eq!(label(other), None, "{other}");
        }
    }

    /// The names of the files and the labels that are found in a folder with these files.
    fn found(files: &[&str], naming: &Naming) -> Result<Vec<(String, Label)>, FolderError> {
        let folder = tempfile::tempdir().unwrap();
        for file in files {
            std::fs::write(folder.path().join(file), "").unwrap();
        }
        let recordings = recordings(folder.path(), naming)?;
        let name = |path: PathBuf| path.file_name().unwrap().to_string_lossy().into_owned();
        Ok(recordings.files.into_iter().map(|(path, label)| (name(path), label)).collect())
    }

    #[test]
    fn films_are_found_by_the_same_names_and_a_track_file_counts_more_than_its_film() {
        let files =
            ["p1_none_r1.mp4", "p1_none_r1.tracks.jsonl", "p2_none_r1.MKV", "p2_none_r1.svg", "README.md"];
        let found = found(&files, &Naming::Standard).unwrap();
        let label = |person| (person, "none".to_owned(), 1);
        assert_eq!(
            found,
            [("p1_none_r1.tracks.jsonl".to_owned(), label(1)), ("p2_none_r1.MKV".to_owned(), label(2))]
        );
    }

    #[test]
    fn people_who_have_names_get_the_numbers_that_nobody_has_and_repetitions_are_counted() {
        let naming = Naming::Pattern(Pattern::new("{person} {what} *").unwrap());
        let files = ["1 good a.mp4", "anna good a.mp4", "anna good b.mp4", "bert good c.mp4"];
        let found = found(&files, &naming).unwrap();
        let labels: Vec<Label> = found.into_iter().map(|(_, label)| label).collect();
        let good = |person, repetition| (person, "good".to_owned(), repetition);
        assert_eq!(labels, [good(1, 1), good(2, 1), good(2, 2), good(3, 1)]);
    }

    #[test]
    fn a_folder_without_such_names_says_how_to_name_them() {
        let said = found(&["run1.mp4"], &Naming::Standard).unwrap_err().to_string();
        assert!(
            said.contains("p<person>_<what>_r<repetition>") && said.contains("--names 'PATTERN'"),
            "{said}"
        );
    }
}
