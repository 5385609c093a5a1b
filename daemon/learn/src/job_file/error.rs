//! Why a job file was refused.

use super::VERSION;

/// A job file was refused: which file, why, and what to do.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {fault}")]
pub struct JobFileError {
    /// The file as the caller named it.
    pub file: String,
    /// What is wrong with it.
    pub fault: JobFault,
}

/// What is wrong with a job file.
#[derive(Debug, thiserror::Error)]
pub enum JobFault {
    /// The bytes are not UTF-8 text.
    #[error(
        "byte {0} is no UTF-8 text; the file is damaged: teach the job again or restore it from a backup"
    )]
    NotText(usize),
    /// The text is no TOML, or has a key too many or too few, or a value of a wrong type.
    #[error("{0}")]
    Toml(#[from] toml::de::Error),
    /// It is some other file.
    #[error("this is no job file: format is {0:?}, not \"andon.job\"")]
    Format(String),
    /// It was written by another version.
    #[error(
        "the job file has version {0}, this program reads version {VERSION}: teach the job again with it"
    )]
    Version(i64),
    /// The text is not what was written.
    #[error(
        "the checksum is {stated} and the text has {computed}: the file is damaged or was edited by hand; \
         teach the job again or restore it from a backup"
    )]
    Checksum {
        /// What the file says.
        stated: String,
        /// What its text has.
        computed: String,
    },
    /// A value breaks a rule of the method.
    #[error("{place}: {problem}")]
    Invalid {
        /// Where, as a path of keys.
        place: String,
        /// What is wrong, and what it may be.
        problem: String,
    },
}
