//! Reads the journal, also while it is being written.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use rusqlite::{Connection, OpenFlags, Row, params};
use shm_schemas::{VerdictLevel, VerdictOutcome, verdict_kind};

use super::error::JournalError;
use super::row::{signed, unsigned};
use super::{csv, table};

/// Which verdicts to read.
#[derive(Clone, Copy, Debug, Default)]
pub struct Query {
    /// Only those decided at this time or later, in nanoseconds since 1970 UTC.
    pub since_utc_ns: Option<u64>,
    /// Only those of this job.
    pub job_id: Option<u32>,
    /// Only anomalies and what could not be judged.
    pub nok: bool,
}

/// A row of the journal, in the order of writing.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// A verdict.
    Verdict(Box<Record>),
    /// Missing verdicts. Every query returns them, since any verdict may have been among them.
    Gap(Gap),
}

/// A verdict as it was written. Times are source times in nanoseconds, except `decided_utc_ns`.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)] // The fields of `shm_schemas::Verdict`, under their names.
pub struct Record {
    pub epoch: u64,
    pub seq: u64,
    pub level: String,
    pub outcome: String,
    pub reason: String,
    pub hand: String,
    pub station: String,
    pub job_id: u32,
    /// In 16 hexadecimal digits.
    pub model_hash: String,
    pub activity: Option<u16>,
    pub iu: Option<u16>,
    pub nearest: Option<u16>,
    pub x_c: [u16; 4],
    pub distance: Option<f32>,
    pub threshold: Option<f32>,
    pub early: bool,
    pub began_ns: u64,
    pub ended_ns: u64,
    pub decided_ns: u64,
    /// Nanoseconds since 1970 UTC.
    pub decided_utc_ns: u64,
}

impl Record {
    /// Level and outcome in one word. A row that holds the number of a code that this build does not know was not judged.
    pub(super) fn kind(&self) -> &'static str {
        let level = VerdictLevel::ALL.iter().find(|level| level.name() == self.level);
        let outcome = VerdictOutcome::ALL.iter().find(|outcome| outcome.name() == self.outcome);
        match (level, outcome) {
            (Some(level), Some(outcome)) => verdict_kind(*level, *outcome),
            _ => verdict_kind(VerdictLevel::Iu, VerdictOutcome::NotJudged),
        }
    }
}

/// Verdicts that are not in the journal.
#[derive(Clone, Debug, PartialEq)]
pub struct Gap {
    /// When the first verdict after it was decided, nanoseconds since 1970 UTC.
    pub utc_ns: u64,
    /// `lost`: they never arrived, or the queue was full. `restart`: the judge has restarted, and verdicts from before may be
    /// missing. `retention`: they were removed because of their age or number.
    pub why: String,
    /// Their epoch; for `retention` that of the newest.
    pub epoch: u64,
    /// Number of the first.
    pub first_seq: u64,
    /// Number of the last; `None` where it is unknown whether any is missing.
    pub last_seq: Option<u64>,
}

/// How the journal is written as text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// CSV (RFC 4180), for spreadsheets. A value that has no meaning is left empty. A gap has a line of its own, from `seq` to `last_seq`.
    Csv,
    /// A table for a terminal. Activities and IUs count from 1.
    Table,
}

/// Writes the line of an entry.
type WriteEntry = fn(&Entry, &mut dyn Write) -> io::Result<()>;

/// A reader of the journal.
#[derive(Debug)]
pub struct History {
    connection: Connection,
    path: PathBuf,
}

/// Verdicts and gaps in one order: a gap stands before the verdict that revealed it.
const QUERY: &str = "
    SELECT id AS position, 1 AS part, epoch, seq, level, outcome, reason, hand, station, job_id, model_hash, activity, iu,
        nearest, x_c0, x_c1, x_c2, x_c3, distance, threshold, early, began_ns, ended_ns, decided_ns, decided_utc_ns,
        NULL AS last_seq
    FROM verdict
    WHERE decided_utc_ns >= ?1 AND (?2 IS NULL OR job_id = ?2) AND (NOT ?3 OR outcome IS NOT 'ok')
    UNION ALL
    SELECT before_verdict, 0, epoch, first_seq, why, '', '', '', '', 0, '', NULL, NULL,
        NULL, 0, 0, 0, 0, NULL, NULL, 0, 0, 0, 0, utc_ns, last_seq
    FROM gap
    WHERE utc_ns >= ?1
    ORDER BY position, part";

impl History {
    /// Opens a journal for reading.
    ///
    /// # Errors
    /// [`JournalError`] when there is no journal at `path`, or it cannot be read.
    pub fn open(path: &Path) -> Result<Self, JournalError> {
        // Read and write: the first reader after a crash must be able to recover the WAL. Without CREATE, a mistyped path makes no empty journal.
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let connection =
            Connection::open_with_flags(path, flags).map_err(|source| JournalError::of(path, 0, source))?;
        Ok(Self { connection, path: path.into() })
    }

    /// Writes a header and one line per entry that matches the query.
    ///
    /// # Errors
    /// [`JournalError`] of the database, [`JournalError::Export`] when `out` cannot be written.
    pub fn write(&self, query: &Query, format: Format, out: &mut impl Write) -> Result<(), JournalError> {
        let (header, write_entry): (_, WriteEntry) = match format {
            Format::Csv => (csv::HEADER, csv::write),
            Format::Table => (table::HEADER, table::write),
        };
        out.write_all(header.as_bytes())?;
        self.visit(query, |entry| Ok(write_entry(&entry, out)?))?;
        Ok(out.flush()?)
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
        let failed = |source| JournalError::of(&self.path, 0, source);
        let mut statement = self.connection.prepare(QUERY).map_err(failed)?;
        let mut rows = statement
            .query(params![query.since_utc_ns.map_or(0, signed), query.job_id, query.nok])
            .map_err(failed)?;
        while let Some(row) = rows.next().map_err(failed)? {
            visit(entry(row).map_err(failed)?)?;
        }
        Ok(())
    }
}

fn entry(row: &Row<'_>) -> rusqlite::Result<Entry> {
    let number = |column: &str| row.get(column).map(unsigned);
    if row.get::<_, u8>("part")? == 0 {
        return Ok(Entry::Gap(Gap {
            utc_ns: number("decided_utc_ns")?,
            why: row.get("level")?,
            epoch: number("epoch")?,
            first_seq: number("seq")?,
            last_seq: row.get::<_, Option<i64>>("last_seq")?.map(unsigned),
        }));
    }
    Ok(Entry::Verdict(Box::new(Record {
        epoch: number("epoch")?,
        seq: number("seq")?,
        level: row.get("level")?,
        outcome: row.get("outcome")?,
        reason: row.get("reason")?,
        hand: row.get("hand")?,
        station: row.get("station")?,
        job_id: row.get("job_id")?,
        model_hash: row.get("model_hash")?,
        activity: row.get("activity")?,
        iu: row.get("iu")?,
        nearest: row.get("nearest")?,
        x_c: [row.get("x_c0")?, row.get("x_c1")?, row.get("x_c2")?, row.get("x_c3")?],
        distance: row.get("distance")?,
        threshold: row.get("threshold")?,
        early: row.get("early")?,
        began_ns: number("began_ns")?,
        ended_ns: number("ended_ns")?,
        decided_ns: number("decided_ns")?,
        decided_utc_ns: number("decided_utc_ns")?,
    })))
}
