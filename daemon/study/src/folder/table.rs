//! A table that says who did what in which recording: comma-separated values or TOML.

use super::{FolderError, Written};
use andon_learn::file;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// The rows of a table.
#[derive(Clone, Debug)]
pub struct Table {
    path: PathBuf,
    rows: Vec<Row>,
}

/// Why a table cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// It cannot be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The table.
        path: PathBuf,
        /// Why it cannot be read.
        source: std::io::Error,
    },
    /// It is no such table.
    #[error(
        "{}: {problem}; a table has the columns file, person and what, and repetition if it is not to be counted: as .csv with these words in \
         its first line, or as .toml with one [[runs]] for each",
        path.display()
    )]
    Form {
        /// The table.
        path: PathBuf,
        /// What is wrong, and in which line.
        problem: String,
    },
    /// It names a recording that is not there.
    #[error("{}: it names {}, which is not there", path.display(), file.display())]
    Missing {
        /// The table.
        path: PathBuf,
        /// The recording.
        file: PathBuf,
    },
}

/// One recording.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    file: PathBuf,
    person: Person,
    what: String,
    #[serde(default)]
    repetition: Option<u32>,
}

/// A person has a number or a name.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
enum Person {
    Number(u32),
    Name(String),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Rows {
    runs: Vec<Row>,
}

impl Table {
    /// Reads a table; its ending says what it is.
    ///
    /// # Errors
    /// What is wrong in which line.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let text =
            file::read_text(path).map_err(|source| TableError::Io { path: path.to_owned(), source })?;
        let form = |problem: String| TableError::Form { path: path.to_owned(), problem };
        let rows = if path.extension().is_some_and(|ending| ending == "toml") {
            toml::from_str::<Rows>(&text).map_err(|error| form(error.to_string().trim_end().to_owned()))?.runs
        } else {
            let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
            reader.deserialize().collect::<Result<_, _>>().map_err(|error| form(error.to_string()))?
        };
        if rows.is_empty() {
            return Err(form("it has no row".to_owned()));
        }
        Ok(Self { path: path.to_owned(), rows })
    }

    /// The recordings that it names, with what it says of them. Their paths start from `folder`.
    pub(super) fn files(&self, folder: &Path) -> Result<Vec<(PathBuf, Written)>, FolderError> {
        let file = |row: &Row| {
            let path = folder.join(&row.file);
            if !path.exists() {
                return Err(TableError::Missing { path: self.path.clone(), file: path }.into());
            }
            let person = match &row.person {
                Person::Number(number) => number.to_string(),
                Person::Name(name) => name.clone(),
            };
            Ok((path, Written { person, what: row.what.clone(), repetition: row.repetition }))
        };
        self.rows.iter().map(file).collect()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::folder::{Naming, recordings};

    /// What is said of the recordings of a folder with these two, by a table of this name and text.
    fn said(name: &str, text: &str) -> Result<Vec<(String, u32, String, u32)>, FolderError> {
        let folder = tempfile::tempdir().unwrap();
        for file in ["a film.mp4", "b.tracks.jsonl"] {
            std::fs::write(folder.path().join(file), "").unwrap();
        }
        let table = folder.path().join(name);
        std::fs::write(&table, text).unwrap();
        let files = recordings(folder.path(), &Naming::Table(Table::read(&table)?))?.files;
        let one = |(path, (person, what, repetition)): (PathBuf, _)| {
            (path.file_name().unwrap().to_string_lossy().into_owned(), person, what, repetition)
        };
        Ok(files.into_iter().map(one).collect())
    }

    #[test]
    fn both_forms_say_the_same() {
        let csv = "file, person, what\na film.mp4, anna, none\nb.tracks.jsonl, 7, J1\n";
        let toml = "[[runs]]\nfile = 'a film.mp4'\nperson = 'anna'\nwhat = 'none'\n\
                    [[runs]]\nfile = 'b.tracks.jsonl'\nperson = 7\nwhat = 'J1'\n";
        let expected = [
            ("a film.mp4".to_owned(), 1, "none".to_owned(), 1),
            ("b.tracks.jsonl".to_owned(), 7, "J1".to_owned(), 1),
        ];
        assert_eq!(said("runs.csv", csv).unwrap(), expected);
        assert_eq!(said("runs.toml", toml).unwrap(), expected);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place_and_the_columns() {
        for (name, text, problem) in [
            ("runs.csv", "file,person\na film.mp4,1\n", "missing field `what`"),
            ("runs.csv", "file,person,what\nnone.mp4,1,none\n", "none.mp4, which is not there"),
            ("runs.csv", "file,person,what\n", "it has no row"),
            ("runs.toml", "[[runs]]\nfile = 'a film.mp4'\nperson = 1\nwat = 'none'\n", "line 4"),
        ] {
            let said = said(name, text).unwrap_err().to_string();
            assert!(said.contains(problem) && said.contains(name), "{said}");
        }
    }
}
