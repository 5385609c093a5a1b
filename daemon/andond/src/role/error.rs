//! Why a role cannot go on, with its code in the log and its exit code.

use std::io;
use std::path::PathBuf;

use andon_ipc::Error as Ipc;
use andon_journal::JournalError;
use andon_learn::job_file::{JobFault, JobFileError};
use andon_learn::recording::TrackError;
use andon_perception::{PerceptionError, RuntimeFile};

use crate::compatibility::Misfit;
use crate::exit::Code;
use crate::log::{code, log};
use crate::perception::SetupError;
use crate::video::OpenError;

/// Why a role cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum RoleError {
    /// It was asked to stop in the middle of a step.
    #[error("asked to stop")]
    Stopped,
    /// The station's shared memory cannot be used.
    #[error(transparent)]
    Ipc(#[from] Ipc),
    /// A frame cannot be processed.
    #[error(transparent)]
    Perception(#[from] PerceptionError),
    /// A model, a library or a calibration is missing or unusable.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The camera or the recording has failed after it was opened.
    #[error("{0}")]
    Source(String),
    /// The camera or the recording cannot be opened.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// The track file cannot be played.
    #[error(transparent)]
    Tracks(#[from] TrackError),
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
    /// The database cannot be opened or written.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The Modbus server cannot start.
    #[error(transparent)]
    Plc(#[from] andon_plc::modbus::ServeError),
    /// The method refuses its constants or the objects.
    #[error("the method cannot work with this configuration: {0}")]
    Method(String),
    /// A reader that a paced writer waits for makes no progress.
    #[error("no reader has taken anything for {0:?}")]
    NoProgress(std::time::Duration),
    /// The program that the role consists of cannot be started.
    #[error("cannot start {path}: {source}")]
    Start {
        /// The program.
        path: String,
        /// What the system said.
        source: io::Error,
    },
}

impl RoleError {
    /// Logs the error and returns the exit code. To be called once.
    pub fn report(&self) -> Code {
        match self {
            Self::Stopped => Code::Stopped,
            Self::Ipc(error) => report_ipc(error),
            Self::Perception(error) => {
                log!(code::ROLE_FAILED, "{error}");
                Code::Fault
            }
            Self::Setup(error) => {
                match error {
                    SetupError::Calibration(_) => log!(code::CALIBRATION_REFUSED, "{error}"),
                    SetupError::Perception(cause)
                        if cause.unusable_file() == Some(RuntimeFile::OnnxRuntime) =>
                    {
                        log!(code::ONNXRUNTIME_MISSING, remedied: "{error}");
                    }
                    SetupError::Perception(_) => log!(code::MODEL_MISSING, remedied: "{error}"),
                }
                Code::Configuration
            }
            Self::Source(_) | Self::Open(OpenError::Gone(_)) => {
                log!(code::RECORDING_DAMAGED, "{self}");
                Code::Fault
            }
            Self::Open(error) => {
                report_camera(error);
                match error {
                    OpenError::Refused(_) | OpenError::Unsupported(_) => Code::Configuration,
                    _ => Code::Fault,
                }
            }
            Self::Tracks(error) => {
                log!(code::RECORDING_DAMAGED, "{error}");
                Code::Configuration
            }
            Self::JobFile(JobFileError {
                fault: JobFault::Toml(_) | JobFault::Format(_) | JobFault::Invalid { .. },
                ..
            })
            | Self::UnreadJob { .. } => {
                log!(code::JOB_REFUSED, "{self}");
                Code::Configuration
            }
            Self::JobFile(_) | Self::UnfitJob { .. } => {
                log!(code::JOB_REFUSED, remedied: "{self}");
                Code::Configuration
            }
            Self::Journal(error) => report_journal(error),
            Self::Plc(_) => {
                log!(code::PLC_PORT_TAKEN, "{self}");
                Code::Fault
            }
            Self::Method(_) => {
                log!(code::CONFIGURATION_REFUSED, "{self}");
                Code::Configuration
            }
            Self::NoProgress(_) => {
                log!(code::NO_PROGRESS, "{self}");
                Code::NoProgress
            }
            Self::Start { .. } => {
                log!(code::ROLE_FAILED, "{self}");
                Code::Fault
            }
        }
    }
}

/// Logs an error of the camera.
pub fn report_camera(error: &OpenError) {
    match error {
        OpenError::Gone(_) => log!(code::CAMERA_GONE, "{error}"),
        OpenError::NotAllowed(_) => log!(code::CAMERA_NOT_ALLOWED, "{error}"),
        OpenError::Refused(_) => log!(code::CAMERA_REFUSED, remedied: "{error}"),
        OpenError::Unfit(_) | OpenError::Unsupported(_) => log!(code::REALSENSE_UNFIT, remedied: "{error}"),
    }
}

/// Logs an error of the journal. Where a person must look at the file, the exit code tells systemd not to try again.
pub(super) fn report_journal(error: &JournalError) -> Code {
    match error {
        JournalError::Locked { .. } => log!(code::JOURNAL_LOCKED, remedied: "{error}"),
        JournalError::Damaged { .. } | JournalError::Newer { .. } => {
            log!(code::JOURNAL_DAMAGED, remedied: "{error}");
            return Code::Configuration;
        }
        _ => log!(code::DISK_FULL, remedied: "{error}"),
    }
    Code::Fault
}

fn report_ipc(error: &Ipc) -> Code {
    match error {
        Ipc::StationName { .. }
        | Ipc::RootTooLong { .. }
        | Ipc::RootNotAbsolute { .. }
        | Ipc::RootNotWritable { .. } => {
            log!(code::CONFIGURATION_REFUSED, "{error}");
            return Code::Configuration;
        }
        Ipc::RootVanished { .. } => log!(code::ROOT_DELETED, remedied: "{error}"),
        Ipc::NoRoom { .. } | Ipc::SharedMemory(_) => log!(code::SHM_FULL, remedied: "{error}"),
        Ipc::StewardRunning { .. } => log!(code::STEWARD_TWICE, "{error}"),
        Ipc::NoSteward { .. } => log!(code::STEWARD_MISSING, remedied: "{error}"),
        Ipc::LayoutMismatch { .. } => log!(code::OTHER_VERSION, remedied: "{error}"),
        Ipc::ServiceUnreadable { .. } => log!(code::SERVICE_UNUSABLE, remedied: "{error}"),
        _ => log!(code::SERVICE_UNUSABLE, "{error}"),
    }
    Code::Fault
}
