//! Files that are there whole or not at all: whoever reads one while it is written has the one before it.

use std::fs::{File, Permissions};
use std::io::{self, Write as _};
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;

/// Writes a file in place of the one before it. It is on disk when this returns.
///
/// # Errors
/// What the system says; the file before it is untouched then.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if std::fs::metadata(path).is_ok_and(|meta| !meta.is_file()) {
        // A pipe or a terminal has no file before it.
        return std::fs::write(path, bytes);
    }
    let folder = folder_of(path);
    // As readable as a file that is written in place: the user's mask applies. An existing one keeps its rights.
    let rights =
        std::fs::metadata(path).map_or_else(|_| Permissions::from_mode(0o666), |meta| meta.permissions());
    let mut file = tempfile::Builder::new().prefix(".andon-").permissions(rights).tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(path)?;
    // The rename itself must survive a loss of power.
    File::open(folder)?.sync_all()
}

/// The folder that a path names; that of the process for a mere file name.
pub(crate) fn folder_of(path: &Path) -> &Path {
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
    fn a_file_that_cannot_be_written_leaves_the_one_before_it() {
        assert!(write(Path::new("/proc/job.toml"), b"new").is_err());
    }
}
