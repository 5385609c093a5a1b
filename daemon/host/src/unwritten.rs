//! What to do where the system does not let a file be written: the remedy depends on what it says.

use std::io::{self, ErrorKind};

/// What to do, as the end of a sentence.
pub fn remedy(error: &io::Error) -> &'static str {
    match error.kind() {
        ErrorKind::StorageFull => "make room on this disk, or name a file on another one",
        ErrorKind::QuotaExceeded => {
            "this user's share of the disk is used up: make room, or name a file on another one"
        }
        ErrorKind::FileTooLarge => {
            "files may not grow that large here: raise the limit (`ulimit -f`), or name a file on another disk"
        }
        ErrorKind::ReadOnlyFilesystem => "this disk can only be read: name a file on another one",
        ErrorKind::NotFound | ErrorKind::NotADirectory => {
            "is the name of its folder right? make the folder, or name another file"
        }
        ErrorKind::IsADirectory => "this is a folder: name a file in it",
        ErrorKind::InvalidFilename => "choose a shorter name",
        ErrorKind::BrokenPipe => "nobody reads it any more",
        ErrorKind::PermissionDenied => "name a file in a folder of yours",
        _ => "is the disk in order? name a file on another one",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whoever has a full disk was told to name a file in a folder of theirs, which is on the same disk.
    #[test]
    fn a_full_disk_a_read_only_one_and_a_folder_of_somebody_else_have_remedies_of_their_own() {
        for (number, word) in [
            (28, "make room"),
            (122, "share"),
            (27, "limit"),
            (30, "only be read"),
            (13, "yours"),
            (2, "folder right"),
            (5, "in order"),
        ] {
            let error = io::Error::from_raw_os_error(number);
            assert!(remedy(&error).contains(word), "{error}: {}", remedy(&error));
        }
    }
}
