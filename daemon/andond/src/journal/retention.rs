//! How long verdicts are kept.

use rusqlite::{Connection, TransactionBehavior, params};

const NS_PER_DAY: i64 = 86_400 * 1_000_000_000;

/// Rows that one look removes at the most. A clock that was set years ahead by mistake makes everything old at once; it must not empty
/// the journal in one go.
const REMOVE_MOST: u32 = 2000;

/// How long verdicts are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Retention {
    /// Older ones go, in days.
    pub keep_days: u32,
    /// The oldest go when the database is larger, in MB (2^20 bytes).
    pub keep_mb: u32,
}

/// Removes what is too old or too much, at most [`REMOVE_MOST`] rows, and says so in the gaps. The newest verdict stays: it
/// tells where the journal ended. Returns how many verdicts have gone.
pub(super) fn apply(connection: &mut Connection, retention: Retention) -> rusqlite::Result<usize> {
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    // Age counts from the newest verdict, so a journal that was switched off for a year keeps what it has.
    let keep_ns = i64::from(retention.keep_days) * NS_PER_DAY;
    let oldest_kept: Option<i64> = transaction.query_row(
        "SELECT max(id) FROM (SELECT id, decided_utc_ns FROM verdict ORDER BY id LIMIT ?1)
         WHERE decided_utc_ns < (SELECT decided_utc_ns FROM verdict ORDER BY id DESC LIMIT 1) - ?2",
        params![REMOVE_MOST, keep_ns],
        |row| row.get(0),
    )?;
    let too_much = used_bytes(&transaction)? > i64::from(retention.keep_mb) << 20;
    let by_size: Option<i64> = if too_much {
        transaction.query_row(
            "SELECT max(id) FROM (SELECT id FROM verdict ORDER BY id LIMIT ?1)",
            params![REMOVE_MOST],
            |row| row.get(0),
        )?
    } else {
        None
    };
    let removed = oldest_kept.max(by_size).map_or(Ok(0), |last| remove(&transaction, last))?;
    transaction.commit()?;
    // Gives free pages back to the file system, 4 KB each, as many as a look can have freed.
    connection.execute_batch("PRAGMA incremental_vacuum(500)")?;
    Ok(removed)
}

/// Bytes of the pages in use.
fn used_bytes(connection: &Connection) -> rusqlite::Result<i64> {
    connection.query_row(
        "SELECT (page_count - freelist_count) * page_size
         FROM pragma_page_count, pragma_freelist_count, pragma_page_size",
        [],
        |row| row.get(0),
    )
}

/// Removes up to and with this id, and says how many that were. One row stands for all that were ever removed: first to last.
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
    // Gaps between verdicts that are gone say nothing any more, and neither do earlier removals.
    connection.execute(
        "DELETE FROM gap WHERE before_verdict <= ?1 OR (why = 'retention' AND id < (SELECT max(id) FROM gap WHERE why = 'retention'))",
        params![last],
    )?;
    Ok(removed)
}
