//! Commands, from shared memory to the judge.

use std::fmt;

use shm_schemas::{Command as Message, CommandKind, CommandSource, PartId};

/// A command to the judge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Judge from now on.
    Enable,
    /// Judge nothing until the next `Enable`.
    Disable,
    /// Load a job.
    LoadJob {
        /// The number of the job.
        job_id: u32,
        /// The version of the job; 0 accepts any.
        model_hash: u64,
        /// Who asks for it.
        source: CommandSource,
    },
    /// A job begins now.
    Start,
    /// The open job ends now.
    Abort,
    /// The jobs that begin from now on are done to this part.
    SetPart {
        /// Its id.
        part: PartId,
        /// Who gives it.
        source: CommandSource,
    },
}

/// As a technician reads it in the log.
impl fmt::Display for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Enable => write!(f, "enable: judge from now on"),
            Self::Disable => write!(f, "disable: judge nothing from now on"),
            Self::LoadJob { job_id, model_hash: 0, source } => {
                write!(f, "load job {job_id}, whatever its hash, for {}", asker(*source))
            }
            Self::LoadJob { job_id, model_hash, source } => {
                write!(f, "load job {job_id} of hash {model_hash:016x}, for {}", asker(*source))
            }
            Self::Start => write!(f, "start: a job begins now"),
            Self::Abort => write!(f, "abort: the running job ends now"),
            Self::SetPart { part, source } if part.is_none() => {
                write!(f, "the next part has no id, says {}", asker(*source))
            }
            Self::SetPart { part, source } => {
                write!(f, "the next part is {:?}, says {}", part.text(), asker(*source))
            }
        }
    }
}

/// What people call who asks.
const fn asker(source: CommandSource) -> &'static str {
    match source {
        CommandSource::Plc => "the PLC",
        CommandSource::Tool => "a person or a scanner",
    }
}

/// A message whose kind is not a command.
#[derive(Debug, thiserror::Error)]
#[error("a message of the kind {0} from {1} is not a command")]
pub struct UnknownCommand(u8, u8);

/// Reads a command from a message.
///
/// # Errors
/// A kind that does not exist.
pub fn read(message: &Message) -> Result<Command, UnknownCommand> {
    let unknown = |_| UnknownCommand(message.kind, message.source);
    let source = || CommandSource::try_from(message.source).map_err(unknown);
    let kind = CommandKind::try_from(message.kind).map_err(unknown)?;
    Ok(match kind {
        CommandKind::Enable => Command::Enable,
        CommandKind::Disable => Command::Disable,
        CommandKind::LoadJob => {
            Command::LoadJob { job_id: message.job_id, model_hash: message.model_hash, source: source()? }
        }
        CommandKind::Start => Command::Start,
        CommandKind::Abort => Command::Abort,
        CommandKind::SetPart => {
            // An invalid id counts as no id, never as that of the part before.
            Command::SetPart {
                part: PartId::new(message.part.bytes()).unwrap_or(PartId::NONE),
                source: source()?,
            }
        }
    })
}
