//! Why a role cannot go on, with its code in the log and its exit code.

use std::io;
use std::path::PathBuf;

use andon_ipc::Error as Ipc;
use andon_journal::JournalError;
use andon_learn::job_file::{JobFault, JobFileError};
use andon_learn::recording::{TrackError, Truncation};
use andon_perception::{PerceptionError, RuntimeFile};
use shm_schemas::Refusal;

use crate::compatibility::Misfit;
use crate::exit::Code as Exit;
use crate::exit::Code::{Configuration, Fault, NoProgress};
use crate::log::Remedy::{self, InMessage, OfCode};
use crate::log::{Code, code};
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
    pub fn report(&self) -> Exit {
        let Some((code, remedy, exit)) = self.classify() else { return Exit::Stopped };
        code.log_found(self, remedy);
        exit
    }

    /// Whether what is missing may come by itself, or when somebody brings it: the role waits for it.
    pub(super) fn may_pass(&self) -> bool {
        match self {
            Self::Journal(error) => may_pass(error),
            Self::Plc(_) => true,
            _ => false,
        }
    }

    /// Whether the next start will meet the same fault, if nobody does anything.
    pub(super) fn is_lasting(&self) -> bool {
        matches!(
            self,
            Self::Ipc(
                Ipc::StewardRunning { .. }
                    | Ipc::NoRoom { .. }
                    | Ipc::SharedMemory(_)
                    | Ipc::LayoutMismatch { .. }
                    | Ipc::OtherUser { .. }
                    | Ipc::ServiceUnreadable { .. }
            )
        )
    }

    /// The code in the log, where the remedy stands, and the exit code; `None` for a stop on request.
    fn classify(&self) -> Option<(&'static Code, Remedy, Exit)> {
        Some(match self {
            Self::Stopped | Self::Ipc(Ipc::Stopped(_)) => return None,
            Self::Ipc(error) => classify_ipc(error),
            Self::Setup(SetupError::Calibration(_)) => (&code::CALIBRATION_REFUSED, OfCode, Configuration),
            Self::Setup(SetupError::Perception(error)) => match error.unusable_file() {
                Some(RuntimeFile::OnnxRuntime) => (&code::ONNXRUNTIME_MISSING, InMessage, Configuration),
                _ => (&code::MODEL_MISSING, InMessage, Configuration),
            },
            Self::Source(_) | Self::Open(OpenError::Gone(_)) => (&code::RECORDING_DAMAGED, OfCode, Fault),
            Self::Open(OpenError::NoRecording(_)) => (&code::RECORDING_DAMAGED, OfCode, Configuration),
            Self::Tracks(_) => (&code::RECORDING_DAMAGED, OfCode, Configuration),
            Self::CutShort(_) => (&code::TRACK_CUT_SHORT, InMessage, Configuration),
            Self::Open(error) => {
                let (code, remedy) = classify_camera(error);
                let is_final = matches!(error, OpenError::Refused(_) | OpenError::Unsupported(_));
                (code, remedy, if is_final { Configuration } else { Fault })
            }
            Self::JobFile(JobFileError { fault, .. }) => match fault {
                JobFault::Toml(_) | JobFault::Format(_) | JobFault::Invalid { .. } => {
                    (&code::JOB_REFUSED, OfCode, Configuration)
                }
                _ => (&code::JOB_REFUSED, InMessage, Configuration),
            },
            Self::UnreadJob { .. } => (&code::JOB_REFUSED, OfCode, Configuration),
            Self::UnfitJob { .. } => (&code::JOB_REFUSED, InMessage, Configuration),
            Self::LostJob { .. } => (&code::JOB_REFUSED, InMessage, Fault),
            Self::Journal(error) => classify_journal(error),
            Self::Plc(_) => (&code::PLC_PORT_TAKEN, OfCode, Fault),
            Self::Metrics { .. } => (&code::METRICS_PORT_TAKEN, OfCode, Fault),
            Self::Method(_) => (&code::CONFIGURATION_REFUSED, OfCode, Configuration),
            Self::NoProgress(_) => (&code::NO_PROGRESS, OfCode, NoProgress),
            Self::Perception(_) | Self::Start { .. } => (&code::ROLE_FAILED, OfCode, Fault),
        })
    }
}

/// Logs an error of the camera.
pub fn report_camera(error: &OpenError) {
    let (code, remedy) = classify_camera(error);
    code.log_found(error, remedy);
}

/// Logs an error of the journal.
pub(super) fn report_journal(error: &JournalError) {
    let (code, remedy, _) = classify_journal(error);
    code.log_found(error, remedy);
}

fn classify_camera(error: &OpenError) -> (&'static Code, Remedy) {
    match error {
        OpenError::Gone(_) => (&code::CAMERA_GONE, OfCode),
        OpenError::NoRecording(_) => (&code::RECORDING_DAMAGED, OfCode),
        OpenError::NotAllowed(_) => (&code::CAMERA_NOT_ALLOWED, OfCode),
        OpenError::Refused(_) => (&code::CAMERA_REFUSED, InMessage),
        OpenError::Unfit(_) | OpenError::Unsupported(_) => (&code::REALSENSE_UNFIT, InMessage),
    }
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
fn classify_journal(error: &JournalError) -> (&'static Code, Remedy, Exit) {
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

fn classify_ipc(error: &Ipc) -> (&'static Code, Remedy, Exit) {
    match error {
        Ipc::StationName { .. }
        | Ipc::RootTooLong { .. }
        | Ipc::RootNotAbsolute { .. }
        | Ipc::RootNotWritable { .. } => (&code::CONFIGURATION_REFUSED, OfCode, Configuration),
        Ipc::RootVanished { .. } => (&code::ROOT_DELETED, InMessage, Fault),
        Ipc::NoRoom { .. } | Ipc::SharedMemory(_) => (&code::SHM_FULL, InMessage, Fault),
        Ipc::StewardRunning { .. } => (&code::STEWARD_TWICE, OfCode, Fault),
        Ipc::NoSteward { .. } => (&code::STEWARD_MISSING, InMessage, Fault),
        Ipc::LayoutMismatch { .. } => (&code::OTHER_VERSION, InMessage, Fault),
        Ipc::ServiceUnreadable { .. } => (&code::SERVICE_UNUSABLE, InMessage, Fault),
        _ => (&code::SERVICE_UNUSABLE, OfCode, Fault),
    }
}
