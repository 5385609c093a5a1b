//! Whether a file was written anew, without reading it.

use std::fs;
use std::os::unix::fs::MetadataExt as _;
use std::path::Path;

/// What changes with a file that was written anew; `None` of one that is missing.
pub(crate) type Mark = Option<(u64, u64, i64, i64)>;

/// That of the file which is there now.
pub(crate) fn mark(path: &Path) -> Mark {
    let meta = fs::metadata(path).ok()?;
    Some((meta.ino(), meta.len(), meta.mtime(), meta.mtime_nsec()))
}
