//! How long verdicts are kept.

use rusqlite::{Connection, TransactionBehavior, params};

const NS_PER_DAY: i64 = 86_400 * 1_000_000_000;

/// Maximum number of rows that one application removes. When the clock is set years ahead by mistake, every row is suddenly too old, and
/// that must not empty the journal at once.
const MAX_REMOVED: u32 = 2000;

/// How long verdicts are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Retention {
    /// Older verdicts are removed, in days before the newest one.
    pub keep_days: u32,
    /// The oldest verdicts are removed while the database is larger, in MB (2^20 bytes).
    pub keep_mb: u32,
}

/// Removes verdicts that are too old or too many, at most [`MAX_REMOVED`], and records a gap for them. The newest verdict stays, because
/// it tells where the journal ends. Returns the number of removed verdicts.
pub(super) fn apply(connection: &mut Connection, retention: Retention) -> rusqlite::Result<usize> {
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    // Age counts back from the newest verdict, so that a station which was switched off for a year keeps its journal.
    let keep_ns = i64::from(retention.keep_days) * NS_PER_DAY;
    let oldest_kept: Option<i64> = transaction.query_row(
        "SELECT max(id) FROM (SELECT id, decided_utc_ns FROM verdict ORDER BY id LIMIT ?1)
         WHERE decided_utc_ns < (SELECT decided_utc_ns FROM verdict ORDER BY id DESC LIMIT 1) - ?2",
        params![MAX_REMOVED, keep_ns],
        |row| row.get(0),
    )?;
    let too_much = used_bytes(&transaction)? > i64::from(retention.keep_mb) << 20;
    let by_size: Option<i64> = if too_much {
        transaction.query_row(
            "SELECT max(id) FROM (SELECT id FROM verdict ORDER BY id LIMIT ?1)",
            params![MAX_REMOVED],
            |row| row.get(0),
        )?
    } else {
        None
    };
    let removed = oldest_kept.max(by_size).map_or(Ok(0), |last| remove(&transaction, last))?;
    transaction.commit()?;
    // Returns free pages of 4 KB to the file system, as many as one application can have freed.
    connection.execute_batch("PRAGMA incremental_vacuum(500)")?;
    Ok(removed)
}

/// Size of the pages in use, in bytes.
fn used_bytes(connection: &Connection) -> rusqlite::Result<i64> {
    connection.query_row(
        "SELECT (page_count - freelist_count) * page_size
         FROM pragma_page_count, pragma_freelist_count, pragma_page_size",
        [],
        |row| row.get(0),
    )
}

/// Removes the verdicts up to and including this id and returns their number. One gap stands for all verdicts that were ever removed.
fn remove(connection: &Connection, last: i64) -> rusqlite::Result<usize> {
    connection.execute(
        "INSERT INTO gap (before_verdict, utc_ns, why, epoch, first_seq, last_seq)
         SELECT ?1 + 1, decided_utc_ns, 'retention', epoch, 1, seq FROM verdict
         WHERE id <= ?1 AND id < (SELECT max(id) FROM verdict) ORDER BY id DESC LIMIT 1",
        params![last],
    )?;
    let removed = connection.execute(
        "DELETE FROM verdict WHERE id <= ?1 AND id < (SELECT max(id) FROM verdict)",
        params![last],
    )?;
    connection.execute("DELETE FROM not_watching WHERE before_verdict <= ?1", params![last])?;
    connection.execute(
        "DELETE FROM audit WHERE utc_ns < (SELECT decided_utc_ns FROM verdict ORDER BY id LIMIT 1)",
        params![],
    )?;
    // The new gap includes the gaps between removed verdicts and the gap of earlier removals.
    connection.execute(
        "DELETE FROM gap WHERE before_verdict <= ?1 OR (why = 'retention' AND id < (SELECT max(id) FROM gap WHERE why = 'retention'))",
        params![last],
    )?;
    Ok(removed)
}
