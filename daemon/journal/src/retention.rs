//! How long verdicts are kept.
//!
//! What a consumer has not acknowledged is not removed for its age. It is removed for its size all the same: a consumer that is away for good must
//! not fill the disk. Then the oldest rows go first. The consumer finds them missing between the rows that it has and the next one, and the journal
//! counts them.

use rusqlite::{Connection, TransactionBehavior, params};
use shm_schemas::RoleId;

use super::account;

const NS_PER_DAY: i64 = 86_400 * 1_000_000_000;

/// Maximum number of rows that one application removes. When the clock is set years ahead by mistake, every row is suddenly too old, and
/// that must not empty the journal at once.
const MAX_REMOVED: u32 = 2000;

/// How long verdicts are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Retention {
    /// Older verdicts are removed, in days before the newest one, once every consumer has acknowledged them.
    pub keep_days: u32,
    /// The oldest verdicts are removed while the database is larger, in MB (2^20 bytes), also those that a consumer still wants.
    pub keep_mb: u32,
    /// Consumers that the station does not have now. They keep their accounts, and nothing waits for them.
    pub without: &'static [RoleId],
}

/// What one application has removed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Removed {
    /// Verdicts.
    pub(super) all: u64,
    /// Those that a consumer had not acknowledged.
    pub(super) unacknowledged: u64,
}

/// Removes verdicts that are too old or too many, at most [`MAX_REMOVED`], and records a gap for them. The newest verdict stays, because
/// it tells where the journal ends.
pub(super) fn apply(connection: &mut Connection, retention: Retention) -> rusqlite::Result<Removed> {
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    // Age counts back from the newest verdict, so that a station which was switched off for a year keeps its journal.
    let keep_ns = i64::from(retention.keep_days) * NS_PER_DAY;
    let settled = settled(&transaction, retention.without)?;
    let too_old: Option<i64> = transaction.query_row(
        "SELECT max(id) FROM (SELECT id, decided_utc_ns FROM verdict ORDER BY id LIMIT ?1)
         WHERE id <= ?3 AND decided_utc_ns < (SELECT decided_utc_ns FROM verdict ORDER BY id DESC LIMIT 1) - ?2",
        params![MAX_REMOVED, keep_ns, settled],
        |row| row.get(0),
    )?;
    let too_much = used_bytes(&transaction)? > i64::from(retention.keep_mb) << 20;
    let by_size: Option<i64> = if too_much {
        transaction.query_row(
            "SELECT max(id) FROM (SELECT id FROM verdict WHERE id < (SELECT max(id) FROM verdict) ORDER BY id LIMIT ?1)",
            params![MAX_REMOVED],
            |row| row.get(0),
        )?
    } else {
        None
    };
    let removed =
        too_old.max(by_size).map_or(Ok(Removed::default()), |last| remove(&transaction, last, settled))?;
    transaction.commit()?;
    // Returns free pages of 4 KB to the file system, as many as one application can have freed.
    connection.execute_batch("PRAGMA incremental_vacuum(500)")?;
    Ok(removed)
}

/// The id up to which every consumer has acknowledged everything.
fn settled(connection: &Connection, without: &[RoleId]) -> rusqlite::Result<i64> {
    let mut settled = i64::MAX;
    for consumer in account::consumers(connection)?.into_iter().filter(|role| !without.contains(role)) {
        settled =
            settled.min(i64::try_from(account::read(connection, consumer)?.settled()).unwrap_or(i64::MAX));
    }
    Ok(settled)
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

/// Removes the verdicts up to and including this id. One gap stands for all verdicts that were ever removed.
fn remove(connection: &Connection, last: i64, settled: i64) -> rusqlite::Result<Removed> {
    let unacknowledged: u32 = connection.query_row(
        "SELECT count(*) FROM verdict WHERE id > ?1 AND id <= ?2 AND id < (SELECT max(id) FROM verdict)",
        params![settled, last],
        |row| row.get(0),
    )?;
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
    Ok(Removed { all: removed as u64, unacknowledged: unacknowledged.into() })
}
