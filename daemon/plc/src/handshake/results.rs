//! How a result gets to the PLC.
//!
//! ```text
//!         a confirmed result waits            `acknowledge` set
//!  Empty ─────────────────────────► Offered ─────────────────────► Acknowledged
//!    ▲                              ▲    │                              │
//!    │                              │    │ without writes: held long    │ `acknowledge` cleared
//!    │                              │    │ enough, and another waits    │
//!    │                              ├────┘                              │
//!    │                              └──────── another waits ◄───────────┤
//!    └─────────────────────────────────────── nothing waits ◄───────────┘
//! ```
//!
//! `done`, and one of `ok`, `nok`, `not-judged`, are set in `Offered` and in no other state. A result is offered only once
//! the journal has it. A result that finds the queue full is lost; the overrun bit and a jump of `sequence` say so.

use shm_schemas::Verdict;

use super::queue::{Pushed, Queue};
use crate::registers::ResultBlock;

/// Where the result on the registers is in its life.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    #[default]
    Empty,
    Offered {
        since_ns: u64,
    },
    Acknowledged,
}

/// When an offered result gives way to the next one.
#[derive(Clone, Copy, Debug)]
pub(super) enum Release {
    /// When `acknowledge` has been set and cleared again; whether it is set now.
    Acknowledge { is_set: bool },
    /// After this time, if another one waits.
    After { hold_ns: u64 },
}

/// The result on the registers, and those behind it.
#[derive(Debug, Default)]
pub(super) struct Results {
    phase: Phase,
    queue: Queue,
    newest: Option<ResultBlock>,
    lost: u32,
    has_overrun: bool,
}

impl Results {
    /// Takes a verdict; false where it had come before.
    pub(super) fn push(&mut self, verdict: &Verdict, now_ns: u64) -> bool {
        let lost = match self.queue.push(verdict, now_ns) {
            Pushed::Repeated => return false,
            Pushed::Queued { lost } | Pushed::Full { lost } => lost,
        };
        self.lost = self.lost.saturating_add(u32::try_from(lost).unwrap_or(u32::MAX));
        self.has_overrun |= lost > 0;
        true
    }

    /// The journal has every verdict of this epoch up to `seq`.
    pub(super) fn confirm(&mut self, epoch: u64, seq: u64) {
        self.queue.confirm(epoch, seq);
    }

    /// Offers the next result, if the phase and the journal allow it.
    pub(super) fn advance(&mut self, release: Release, now_ns: u64) {
        let is_free = match (self.phase, release) {
            (Phase::Empty, _) | (Phase::Acknowledged, Release::After { .. }) => true,
            (Phase::Acknowledged, Release::Acknowledge { is_set }) => !is_set,
            (Phase::Offered { .. }, Release::Acknowledge { .. }) => false,
            (Phase::Offered { since_ns }, Release::After { hold_ns }) => {
                self.queue.is_next_confirmed() && now_ns.saturating_sub(since_ns) >= hold_ns
            }
        };
        if !is_free {
            return;
        }
        self.phase = match self.queue.pop() {
            Some(result) => {
                self.newest = Some(result);
                Phase::Offered { since_ns: now_ns }
            }
            None => Phase::Empty,
        };
    }

    /// The PLC has read the offered result; false where none is offered.
    pub(super) fn acknowledge(&mut self) -> bool {
        let is_offered = self.offered().is_some();
        if is_offered {
            self.phase = Phase::Acknowledged;
        }
        is_offered
    }

    /// The result that is offered.
    pub(super) fn offered(&self) -> Option<&ResultBlock> {
        self.newest.as_ref().filter(|_| matches!(self.phase, Phase::Offered { .. }))
    }

    /// The result that was offered last; it stays on the registers.
    pub(super) fn newest(&self) -> Option<ResultBlock> {
        self.newest
    }

    /// Since when the oldest result waits that the journal does not have.
    pub(super) fn unconfirmed_since(&self) -> Option<u64> {
        self.queue.unconfirmed_since()
    }

    /// Results that wait behind the offered one.
    pub(super) fn queued(&self) -> u16 {
        // At most QUEUE.
        self.queue.len() as u16
    }

    /// Results that were lost since the start.
    pub(super) fn lost(&self) -> u32 {
        self.lost
    }

    /// Whether a result was lost since [`Results::reset_overrun`].
    pub(super) fn has_overrun(&self) -> bool {
        self.has_overrun
    }

    pub(super) fn reset_overrun(&mut self) {
        self.has_overrun = false;
    }
}
