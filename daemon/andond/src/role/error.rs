//! Why a role cannot go on, with its code in the log and its exit code.

use std::io;
use std::path::PathBuf;

use andon_core::{anomaly, couple};
use andon_host::exit::Code::{Configuration, Fault};
use andon_host::log::Remedy::{InMessage, OfCode};
use andon_host::log::code;
use andon_host::role::{CycleError, Ending, Failure};
use andon_ipc::Error as Ipc;
use andon_journal::JournalError;
use andon_learn::job_file::{JobFault, JobFileError};
use andon_learn::recording::{TrackError, Truncation};
use andon_perception::{PerceptionError, RuntimeFile};
use shm_schemas::Refusal;

use crate::compatibility::Misfit;
use crate::perception::SetupError;

/// Why a role cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum RoleError {
    /// What ends any role: a stop, the station's shared memory, a reader that makes no progress.
    #[error(transparent)]
    Cycle(#[from] CycleError),
    /// A frame cannot be processed.
    #[error(transparent)]
    Perception(#[from] PerceptionError),
    /// A model, a library or a calibration is missing or unusable.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The recording has failed after it was opened.
    #[error("{0}")]
    Source(String),
    /// The track file cannot be played.
    #[error(transparent)]
    Tracks(#[from] TrackError),
    /// The track file was not written to its end.
    #[error("{0}")]
    CutShort(Truncation),
    /// A job file is not one, or is damaged.
    #[error(transparent)]
    JobFile(#[from] JobFileError),
    /// A job file that cannot be read.
    #[error("job {}: {source}", path.display())]
    UnreadJob {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A job that does not fit the station.
    #[error("job {}: {misfit}", path.display())]
    UnfitJob {
        /// The file.
        path: PathBuf,
        /// What does not fit.
        misfit: Misfit,
    },
    /// The job that the judge has loaded cannot be found any more.
    #[error(
        "the job in force, {job_id}, cannot be encoded for: {}; put its file back into the folder of jobs, or load it again",
        refusal.name()
    )]
    LostJob {
        /// The id of the job.
        job_id: u32,
        /// Why it cannot be used.
        refusal: Refusal,
    },
    /// The database cannot be opened or written.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The Modbus server cannot start.
    #[error(transparent)]
    Plc(#[from] andon_plc::modbus::ServeError),
    /// The server of the metrics cannot start.
    #[error("cannot listen on {address} for metrics: {source}")]
    Metrics {
        /// The address.
        address: std::net::SocketAddr,
        /// What the system said.
        source: io::Error,
    },
    /// The server of the board cannot start.
    #[error("cannot listen on {address} for the board: {source}")]
    Board {
        /// The address.
        address: std::net::SocketAddr,
        /// What the system said.
        source: io::Error,
    },
    /// The board may not be reached where it would be.
    #[error(transparent)]
    UnsafeBoard(#[from] crate::boards::UnsafeBoard),
    /// The board has no words to show.
    #[error(transparent)]
    Words(#[from] andon_board::TableError),
    /// Recordings cannot be made.
    #[error(transparent)]
    Record(#[from] andon_record::role::RecordError),
    /// The method refuses its constants or the objects.
    #[error("the method cannot work with this configuration: {0}")]
    Method(String),
    /// The program that the role consists of cannot be started.
    #[error("cannot start {path}: {source}")]
    Start {
        /// The program.
        path: String,
        /// What the system said.
        source: io::Error,
    },
}

impl From<Ipc> for RoleError {
    fn from(error: Ipc) -> Self {
        Self::Cycle(error.into())
    }
}

impl From<couple::Unusable> for RoleError {
    fn from(error: couple::Unusable) -> Self {
        Self::Method(format!("{error:?}"))
    }
}

impl From<anomaly::Unusable> for RoleError {
    fn from(error: anomaly::Unusable) -> Self {
        Self::Method(format!("{error:?}"))
    }
}

impl Failure for RoleError {
    fn may_pass(&self) -> bool {
        match self {
            Self::Journal(error) => may_pass(error),
            Self::Plc(_) => true,
            _ => false,
        }
    }

    fn is_lasting(&self) -> bool {
        match self {
            Self::Cycle(error) => error.is_lasting(),
            Self::Record(error) => error.is_lasting(),
            _ => false,
        }
    }

    fn ending(&self) -> Option<Ending> {
        Some(match self {
            Self::Cycle(error) => return error.ending(),
            Self::Setup(SetupError::Calibration(_)) => (&code::CALIBRATION_REFUSED, OfCode, Configuration),
            Self::Setup(SetupError::Perception(error)) => match error.unusable_file() {
                Some(RuntimeFile::OnnxRuntime) => (&code::ONNXRUNTIME_MISSING, InMessage, Configuration),
                _ => (&code::MODEL_MISSING, InMessage, Configuration),
            },
            Self::Source(_) => (&code::RECORDING_DAMAGED, OfCode, Fault),
            Self::Tracks(_) => (&code::RECORDING_DAMAGED, OfCode, Configuration),
            Self::CutShort(_) => (&code::TRACK_CUT_SHORT, InMessage, Configuration),
            Self::JobFile(JobFileError { fault, .. }) => match fault {
                JobFault::Toml(_) | JobFault::Format(_) | JobFault::Invalid { .. } => {
                    (&code::JOB_REFUSED, OfCode, Configuration)
                }
                _ => (&code::JOB_REFUSED, InMessage, Configuration),
            },
            Self::UnreadJob { .. } => (&code::JOB_REFUSED, OfCode, Configuration),
            Self::UnfitJob { .. } => (&code::JOB_REFUSED, InMessage, Configuration),
            Self::LostJob { .. } => (&code::JOB_REFUSED, InMessage, Fault),
            Self::Journal(error) => ending_of_journal(error),
            Self::Plc(_) => (&code::PLC_PORT_TAKEN, OfCode, Fault),
            Self::Metrics { .. } => (&code::METRICS_PORT_TAKEN, OfCode, Fault),
            Self::Board { .. } => (&code::BOARD_PORT_TAKEN, OfCode, Fault),
            Self::UnsafeBoard(_) => (&code::BOARD_UNSAFE, InMessage, Configuration),
            Self::Words(_) => (&code::BOARD_WORDS_REFUSED, OfCode, Configuration),
            Self::Record(error) => return error.ending(),
            Self::Method(_) => (&code::CONFIGURATION_REFUSED, OfCode, Configuration),
            Self::Perception(_) | Self::Start { .. } => (&code::ROLE_FAILED, OfCode, Fault),
        })
    }
}

/// Logs an error of the journal.
pub(super) fn report_journal(error: &JournalError) {
    let (code, remedy, _) = ending_of_journal(error);
    code.log_found(error, remedy);
}

/// Whether it can be written again when somebody makes room, closes a program or mounts a disk.
pub(super) fn may_pass(error: &JournalError) -> bool {
    matches!(
        error,
        JournalError::Full { .. }
            | JournalError::Locked { .. }
            | JournalError::Open { .. }
            | JournalError::PutAside { .. }
    )
}

/// Where a person must look at the file, the exit code tells systemd not to try again.
fn ending_of_journal(error: &JournalError) -> Ending {
    match error {
        JournalError::Locked { .. } => (&code::JOURNAL_LOCKED, InMessage, Fault),
        JournalError::Damaged { .. } | JournalError::Newer { .. } => {
            (&code::JOURNAL_DAMAGED, InMessage, Configuration)
        }
        JournalError::Open { .. } | JournalError::NotFile { .. } | JournalError::PutAside { .. } => {
            (&code::JOURNAL_NOT_OPENED, InMessage, Fault)
        }
        JournalError::Removed { .. } => (&code::JOURNAL_REMOVED, OfCode, Fault),
        _ => (&code::DISK_FULL, InMessage, Fault),
    }
}
