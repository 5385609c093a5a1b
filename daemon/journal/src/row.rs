//! Writes a verdict as a row, and the gaps before it.

use rusqlite::{Connection, OptionalExtension, Row, params};
use shm_schemas::{
    HandCode, MessageId, NO_INDEX, NO_PERCENT, OrderFault, PartId, Stamp, Verdict, VerdictLevel,
    VerdictMeasure, VerdictNote, VerdictOutcome, VerdictReason,
};

use super::Written;

/// The newest verdict on disk.
pub(super) fn newest(connection: &Connection) -> rusqlite::Result<Option<MessageId>> {
    connection
        .query_row("SELECT epoch, seq FROM verdict ORDER BY id DESC LIMIT 1", [], |row| {
            Ok(MessageId { epoch: unsigned(row.get(0)?), seq: unsigned(row.get(1)?) })
        })
        .optional()
}

/// Writes the verdict and the gaps that its number reveals. Adds the number of missing verdicts to `lost` and returns the newest verdict.
pub(super) fn insert(
    connection: &Connection,
    verdict: &Verdict,
    newest: Option<MessageId>,
    lost: &mut u64,
) -> rusqlite::Result<MessageId> {
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
            insert_gap(connection, verdict, "restart", MessageId { seq: old.seq + 1, ..old }, None)?;
            1
        }
        None => 1,
    };
    if missing_from < stamp.seq {
        *lost += stamp.seq - missing_from;
        insert_gap(
            connection,
            verdict,
            "lost",
            MessageId { epoch: stamp.epoch, seq: missing_from },
            Some(stamp.seq - 1),
        )?;
    }
    insert_verdict(connection, verdict)?;
    Ok(stamp.id())
}

fn insert_gap(
    connection: &Connection,
    before: &Verdict,
    why: &str,
    first: MessageId,
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
            signed(first.epoch),
            signed(first.seq),
            last_seq.map(signed)
        ])?;
    Ok(())
}

/// Writes that everything before the next verdict is in no file under this name, up to `newest` where that is known.
pub(super) fn insert_missing(
    connection: &Connection,
    why: &str,
    utc_ns: u64,
    newest: Option<MessageId>,
) -> rusqlite::Result<()> {
    connection.execute(
        "INSERT INTO gap (before_verdict, utc_ns, why, epoch, first_seq, last_seq)
         VALUES ((SELECT coalesce(max(id), 0) + 1 FROM verdict), ?1, ?2, ?3, 1, ?4)",
        params![
            signed(utc_ns),
            why,
            signed(newest.map_or(0, |newest| newest.epoch)),
            newest.map(|newest| signed(newest.seq))
        ],
    )?;
    Ok(())
}

fn insert_verdict(connection: &Connection, verdict: &Verdict) -> rusqlite::Result<()> {
    let stamp = &verdict.stamp;
    let station = verdict.station.split(|&byte| byte == 0).next().unwrap_or_default();
    connection
        .prepare_cached(
            "INSERT INTO verdict (epoch, seq, level, outcome, reason, hand, station, job_id, model_hash, activity, iu,
             nearest, x_c0, x_c1, x_c2, x_c3, distance, threshold, early, began_ns, ended_ns, decided_ns,
             decided_utc_ns, frame_seq, captured_ns, sent_ns, part, note, broken, broken_activity, broken_runs,
             measure, measured, shown_min, shown_max, captured_percent, seen_percent, missing_hand, missing_object,
             missing_s, missing_percent, needed_percent)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18, ?19, ?20, ?21,
             ?22, ?23, ?24, ?25, ?26, ?27, ?28, ?29, ?30, ?31, ?32, ?33, ?34, ?35, ?36, ?37,
             ?38, ?39, ?40, ?41, ?42)",
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
            verdict.part.text(),
            word(VerdictNote::try_from(verdict.note).map(VerdictNote::name), verdict.note),
            word(OrderFault::try_from(verdict.broken).map(OrderFault::name), verdict.broken),
            index(verdict.broken_activity),
            verdict.broken_runs,
            word(VerdictMeasure::try_from(verdict.measure).map(VerdictMeasure::name), verdict.measure),
            number(verdict.measured),
            number(verdict.shown_min),
            number(verdict.shown_max),
            percent(verdict.captured_percent),
            percent(verdict.seen_percent),
            word(HandCode::try_from(verdict.missing_hand).map(HandCode::name), verdict.missing_hand),
            Some(verdict.missing_object).filter(|id| *id != 0),
            number(verdict.missing_s),
            percent(verdict.missing_percent),
            percent(verdict.needed_percent),
        ])?;
    Ok(())
}

/// The rows after this one, oldest first.
pub(super) fn after(connection: &Connection, row: u64, count: usize) -> rusqlite::Result<Vec<Written>> {
    let mut statement =
        connection.prepare_cached("SELECT * FROM verdict WHERE id > ?1 ORDER BY id LIMIT ?2")?;
    let rows = statement.query_map(params![signed(row), count as i64], |row| {
        Ok(Written { row: unsigned(row.get("id")?), verdict: read_verdict(row)? })
    })?;
    rows.collect()
}

/// The inverse of [`insert_verdict`].
fn read_verdict(row: &Row<'_>) -> rusqlite::Result<Verdict> {
    let number = |column: &str| row.get(column).map(unsigned);
    let index = |column: &str| row.get(column).map(|index: Option<u16>| index.unwrap_or(NO_INDEX));
    let value = |column: &str| row.get(column).map(|value: Option<f32>| value.unwrap_or(f32::NAN));
    let percent = |column: &str| row.get(column).map(|of: Option<u8>| of.unwrap_or(NO_PERCENT));
    let text = |column: &str| row.get::<_, String>(column);
    let mut verdict = Verdict {
        stamp: Stamp {
            seq: number("seq")?,
            epoch: number("epoch")?,
            frame_seq: number("frame_seq")?,
            captured_ns: number("captured_ns")?,
            sent_ns: number("sent_ns")?,
        },
        model_hash: u64::from_str_radix(&text("model_hash")?, 16).unwrap_or_default(),
        began_ns: number("began_ns")?,
        ended_ns: number("ended_ns")?,
        decided_ns: number("decided_ns")?,
        decided_utc_ns: number("decided_utc_ns")?,
        job_id: row.get("job_id")?,
        distance: value("distance")?,
        threshold: value("threshold")?,
        x_c: [row.get("x_c0")?, row.get("x_c1")?, row.get("x_c2")?, row.get("x_c3")?],
        activity: index("activity")?,
        iu: index("iu")?,
        nearest: index("nearest")?,
        level: code(VerdictLevel::ALL, VerdictLevel::name, VerdictLevel::code, &text("level")?),
        outcome: code(VerdictOutcome::ALL, VerdictOutcome::name, VerdictOutcome::code, &text("outcome")?),
        reason: code(VerdictReason::ALL, VerdictReason::name, VerdictReason::code, &text("reason")?),
        hand: code(HandCode::ALL, HandCode::name, HandCode::code, &text("hand")?),
        early: row.get("early")?,
        note: code(VerdictNote::ALL, VerdictNote::name, VerdictNote::code, &text("note")?),
        broken: code(OrderFault::ALL, OrderFault::name, OrderFault::code, &text("broken")?),
        broken_activity: index("broken_activity")?,
        broken_runs: row.get("broken_runs")?,
        measure: code(VerdictMeasure::ALL, VerdictMeasure::name, VerdictMeasure::code, &text("measure")?),
        measured: value("measured")?,
        shown_min: value("shown_min")?,
        shown_max: value("shown_max")?,
        captured_percent: percent("captured_percent")?,
        seen_percent: percent("seen_percent")?,
        missing_hand: code(HandCode::ALL, HandCode::name, HandCode::code, &text("missing_hand")?),
        missing_object: row.get::<_, Option<u16>>("missing_object")?.unwrap_or_default(),
        missing_s: value("missing_s")?,
        missing_percent: percent("missing_percent")?,
        needed_percent: percent("needed_percent")?,
        // Rows are written by this; where another program has put something else, that is none.
        part: PartId::new(text("part")?.as_bytes()).unwrap_or(PartId::NONE),
        ..Verdict::default()
    };
    for (to, from) in verdict.station.iter_mut().zip(text("station")?.bytes()) {
        *to = from;
    }
    Ok(verdict)
}

/// The inverse of [`word`].
pub(super) fn code<T: Copy>(all: &[T], name: fn(T) -> &'static str, code: fn(T) -> u8, text: &str) -> u8 {
    let known = all.iter().find(|&&word| name(word) == text).map(|&word| code(word));
    known.or_else(|| text.parse().ok()).unwrap_or_default()
}

/// The name of a code, or its number where this build does not know it.
fn word<E>(known: Result<&'static str, E>, code: u8) -> String {
    known.map_or_else(|_| code.to_string(), str::to_owned)
}

fn index(index: u16) -> Option<u16> {
    (index != NO_INDEX).then_some(index)
}

fn percent(percent: u8) -> Option<u8> {
    (percent != NO_PERCENT).then_some(percent)
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
