//! What a task changes by itself, at the moment in which its command begins. Where that cannot begin, or fails, the files are as they were.
//!
//! What is to be put back is noted on disk before anything is changed. Where the role is killed or the power fails, its next start puts it back.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use andon_host::atomic;
use andon_host::log::{code, log};
use serde::{Deserialize, Serialize};

/// One change.
#[derive(Debug)]
pub(super) enum Change {
    /// A file is kept under another name. A copy changes nothing for anybody, and stays.
    Keep { file: PathBuf, copy: PathBuf },
    /// These bytes take the place of a file.
    Put { file: PathBuf, bytes: Vec<u8> },
    /// A file that the command writes anew makes way.
    Remove { file: PathBuf },
}

/// What was changed, as it was before. Where nobody says what becomes of it, as where the role ends by an error, it is put back.
#[derive(Debug)]
pub(super) struct Before {
    was: Vec<Was>,
    /// The file that has all of it for the next start. It is there while a task runs that has changed something.
    note: PathBuf,
}

#[derive(Debug, Serialize, Deserialize)]
struct Was {
    file: PathBuf,
    /// `None` where there was none.
    bytes: Option<Vec<u8>>,
    /// What was put in its place; `None` where it has made way for what the command writes.
    put: Option<Vec<u8>>,
}

/// Makes all changes and begins what they are for, or does nothing.
///
/// # Errors
/// What cannot be changed or begun, and why.
pub(super) fn and_begin<T>(
    changes: Vec<Change>,
    note: PathBuf,
    begin: impl FnOnce() -> io::Result<T>,
) -> Result<(T, Before), String> {
    let mut before = Before { was: Vec::new(), note };
    let made = changes.into_iter().try_for_each(|change| before.make(change));
    let begun = made.and_then(|()| begin().map_err(|error| format!("andond cannot be started: {error}")));
    match begun {
        Ok(begun) => Ok((begun, before)),
        Err(why) => {
            before.put_back(false);
            Err(why)
        }
    }
}

/// Puts back what a task has changed whose role was killed before it ended, and says so in one line; `None` where there is nothing to be put back.
pub(super) fn put_back_noted(note: PathBuf) -> Option<String> {
    let noted =
        read(&note).and_then(|bytes| Ok(bytes.map(|bytes| serde_json::from_slice(&bytes)).transpose()?));
    match noted {
        Ok(None) => None,
        Ok(Some(was)) => {
            let before = Before { was, note };
            let files: Vec<_> = before.was.iter().map(|was| was.file.display().to_string()).collect();
            before.put_back(false);
            let files = files.join(", ");
            Some(format!(
                "broken off with its role: put back, unless somebody has written there since: {files}"
            ))
        }
        Err(error) => {
            log!(
                code::EXECUTOR_CANNOT_WRITE,
                "{}, by which files would be put back: {error}",
                note.display()
            );
            None
        }
    }
}

impl Before {
    fn make(&mut self, change: Change) -> Result<(), String> {
        let failed = |file: &Path| {
            let file = file.display().to_string();
            move |error: io::Error| format!("{file}: {error}")
        };
        match change {
            Change::Keep { file, copy } => {
                let bytes = fs::read(&file).map_err(failed(&file))?;
                atomic::write(&copy, &bytes).map_err(failed(&copy))
            }
            Change::Put { file, bytes } => {
                let was = read(&file).map_err(failed(&file))?;
                self.note(Was { file: file.clone(), bytes: was, put: Some(bytes.clone()) })?;
                atomic::write(&file, &bytes).map_err(failed(&file))
            }
            Change::Remove { file } => {
                let was = read(&file).map_err(failed(&file))?;
                if was.is_none() {
                    return Ok(());
                }
                self.note(Was { file: file.clone(), bytes: was, put: None })?;
                fs::remove_file(&file).map_err(failed(&file))
            }
        }
    }

    /// Notes what is about to be changed.
    fn note(&mut self, was: Was) -> Result<(), String> {
        self.was.push(was);
        let noted = serde_json::to_vec(&self.was).map_err(io::Error::from);
        let noted = noted.and_then(|bytes| atomic::write(&self.note, &bytes));
        noted.map_err(|error| format!("{}: {error}", self.note.display()))
    }

    /// The task is done: what was changed stays.
    pub(super) fn keep(mut self) {
        if !self.was.is_empty() {
            self.was.clear();
            self.forget();
        }
    }

    /// The task has failed or was stopped: its files are again what they were. What has been put in the place of a file stays where the command had
    /// done its work already.
    pub(super) fn put_back(mut self, has_done_its_work: bool) {
        self.restore(has_done_its_work);
    }

    /// What somebody else has written meanwhile stays as well.
    fn restore(&mut self, has_done_its_work: bool) {
        if self.was.is_empty() {
            return;
        }
        let mut is_whole = true;
        for Was { file, bytes, put } in self.was.drain(..) {
            let stays = match put {
                Some(put) => has_done_its_work || fs::read(&file).ok() != Some(put),
                None => file.exists(),
            };
            if stays {
                continue;
            }
            let put = match bytes {
                Some(bytes) => atomic::write(&file, &bytes),
                None => fs::remove_file(&file),
            };
            if let Err(error) = put {
                is_whole = false;
                log!(code::EXECUTOR_CANNOT_WRITE, "{}: {error}", file.display());
            }
        }
        // What could not be put back is tried again by the next start.
        if is_whole {
            self.forget();
        }
    }

    /// Removes the note, also from the disk: one that comes back after a loss of power would undo what was done.
    fn forget(&self) {
        if let Err(error) = atomic::remove(&self.note) {
            log!(code::EXECUTOR_CANNOT_WRITE, "{}: {error}", self.note.display());
        }
    }
}

impl Drop for Before {
    fn drop(&mut self) {
        self.restore(false);
    }
}

/// The bytes of a file; `None` where there is none.
fn read(file: &Path) -> io::Result<Option<Vec<u8>>> {
    match fs::read(file) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use tempfile::TempDir;

    /// The names in a folder with what is in them.
    fn all(folder: &Path) -> Vec<(String, String)> {
        let entries = fs::read_dir(folder).unwrap().flatten().filter(|entry| entry.file_name() != "note");
        let mut all: Vec<_> = entries
            .map(|entry| {
                (entry.file_name().to_string_lossy().into_owned(), fs::read_to_string(entry.path()).unwrap())
            })
            .collect();
        all.sort();
        all
    }

    fn changes(folder: &Path) -> Vec<Change> {
        let file = |name: &str| folder.join(name);
        vec![
            Change::Put { file: file("job"), bytes: b"version".to_vec() },
            Change::Put { file: file("new"), bytes: b"version".to_vec() },
            Change::Remove { file: file("report") },
            Change::Remove { file: file("none") },
        ]
    }

    fn note(folder: &TempDir) -> PathBuf {
        folder.path().join("note")
    }

    fn begin<T>(
        folder: &TempDir,
        changes: Vec<Change>,
        begin: impl FnOnce() -> io::Result<T>,
    ) -> Result<(T, Before), String> {
        and_begin(changes, note(folder), begin)
    }

    fn folder() -> TempDir {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("job"), "job").unwrap();
        fs::write(folder.path().join("report"), "report").unwrap();
        folder
    }

    #[test]
    fn what_cannot_begin_or_cannot_be_changed_as_a_whole_leaves_all_as_it_was() {
        let folder = folder();
        let before = all(folder.path());
        let refused = begin(&folder, changes(folder.path()), || Err::<(), _>(io::ErrorKind::NotFound.into()));
        assert!(refused.unwrap_err().contains("andond cannot be started"));
        assert_eq!(all(folder.path()), before);
        let mut changes = changes(folder.path());
        changes.push(Change::Put { file: folder.path().join("missing/job"), bytes: Vec::new() });
        let refused = begin(&folder, changes, || -> io::Result<()> { unreachable!("a change has failed") });
        assert!(refused.unwrap_err().contains("missing/job"));
        assert_eq!(all(folder.path()), before);
    }

    #[test]
    fn a_task_that_fails_leaves_its_files_as_they_were_and_what_its_command_has_written() {
        let folder = folder();
        let before = all(folder.path());
        let ((), was) = begin(&folder, changes(folder.path()), || Ok(())).unwrap();
        let changed = [("job", "version"), ("new", "version")];
        assert_eq!(all(folder.path()), changed.map(|(name, text)| (name.to_owned(), text.to_owned())));
        was.put_back(false);
        assert_eq!(all(folder.path()), before);
        drop(begin(&folder, changes(folder.path()), || Ok(())).unwrap());
        assert_eq!(all(folder.path()), before, "a role that ends by an error");
        let ((), was) = begin(&folder, changes(folder.path()), || Ok(())).unwrap();
        for name in ["report", "new"] {
            fs::write(folder.path().join(name), "another").unwrap();
        }
        was.put_back(false);
        for name in ["report", "new"] {
            assert_eq!(fs::read_to_string(folder.path().join(name)).unwrap(), "another");
        }
        let ((), was) = begin(&folder, changes(folder.path()), || Ok(())).unwrap();
        was.put_back(true);
        let text = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
        assert_eq!((text("job").as_str(), text("report").as_str()), ("version", "another"));
    }

    #[test]
    fn what_a_killed_role_has_changed_is_put_back_by_the_next_one_unless_somebody_has_written_meanwhile() {
        let folder = folder();
        let before = all(folder.path());
        let killed = || {
            let ((), was) = begin(&folder, changes(folder.path()), || Ok(())).unwrap();
            std::mem::forget(was);
        };
        killed();
        assert_ne!(all(folder.path()), before);
        put_back_noted(note(&folder));
        assert_eq!((all(folder.path()), note(&folder).exists()), (before.clone(), false));
        // There is nothing to be put back.
        put_back_noted(note(&folder));
        assert_eq!(all(folder.path()), before);

        killed();
        for name in ["job", "report"] {
            fs::write(folder.path().join(name), "another").unwrap();
        }
        put_back_noted(note(&folder));
        let written = [("job", "another"), ("report", "another")];
        assert_eq!(all(folder.path()), written.map(|(name, text)| (name.to_owned(), text.to_owned())));

        // Killed before it has changed what it has noted, and once it was done.
        let ((), was) = begin(&folder, changes(folder.path()), || Ok(())).unwrap();
        let noted = fs::read(note(&folder)).unwrap();
        was.put_back(false);
        fs::write(note(&folder), noted).unwrap();
        put_back_noted(note(&folder));
        assert_eq!(all(folder.path()), written.map(|(name, text)| (name.to_owned(), text.to_owned())));
        let ((), was) = begin(&folder, changes(folder.path()), || Ok(())).unwrap();
        let changed = all(folder.path());
        was.keep();
        put_back_noted(note(&folder));
        assert_eq!(all(folder.path()), changed);
        // A note that is none is said, and nothing is done.
        fs::write(note(&folder), "no note").unwrap();
        put_back_noted(note(&folder));
        assert_eq!(all(folder.path()), changed);
    }
}
