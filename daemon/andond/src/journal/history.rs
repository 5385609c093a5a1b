//! Reading the journal, also while it is written.

use std::path::{Path, PathBuf};

use rusqlite::{Connection, OpenFlags, Row, params};

use super::error::JournalError;
use super::row::{signed, unsigned};

/// What to read.
#[derive(Clone, Copy, Debug, Default)]
pub struct Query {
    /// Decided at this time or later, nanoseconds since 1970 UTC.
    pub since_utc_ns: Option<u64>,
    /// Of this job only.
    pub job_id: Option<u32>,
    /// Only what is not right: anomalies, and what could not be judged.
    pub nok: bool,
    /// Only the newest so many verdicts.
    pub newest: Option<u32>,
}

/// A row of the journal, in the order of writing.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// A verdict.
    Verdict(Box<Record>),
    /// Verdicts that are not there. Always shown, whatever is asked for: any verdict may have been among them.
    Gap(Gap),
}

/// A verdict as it was written. Times are source times in nanoseconds, except `decided_utc_ns`.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)] // The fields of `shm_schemas::Verdict`, under their names.
pub struct Record {
    pub epoch: u64,
    pub seq: u64,
    pub kind: String,
    pub reason: String,
    /// `None`: could not be judged.
    pub ok: Option<bool>,
    pub hand: String,
    pub station: String,
    pub job_id: u32,
    /// 16 hexadecimal digits.
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
    /// Since 1970.
    pub decided_utc_ns: u64,
}

/// Verdicts that are not in the journal.
#[derive(Clone, Debug, PartialEq)]
pub struct Gap {
    /// When the first verdict after it was decided, nanoseconds since 1970 UTC.
    pub utc_ns: u64,
    /// `lost`: they never came, or there was no room. `restart`: the judge started anew, what it sent before may be
    /// missing. `retention`: they were removed for their age or number.
    pub why: String,
    /// Their epoch; for `retention` the newest of them.
    pub epoch: u64,
    /// The first of them.
    pub first_seq: u64,
    /// The last; `None` where it is not known whether any is missing.
    pub last_seq: Option<u64>,
}

/// A reader of the journal.
#[derive(Debug)]
pub struct History {
    connection: Connection,
    path: PathBuf,
}

/// Gaps and verdicts in one order: a gap stands before the verdict that showed it.
const QUERY: &str = "
    WITH chosen AS (
        SELECT * FROM verdict
        WHERE decided_utc_ns >= ?1 AND (?2 IS NULL OR job_id = ?2) AND (NOT ?3 OR ok IS NOT 1)
        ORDER BY id DESC LIMIT ?4)
    SELECT id AS place, 1 AS part, epoch, seq, kind, reason, ok, hand, station, job_id, model_hash, activity, iu,
        nearest, x_c0, x_c1, x_c2, x_c3, distance, threshold, early, began_ns, ended_ns, decided_ns, decided_utc_ns,
        NULL AS last_seq
    FROM chosen
    UNION ALL
    SELECT before_verdict, 0, epoch, first_seq, why, '', NULL, '', '', 0, '', NULL, NULL,
        NULL, 0, 0, 0, 0, NULL, NULL, 0, 0, 0, 0, utc_ns, last_seq
    FROM gap
    WHERE utc_ns >= ?1 AND (?4 < 0 OR before_verdict >= (SELECT coalesce(min(id), 0) FROM chosen))
    ORDER BY place, part";

impl History {
    /// Opens a journal for reading.
    ///
    /// # Errors
    /// [`JournalError`] where there is none, or it cannot be read.
    pub fn open(path: &Path) -> Result<Self, JournalError> {
        // Not read only: the first reader after a crash must be able to put the WAL in order. No CREATE: no empty journal by a typing error.
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let connection =
            Connection::open_with_flags(path, flags).map_err(|source| JournalError::of(path, 0, source))?;
        Ok(Self { connection, path: path.into() })
    }

    /// Hands every entry to `visit`, oldest first. Millions are read one by one, not held.
    ///
    /// # Errors
    /// [`JournalError`] of the database or of `visit`, which ends the reading.
    pub fn visit(
        &self,
        query: &Query,
        mut visit: impl FnMut(Entry) -> Result<(), JournalError>,
    ) -> Result<(), JournalError> {
        let failed = |source| JournalError::of(&self.path, 0, source);
        let mut statement = self.connection.prepare(QUERY).map_err(failed)?;
        let mut rows = statement
            .query(params![
                query.since_utc_ns.map_or(0, signed),
                query.job_id,
                query.nok,
                query.newest.map_or(-1, i64::from),
            ])
            .map_err(failed)?;
        while let Some(row) = rows.next().map_err(failed)? {
            visit(entry(row).map_err(failed)?)?;
        }
        Ok(())
    }

    /// All entries at once, oldest first: for queries that are known to be short.
    ///
    /// # Errors
    /// As [`History::visit`].
    pub fn entries(&self, query: &Query) -> Result<Vec<Entry>, JournalError> {
        let mut entries = Vec::new();
        self.visit(query, |entry| {
            entries.push(entry);
            Ok(())
        })?;
        Ok(entries)
    }
}

fn entry(row: &Row<'_>) -> rusqlite::Result<Entry> {
    let number = |column: &str| row.get(column).map(unsigned);
    if row.get::<_, u8>("part")? == 0 {
        return Ok(Entry::Gap(Gap {
            utc_ns: number("decided_utc_ns")?,
            why: row.get("kind")?,
            epoch: number("epoch")?,
            first_seq: number("seq")?,
            last_seq: row.get::<_, Option<i64>>("last_seq")?.map(unsigned),
        }));
    }
    Ok(Entry::Verdict(Box::new(Record {
        epoch: number("epoch")?,
        seq: number("seq")?,
        kind: row.get("kind")?,
        reason: row.get("reason")?,
        ok: row.get("ok")?,
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
