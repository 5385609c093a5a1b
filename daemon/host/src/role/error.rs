//! Why a role cannot go on, with its code in the log and its exit code.

use std::fmt::Display;
use std::time::Duration;

use andon_ipc::Error as Ipc;

use crate::exit::Code as Exit;
use crate::exit::Code::{Configuration, Fault, NoProgress};
use crate::log::Remedy::{self, InMessage, OfCode};
use crate::log::{Code, code};

/// How an error ends its process: the code in the log, where the remedy stands, and the exit code.
pub type Ending = (&'static Code, Remedy, Exit);

/// Why a role cannot go on. Each program has an error of its own, which holds those of the libraries that it uses.
pub trait Failure: Display + From<CycleError> {
    /// How it ends the process; `None` for a stop on request.
    fn ending(&self) -> Option<Ending>;

    /// Whether what is missing may come by itself, or when somebody brings it: the role waits for it.
    fn may_pass(&self) -> bool {
        false
    }

    /// Whether the next start will meet the same fault, if nobody does anything.
    fn is_lasting(&self) -> bool;

    /// Logs the error and returns the exit code. To be called once.
    fn report(&self) -> Exit {
        let Some((code, remedy, exit)) = self.ending() else { return Exit::Stopped };
        code.log_found(self, remedy);
        exit
    }
}

/// What ends a role in its cycle, whatever it does there.
#[derive(Debug, thiserror::Error)]
pub enum CycleError {
    /// It was asked to stop in the middle of a step.
    #[error("asked to stop")]
    Stopped,
    /// The station's shared memory cannot be used.
    #[error(transparent)]
    Ipc(#[from] Ipc),
    /// A reader that a paced writer waits for makes no progress.
    #[error("no reader has taken anything for {0:?}")]
    NoProgress(Duration),
}

impl Failure for CycleError {
    fn ending(&self) -> Option<Ending> {
        match self {
            Self::Stopped | Self::Ipc(Ipc::Stopped(_)) => None,
            Self::Ipc(error) => Some(ending_of_ipc(error)),
            Self::NoProgress(_) => Some((&code::NO_PROGRESS, OfCode, NoProgress)),
        }
    }

    fn is_lasting(&self) -> bool {
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
}

fn ending_of_ipc(error: &Ipc) -> Ending {
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
