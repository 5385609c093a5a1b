//! Commands, from shared memory to the judge.

use shm_schemas::{Command as Message, CommandKind};

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
}

/// A message whose kind is no command.
#[derive(Debug, thiserror::Error)]
#[error("a message of the kind {0} is no command")]
pub struct UnknownCommand(u8);

/// Reads a command from a message.
///
/// # Errors
/// A kind that does not exist.
pub fn read(message: &Message) -> Result<Command, UnknownCommand> {
    let kind = CommandKind::try_from(message.kind).map_err(|_| UnknownCommand(message.kind))?;
    Ok(match kind {
        CommandKind::Enable => Command::Enable,
        CommandKind::Disable => Command::Disable,
        CommandKind::LoadJob => Command::LoadJob { job_id: message.job_id, model_hash: message.model_hash },
        CommandKind::Start => Command::Start,
        CommandKind::Abort => Command::Abort,
    })
}
