//! Who and what: the user who changed a configuration, and the program that runs.

use std::fs::{self, Metadata};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

/// The user whose file of these was changed last: that is who changed the configuration, as far as the system knows.
pub(crate) fn owner_of_newest(files: &[PathBuf]) -> String {
    let found = files.iter().filter_map(|file| Some((file, fs::metadata(file).ok()?)));
    let newest = found.max_by_key(|(_, meta)| (meta.mtime(), meta.mtime_nsec()));
    newest.map_or_else(
        || "unknown".to_owned(),
        |(file, meta)| format!("user {}, by {}", user_name(meta.uid()), name_of(file)),
    )
}

/// The user who runs this process.
pub(crate) fn own_user() -> String {
    format!("user {}", user_name(rustix::process::getuid().as_raw()))
}

/// The program that runs: its version, and what tells one installation of it from the next.
pub(crate) fn program() -> String {
    let version = env!("CARGO_PKG_VERSION");
    let installed = |meta: Metadata| {
        let time = jiff::Timestamp::from_second(meta.mtime()).map(|time| time.to_string());
        format!("andond {version} of {}, {} bytes", time.unwrap_or_default(), meta.len())
    };
    let own = std::env::current_exe().and_then(fs::metadata);
    own.map_or_else(|_| format!("andond {version}"), installed)
}

fn name_of(file: &Path) -> String {
    file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned()
}

/// The name of a user, or the number where the system has no name for it.
fn user_name(user: u32) -> String {
    let users = fs::read_to_string("/etc/passwd").unwrap_or_default();
    let known = users.lines().find_map(|line| {
        let mut fields = line.split(':');
        let name = fields.next()?;
        (fields.nth(1)?.parse() == Ok(user)).then(|| name.to_owned())
    });
    known.unwrap_or_else(|| user.to_string())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_user_is_named_and_one_without_a_name_is_a_number() {
        assert_eq!(user_name(0), "root");
        assert_eq!(user_name(4_294_967_294), "4294967294");
    }

    #[test]
    fn the_file_that_was_changed_last_tells_who_changed_the_configuration() {
        let folder = tempfile::tempdir().unwrap();
        let [old, new] = ["old.toml", "new.toml"].map(|name| folder.path().join(name));
        fs::write(&old, "").unwrap();
        fs::write(&new, "").unwrap();
        let past = std::time::SystemTime::UNIX_EPOCH;
        fs::File::options().write(true).open(&old).unwrap().set_modified(past).unwrap();
        assert!(owner_of_newest(&[new, old]).ends_with(", by new.toml"));
        assert_eq!(owner_of_newest(&[folder.path().join("none")]), "unknown");
    }
}
