//! Reads the journal, also while it is being written.

use std::io::Write;
use std::path::{Path, PathBuf};

use rusqlite::{Connection, OpenFlags, OptionalExtension as _, Row, ffi, params};
use shm_schemas::{MessageId, PartId, Verdict};

use super::audit::AuditEntry;
use super::csv;
use super::entry::{Entry, Gap, NotWatching};
use super::error::JournalError;
use super::place;
use super::row::{after, read_verdict, signed, unsigned};

/// Which verdicts to read.
#[derive(Clone, Copy, Debug, Default)]
pub struct Query {
    /// Only those decided at this time or later, in nanoseconds since 1970 UTC.
    pub since_utc_ns: Option<u64>,
    /// Only those of this job.
    pub job_id: Option<u32>,
    /// Only those of this part; an empty id asks for those without one.
    pub part: Option<PartId>,
    /// Only anomalies and what could not be judged.
    pub nok: bool,
}

/// A reader of the journal.
#[derive(Debug)]
pub struct History {
    pub(super) connection: Connection,
    pub(super) path: PathBuf,
}

/// Verdicts and the rest in one order. A gap stands before the verdict that revealed it, and a time without sight before the first verdict after its
/// begin.
const QUERY: &str = "
    SELECT entry.*, verdict.* FROM (
        SELECT id AS position, 2 AS rank, NULL AS utc_ns, NULL AS why, NULL AS gap_epoch, NULL AS first, NULL AS last
        FROM verdict
        WHERE decided_utc_ns >= ?1 AND (?2 IS NULL OR job_id = ?2) AND (NOT ?3 OR outcome IS NOT 'ok')
            AND (?4 IS NULL OR part = ?4)
        UNION ALL
        SELECT before_verdict, 1, utc_ns, why, epoch, first_seq, last_seq FROM gap WHERE utc_ns >= ?1
        UNION ALL
        SELECT before_verdict, 0, began_utc_ns, why, NULL, NULL, ended_utc_ns FROM not_watching
        WHERE coalesce(ended_utc_ns, began_utc_ns) >= ?1
    ) AS entry LEFT JOIN verdict ON rank = 2 AND verdict.id = position
    ORDER BY position, rank";

impl History {
    /// Opens a journal for reading.
    ///
    /// # Errors
    /// [`JournalError`] when there is no journal at `path`, or it cannot be read.
    pub fn open(path: &Path) -> Result<Self, JournalError> {
        JournalError::unless_file(path)?;
        // Read and write: the first reader after a crash must be able to recover the WAL. Without CREATE, a mistyped path makes no empty journal.
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let connection =
            Connection::open_with_flags(path, flags).map_err(|source| JournalError::of(path, 0, source))?;
        Ok(Self { connection, path: path.into() })
    }

    /// Opens a journal that is being written, without the right to write anything beside it. Of the write-ahead log and its index, which the writer
    /// makes, nothing is made, changed or recovered.
    ///
    /// # Errors
    /// As [`History::open`]; [`JournalError::Open`], here or while it is read, also where no log is there yet, or its index is being made.
    pub fn open_read_only(path: &Path) -> Result<Self, JournalError> {
        JournalError::unless_file(path)?;
        let failed = |source| JournalError::of(path, 0, source);
        // SQLite makes a log that is missing, also for a reader, where the system lets it.
        if !place::has_log(path) {
            return Err(failed(no_log()));
        }
        let flags =
            OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX | OpenFlags::SQLITE_OPEN_URI;
        let connection =
            Connection::open_with_flags(place::uri(path, "readonly_shm=1"), flags).map_err(failed)?;
        Ok(Self { connection, path: path.into() })
    }

    /// Writes every entry that matches the query as CSV (RFC 4180), for spreadsheets. A value that has no meaning is left empty, and indices of
    /// activities and IUs count from 0. A gap has a line of its own, from `seq` to `last_seq`, and so has a time without sight, to `ended_utc`.
    ///
    /// # Errors
    /// [`JournalError`] of the database, [`JournalError::Export`] when `out` cannot be written.
    pub fn write_csv(&self, query: &Query, out: &mut impl Write) -> Result<(), JournalError> {
        out.write_all(csv::header().as_bytes())?;
        self.visit(query, |entry| Ok(csv::write(&entry, out)?))?;
        Ok(out.flush()?)
    }

    /// Calls `visit` with everything that was done since this time, nanoseconds since 1970 UTC, oldest first.
    ///
    /// # Errors
    /// As [`History::visit`].
    pub fn visit_audit(
        &self,
        since_utc_ns: Option<u64>,
        mut visit: impl FnMut(AuditEntry) -> Result<(), JournalError>,
    ) -> Result<(), JournalError> {
        let failed = |source| JournalError::of(&self.path, 0, source);
        let query = "SELECT utc_ns, kind, who, what FROM audit WHERE utc_ns >= ?1 ORDER BY id";
        let mut statement = self.connection.prepare(query).map_err(failed)?;
        let mut rows = statement.query(params![since_utc_ns.map_or(0, signed)]).map_err(failed)?;
        while let Some(row) = rows.next().map_err(failed)? {
            visit(audit_entry(row).map_err(failed)?)?;
        }
        Ok(())
    }

    /// What was done last, newest first: at most so many entries.
    ///
    /// # Errors
    /// [`JournalError`] of the database.
    pub fn newest_audit(&self, count: u32) -> Result<Vec<AuditEntry>, JournalError> {
        let failed = |source| JournalError::of(&self.path, 0, source);
        let query = "SELECT utc_ns, kind, who, what FROM audit ORDER BY id DESC LIMIT ?1";
        let mut statement = self.connection.prepare(query).map_err(failed)?;
        let rows = statement.query_map(params![count], audit_entry).map_err(failed)?;
        rows.map(|row| row.map_err(failed)).collect()
    }

    /// Writes everything that was done since this time as CSV.
    ///
    /// # Errors
    /// As [`History::write_csv`].
    pub fn write_audit_csv(
        &self,
        since_utc_ns: Option<u64>,
        out: &mut impl Write,
    ) -> Result<(), JournalError> {
        out.write_all(csv::AUDIT_HEADER.as_bytes())?;
        self.visit_audit(since_utc_ns, |audit| Ok(csv::write_audit(&audit, out)?))?;
        Ok(out.flush()?)
    }

    /// Writes a copy of the whole journal as it is at this moment to a file that does not exist. The journal may be written meanwhile.
    ///
    /// # Errors
    /// [`JournalError`] of the database, or why the copy cannot be written.
    pub fn copy_to(&self, copy: &Path) -> Result<(), JournalError> {
        let failed = |source| JournalError::of(&self.path, 0, source);
        self.connection.execute("VACUUM INTO ?1", params![copy.to_string_lossy()]).map_err(failed)?;
        Ok(())
    }

    /// Calls `visit` with every entry, oldest first. Only one is held in memory, since there may be millions.
    ///
    /// # Errors
    /// [`JournalError`] of the database, or of `visit`, whose error ends the reading.
    pub fn visit(
        &self,
        query: &Query,
        mut visit: impl FnMut(Entry) -> Result<(), JournalError>,
    ) -> Result<(), JournalError> {
        self.visit_rows(query, |_row, entry| visit(entry))
    }

    /// The verdict of a row; `None` where there is no such row, or not any more.
    ///
    /// # Errors
    /// [`JournalError`] of the database.
    pub fn verdict(&self, row: u64) -> Result<Option<Verdict>, JournalError> {
        let Some(before) = row.checked_sub(1) else { return Ok(None) };
        let found = after(&self.connection, before, 1);
        let found = found.map_err(|source| JournalError::of(&self.path, 0, source))?;
        Ok(found.into_iter().find(|written| written.row == row).map(|written| written.verdict))
    }

    /// The number of the row of a verdict; `None` where the journal does not have it, or not any more.
    ///
    /// # Errors
    /// [`JournalError`] of the database.
    pub fn row(&self, verdict: MessageId) -> Result<Option<u64>, JournalError> {
        let query = "SELECT id FROM verdict WHERE epoch = ?1 AND seq = ?2";
        let key = params![signed(verdict.epoch), signed(verdict.seq)];
        let found = self.connection.query_row(query, key, |row| row.get(0).map(unsigned)).optional();
        found.map_err(|source| JournalError::of(&self.path, 0, source))
    }

    /// As [`History::visit`], with the number of the row of a verdict; anything else has that of the verdict that follows it.
    ///
    /// # Errors
    /// As [`History::visit`].
    pub fn visit_rows(
        &self,
        query: &Query,
        mut visit: impl FnMut(u64, Entry) -> Result<(), JournalError>,
    ) -> Result<(), JournalError> {
        let failed = |source| JournalError::of(&self.path, 0, source);
        let part = query.part.as_ref().map(PartId::text);
        let mut statement = self.connection.prepare(QUERY).map_err(failed)?;
        let mut rows = statement
            .query(params![query.since_utc_ns.map_or(0, signed), query.job_id, query.nok, part])
            .map_err(failed)?;
        while let Some(row) = rows.next().map_err(failed)? {
            let number = row.get("position").map(unsigned).map_err(failed)?;
            visit(number, entry(row).map_err(failed)?)?;
        }
        Ok(())
    }
}

fn no_log() -> rusqlite::Error {
    let cause = ffi::Error::new(ffi::SQLITE_CANTOPEN);
    rusqlite::Error::SqliteFailure(cause, Some("it has no log: nobody writes it".to_owned()))
}

fn audit_entry(row: &Row<'_>) -> rusqlite::Result<AuditEntry> {
    let (utc_ns, kind) = (row.get("utc_ns").map(unsigned)?, row.get("kind")?);
    Ok(AuditEntry { utc_ns, kind, who: row.get("who")?, what: row.get("what")? })
}

fn entry(row: &Row<'_>) -> rusqlite::Result<Entry> {
    let number = |column: &str| row.get(column).map(unsigned);
    let last = || row.get::<_, Option<i64>>("last").map(|last| last.map(unsigned));
    Ok(match row.get::<_, u8>("rank")? {
        0 => Entry::NotWatching(NotWatching {
            began_utc_ns: number("utc_ns")?,
            ended_utc_ns: last()?,
            why: row.get("why")?,
        }),
        1 => Entry::Gap(Gap {
            utc_ns: number("utc_ns")?,
            why: row.get("why")?,
            epoch: number("gap_epoch")?,
            first_seq: number("first")?,
            last_seq: last()?,
        }),
        _ => Entry::Verdict(Box::new(read_verdict(row)?)),
    })
}
