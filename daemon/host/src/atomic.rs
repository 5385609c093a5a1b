//! Files that are there whole or not at all: whoever reads one while it is written has the one before it.

use std::ffi::OsStr;
use std::fs::{File, Permissions};
use std::io::{self, Write as _};
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;

use tempfile::{NamedTempFile, TempPath};

/// Writes a file in place of the one before it. It is on disk when this returns.
///
/// # Errors
/// What the system says; the file before it is untouched then.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if std::fs::metadata(path).is_ok_and(|meta| !meta.is_file()) {
        // A pipe or a terminal has no file before it.
        return std::fs::write(path, bytes);
    }
    put(staged(path, bytes)?.into_temp_path(), path)
}

/// Writes several files in place of those before them: all, or none where the system refuses one of them.
///
/// # Errors
/// The file that cannot be written, and what the system says. The files before them are untouched then, except where a disk fails while finished
/// files are given their names.
pub fn write_together<'a>(files: &[(&'a Path, &[u8])]) -> Result<(), (&'a Path, io::Error)> {
    let mut finished = Vec::new();
    for &(path, bytes) in files {
        if std::fs::metadata(path).is_ok_and(|meta| !meta.is_file()) {
            // As in `write`.
            std::fs::write(path, bytes).map_err(|error| (path, error))?;
        } else {
            finished.push((path, staged(path, bytes).map_err(|error| (path, error))?));
        }
    }
    finished
        .into_iter()
        .try_for_each(|(path, part)| put(part.into_temp_path(), path).map_err(|error| (path, error)))
}

/// A new file beside `path` with these bytes, on disk, which has no name that anybody looks for yet. It is gone when it is dropped.
///
/// # Errors
/// What the system says.
pub fn staged(path: &Path, bytes: &[u8]) -> io::Result<NamedTempFile> {
    let mut part = beside(path)?;
    part.write_all(bytes)?;
    part.as_file().sync_all()?;
    Ok(part)
}

/// A new file in the folder of `path` and with its ending. It is gone when it is dropped.
///
/// # Errors
/// What the system says.
pub fn beside(path: &Path) -> io::Result<NamedTempFile> {
    // As readable as a file that is written in place: the user's mask applies. An existing one keeps its rights.
    let rights =
        std::fs::metadata(path).map_or_else(|_| Permissions::from_mode(0o666), |meta| meta.permissions());
    let ending =
        path.extension().map(|ending| [OsStr::new("."), ending].join(OsStr::new(""))).unwrap_or_default();
    tempfile::Builder::new()
        .prefix(".andon-")
        .suffix(&ending)
        .permissions(rights)
        .tempfile_in(folder_of(path))
}

/// Gives a finished file its name.
///
/// # Errors
/// What the system says.
pub fn put(part: TempPath, path: &Path) -> io::Result<()> {
    part.persist(path)?;
    keep_names(path)
}

/// The same, but never in the place of another file.
///
/// # Errors
/// What the system says; also that there is a file of this name.
pub fn put_new(part: TempPath, path: &Path) -> io::Result<()> {
    part.persist_noclobber(path)?;
    keep_names(path)
}

/// Brings the names in the folder of `path` to the disk: what has another one, or none, must survive a loss of power.
fn keep_names(path: &Path) -> io::Result<()> {
    File::open(folder_of(path))?.sync_all()
}

/// Removes a file, also from the disk: it does not come back after a loss of power. One that is not there is removed.
///
/// # Errors
/// What the system says.
pub fn remove(path: &Path) -> io::Result<()> {
    remove_file(path)?;
    keep_names(path)
}

/// Removes a file that somebody else may have removed meanwhile. A loss of power may bring it back.
///
/// # Errors
/// What the system says.
pub fn remove_file(path: &Path) -> io::Result<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        removed => removed,
    }
}

/// Whether a file has a name that others look for: what [`staged`] and [`beside`] make begins with a dot until it is finished.
pub fn is_named(path: &Path) -> bool {
    path.file_name().is_some_and(|name| !name.as_encoded_bytes().starts_with(b"."))
}

/// The folder that a path names; that of the process for a mere file name.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_file_is_replaced_by_another_and_never_written_in_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("job.toml");
        std::fs::write(&path, "old").unwrap();
        std::fs::set_permissions(&path, Permissions::from_mode(0o640)).unwrap();
        let mut reader = File::open(&path).unwrap();
        write(&path, b"new").unwrap();
        let mut read = String::new();
        std::io::Read::read_to_string(&mut reader, &mut read).unwrap();
        assert_eq!(read, "old", "whoever had it open still has all of it");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(std::fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing else is left");
    }

    #[test]
    fn of_several_files_none_is_written_where_one_cannot_be() {
        let folder = tempfile::tempdir().unwrap();
        let (first, second) = (folder.path().join("a.toml"), folder.path().join("none/b.toml"));
        let (refused, _) = write_together(&[(&first, b"a"), (&second, b"b")]).unwrap_err();
        assert_eq!(refused, second);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left");
        std::fs::create_dir(second.parent().unwrap()).unwrap();
        write_together(&[(&first, b"a"), (&second, b"b")]).unwrap();
        assert_eq!([first, second].map(|path| std::fs::read_to_string(path).unwrap()), ["a", "b"]);
    }

    #[test]
    fn what_is_being_written_has_no_name_that_anybody_looks_for_and_what_is_removed_is_gone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("job.toml");
        let part = staged(&path, b"new").unwrap();
        assert!(!is_named(part.path()) && is_named(&path));
        put(part.into_temp_path(), &path).unwrap();
        remove(&path).unwrap();
        assert!(!path.exists());
        remove(&path).unwrap();
        assert!(remove(folder.path()).is_err());
    }

    #[test]
    fn a_file_that_cannot_be_written_leaves_the_one_before_it() {
        assert!(write(Path::new("/proc/job.toml"), b"new").is_err());
    }
}
