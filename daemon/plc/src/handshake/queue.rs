//! Results on their way to the PLC: numbered as they come, held back until the journal has them.

use std::collections::VecDeque;

use shm_schemas::{NO_INDEX, Verdict, VerdictKind};

use crate::registers::{ResultBlock, status};

/// Results that wait behind the offered one (DESIGN 5).
pub const QUEUE: usize = 8;

/// A result that waits.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    result: ResultBlock,
    since_ns: u64,
    confirmed: bool,
}

/// What happened to a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Taken {
    /// It waits; so many before it were lost.
    Queued { lost: u64 },
    /// There was no room: it and those before it are lost.
    Full { lost: u64 },
    /// It had come before.
    Again,
}

/// The queue.
#[derive(Debug, Default)]
pub(super) struct Queue {
    waiting: VecDeque<Waiting>,
    sequence: u32,
    /// Epoch and seq of the newest verdict that came.
    newest: Option<(u64, u64)>,
    /// Epoch and seq of the newest verdict that the journal has.
    confirmed: Option<(u64, u64)>,
}

impl Queue {
    pub(super) fn len(&self) -> usize {
        self.waiting.len()
    }

    pub(super) fn push(&mut self, verdict: &Verdict, now_ns: u64) -> Taken {
        let (epoch, seq) = (verdict.stamp.epoch, verdict.stamp.seq);
        let lost = match self.newest {
            // Who starts in the middle has lost nothing: it was never offered.
            None => 0,
            Some((known, newest)) if known == epoch && seq <= newest => return Taken::Again,
            Some((known, newest)) if known == epoch => seq - newest - 1,
            // A writer numbers from 1 after its start.
            Some(_) => seq.saturating_sub(1),
        };
        self.newest = Some((epoch, seq));
        self.number(lost);
        let sequence = self.number(1);
        if self.waiting.len() >= QUEUE {
            return Taken::Full { lost: lost + 1 };
        }
        let result = ResultBlock { sequence, outcome: outcome(verdict), verdict: *verdict };
        self.waiting.push_back(Waiting { result, since_ns: now_ns, confirmed: false });
        self.apply_confirmation();
        Taken::Queued { lost }
    }

    /// The journal has every verdict up to this one.
    pub(super) fn confirm(&mut self, epoch: u64, seq: u64) {
        self.confirmed = Some((epoch, seq));
        self.apply_confirmation();
    }

    /// Takes the first result out, once the journal has it.
    pub(super) fn pop(&mut self) -> Option<ResultBlock> {
        self.waiting.pop_front_if(|first| first.confirmed).map(|first| first.result)
    }

    /// Whether [`Queue::pop`] would give one.
    pub(super) fn is_next_confirmed(&self) -> bool {
        self.waiting.front().is_some_and(|first| first.confirmed)
    }

    /// Since when the oldest result waits that the journal does not have.
    pub(super) fn unconfirmed_since(&self) -> Option<u64> {
        self.waiting.iter().find(|waiting| !waiting.confirmed).map(|waiting| waiting.since_ns)
    }

    /// The journal reads the same channel in the same order. So what it has of the newest epoch says that it is through with
    /// every earlier one: it has those verdicts, or a row for the gap.
    fn apply_confirmation(&mut self) {
        let (Some((epoch, seq)), Some((newest, _))) = (self.confirmed, self.newest) else { return };
        for waiting in &mut self.waiting {
            let stamp = &waiting.result.verdict.stamp;
            waiting.confirmed |= if stamp.epoch == epoch {
                stamp.seq <= seq
            } else {
                epoch == newest && stamp.epoch != newest
            };
        }
    }

    /// Moves the sequence on; 0 is left out, it stands for no result.
    fn number(&mut self, by: u64) -> u32 {
        // 2^32 - 1 numbers: 1..=u32::MAX.
        let next = (u64::from(self.sequence) + by).checked_sub(1).map_or(0, |n| n % u64::from(u32::MAX) + 1);
        self.sequence = u32::try_from(next).unwrap_or(1);
        self.sequence
    }
}

/// The bit of the status word that says how it came out. What is not known to be right is never `OK`.
fn outcome(verdict: &Verdict) -> u16 {
    use VerdictKind as K;
    match K::try_from(verdict.kind) {
        Ok(K::IuOk | K::ActivityOk | K::JobOk) => status::OK,
        Ok(K::IuAnomaly | K::ActivityAnomaly | K::JobAnomaly) => status::NOK,
        Ok(K::NotJudged) | Err(_) => status::NOT_JUDGED,
    }
}

/// Whether the verdict ends a job.
pub(super) fn ends_job(verdict: &Verdict) -> bool {
    verdict.activity == NO_INDEX && verdict.iu == NO_INDEX
}
