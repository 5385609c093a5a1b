//! When the line did not watch: a row from begin to end.

use rusqlite::params;

use super::row::signed;
use super::{Journal, JournalError};

/// A row that has a start and waits for its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OpenRow(i64);

impl Journal {
    /// Writes that the line has not watched since this time, in nanoseconds since 1970 UTC, and why: a word of [`shm_schemas::Sight`], or
    /// a sentence. Gives the row, for its end.
    ///
    /// # Errors
    /// [`JournalError`] when it could not be written; nothing is kept for later.
    pub fn stops_watching(&mut self, began_utc_ns: u64, why: &str) -> Result<OpenRow, JournalError> {
        let written = self.connection.execute(
            "INSERT INTO not_watching (before_verdict, began_utc_ns, why)
             VALUES ((SELECT coalesce(max(id), 0) + 1 FROM verdict), ?1, ?2)",
            params![signed(began_utc_ns), why],
        );
        written.map_err(|source| self.failed(source))?;
        Ok(OpenRow(self.connection.last_insert_rowid()))
    }

    /// Writes the end of that time. A row of an earlier start, whose end nobody saw, stays open.
    ///
    /// # Errors
    /// As [`Journal::stops_watching`].
    pub fn watches_again(&mut self, row: OpenRow, ended_utc_ns: u64) -> Result<(), JournalError> {
        let written = self.connection.execute(
            "UPDATE not_watching SET ended_utc_ns = ?2 WHERE id = ?1",
            params![row.0, signed(ended_utc_ns)],
        );
        written.map(drop).map_err(|source| self.failed(source))
    }
}
