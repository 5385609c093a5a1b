//! What can go wrong with the journal, with the remedy.

use std::io;
use std::path::{Path, PathBuf};

use rusqlite::ErrorCode;
use thiserror::Error;

/// A fault of the journal.
#[derive(Debug, Error)]
pub enum JournalError {
    /// No room, or writing failed.
    #[error(
        "cannot write the journal {path}: {source}; {waiting} verdicts wait in memory and nothing is told to the PLC. \
         Make room on the disk, or lower `keep_mb`"
    )]
    Full {
        /// The database.
        path: PathBuf,
        /// Verdicts that wait.
        waiting: usize,
        /// What SQLite says.
        source: rusqlite::Error,
    },
    /// Another process writes it.
    #[error(
        "the journal {path} is locked by another program; {waiting} verdicts wait in memory and nothing is told to the \
         PLC. Close the program (`fuser {path}` names it); to read, use `andond history`"
    )]
    Locked {
        /// The database.
        path: PathBuf,
        /// Verdicts that wait.
        waiting: usize,
    },
    /// It cannot be opened.
    #[error(
        "cannot open the journal {path}: {source}; does its directory exist, and may this user write there?"
    )]
    Open {
        /// The database.
        path: PathBuf,
        /// What SQLite says.
        source: rusqlite::Error,
    },
    /// The file is damaged, or it is something else.
    #[error("{path} is damaged or no journal: {source}; move it away, a new one is made")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What SQLite says.
        source: rusqlite::Error,
    },
    /// A newer Andon wrote it.
    #[error("the journal {path} has schema {found}, this Andon knows up to {known}; install the newer Andon")]
    Newer {
        /// The database.
        path: PathBuf,
        /// Its schema.
        found: u32,
        /// The newest schema known here.
        known: u32,
    },
    /// Anything else that SQLite refuses.
    #[error("journal {path}: {source}")]
    Database {
        /// The database.
        path: PathBuf,
        /// What SQLite says.
        source: rusqlite::Error,
    },
    /// The export cannot be written.
    #[error("cannot write the export: {0}")]
    Export(#[from] io::Error),
}

impl JournalError {
    pub(super) fn of(path: &Path, waiting: usize, source: rusqlite::Error) -> Self {
        let path = path.to_path_buf();
        match source.sqlite_error_code() {
            // A quota, a file size limit and a broken disk come as I/O errors; the remedy is the same.
            Some(ErrorCode::DiskFull | ErrorCode::SystemIoFailure) => Self::Full { path, waiting, source },
            Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => Self::Locked { path, waiting },
            Some(ErrorCode::CannotOpen | ErrorCode::ReadOnly | ErrorCode::PermissionDenied) => {
                Self::Open { path, source }
            }
            Some(ErrorCode::DatabaseCorrupt | ErrorCode::NotADatabase) => Self::Damaged { path, source },
            _ => Self::Database { path, source },
        }
    }
}
