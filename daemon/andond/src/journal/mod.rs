//! The journal: every verdict in SQLite, before the PLC is told.
//!
//! [`Journal`] is the one writer (role `journal`), [`History`] reads at the same time (`andond history`).
//!
//! What is confirmed stays: the database is in WAL mode with `synchronous = FULL`, so a commit has been synced when
//! [`Journal::append`] returns. `NORMAL` would be faster and would lose the last commits when power fails, after
//! the PLC was told. A commit costs one sync of a few kilobytes, and a bench gives a few verdicts a second.
//!
//! What is not in the journal is in it as a gap: a jump in `seq` and every new start of the judge is a row of its own, written in
//! the same transaction as the verdict that showed it. What cannot be written now (disk full, locked) waits in
//! memory; what does not fit there is dropped and becomes a gap by its jump.

mod csv;
mod error;
mod history;
mod retention;
mod row;
mod schema;
mod table;

#[cfg(test)]
mod tests;

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::time::Duration;

use rusqlite::{Connection, TransactionBehavior};
use shm_schemas::Verdict;

pub use error::JournalError;
pub use history::{Entry, Gap, History, Query, Record};
pub use retention::Retention;

/// Verdicts that wait while the disk is full or the database is locked: as many as the channel `verdict` holds, which
/// is some minutes of a busy bench.
const WAITING: usize = 1024;
/// How long a write waits for another writer's lock: under the role's watchdog. What waits is tried again with the next verdict.
const LOCK_PATIENCE: Duration = Duration::from_millis(250);
/// Rows between two looks at the retention: a look costs a query by an index, and a thousand rows are a quarter of a megabyte.
const RETAIN_EVERY: u32 = 1000;

/// The newest verdict that is on disk. Everything of its epoch before it is there too, or its gap is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Confirmed {
    /// The epoch of the judge that sent it.
    pub epoch: u64,
    /// Its number.
    pub seq: u64,
}

/// The writer of the journal.
#[derive(Debug)]
pub struct Journal {
    connection: Connection,
    path: PathBuf,
    retention: Retention,
    newest: Option<Confirmed>,
    waiting: VecDeque<Verdict>,
    lost: u64,
    removed: u64,
    until_retention: u32,
}

impl Journal {
    /// Opens or makes the database, brings its schema up to date and applies the retention.
    ///
    /// # Errors
    /// [`JournalError`] where it cannot be opened or written, is no journal, or comes from a newer Andon.
    pub fn open(path: &Path, retention: Retention) -> Result<Self, JournalError> {
        let failed = |source| JournalError::of(path, 0, source);
        let mut connection = Connection::open(path).map_err(failed)?;
        connection.busy_timeout(LOCK_PATIENCE).map_err(failed)?;
        schema::prepare(&mut connection, path)?;
        let newest = row::newest(&connection).map_err(failed)?;
        let waiting = VecDeque::new();
        let mut journal = Self {
            connection,
            path: path.into(),
            retention,
            newest,
            waiting,
            lost: 0,
            removed: 0,
            until_retention: RETAIN_EVERY,
        };
        journal.retain();
        Ok(journal)
    }

    /// Writes a verdict, after those that wait. It is on disk when this returns `Ok`; one that is there already is not written twice.
    ///
    /// # Errors
    /// [`JournalError`] where nothing could be written; the verdict waits and goes with the next call.
    pub fn append(&mut self, verdict: &Verdict) -> Result<Confirmed, JournalError> {
        self.push(verdict);
        self.flush()?;
        Ok(Confirmed { epoch: verdict.stamp.epoch, seq: verdict.stamp.seq })
    }

    /// Lets a verdict wait for the next [`Journal::flush`]: many written at once cost one sync. Without room the oldest that
    /// waits gives way, which becomes a gap.
    pub fn push(&mut self, verdict: &Verdict) {
        if !self.has_room() {
            self.waiting.pop_front();
        }
        self.waiting.push_back(*verdict);
    }

    /// Whether one more can wait.
    pub fn has_room(&self) -> bool {
        self.waiting.len() < WAITING
    }

    /// Writes what waits. Call it from time to time while [`Journal::waiting`] is not 0.
    ///
    /// # Errors
    /// As [`Journal::append`].
    pub fn flush(&mut self) -> Result<Option<Confirmed>, JournalError> {
        let (newest, lost) = self.write_waiting().map_err(|source| self.failed(source))?;
        self.newest = newest;
        self.lost += lost;
        // At most WAITING.
        self.until_retention = self.until_retention.saturating_sub(self.waiting.len() as u32);
        self.waiting.clear();
        if self.until_retention == 0 {
            self.until_retention = RETAIN_EVERY;
            self.retain();
        }
        Ok(self.newest)
    }

    /// The newest verdict on disk.
    pub fn newest(&self) -> Option<Confirmed> {
        self.newest
    }

    /// How many verdicts the gaps stand for that this writer has recorded.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// How many verdicts this writer has removed because of their age or the size of the database.
    pub fn removed(&self) -> u64 {
        self.removed
    }

    /// How many verdicts could not be written yet.
    pub fn waiting(&self) -> usize {
        self.waiting.len()
    }

    /// One transaction: all or nothing. Returns the newest verdict on disk and how many the new gaps stand for.
    fn write_waiting(&mut self) -> rusqlite::Result<(Option<Confirmed>, u64)> {
        let mut lost = 0;
        if self.waiting.is_empty() {
            return Ok((self.newest, lost));
        }
        // Immediate: who waits for the lock waits here, and not in the middle.
        let transaction = self.connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
        let mut newest = self.newest;
        for verdict in &self.waiting {
            newest = Some(row::insert(&transaction, verdict, newest, &mut lost)?);
        }
        transaction.commit()?;
        Ok((newest, lost))
    }

    /// One that fails is tried again later: writing goes before tidying up.
    fn retain(&mut self) {
        match retention::apply(&mut self.connection, self.retention) {
            Ok(removed) => self.removed += removed as u64,
            Err(error) => tracing::debug!(%error, path = %self.path.display(), "old verdicts stay for now"),
        }
    }

    fn failed(&self, source: rusqlite::Error) -> JournalError {
        JournalError::of(&self.path, self.waiting.len(), source)
    }
}
