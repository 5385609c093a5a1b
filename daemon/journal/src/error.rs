//! What can go wrong with the journal, and what to do about it.

use std::io;
use std::path::{Path, PathBuf};

use rusqlite::ErrorCode;
use thiserror::Error;

/// `SQLITE_READONLY_DBMOVED`.
const READONLY_DBMOVED: i32 = rusqlite::ffi::SQLITE_READONLY_DBMOVED;

/// A fault of the journal. Its message ends with the remedy.
#[derive(Debug, Error)]
pub enum JournalError {
    /// The disk is full or cannot be written.
    #[error(
        "cannot write the journal {path}: {source}; {waiting} verdicts wait in memory and the PLC is not told of them. \
         Make room on the disk, or lower `keep_mb`"
    )]
    Full {
        /// The database.
        path: PathBuf,
        /// Length of the queue.
        waiting: usize,
        /// The cause that SQLite gives.
        source: rusqlite::Error,
    },
    /// It was removed or replaced while it was open.
    #[error(
        "the journal {path} was removed while it was in use: what was in it is gone, and a new one begins"
    )]
    Removed {
        /// The database.
        path: PathBuf,
    },
    /// A damaged one cannot be put aside.
    #[error(
        "the journal {path} is damaged and cannot be put aside: {source}; let the role's user write in its folder"
    )]
    PutAside {
        /// The database.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Another process holds its lock.
    #[error(
        "the journal {path} is locked by another program; {waiting} verdicts wait in memory and the PLC is not told of \
         them. Close the program (`fuser {path}` names it); to read, use `andond history`"
    )]
    Locked {
        /// The database.
        path: PathBuf,
        /// Length of the queue.
        waiting: usize,
    },
    /// It cannot be opened.
    #[error(
        "cannot open the journal {path}: {source}; does its directory exist, and may this user write there?"
    )]
    Open {
        /// The database.
        path: PathBuf,
        /// The cause that SQLite gives.
        source: rusqlite::Error,
    },
    /// There is something else in its place.
    #[error("{path} is a pipe, a device or a folder, and no journal: give `journal.path` the path of a file")]
    NotFile {
        /// What is there.
        path: PathBuf,
    },
    /// The file is damaged, or is no journal.
    #[error("{path} is damaged or no journal: {source}; `sqlite3 .recover` may repair a copy of it")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The cause that SQLite gives.
        source: rusqlite::Error,
    },
    /// A newer Andon wrote it.
    #[error(
        "the journal {path} has schema {found}, but this Andon knows schemas up to {known}; install the newer Andon"
    )]
    Newer {
        /// The database.
        path: PathBuf,
        /// Its schema.
        found: u32,
        /// The newest schema known here.
        known: u32,
    },
    /// Any other error of SQLite.
    #[error("journal {path}: {source}")]
    Database {
        /// The database.
        path: PathBuf,
        /// The cause that SQLite gives.
        source: rusqlite::Error,
    },
    /// What somebody asks cannot be answered.
    #[error("--sql: {0}; the tables are verdict, gap, not_watching and audit, and they can only be read")]
    Question(String),
    /// The export cannot be written.
    #[error("cannot write the export: {0}")]
    Export(#[from] io::Error),
}

impl JournalError {
    /// [`JournalError::NotFile`] where the path leads to something else than a file; nothing may be there.
    pub(crate) fn unless_file(path: &Path) -> Result<(), Self> {
        let is_other = std::fs::metadata(path).is_ok_and(|there| !there.is_file());
        if is_other { Err(Self::NotFile { path: path.into() }) } else { Ok(()) }
    }

    pub(super) fn of(path: &Path, waiting: usize, source: rusqlite::Error) -> Self {
        let path = path.to_path_buf();
        match source.sqlite_error_code() {
            // A quota, a file size limit and a broken disk are reported as I/O errors and have the same remedy.
            Some(ErrorCode::DiskFull | ErrorCode::SystemIoFailure) => Self::Full { path, waiting, source },
            Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => Self::Locked { path, waiting },
            // The file was deleted or renamed under the connection, and SQLite has noticed it.
            Some(ErrorCode::ReadOnly)
                if source.sqlite_error().is_some_and(|error| error.extended_code == READONLY_DBMOVED) =>
            {
                Self::Removed { path }
            }
            Some(ErrorCode::CannotOpen | ErrorCode::ReadOnly | ErrorCode::PermissionDenied) => {
                Self::Open { path, source }
            }
            Some(ErrorCode::DatabaseCorrupt | ErrorCode::NotADatabase) => Self::Damaged { path, source },
            _ => Self::Database { path, source },
        }
    }
}
