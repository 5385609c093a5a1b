//! Files that nobody but their user may read.

use std::fs::Permissions;
use std::io::{self, Write as _};
use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _, fchown};
use std::path::Path;

use andon_host::atomic;
use tempfile::NamedTempFile;

use super::super::{ToolError, cannot_write};

/// A file that is on disk and has no name yet. It is gone when this is dropped.
pub(super) struct Secret<'p> {
    path: &'p Path,
    part: NamedTempFile,
}

/// Writes a file that is to take the place of the one before it. It belongs to whom its folder belongs to: where root makes it, the station's units
/// read it all the same.
///
/// # Errors
/// What the system says.
pub(super) fn staged<'p>(path: &'p Path, bytes: &[u8]) -> Result<Secret<'p>, ToolError> {
    let part = own(path, bytes).map_err(cannot_write(path))?;
    Ok(Secret { path, part })
}

fn own(path: &Path, bytes: &[u8]) -> io::Result<NamedTempFile> {
    let folder = atomic::folder_of(path).metadata()?;
    let part = atomic::beside(path)?;
    // Before anything is in it.
    part.as_file().set_permissions(Permissions::from_mode(0o600))?;
    let own = part.as_file().metadata()?;
    if own.uid() != folder.uid() && rustix::process::geteuid().is_root() {
        fchown(part.as_file(), Some(folder.uid()), Some(folder.gid()))?;
    }
    part.as_file().write_all(bytes)?;
    part.as_file().sync_all()?;
    Ok(part)
}

impl Secret<'_> {
    /// Gives it its name.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn put(self) -> Result<(), ToolError> {
        atomic::put(self.part.into_temp_path(), self.path).map_err(cannot_write(self.path))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn nobody_else_may_read_it_whatever_was_there_before() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("logins.toml");
        std::fs::write(&path, "old").unwrap();
        std::fs::set_permissions(&path, Permissions::from_mode(0o644)).unwrap();
        staged(&path, b"new").unwrap().put().unwrap();
        assert_eq!(path.metadata().unwrap().permissions().mode() & 0o777, 0o600);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
        assert!(staged(&folder.path().join("none/logins.toml"), b"").is_err());
    }
}
