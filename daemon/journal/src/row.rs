//! Writes a verdict as a row, and the gaps before it.

use std::sync::LazyLock;

use rusqlite::types::{Value as Sql, ValueRef};
use rusqlite::{Connection, OptionalExtension, Row, params, params_from_iter};
use shm_schemas::{COLUMNS, Column, MessageId, Value, Verdict};

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

/// Every column of the table has its own in the database, under its name.
static INSERT: LazyLock<String> = LazyLock::new(|| {
    let names: Vec<&str> = COLUMNS.iter().map(|column| column.name).collect();
    let places = vec!["?"; COLUMNS.len()];
    format!("INSERT INTO verdict ({}) VALUES ({})", names.join(", "), places.join(", "))
});

fn insert_verdict(connection: &Connection, verdict: &Verdict) -> rusqlite::Result<()> {
    let values = COLUMNS.iter().map(|column| sql((column.get)(verdict)));
    connection.prepare_cached(&INSERT)?.execute(params_from_iter(values))?;
    Ok(())
}

/// A value as the database has it. A word that this build does not know stays a number.
fn sql(value: Value<'_>) -> Sql {
    match value {
        Value::None => Sql::Null,
        Value::Whole(number) | Value::Time(number) => Sql::Integer(signed(number)),
        Value::Hash(hash) => Sql::Text(format!("{hash:016x}")),
        Value::Number(number) => Sql::Real(number.into()),
        Value::Word(word) => Sql::Text(word.to_owned()),
        Value::Unknown(code) => Sql::Text(code.to_string()),
        Value::Text(text) => Sql::Text(text.to_owned()),
    }
}

/// The inverse of [`sql`].
fn value<'r>(column: &Column, found: ValueRef<'r>) -> rusqlite::Result<Value<'r>> {
    Ok(match found {
        ValueRef::Null => Value::None,
        ValueRef::Integer(number) => Value::Whole(unsigned(number)),
        // It was written from the same number of bits.
        ValueRef::Real(number) => Value::Number(number as f32),
        found => {
            let text = found.as_str()?;
            match (column.get)(&Verdict::NONE) {
                Value::Hash(_) => Value::Hash(u64::from_str_radix(text, 16).unwrap_or_default()),
                _ => Value::Text(text),
            }
        }
    })
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
pub(super) fn read_verdict(row: &Row<'_>) -> rusqlite::Result<Verdict> {
    let mut verdict = Verdict::NONE;
    for column in COLUMNS {
        (column.set)(&mut verdict, value(column, row.get_ref(column.name)?)?);
    }
    Ok(verdict)
}

/// SQLite's integers are signed: the bits are kept.
pub(super) fn signed(value: u64) -> i64 {
    value.cast_signed()
}

/// The inverse of [`signed`].
pub(super) fn unsigned(value: i64) -> u64 {
    value.cast_unsigned()
}
