//! The queue of results: the rows of the journal, numbered in their order.

use std::collections::VecDeque;

use shm_schemas::{Account, Journalled, MessageId, Verdict, VerdictOutcome, WAITING_RESULTS};

use crate::registers::{ResultBlock, status};

/// The number of results that can wait behind the offered one.
pub const QUEUE: usize = WAITING_RESULTS;

/// A result that the PLC is owed: its row and its number.
#[derive(Clone, Copy, Debug)]
pub(super) struct PendingResult {
    pub(super) row: u64,
    pub(super) sequence: u32,
    /// `None` until the journal has sent the row again, after a restart.
    pub(super) result: Option<ResultBlock>,
}

impl PendingResult {
    /// As an account has it; `None` where there is none.
    pub(super) fn resume(row: u64, sequence: u32) -> Option<Self> {
        (sequence != 0).then_some(Self { row, sequence, result: None })
    }

    /// Takes the row, if it is the one that is missing.
    pub(super) fn fill(&mut self, row: &Journalled) {
        if self.result.is_none() && self.row == row.row {
            self.result = Some(block(self.sequence, &row.verdict));
        }
    }

    /// Whether the journal has to send the row again.
    fn is_missing(&self) -> bool {
        self.result.is_none()
    }
}

/// What became of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// It is numbered and waits, or was lost because the queue was full.
    New,
    /// It had come before.
    Repeated,
    /// Rows before it have not come: they must be asked for.
    Early,
    /// The queue is full. It stays in the journal, and is asked for when there is room.
    Waits,
}

/// The queue.
#[derive(Debug, Default)]
pub(super) struct Queue {
    waiting: VecDeque<PendingResult>,
    /// The newest row that was numbered, its number and its verdict.
    row: u64,
    sequence: u32,
    newest: Option<MessageId>,
    /// The newest request for rows, and the row up to which everything has come that answers it.
    asked: u32,
    heard: u64,
    /// Rows that could not be taken are in the journal, and have not been asked for again.
    has_more: bool,
}

impl Queue {
    pub(super) fn resume(account: &Account) -> Self {
        let waiting = account.waiting_rows.iter().zip(account.waiting_sequences);
        Self {
            waiting: waiting.filter_map(|(row, sequence)| PendingResult::resume(*row, sequence)).collect(),
            row: account.row,
            sequence: account.sequence,
            newest: (account.seq != 0).then_some(MessageId { epoch: account.epoch, seq: account.seq }),
            ..Self::default()
        }
    }

    /// Writes what [`Queue::resume`] reads.
    pub(super) fn save(&self, account: &mut Account) {
        (account.row, account.sequence) = (self.row, self.sequence);
        let newest = self.newest.unwrap_or_default();
        (account.epoch, account.seq) = (newest.epoch, newest.seq);
        for (index, owed) in self.waiting.iter().enumerate() {
            (account.waiting_rows[index], account.waiting_sequences[index]) = (owed.row, owed.sequence);
        }
    }

    /// The rows are those of another journal from now on. What has come stays.
    pub(super) fn forget_rows(&mut self) {
        self.row = 0;
        self.waiting.iter_mut().for_each(|owed| owed.row = 0);
    }

    pub(super) fn len(&self) -> usize {
        self.waiting.len()
    }

    /// The newest row that was numbered.
    pub(super) fn row(&self) -> u64 {
        self.row
    }

    /// The newest verdict that was numbered.
    pub(super) fn newest(&self) -> Option<MessageId> {
        self.newest
    }

    /// The rows after this one are needed.
    pub(super) fn needs_after(&self) -> u64 {
        let missing = self.waiting.iter().filter(|owed| owed.is_missing() && owed.row != 0);
        missing.map(|owed| owed.row - 1).min().unwrap_or(self.row)
    }

    /// The row after which the answer to this request begins.
    pub(super) fn ask(&mut self, asked: u32, after_row: u64) -> u64 {
        if asked != self.asked {
            (self.asked, self.heard) = (asked, after_row);
        }
        self.heard
    }

    /// Whether rows that could not be taken are left in the journal.
    pub(super) fn has_more(&self) -> bool {
        self.has_more
    }

    /// Whether they must be asked for now. True once.
    pub(super) fn wants_more(&mut self) -> bool {
        let wants_more = self.has_more && self.waiting.len() < QUEUE;
        self.has_more &= !wants_more;
        wants_more
    }

    /// Takes a row, and counts in `lost` what this shows to be lost. Where one `may_wait`, it stays in the journal while the queue is full.
    pub(super) fn take(&mut self, row: &Journalled, may_wait: bool, lost: &mut u64) -> Taken {
        if row.before > self.heard {
            return Taken::Early;
        }
        self.heard = self.heard.max(row.row);
        if row.row <= self.row {
            self.waiting.iter_mut().for_each(|owed| owed.fill(row));
            return Taken::Repeated;
        }
        // What was asked for has come up to here: a row that has not is not in the journal any more.
        let known = self.waiting.len();
        self.waiting.retain(|owed| !owed.is_missing());
        *lost += (known - self.waiting.len()) as u64;
        self.has_more |= may_wait && self.waiting.len() == QUEUE;
        if self.has_more {
            return Taken::Waits;
        }
        self.row = row.row;
        self.number(row, lost)
    }

    fn number(&mut self, row: &Journalled, lost: &mut u64) -> Taken {
        let id = row.verdict.stamp.id();
        let missing = match self.newest {
            // Nothing is lost before the first: what was never numbered was never the PLC's.
            None => 0,
            // A new journal has it a second time.
            Some(newest) if newest.epoch == id.epoch && id.seq <= newest.seq => return Taken::Repeated,
            Some(newest) if newest.epoch == id.epoch => id.seq - newest.seq - 1,
            // A writer counts from 1 after its start.
            Some(_) => id.seq.saturating_sub(1),
        };
        self.newest = Some(id);
        *lost += missing;
        self.advance(missing);
        let sequence = self.advance(1);
        if self.waiting.len() < QUEUE {
            let result = Some(block(sequence, &row.verdict));
            self.waiting.push_back(PendingResult { row: row.row, sequence, result });
        } else {
            *lost += 1;
        }
        Taken::New
    }

    /// Takes the first result out.
    pub(super) fn pop(&mut self) -> Option<PendingResult> {
        self.waiting.pop_front_if(|first| !first.is_missing())
    }

    /// Whether [`Queue::pop`] would give one.
    pub(super) fn has_next(&self) -> bool {
        self.waiting.front().is_some_and(|first| !first.is_missing())
    }

    /// Advances the sequence. It never is 0, which stands for no result.
    fn advance(&mut self, by: u64) -> u32 {
        // 2^32 - 1 numbers: 1..=u32::MAX.
        let next = (u64::from(self.sequence) + by).checked_sub(1).map_or(0, |n| n % u64::from(u32::MAX) + 1);
        self.sequence = u32::try_from(next).unwrap_or(1);
        self.sequence
    }
}

fn block(sequence: u32, verdict: &Verdict) -> ResultBlock {
    ResultBlock { sequence, outcome: outcome(verdict), verdict: *verdict }
}

/// The outcome as a bit of the status word. What is not known to be right is never `OK`.
fn outcome(verdict: &Verdict) -> u16 {
    match (verdict.level(), verdict.outcome()) {
        (Ok(_), Ok(VerdictOutcome::Ok)) => status::OK,
        (_, Ok(VerdictOutcome::Anomaly)) => status::NOK,
        (_, Ok(VerdictOutcome::NotJudged | VerdictOutcome::Ok) | Err(_)) => status::NOT_JUDGED,
    }
}
