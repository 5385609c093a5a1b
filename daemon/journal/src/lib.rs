//! The journal: every verdict is in SQLite before the PLC is told.
//!
//! [`Journal`] is the only writer (role `journal`); [`History`] may read at the same time (`andond history`). A row does not name the recording that
//! shows it: [`History::write_sql`] and `andond history` find that in the folder of recordings, from which it may be gone at any time.
//!
//! A confirmed verdict survives a power failure: the database is in WAL mode with `synchronous = FULL`, so a commit has been synced when
//! [`Journal::flush`] returns. `NORMAL` would be faster, but would lose commits of which the PLC has already been told. A commit costs
//! one sync of a few kilobytes, and a bench produces a few verdicts per second.
//!
//! A missing verdict is recorded as a gap. Each jump in `seq` and each restart of the judge is a row of its own. It is written in the same
//! transaction as the verdict that revealed it. A verdict that cannot be written now (disk full, database locked) is queued in memory. When the queue
//! is full, the oldest is dropped and becomes a gap like any other.
#![forbid(unsafe_code)]

mod account;
mod audit;
mod csv;
mod entry;
mod error;
mod history;
mod not_watching;
mod place;
mod retention;
mod row;
mod schema;
mod sql;

#[cfg(test)]
mod tests;

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use rusqlite::{Connection, TransactionBehavior};
use shm_schemas::{Account, MessageId, RoleId, Verdict};

pub use audit::AuditEntry;
pub use entry::{Entry, Gap, NotWatching};
pub use error::JournalError;
pub use history::{History, Query};
pub use not_watching::OpenRow;
pub use retention::Retention;

/// Length of the queue that fills while the disk is full or the database is locked. It is as long as the channel `verdict`, which holds
/// some minutes of a busy bench.
const MAX_WAITING: usize = 1024;
/// How long a write waits for the lock of another writer. It is shorter than the role's watchdog allows, since the next flush tries again.
const LOCK_TIMEOUT: Duration = Duration::from_millis(250);
/// Rows between two applications of the retention: one costs a query on an index, and a thousand rows take a quarter of a megabyte.
const ROWS_BETWEEN_RETENTIONS: u32 = 1000;

/// A verdict and its row, which grows with every verdict that is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Written {
    /// The row.
    pub row: u64,
    /// The verdict.
    pub verdict: Verdict,
}

/// The writer of the journal.
#[derive(Debug)]
pub struct Journal {
    connection: Connection,
    identity: u64,
    path: PathBuf,
    /// Device and inode of the database that is open.
    file: Option<(u64, u64)>,
    retention: Retention,
    newest: Option<MessageId>,
    waiting: VecDeque<Verdict>,
    lost: u64,
    removed: u64,
    unacknowledged: u64,
    until_retention: u32,
}

impl Journal {
    /// Opens or creates the database, brings its schema up to date and applies the retention.
    ///
    /// # Errors
    /// [`JournalError`] when the file cannot be opened or written, is no journal, or was written by a newer Andon.
    pub fn open(path: &Path, retention: Retention) -> Result<Self, JournalError> {
        JournalError::unless_file(path)?;
        let failed = |source| JournalError::of(path, 0, source);
        let mut connection = Connection::open(path).map_err(failed)?;
        connection.busy_timeout(LOCK_TIMEOUT).map_err(failed)?;
        schema::prepare(&mut connection, path)?;
        let newest = row::newest(&connection).map_err(failed)?;
        let identity = account::identity(&connection).map_err(failed)?;
        let waiting = VecDeque::new();
        let mut journal = Self {
            connection,
            identity,
            path: path.into(),
            file: place::identity(path),
            retention,
            newest,
            waiting,
            lost: 0,
            removed: 0,
            unacknowledged: 0,
            until_retention: ROWS_BETWEEN_RETENTIONS,
        };
        journal.retain();
        Ok(journal)
    }

    /// Opens the database as [`Journal::open`] does. A damaged one, and a file that is no database, is put aside under a name with the time. A new
    /// one begins, and a gap stands for what was in the old one. Returns the name, if there is one.
    ///
    /// # Errors
    /// As [`Journal::open`], and where the file cannot be renamed.
    pub fn open_or_replace(
        path: &Path,
        retention: Retention,
    ) -> Result<(Self, Option<PathBuf>), JournalError> {
        match Self::open(path, retention) {
            Err(JournalError::Damaged { .. }) => {
                let (journal, aside) = Self::replace(path, retention, None)?;
                Ok((journal, Some(aside)))
            }
            opened => Ok((opened?, None)),
        }
    }

    fn replace(
        path: &Path,
        retention: Retention,
        newest: Option<MessageId>,
    ) -> Result<(Self, PathBuf), JournalError> {
        let moved = place::put_aside(path, &stamp());
        let aside = moved.map_err(|source| JournalError::PutAside { path: path.into(), source })?;
        let mut journal = Self::open(path, retention)?;
        journal.insert_missing("damaged", newest)?;
        Ok((journal, aside))
    }

    /// Begins a new database in place of one that was removed or is damaged. The queue is kept, and with it everything that the PLC
    /// has not been told of; a gap stands for the rest. Returns the name under which a damaged one was put aside.
    ///
    /// # Errors
    /// As [`Journal::open_or_replace`]; the next call tries again.
    pub fn begin_anew(&mut self) -> Result<Option<PathBuf>, JournalError> {
        let was_removed = !self.is_in_place();
        // The old connection is closed first. Where only the log was removed, SQLite then saves what is in it.
        self.connection = Connection::open_in_memory().map_err(|source| self.failed(source))?;
        self.file = None;
        let (mut fresh, aside) = if was_removed {
            if place::identity(&self.path).is_none() {
                place::remove_companions(&self.path);
            }
            Self::open_or_replace(&self.path, self.retention)?
        } else {
            let (fresh, aside) = Self::replace(&self.path, self.retention, self.newest)?;
            (fresh, Some(aside))
        };
        let holds = |newest: MessageId| {
            fresh.newest.is_some_and(|fresh| fresh.epoch == newest.epoch && fresh.seq >= newest.seq)
        };
        if was_removed && aside.is_none() && self.newest.is_some_and(|newest| !holds(newest)) {
            fresh.insert_missing("removed", self.newest)?;
        }
        // What was on disk is behind the gap: it is neither lost nor written again.
        fresh.newest = fresh.newest.or(self.newest);
        (fresh.lost, fresh.removed, fresh.unacknowledged) = (self.lost, self.removed, self.unacknowledged);
        std::mem::swap(&mut fresh.waiting, &mut self.waiting);
        *self = fresh;
        Ok(aside)
    }

    /// Whether the database that is open is the one under its path: what is written to another is lost.
    pub fn is_in_place(&self) -> bool {
        self.file.is_some() && place::identity(&self.path) == self.file
    }

    fn insert_missing(&mut self, why: &str, newest: Option<MessageId>) -> Result<(), JournalError> {
        let written = row::insert_missing(&self.connection, why, now_utc_ns(), newest);
        written.map_err(|source| self.failed(source))
    }

    /// Queues a verdict for the next [`Journal::flush`]: verdicts that are written together cost one sync. When the queue is full, the
    /// oldest verdict in it is dropped and becomes a gap.
    pub fn push(&mut self, verdict: &Verdict) {
        if !self.has_room() {
            self.waiting.pop_front();
        }
        self.waiting.push_back(*verdict);
    }

    /// Whether the queue has room for another verdict.
    pub fn has_room(&self) -> bool {
        self.waiting.len() < MAX_WAITING
    }

    /// Writes the queue. It is on disk when this returns `Ok`. A verdict that was on disk before is not written twice.
    ///
    /// # Errors
    /// [`JournalError`] when nothing could be written; the queue is kept for the next call. [`JournalError::Removed`] when the database has
    /// gone from its place: [`Journal::begin_anew`] makes another one.
    pub fn flush(&mut self) -> Result<(), JournalError> {
        let (newest, lost) = self.write_waiting().map_err(|source| self.failed(source))?;
        // After the commit: what was removed before it has taken the rows with it.
        let has_written = !self.waiting.is_empty();
        if !self.is_in_place() || has_written && !place::has_log(&self.path) {
            self.file = None;
            return Err(JournalError::Removed { path: self.path.clone() });
        }
        self.newest = newest;
        self.lost += lost;
        // The queue holds at most MAX_WAITING verdicts.
        self.until_retention = self.until_retention.saturating_sub(self.waiting.len() as u32);
        self.waiting.clear();
        if self.until_retention == 0 {
            self.until_retention = ROWS_BETWEEN_RETENTIONS;
            self.retain();
        }
        Ok(())
    }

    /// The newest verdict on disk.
    pub fn newest(&self) -> Option<MessageId> {
        self.newest
    }

    /// The random number that this database was given when it was made: rows of another one are others.
    pub fn identity(&self) -> u64 {
        self.identity
    }

    /// The consumers that have an account. What they have not acknowledged stays within the size of the [`Retention`].
    ///
    /// # Errors
    /// [`JournalError`] when they cannot be read.
    pub fn consumers(&self) -> Result<Vec<RoleId>, JournalError> {
        account::consumers(&self.connection).map_err(|source| self.failed(source))
    }

    /// The account of a consumer that was kept last. One with `boot` 0 was never kept: it says where the journal ends.
    ///
    /// # Errors
    /// [`JournalError`] when it cannot be read.
    pub fn account(&self, consumer: RoleId) -> Result<Account, JournalError> {
        account::read(&self.connection, consumer).map_err(|source| self.failed(source))
    }

    /// Keeps the account of a consumer, the first time for good. It is on disk when this returns `Ok`.
    ///
    /// # Errors
    /// [`JournalError`] when it could not be written.
    pub fn keep(&mut self, consumer: RoleId, account: &Account) -> Result<(), JournalError> {
        account::write(&self.connection, consumer, account).map_err(|source| self.failed(source))
    }

    /// The rows after this one, at most `count`, oldest first.
    ///
    /// # Errors
    /// [`JournalError`] when they cannot be read.
    pub fn rows_after(&self, row: u64, count: usize) -> Result<Vec<Written>, JournalError> {
        row::after(&self.connection, row, count).map_err(|source| self.failed(source))
    }

    /// Number of verdicts in the gaps that this writer has recorded.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// Number of verdicts that this writer has removed because of their age or the size of the database.
    pub fn removed(&self) -> u64 {
        self.removed
    }

    /// Number of those that a consumer had not acknowledged: the database was too large to keep them.
    pub fn unacknowledged(&self) -> u64 {
        self.unacknowledged
    }

    /// Number of verdicts in the queue.
    pub fn waiting(&self) -> usize {
        self.waiting.len()
    }

    /// Writes the queue in one transaction: all of it or nothing. Returns the newest verdict on disk and the number of verdicts in new gaps.
    fn write_waiting(&mut self) -> rusqlite::Result<(Option<MessageId>, u64)> {
        let mut lost = 0;
        if self.waiting.is_empty() {
            return Ok((self.newest, lost));
        }
        // Immediate: a wait for the lock happens here and not in the middle of the transaction.
        let transaction = self.connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
        let mut newest = self.newest;
        for verdict in &self.waiting {
            newest = Some(row::insert(&transaction, verdict, newest, &mut lost)?);
        }
        transaction.commit()?;
        Ok((newest, lost))
    }

    /// A failure is only logged, and the next application tries again: writing matters more than removing.
    fn retain(&mut self) {
        match retention::apply(&mut self.connection, self.retention) {
            Ok(removed) => {
                self.removed += removed.all;
                self.unacknowledged += removed.unacknowledged;
            }
            Err(error) => {
                tracing::debug!(%error, path = %self.path.display(), "old verdicts could not be removed yet")
            }
        }
    }

    fn failed(&self, source: rusqlite::Error) -> JournalError {
        JournalError::of(&self.path, self.waiting.len(), source)
    }
}

/// The time as a part of a file's name.
fn stamp() -> String {
    let seconds = i64::try_from(now_utc_ns() / 1_000_000_000).unwrap_or_default();
    jiff::Timestamp::from_second(seconds)
        .map_or_else(|_| seconds.to_string(), |time| time.strftime("%Y%m%dT%H%M%SZ").to_string())
}

fn now_utc_ns() -> u64 {
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    // 2^64 ns are 584 years.
    since_1970.as_nanos() as u64
}
