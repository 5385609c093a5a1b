//! What can be wrong with a camera or a recording, and how the role `capture` ends by it.

use andon_host::exit::Code::{Configuration, Fault};
use andon_host::log::Remedy::{self, InMessage, OfCode};
use andon_host::log::{Code, code};
use andon_host::role::{CycleError, Ending, Failure};

/// Why a camera or a recording cannot be opened: each holds a message for a technician.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OpenError {
    /// It is missing or does not answer. A camera may come back.
    #[error("{0}")]
    Gone(String),
    /// It is no recording that can be played.
    #[error("{0}")]
    NoRecording(String),
    /// This user may not open it.
    #[error("{0}")]
    NotAllowed(String),
    /// It does not offer what the configuration asks for.
    #[error("{0}")]
    Refused(String),
    /// It cannot work the way it is connected.
    #[error("{0}")]
    Unfit(String),
    /// This build or this installation does not support it.
    #[error("{0}")]
    Unsupported(String),
}

impl OpenError {
    /// Logs that a camera is missing, while the role goes on and tries again.
    pub(crate) fn report(&self) {
        let (code, remedy) = self.code();
        code.log_found(self, remedy);
    }

    fn code(&self) -> (&'static Code, Remedy) {
        match self {
            Self::Gone(_) => (&code::CAMERA_GONE, OfCode),
            Self::NoRecording(_) => (&code::RECORDING_DAMAGED, OfCode),
            Self::NotAllowed(_) => (&code::CAMERA_NOT_ALLOWED, OfCode),
            Self::Refused(_) => (&code::CAMERA_REFUSED, InMessage),
            Self::Unfit(_) | Self::Unsupported(_) => (&code::REALSENSE_UNFIT, InMessage),
        }
    }
}

/// Why `capture` cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum CaptureError {
    /// What ends any role.
    #[error(transparent)]
    Cycle(#[from] CycleError),
    /// The camera or the recording cannot be opened.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// The camera or the recording has failed after it was opened.
    #[error("{0}")]
    Source(String),
}

impl From<andon_ipc::Error> for CaptureError {
    fn from(error: andon_ipc::Error) -> Self {
        Self::Cycle(error.into())
    }
}

impl Failure for CaptureError {
    fn ending(&self) -> Option<Ending> {
        Some(match self {
            Self::Cycle(error) => return error.ending(),
            Self::Source(_) | Self::Open(OpenError::Gone(_)) => (&code::RECORDING_DAMAGED, OfCode, Fault),
            Self::Open(error) => {
                let (code, remedy) = error.code();
                let is_final = matches!(
                    error,
                    OpenError::NoRecording(_) | OpenError::Refused(_) | OpenError::Unsupported(_)
                );
                (code, remedy, if is_final { Configuration } else { Fault })
            }
        })
    }

    fn is_lasting(&self) -> bool {
        matches!(self, Self::Cycle(error) if error.is_lasting())
    }
}
