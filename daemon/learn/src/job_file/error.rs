//! Why a job file was refused.

use super::VERSION;
use crate::file::NotText;

/// A job file was refused.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {fault}")]
pub struct JobFileError {
    /// The file's name as the caller gave it.
    pub file: String,
    /// What is wrong with it.
    pub fault: JobFault,
}

/// What is wrong with a job file.
#[derive(Debug, thiserror::Error)]
pub enum JobFault {
    /// There is nothing in it.
    #[error("the file is empty: teach the job again or restore the file from a backup")]
    Empty,
    /// It is something else, such as a film, or was saved in another encoding.
    #[error("{0}; a job file is the .toml that `andond teach` has written")]
    NotText(#[from] NotText),
    /// The text is not TOML, a key is unknown or missing, or a value has the wrong type. It has what the parser says, and what to do where that is
    /// known.
    #[error("{0}")]
    Toml(String),
    /// The file has another format.
    #[error("this is not a job file: format is {0:?}, not \"andon.job\"")]
    Format(String),
    /// The file has another version of the format.
    #[error(
        "the job file has version {0}, and this program reads version {VERSION}: teach the job again with this program"
    )]
    Version(i64),
    /// The text is not the text that was written.
    #[error(
        "the checksum is {stated}, but that of the text is {computed}: the file is damaged or was edited by hand; \
         teach the job again or restore the file from a backup"
    )]
    Checksum {
        /// The checksum in the file.
        stated: String,
        /// The checksum of its text.
        computed: String,
    },
    /// A value breaks a rule of the method.
    #[error("{key}: {problem}")]
    Invalid {
        /// The path of the key, such as `activity[0].iu[1].threshold`.
        key: String,
        /// What is wrong with the value, and which values are allowed.
        problem: String,
    },
}
