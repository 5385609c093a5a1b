//! Writes a verdict as a row, and the gaps before it.

use rusqlite::{Connection, OptionalExtension, params};
use shm_schemas::{HandCode, NO_INDEX, Verdict, VerdictLevel, VerdictOutcome, VerdictReason};

use super::Confirmed;

/// The newest verdict on disk.
pub(super) fn newest(connection: &Connection) -> rusqlite::Result<Option<Confirmed>> {
    connection
        .query_row("SELECT epoch, seq FROM verdict ORDER BY id DESC LIMIT 1", [], |row| {
            Ok(Confirmed { epoch: unsigned(row.get(0)?), seq: unsigned(row.get(1)?) })
        })
        .optional()
}

/// Writes the verdict and the gaps that its number reveals. Adds the number of missing verdicts to `lost` and returns the newest verdict.
pub(super) fn insert(
    connection: &Connection,
    verdict: &Verdict,
    newest: Option<Confirmed>,
    lost: &mut u64,
) -> rusqlite::Result<Confirmed> {
    let stamp = &verdict.stamp;
    let missing_from = match newest {
        Some(newest) if newest.epoch == stamp.epoch => {
            if stamp.seq <= newest.seq {
                return Ok(newest);
            }
            newest.seq + 1
        }
        Some(old) => {
            // A judge that was killed may have sent verdicts that never arrived.
            insert_gap(connection, verdict, "restart", (old.epoch, old.seq + 1), None)?;
            1
        }
        None => 1,
    };
    if missing_from < stamp.seq {
        *lost += stamp.seq - missing_from;
        insert_gap(connection, verdict, "lost", (stamp.epoch, missing_from), Some(stamp.seq - 1))?;
    }
    insert_verdict(connection, verdict)?;
    Ok(Confirmed { epoch: stamp.epoch, seq: stamp.seq })
}

fn insert_gap(
    connection: &Connection,
    before: &Verdict,
    why: &str,
    (epoch, first_seq): (u64, u64),
    last_seq: Option<u64>,
) -> rusqlite::Result<()> {
    connection
        .prepare_cached(
            "INSERT INTO gap (before_verdict, utc_ns, why, epoch, first_seq, last_seq)
             VALUES ((SELECT coalesce(max(id), 0) + 1 FROM verdict), ?1, ?2, ?3, ?4, ?5)",
        )?
        .execute(params![
            signed(before.decided_utc_ns),
            why,
            signed(epoch),
            signed(first_seq),
            last_seq.map(signed)
        ])?;
    Ok(())
}

fn insert_verdict(connection: &Connection, verdict: &Verdict) -> rusqlite::Result<()> {
    let stamp = &verdict.stamp;
    let station = verdict.station.split(|&byte| byte == 0).next().unwrap_or_default();
    connection
        .prepare_cached(
            "INSERT INTO verdict (epoch, seq, level, outcome, reason, hand, station, job_id, model_hash, activity, iu,
             nearest, x_c0, x_c1, x_c2, x_c3, distance, threshold, early, began_ns, ended_ns, decided_ns,
             decided_utc_ns, frame_seq, captured_ns, sent_ns)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18, ?19, ?20, ?21,
             ?22, ?23, ?24, ?25, ?26)",
        )?
        .execute(params![
            signed(stamp.epoch),
            signed(stamp.seq),
            word(verdict.level().map(VerdictLevel::name), verdict.level),
            word(verdict.outcome().map(VerdictOutcome::name), verdict.outcome),
            word(VerdictReason::try_from(verdict.reason).map(VerdictReason::name), verdict.reason),
            word(HandCode::try_from(verdict.hand).map(HandCode::name), verdict.hand),
            String::from_utf8_lossy(station),
            verdict.job_id,
            format!("{:016x}", verdict.model_hash),
            index(verdict.activity),
            index(verdict.iu),
            index(verdict.nearest),
            verdict.x_c[0],
            verdict.x_c[1],
            verdict.x_c[2],
            verdict.x_c[3],
            number(verdict.distance),
            number(verdict.threshold),
            verdict.early,
            signed(verdict.began_ns),
            signed(verdict.ended_ns),
            signed(verdict.decided_ns),
            signed(verdict.decided_utc_ns),
            signed(stamp.frame_seq),
            signed(stamp.captured_ns),
            signed(stamp.sent_ns),
        ])?;
    Ok(())
}

/// The name of a code, or its number where this build does not know it.
fn word<E>(known: Result<&'static str, E>, code: u8) -> String {
    known.map_or_else(|_| code.to_string(), str::to_owned)
}

fn index(index: u16) -> Option<u16> {
    (index != NO_INDEX).then_some(index)
}

fn number(value: f32) -> Option<f32> {
    (!value.is_nan()).then_some(value)
}

/// SQLite's integers are signed: the bits are kept.
pub(super) fn signed(value: u64) -> i64 {
    value.cast_signed()
}

/// The inverse of [`signed`].
pub(super) fn unsigned(value: i64) -> u64 {
    value.cast_unsigned()
}
