//! Where the database lies: whether it is still there, and how a damaged one is put aside.

use std::fs;
use std::io;
use std::os::unix::ffi::OsStrExt as _;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

/// What SQLite keeps beside a database in WAL mode.
const COMPANIONS: [&str; 2] = ["-wal", "-shm"];

/// The file under this path; `None` where there is none.
pub(super) fn identity(path: &Path) -> Option<(u64, u64)> {
    fs::metadata(path).ok().map(|meta| (meta.dev(), meta.ino()))
}

/// Whether the write-ahead log lies beside the database. While a connection is open and has written, it does.
pub(super) fn has_log(path: &Path) -> bool {
    companion(path, COMPANIONS[0]).exists()
}

/// The address of the database for SQLite, with a parameter. Whatever may mean something in an address is written in hexadecimal digits.
pub(super) fn uri(path: &Path, parameter: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"/._-".contains(&byte);
    let bytes = path.as_os_str().as_bytes().iter();
    let escaped: String = bytes
        .map(|byte| if plain(*byte) { char::from(*byte).to_string() } else { format!("%{byte:02x}") })
        .collect();
    // A path with two slashes in front would name a machine.
    let machine = if escaped.starts_with('/') { "//" } else { "" };
    format!("file:{machine}{escaped}?{parameter}")
}

/// Renames the database and what lies beside it. Returns the new name, which no file had.
pub(super) fn put_aside(path: &Path, stamp: &str) -> io::Result<PathBuf> {
    let mut aside = companion(path, &format!(".damaged-{stamp}"));
    let mut number = 1;
    while aside.exists() {
        number += 1;
        aside = companion(path, &format!(".damaged-{stamp}-{number}"));
    }
    fs::rename(path, &aside)?;
    for name in COMPANIONS {
        match fs::rename(companion(path, name), companion(&aside, name)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => (),
        }
    }
    Ok(aside)
}

/// Removes what lies beside a database that is not there any more: with a new database SQLite would read it as its own.
pub(super) fn remove_companions(path: &Path) {
    for name in COMPANIONS {
        // Where there is none there is nothing to remove; where that fails, opening the database fails too.
        let _ = fs::remove_file(companion(path, name));
    }
}

fn companion(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}
