//! How a result gets to the PLC.
//!
//! ```text
//!         a result waits             `acknowledge` set           the journal keeps it
//!  Empty ───────────────► Offered ─────────────────────► Released ───────────────────► Acknowledged
//!                            ▲    without writes: held long    (`done` is still set)         │
//!                            │    enough, and another waits                                 │
//!                            └──────── another waits, and `acknowledge` is clear ────────────┘
//! ```
//!
//! `done`, and one of `ok`, `nok`, `not-judged`, are set in `Offered` and `Released` and in no other state. All results come from the journal. An
//! acknowledgement counts once the journal keeps it. Whatever ends this process, its next start offers what was not acknowledged, under the same
//! number, and nothing older. A result that finds the queue full stays in the journal and is asked for when there is room. Without writes nobody says
//! that they keep up, and so it is lost. The overrun bit and a jump of `sequence` say so, as for a result that the journal does not have.

use shm_schemas::{Account, Journalled, MessageId};

use super::queue::{PendingResult, Queue, Taken};
use crate::registers::ResultBlock;

/// Where the result on the registers is in its life.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    #[default]
    Empty,
    Offered {
        since_ns: u64,
    },
    Released,
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
    shown: Option<PendingResult>,
    lost: u32,
    has_overrun: bool,
}

impl Results {
    /// Goes on where the account ends.
    pub(super) fn resume(account: &Account, now_ns: u64) -> Self {
        let shown = PendingResult::resume(account.shown_row, account.shown_sequence);
        let phase = match shown {
            None => Phase::Empty,
            Some(_) if account.is_acknowledged != 0 => Phase::Acknowledged,
            Some(_) => Phase::Offered { since_ns: now_ns },
        };
        let (lost, has_overrun) = (account.lost, account.has_overrun != 0);
        Self { phase, queue: Queue::resume(account), shown, lost, has_overrun }
    }

    /// Writes what [`Results::resume`] reads.
    pub(super) fn save(&self, account: &mut Account) {
        self.queue.save(account);
        (account.shown_row, account.shown_sequence) =
            self.shown.map_or((0, 0), |shown| (shown.row, shown.sequence));
        account.is_acknowledged = matches!(self.phase, Phase::Released | Phase::Acknowledged).into();
        (account.lost, account.has_overrun) = (self.lost, self.has_overrun.into());
    }

    /// The rows are those of another journal from now on.
    pub(super) fn forget_rows(&mut self) {
        self.queue.forget_rows();
        if let Some(shown) = &mut self.shown {
            shown.row = 0;
        }
    }

    /// The row after which the answer to this request for rows begins.
    pub(super) fn ask(&mut self, asked: u32) -> u64 {
        self.queue.ask(asked, self.needs_after())
    }

    /// Whether rows that could not be taken are left in the journal.
    pub(super) fn has_more(&self) -> bool {
        self.queue.has_more()
    }

    /// Whether they must be asked for now. True once.
    pub(super) fn wants_more(&mut self) -> bool {
        self.queue.wants_more()
    }

    /// Takes a row of the journal, which stays there while the queue is full if it `may_wait`.
    pub(super) fn take(&mut self, row: &Journalled, may_wait: bool) -> Taken {
        let mut lost = 0;
        let taken = self.queue.take(row, may_wait, &mut lost);
        if let Some(shown) = self.shown.as_mut().filter(|_| taken != Taken::Early) {
            shown.fill(row);
        }
        let is_past = matches!(taken, Taken::New | Taken::Waits);
        if is_past && matches!(self.phase, Phase::Offered { .. }) && self.offered().is_none() {
            // As in the queue: what has not come by now is not in the journal any more.
            (self.phase, self.shown) = (Phase::Empty, None);
            lost += 1;
        }
        self.lost = self.lost.saturating_add(u32::try_from(lost).unwrap_or(u32::MAX));
        self.has_overrun |= lost > 0;
        taken
    }

    /// Offers the next result, if the phase allows it.
    pub(super) fn advance(&mut self, release: Release, now_ns: u64) {
        let is_free = match (self.phase, release) {
            (Phase::Empty, _) | (Phase::Acknowledged, Release::After { .. }) => true,
            (Phase::Acknowledged, Release::Acknowledge { is_set }) => !is_set,
            (Phase::Offered { since_ns }, Release::After { hold_ns }) => {
                let is_over = self.queue.has_next() && now_ns.saturating_sub(since_ns) >= hold_ns;
                if is_over && self.offered().is_some() {
                    self.phase = Phase::Released;
                }
                false
            }
            (Phase::Offered { .. }, Release::Acknowledge { .. }) | (Phase::Released, _) => false,
        };
        if !is_free {
            return;
        }
        if let Some(owed) = self.queue.pop() {
            self.shown = Some(owed);
            self.phase = Phase::Offered { since_ns: now_ns };
        }
    }

    /// The PLC has read the offered result.
    pub(super) fn acknowledge(&mut self) {
        if self.offered().is_some() {
            self.phase = Phase::Released;
        }
    }

    /// The number of the result that was acknowledged last, as the journal is to keep it; 0 is none.
    pub(super) fn released(&self) -> u32 {
        let is_released = matches!(self.phase, Phase::Released | Phase::Acknowledged);
        self.shown.filter(|_| is_released).map_or(0, |shown| shown.sequence)
    }

    /// Whether an acknowledgement waits for the journal.
    pub(super) fn is_released(&self) -> bool {
        self.phase == Phase::Released
    }

    /// The journal keeps the acknowledgement. True where one was waiting for that.
    pub(super) fn kept(&mut self) -> bool {
        let was_released = self.phase == Phase::Released;
        if was_released {
            self.phase = Phase::Acknowledged;
        }
        was_released
    }

    /// The result that is offered.
    pub(super) fn offered(&self) -> Option<ResultBlock> {
        let is_offered = matches!(self.phase, Phase::Offered { .. } | Phase::Released);
        self.newest().filter(|_| is_offered)
    }

    /// The result that was offered last; it stays on the registers.
    pub(super) fn newest(&self) -> Option<ResultBlock> {
        self.shown?.result
    }

    /// The newest verdict that came from the journal.
    pub(super) fn newest_verdict(&self) -> Option<MessageId> {
        self.queue.newest()
    }

    /// Whether rows of the account have not come yet.
    pub(super) fn is_missing_rows(&self) -> bool {
        self.needs_after() < self.queue.row()
    }

    /// The rows after this one are needed.
    fn needs_after(&self) -> u64 {
        let shown = self.shown.filter(|shown| shown.result.is_none() && shown.row != 0);
        let queued = self.queue.needs_after();
        shown.map_or(queued, |shown| queued.min(shown.row - 1))
    }

    /// Results that wait behind the offered one.
    pub(super) fn queued(&self) -> u16 {
        // At most QUEUE.
        self.queue.len() as u16
    }

    /// Results that were lost to the PLC.
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
