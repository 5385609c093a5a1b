//! When the line did not see its bench: a row from begin to end.

use rusqlite::params;
use shm_schemas::Sight;

use super::row::signed;
use super::{Journal, JournalError};

impl Journal {
    /// Writes that the line has not seen its bench since this time, in nanoseconds since 1970 UTC.
    ///
    /// # Errors
    /// [`JournalError`] when it could not be written; nothing is kept for later.
    pub fn stops_watching(&mut self, began_utc_ns: u64, why: Sight) -> Result<(), JournalError> {
        let written = self.connection.execute(
            "INSERT INTO not_watching (before_verdict, began_utc_ns, why)
             VALUES ((SELECT coalesce(max(id), 0) + 1 FROM verdict), ?1, ?2)",
            params![signed(began_utc_ns), why.name()],
        );
        written.map(drop).map_err(|source| self.failed(source))
    }

    /// Writes that the line sees its bench again. A row of an earlier start, whose end nobody saw, stays open.
    ///
    /// # Errors
    /// As [`Journal::stops_watching`].
    pub fn watches_again(&mut self, ended_utc_ns: u64) -> Result<(), JournalError> {
        let written = self.connection.execute(
            "UPDATE not_watching SET ended_utc_ns = ?1
             WHERE id = (SELECT max(id) FROM not_watching) AND ended_utc_ns IS NULL",
            params![signed(ended_utc_ns)],
        );
        written.map(drop).map_err(|source| self.failed(source))
    }
}
