//! The queue of results: numbered in the order in which they come, held back until the journal has them.

use std::collections::VecDeque;

use shm_schemas::{Verdict, VerdictOutcome};

use crate::registers::{ResultBlock, status};

/// The number of results that can wait behind the offered one.
pub const QUEUE: usize = 8;

/// A result that waits.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    result: ResultBlock,
    since_ns: u64,
    confirmed: bool,
}

/// What became of a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pushed {
    /// It waits; this many before it were lost.
    Queued { lost: u64 },
    /// There was no room: this many were lost, itself included.
    Full { lost: u64 },
    /// It had come before.
    Repeated,
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

    pub(super) fn push(&mut self, verdict: &Verdict, now_ns: u64) -> Pushed {
        let (epoch, seq) = (verdict.stamp.epoch, verdict.stamp.seq);
        let lost = match self.newest {
            // Nothing is lost before the first: what this role did not see was never its to offer.
            None => 0,
            Some((known, newest)) if known == epoch && seq <= newest => return Pushed::Repeated,
            Some((known, newest)) if known == epoch => seq - newest - 1,
            // A writer counts from 1 after its start.
            Some(_) => seq.saturating_sub(1),
        };
        self.newest = Some((epoch, seq));
        self.number(lost);
        let sequence = self.number(1);
        if self.waiting.len() >= QUEUE {
            return Pushed::Full { lost: lost + 1 };
        }
        let result = ResultBlock { sequence, outcome: outcome(verdict), verdict: *verdict };
        self.waiting.push_back(Waiting { result, since_ns: now_ns, confirmed: false });
        self.apply_confirmation();
        Pushed::Queued { lost }
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

    /// The journal reads the same channel in the same order. Once it has a verdict of the newest epoch, it has written every earlier
    /// epoch: its verdicts, or a row for the gap.
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

    /// Advances the sequence. It never is 0, which stands for no result.
    fn number(&mut self, by: u64) -> u32 {
        // 2^32 - 1 numbers: 1..=u32::MAX.
        let next = (u64::from(self.sequence) + by).checked_sub(1).map_or(0, |n| n % u64::from(u32::MAX) + 1);
        self.sequence = u32::try_from(next).unwrap_or(1);
        self.sequence
    }
}

/// The outcome as a bit of the status word. What is not known to be right is never `OK`.
fn outcome(verdict: &Verdict) -> u16 {
    match (verdict.level(), verdict.outcome()) {
        (Ok(_), Ok(VerdictOutcome::Ok)) => status::OK,
        (_, Ok(VerdictOutcome::Anomaly)) => status::NOK,
        (_, Ok(VerdictOutcome::NotJudged | VerdictOutcome::Ok) | Err(_)) => status::NOT_JUDGED,
    }
}
