//! The accounts of the consumers, kept beside the verdicts that they count.

use rusqlite::{Connection, OptionalExtension, Row, params};
use shm_schemas::{Account, PartId, RoleId, WAITING_RESULTS};

use super::row::{signed, unsigned};

/// The random number that the database was given when it was made: rows of another one are others.
pub(super) fn identity(connection: &Connection) -> rusqlite::Result<u64> {
    connection.query_row("SELECT journal FROM identity", [], |row| row.get(0).map(unsigned))
}

/// The account of a consumer that was kept last; before the first, where the journal ends.
pub(super) fn read(connection: &Connection, consumer: RoleId) -> rusqlite::Result<Account> {
    let journal = identity(connection)?;
    let kept = connection
        .query_row("SELECT * FROM account WHERE consumer = ?1", [consumer.name()], |row| {
            account(row, journal)
        })
        .optional()?;
    if let Some(account) = kept {
        return Ok(account);
    }
    let newest = connection
        .query_row("SELECT id, epoch, seq FROM verdict ORDER BY id DESC LIMIT 1", [], |row| {
            Ok((unsigned(row.get(0)?), unsigned(row.get(1)?), unsigned(row.get(2)?)))
        })
        .optional()?;
    let (row, epoch, seq) = newest.unwrap_or_default();
    Ok(Account { journal, row, epoch, seq, ..Account::default() })
}

/// The consumers that have an account. A name that is no role of this build is left out.
pub(super) fn consumers(connection: &Connection) -> rusqlite::Result<Vec<RoleId>> {
    let mut names = connection.prepare_cached("SELECT consumer FROM account ORDER BY consumer")?;
    let names = names.query_map([], |row| row.get::<_, String>(0))?;
    let role = |name: String| RoleId::ALL.iter().copied().find(|role| role.name() == name);
    names.filter_map(|name| name.map(role).transpose()).collect()
}

/// Writes the account of a consumer in place of the one before it. It is on disk when this returns.
pub(super) fn write(connection: &Connection, consumer: RoleId, account: &Account) -> rusqlite::Result<()> {
    connection
        .prepare_cached(
            "INSERT OR REPLACE INTO account (consumer, boot, number, row, epoch, seq, sequence, lost, has_overrun, error,
             error_detail, shown_row, shown_sequence, is_acknowledged, waiting, wanted_job,
             wanted_hash, part)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18)",
        )?
        .execute(params![
            consumer.name(),
            account.boot,
            signed(account.number),
            signed(account.row),
            signed(account.epoch),
            signed(account.seq),
            account.sequence,
            account.lost,
            account.has_overrun,
            account.error,
            account.error_detail,
            signed(account.shown_row),
            account.shown_sequence,
            account.is_acknowledged,
            waiting_text(account),
            account.wanted_job,
            signed(account.wanted_hash),
            (account.gives_parts != 0).then_some(account.part.text()),
        ])?;
    Ok(())
}

fn account(row: &Row<'_>, journal: u64) -> rusqlite::Result<Account> {
    let number = |column: &str| row.get(column).map(unsigned);
    let part: Option<String> = row.get("part")?;
    let mut account = Account {
        journal,
        boot: row.get("boot")?,
        number: number("number")?,
        row: number("row")?,
        epoch: number("epoch")?,
        seq: number("seq")?,
        sequence: row.get("sequence")?,
        lost: row.get("lost")?,
        has_overrun: row.get("has_overrun")?,
        error: row.get("error")?,
        error_detail: row.get("error_detail")?,
        shown_row: number("shown_row")?,
        shown_sequence: row.get("shown_sequence")?,
        is_acknowledged: row.get("is_acknowledged")?,
        wanted_job: row.get("wanted_job")?,
        wanted_hash: number("wanted_hash")?,
        gives_parts: part.is_some().into(),
        part: part.and_then(|id| PartId::new(id.as_bytes()).ok()).unwrap_or(PartId::NONE),
        ..Account::default()
    };
    read_waiting(&row.get::<_, String>("waiting")?, &mut account);
    Ok(account)
}

/// `ROW:NUMBER ROW:NUMBER`, so that a person can read it.
fn waiting_text(account: &Account) -> String {
    let waiting = account.waiting_rows.iter().zip(account.waiting_sequences);
    let texts =
        waiting.filter(|(_, sequence)| *sequence != 0).map(|(row, sequence)| format!("{row}:{sequence}"));
    texts.collect::<Vec<_>>().join(" ")
}

fn read_waiting(text: &str, account: &mut Account) {
    let pairs = text.split(' ').filter_map(|pair| pair.split_once(':'));
    for (index, (row, sequence)) in pairs.take(WAITING_RESULTS).enumerate() {
        account.waiting_rows[index] = row.parse().unwrap_or_default();
        account.waiting_sequences[index] = sequence.parse().unwrap_or_default();
    }
}
