//! The control block: commands on their way to the line, and the answers to them.

use std::collections::VecDeque;

use shm_schemas::CommandKind;

use crate::registers::{Control, control};

/// Commands that can wait for the loop. The control word has four bits for the line, and the loop sends every 20 ms.
const WAITING: usize = 16;

/// A command for the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineCommand {
    /// What the line must do.
    pub kind: CommandKind,
    /// The job, for `LoadJob`; otherwise 0.
    pub job_id: u32,
    /// Hash of the job file, for `LoadJob`, where 0 accepts any; otherwise 0.
    pub model_hash: u64,
}

/// The control block as a client has written it, and what became of its commands.
#[derive(Debug, Default)]
pub(super) struct Commands {
    control: Control,
    carried_out: u16,
    refused: u16,
    waiting: VecDeque<LineCommand>,
}

impl Commands {
    pub(super) fn control(&self) -> Control {
        self.control
    }

    pub(super) fn is_set(&self, bit: u16) -> bool {
        self.control.word & bit != 0
    }

    /// The bits of the commands that were carried out, and of those that were refused.
    pub(super) fn answers(&self) -> (u16, u16) {
        (self.carried_out, self.refused)
    }

    /// Takes what a client has written; returns the control bits that have changed. Answers clear with their bit.
    pub(super) fn write(&mut self, written: Control) -> u16 {
        let changed = written.word ^ self.control.word;
        self.carried_out &= written.word;
        self.refused &= written.word;
        self.control = written;
        changed
    }

    /// Lets a command wait for the loop; false where there is no room.
    pub(super) fn push(&mut self, kind: CommandKind) -> bool {
        if self.waiting.len() == WAITING {
            return false;
        }
        let (job_id, model_hash) = match kind {
            CommandKind::LoadJob => (self.control.load_job_id, self.control.load_model_hash),
            _ => (0, 0),
        };
        self.waiting.push_back(LineCommand { kind, job_id, model_hash });
        true
    }

    pub(super) fn pop(&mut self) -> Option<LineCommand> {
        self.waiting.pop_front()
    }

    /// Answers a command, if its control bit is still set.
    pub(super) fn answer(&mut self, bit: u16, was_carried_out: bool) {
        let answers = if was_carried_out { &mut self.carried_out } else { &mut self.refused };
        *answers |= bit & self.control.word;
    }
}

/// The control bit of a command.
pub(super) const fn bit(kind: CommandKind) -> u16 {
    match kind {
        // One bit for both: `Disable` clears it, and its answer with it.
        CommandKind::Enable | CommandKind::Disable => control::ENABLE,
        CommandKind::LoadJob => control::LOAD_JOB,
        CommandKind::Start => control::START,
        CommandKind::Abort => control::ABORT,
    }
}
