//! Commands, from shared memory to the judge.

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
    let kind = CommandKind::try_from(message.kind).map_err(unknown)?;
    Ok(match kind {
        CommandKind::Enable => Command::Enable,
        CommandKind::Disable => Command::Disable,
        CommandKind::LoadJob => Command::LoadJob { job_id: message.job_id, model_hash: message.model_hash },
        CommandKind::Start => Command::Start,
        CommandKind::Abort => Command::Abort,
        CommandKind::SetPart => {
            let source = CommandSource::try_from(message.source).map_err(unknown)?;
            // What is no id is none: never that of the part before.
            Command::SetPart { part: PartId::new(message.part.bytes()).unwrap_or(PartId::NONE), source }
        }
    })
}
