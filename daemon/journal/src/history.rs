//! Reads the journal, also while it is being written.

use std::io::Write;
use std::path::{Path, PathBuf};

use rusqlite::{Connection, OpenFlags, Row, params};
use shm_schemas::PartId;

use super::audit::Deed;
use super::csv;
use super::entry::{Entry, Gap, NotWatching, Record};
use super::error::JournalError;
use super::row::{signed, unsigned};

/// Which verdicts to read.
#[derive(Clone, Copy, Debug, Default)]
pub struct Query {
    /// Only those decided at this time or later, in nanoseconds since 1970 UTC.
    pub since_utc_ns: Option<u64>,
    /// Only those of this job.
    pub job_id: Option<u32>,
    /// Only those of this part; one that is none asks for those without.
    pub part: Option<PartId>,
    /// Only anomalies and what could not be judged.
    pub nok: bool,
}

/// A reader of the journal.
#[derive(Debug)]
pub struct History {
    connection: Connection,
    path: PathBuf,
}

/// Verdicts and the rest in one order: a gap stands before the verdict that revealed it, and a time without sight before the first
/// verdict after its begin.
const QUERY: &str = "
    SELECT id AS position, 2 AS rank, epoch, seq, level, outcome, reason, hand, station, job_id, model_hash, activity, iu,
        nearest, x_c0, x_c1, x_c2, x_c3, distance, threshold, early, began_ns, ended_ns, decided_ns, decided_utc_ns,
        NULL AS last_seq, part, note, broken, broken_activity, broken_runs, measure, measured, shown_min, shown_max,
        captured_percent, seen_percent, missing_hand, missing_object, missing_s, missing_percent, needed_percent
    FROM verdict
    WHERE decided_utc_ns >= ?1 AND (?2 IS NULL OR job_id = ?2) AND (NOT ?3 OR outcome IS NOT 'ok')
        AND (?4 IS NULL OR part = ?4)
    UNION ALL
    SELECT before_verdict, 1, epoch, first_seq, why, '', '', '', '', 0, '', NULL, NULL,
        NULL, 0, 0, 0, 0, NULL, NULL, 0, 0, 0, 0, utc_ns, last_seq, '', '', '', NULL, 0, '', NULL, NULL, NULL,
        NULL, NULL, '', NULL, NULL, NULL, NULL
    FROM gap
    WHERE utc_ns >= ?1
    UNION ALL
    SELECT before_verdict, 0, 0, 0, why, '', '', '', '', 0, '', NULL, NULL,
        NULL, 0, 0, 0, 0, NULL, NULL, 0, 0, 0, 0, began_utc_ns, ended_utc_ns, '', '', '', NULL, 0, '', NULL, NULL, NULL,
        NULL, NULL, '', NULL, NULL, NULL, NULL
    FROM not_watching
    WHERE coalesce(ended_utc_ns, began_utc_ns) >= ?1
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

    /// Writes every entry that matches the query as CSV (RFC 4180), for spreadsheets. A value that has no meaning is left empty, and indices of
    /// activities and IUs count from 0. A gap has a line of its own, from `seq` to `last_seq`, and so has a time without sight, to `ended_utc`.
    ///
    /// # Errors
    /// [`JournalError`] of the database, [`JournalError::Export`] when `out` cannot be written.
    pub fn write_csv(&self, query: &Query, out: &mut impl Write) -> Result<(), JournalError> {
        out.write_all(csv::HEADER.as_bytes())?;
        self.visit(query, |entry| Ok(csv::write(&entry, out)?))?;
        Ok(out.flush()?)
    }

    /// Calls `visit` with everything that was done since this time, nanoseconds since 1970 UTC, oldest first.
    ///
    /// # Errors
    /// As [`History::visit`].
    pub fn visit_deeds(
        &self,
        since_utc_ns: Option<u64>,
        mut visit: impl FnMut(Deed) -> Result<(), JournalError>,
    ) -> Result<(), JournalError> {
        let failed = |source| JournalError::of(&self.path, 0, source);
        let query = "SELECT utc_ns, kind, who, what FROM audit WHERE utc_ns >= ?1 ORDER BY id";
        let mut statement = self.connection.prepare(query).map_err(failed)?;
        let mut rows = statement.query(params![since_utc_ns.map_or(0, signed)]).map_err(failed)?;
        while let Some(row) = rows.next().map_err(failed)? {
            let deed = || -> rusqlite::Result<Deed> {
                let utc_ns = row.get("utc_ns").map(unsigned)?;
                Ok(Deed { utc_ns, kind: row.get("kind")?, who: row.get("who")?, what: row.get("what")? })
            };
            visit(deed().map_err(failed)?)?;
        }
        Ok(())
    }

    /// Writes everything that was done since this time as CSV.
    ///
    /// # Errors
    /// As [`History::write_csv`].
    pub fn write_deeds_csv(
        &self,
        since_utc_ns: Option<u64>,
        out: &mut impl Write,
    ) -> Result<(), JournalError> {
        out.write_all(csv::DEEDS_HEADER.as_bytes())?;
        self.visit_deeds(since_utc_ns, |deed| Ok(csv::write_deed(&deed, out)?))?;
        Ok(out.flush()?)
    }

    /// Writes a copy of the whole journal as it is at this moment, also while it is being written, to a file that does not exist.
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
        let failed = |source| JournalError::of(&self.path, 0, source);
        let part = query.part.as_ref().map(PartId::text);
        let mut statement = self.connection.prepare(QUERY).map_err(failed)?;
        let mut rows = statement
            .query(params![query.since_utc_ns.map_or(0, signed), query.job_id, query.nok, part])
            .map_err(failed)?;
        while let Some(row) = rows.next().map_err(failed)? {
            visit(entry(row).map_err(failed)?)?;
        }
        Ok(())
    }
}

fn entry(row: &Row<'_>) -> rusqlite::Result<Entry> {
    let number = |column: &str| row.get(column).map(unsigned);
    let rank: u8 = row.get("rank")?;
    if rank == 0 {
        return Ok(Entry::NotWatching(NotWatching {
            began_utc_ns: number("decided_utc_ns")?,
            ended_utc_ns: row.get::<_, Option<i64>>("last_seq")?.map(unsigned),
            why: row.get("level")?,
        }));
    }
    if rank == 1 {
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
        note: row.get("note")?,
        broken: row.get("broken")?,
        broken_activity: row.get("broken_activity")?,
        broken_runs: row.get("broken_runs")?,
        measure: row.get("measure")?,
        measured: row.get("measured")?,
        shown: [row.get("shown_min")?, row.get("shown_max")?],
        captured_percent: row.get("captured_percent")?,
        seen_percent: row.get("seen_percent")?,
        missing_hand: row.get("missing_hand")?,
        missing_object: row.get("missing_object")?,
        missing_s: row.get("missing_s")?,
        missing_percent: row.get("missing_percent")?,
        needed_percent: row.get("needed_percent")?,
        began_ns: number("began_ns")?,
        ended_ns: number("ended_ns")?,
        decided_ns: number("decided_ns")?,
        decided_utc_ns: number("decided_utc_ns")?,
        part: row.get("part")?,
    })))
}
