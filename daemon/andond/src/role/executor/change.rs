//! What a task changes by itself, at the moment in which its command begins. Where that cannot begin, or fails, the files are as they were.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use andon_host::atomic;
use andon_host::log::{code, log};

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
#[derive(Debug, Default)]
pub(super) struct Before(Vec<Was>);

#[derive(Debug)]
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
    begin: impl FnOnce() -> io::Result<T>,
) -> Result<(T, Before), String> {
    let mut before = Before::default();
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
                atomic::write(&file, &bytes).map_err(failed(&file))?;
                self.0.push(Was { file, bytes: was, put: Some(bytes) });
                Ok(())
            }
            Change::Remove { file } => {
                let was = read(&file).map_err(failed(&file))?;
                if was.is_some() {
                    fs::remove_file(&file).map_err(failed(&file))?;
                    self.0.push(Was { file, bytes: was, put: None });
                }
                Ok(())
            }
        }
    }

    /// The task is done: what was changed stays.
    pub(super) fn keep(mut self) {
        self.0.clear();
    }

    /// The task has failed or was stopped: its files are again what they were. What has been put in the place of a file stays where the command had
    /// done its work already.
    pub(super) fn put_back(mut self, has_done_its_work: bool) {
        self.restore(has_done_its_work);
    }

    /// What somebody else has written meanwhile stays as well.
    fn restore(&mut self, has_done_its_work: bool) {
        for Was { file, bytes, put } in self.0.drain(..) {
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
                log!(code::EXECUTOR_CANNOT_WRITE, "{}: {error}", file.display());
            }
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

    /// The names in a folder with what is in them.
    fn all(folder: &Path) -> Vec<(String, String)> {
        let entries = fs::read_dir(folder).unwrap().flatten();
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

    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("job"), "job").unwrap();
        fs::write(folder.path().join("report"), "report").unwrap();
        folder
    }

    #[test]
    fn what_cannot_begin_or_cannot_be_changed_as_a_whole_leaves_all_as_it_was() {
        let folder = folder();
        let before = all(folder.path());
        let refused = and_begin(changes(folder.path()), || Err::<(), _>(io::ErrorKind::NotFound.into()));
        assert!(refused.unwrap_err().contains("andond cannot be started"));
        assert_eq!(all(folder.path()), before);
        let mut changes = changes(folder.path());
        changes.push(Change::Put { file: folder.path().join("missing/job"), bytes: Vec::new() });
        let refused = and_begin(changes, || -> io::Result<()> { unreachable!("a change has failed") });
        assert!(refused.unwrap_err().contains("missing/job"));
        assert_eq!(all(folder.path()), before);
    }

    #[test]
    fn a_task_that_fails_leaves_its_files_as_they_were_and_what_its_command_has_written() {
        let folder = folder();
        let before = all(folder.path());
        let ((), was) = and_begin(changes(folder.path()), || Ok(())).unwrap();
        let changed = [("job", "version"), ("new", "version")];
        assert_eq!(all(folder.path()), changed.map(|(name, text)| (name.to_owned(), text.to_owned())));
        was.put_back(false);
        assert_eq!(all(folder.path()), before);
        drop(and_begin(changes(folder.path()), || Ok(())).unwrap());
        assert_eq!(all(folder.path()), before, "a role that ends by an error");
        let ((), was) = and_begin(changes(folder.path()), || Ok(())).unwrap();
        for name in ["report", "new"] {
            fs::write(folder.path().join(name), "another").unwrap();
        }
        was.put_back(false);
        for name in ["report", "new"] {
            assert_eq!(fs::read_to_string(folder.path().join(name)).unwrap(), "another");
        }
        let ((), was) = and_begin(changes(folder.path()), || Ok(())).unwrap();
        was.put_back(true);
        let text = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
        assert_eq!((text("job").as_str(), text("report").as_str()), ("version", "another"));
    }
}
