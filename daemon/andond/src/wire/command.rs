//! Commands out of shared memory.

use shm_schemas::{Command as Message, CommandKind};

/// What the judge is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Watch.
    Enable,
    /// Do not watch.
    Disable,
    /// Load the job of this number; `model_hash` 0 accepts any version of it.
    LoadJob {
        /// The job's number.
        job_id: u32,
        /// The version that is wanted.
        model_hash: u64,
    },
    /// The job begins now.
    Start,
    /// The job ends now.
    Abort,
}

/// A message that is no command.
#[derive(Debug, thiserror::Error)]
#[error("a message of the kind {0} is no command")]
pub struct UnknownCommand(u8);

/// What a message asks of the judge.
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
