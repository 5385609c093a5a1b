//! One file of the configuration: its text, its tables, and the lines of both.

use super::fault::Fault;
use andon_learn::file::{self, typographic};
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::de::DeTable;

/// Longest value that a message shows, in characters: the message should stay on one line of a terminal.
const SHOWN_CHARACTERS: usize = 60;

/// A file that could be read.
pub(super) struct File {
    /// As it was given.
    path: PathBuf,
    /// Its folder, absolute.
    folder: PathBuf,
    text: String,
}

impl File {
    /// Reads `path`, or reports in `faults` why that is impossible.
    pub(super) fn open(path: &Path, faults: &mut Vec<Fault>) -> Option<Self> {
        let read = file::read_text(path).and_then(|text| Ok((text, std::path::absolute(path)?)));
        match read {
            Ok((text, absolute)) => {
                let folder = absolute.parent().unwrap_or(Path::new("/")).to_owned();
                Some(Self { path: path.to_owned(), folder, text })
            }
            Err(error) => {
                faults.push(fault(path, None, format!("cannot be read: {error}")));
                None
            }
        }
    }
}

/// A file and what of it could be parsed.
pub(super) struct Document<'f> {
    /// The file as it was given.
    pub(super) path: &'f Path,
    /// Its folder, absolute: relative paths in it start here.
    pub(super) folder: &'f Path,
    pub(super) table: DeTable<'f>,
    text: &'f str,
}

impl<'f> Document<'f> {
    /// Parses `file`. What is not TOML is reported in `faults`, the rest is kept.
    pub(super) fn parse(file: &'f File, faults: &mut Vec<Fault>) -> Self {
        let (table, errors) = DeTable::parse_recoverable(&file.text);
        let document =
            Self { path: &file.path, folder: &file.folder, table: table.into_inner(), text: &file.text };
        let line = |error: &toml::de::Error| error.span().map(|span| document.line(span.start));
        // One mistake can cause several errors of the parser on the same line.
        let firsts = errors.chunk_by(|a, b| line(a) == line(b)).filter_map(|errors| errors.first());
        faults.extend(firsts.map(|error| {
            let at = error.span().map_or(0, |span| span.start);
            let remedy =
                typographic(document.text, at).map(|remedy| format!("; {remedy}")).unwrap_or_default();
            fault(document.path, line(error), format!("is not TOML: {}{remedy}", error.message()))
        }));
        document
    }

    /// The number of the line that holds byte `at`, from 1.
    pub(super) fn line(&self, at: usize) -> usize {
        1 + self.text.bytes().take(at).filter(|byte| *byte == b'\n').count()
    }

    /// The text of the value of `key`, in the bytes of `span`, cut to one line. `None` where these are the heading of a section.
    pub(super) fn shown(&self, key: &str, span: Range<usize>) -> Option<String> {
        let text = self.text.get(span)?;
        if text.trim_matches(['[', ']']) == key {
            return None;
        }
        let words: Vec<&str> = text.split_whitespace().collect();
        let line = words.join(" ");
        Some(match line.char_indices().nth(SHOWN_CHARACTERS) {
            Some((end, _)) => format!("{}...", &line[..end]),
            None => line,
        })
    }
}

/// A fault of a whole file or line.
fn fault(path: &Path, line: Option<usize>, problem: String) -> Fault {
    Fault { file: path.to_owned(), line, key: None, value: None, problem, likely: None }
}
