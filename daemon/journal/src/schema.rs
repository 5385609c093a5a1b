//! The tables, and the migrations from older ones.

use std::path::Path;

use rusqlite::{Connection, TransactionBehavior};
use shm_schemas::COLUMNS;

use super::error::JournalError;

/// Migration `i` takes the schema from version `i` to `i + 1`, which SQLite keeps as `user_version`. Only append. A value that verdicts have more needs
/// none: see [`prepare`].
pub(super) const MIGRATIONS: &[&str] = &[
    "
    CREATE TABLE verdict (
        id             INTEGER PRIMARY KEY,  -- in the order of arrival
        epoch          INTEGER NOT NULL,     -- one per start of the judge
        seq            INTEGER NOT NULL,     -- number within the epoch, from 1
        kind           TEXT    NOT NULL,
        reason         TEXT    NOT NULL,
        ok             INTEGER,              -- 1 correct, 0 anomaly, NULL not judged
        hand           TEXT    NOT NULL,
        station        TEXT    NOT NULL,
        job_id         INTEGER NOT NULL,
        model_hash     TEXT    NOT NULL,     -- 16 hexadecimal digits
        activity       INTEGER,
        iu             INTEGER,
        nearest        INTEGER,
        x_c0           INTEGER NOT NULL,
        x_c1           INTEGER NOT NULL,
        x_c2           INTEGER NOT NULL,
        x_c3           INTEGER NOT NULL,
        distance       REAL,
        threshold      REAL,
        early          INTEGER NOT NULL,
        began_ns       INTEGER NOT NULL,     -- source time
        ended_ns       INTEGER NOT NULL,
        decided_ns     INTEGER NOT NULL,
        decided_utc_ns INTEGER NOT NULL,     -- since 1970
        frame_seq      INTEGER NOT NULL,
        captured_ns    INTEGER NOT NULL,     -- CLOCK_MONOTONIC
        sent_ns        INTEGER NOT NULL,
        UNIQUE (epoch, seq)
    ) STRICT;
    CREATE INDEX verdict_decided ON verdict (decided_utc_ns);
    CREATE TABLE gap (
        id             INTEGER PRIMARY KEY,
        before_verdict INTEGER NOT NULL,     -- id of the first verdict after the gap
        utc_ns         INTEGER NOT NULL,     -- when that verdict was decided
        why            TEXT    NOT NULL CHECK (why IN ('lost', 'restart', 'retention')),
        epoch          INTEGER NOT NULL,
        first_seq      INTEGER NOT NULL,     -- first missing number
        last_seq       INTEGER               -- last missing number, NULL: unknown whether any is missing
    ) STRICT;
",
    "
    -- Level and outcome have a column each; `kind` mixed them, and `ok` repeated the outcome.
    ALTER TABLE verdict ADD COLUMN level TEXT NOT NULL DEFAULT '';
    ALTER TABLE verdict ADD COLUMN outcome TEXT NOT NULL DEFAULT '';
    UPDATE verdict SET
        level = CASE WHEN iu IS NOT NULL THEN 'iu' WHEN activity IS NOT NULL THEN 'activity' ELSE 'job' END,
        outcome = CASE ok WHEN 1 THEN 'ok' WHEN 0 THEN 'anomaly' ELSE 'not_judged' END;
    ALTER TABLE verdict DROP COLUMN kind;
    ALTER TABLE verdict DROP COLUMN ok;
",
    "
    CREATE TABLE not_watching (
        id             INTEGER PRIMARY KEY,
        before_verdict INTEGER NOT NULL,     -- id of the first verdict after its begin
        began_utc_ns   INTEGER NOT NULL,
        ended_utc_ns   INTEGER,              -- NULL: it lasts, or nobody saw its end
        why            TEXT    NOT NULL      -- a word of the channel `health`
    ) STRICT;
",
    "
    CREATE TABLE identity (
        journal INTEGER NOT NULL             -- random: rows of another database are others
    ) STRICT;
    INSERT INTO identity (journal) VALUES (random());
    CREATE TABLE account (                   -- what the PLC has been told: one row
        id              INTEGER PRIMARY KEY CHECK (id = 1),
        boot            INTEGER NOT NULL,    -- counts the starts of the role plc
        number          INTEGER NOT NULL,    -- counts the changes in one start
        row             INTEGER NOT NULL,    -- id of the newest verdict that was numbered
        epoch           INTEGER NOT NULL,    -- and its key
        seq             INTEGER NOT NULL,
        sequence        INTEGER NOT NULL,    -- and its number
        lost            INTEGER NOT NULL,
        has_overrun     INTEGER NOT NULL,
        error           INTEGER NOT NULL,
        error_detail    INTEGER NOT NULL,
        shown_row       INTEGER NOT NULL,    -- id of the verdict that was offered last
        shown_sequence  INTEGER NOT NULL,    -- and its number
        is_acknowledged INTEGER NOT NULL,
        waiting         TEXT    NOT NULL,    -- ids and numbers of those behind it
        wanted_job      INTEGER NOT NULL,    -- the job that the PLC has loaded
        wanted_hash     INTEGER NOT NULL
    ) STRICT;
",
    "
    -- A gap has more reasons than the three that were known at first.
    CREATE TABLE new_gap (
        id             INTEGER PRIMARY KEY,
        before_verdict INTEGER NOT NULL,     -- id of the first verdict after the gap
        utc_ns         INTEGER NOT NULL,     -- when that verdict was decided, or the gap was found
        why            TEXT    NOT NULL,     -- lost, restart, retention, removed, damaged
        epoch          INTEGER NOT NULL,
        first_seq      INTEGER NOT NULL,     -- first missing number
        last_seq       INTEGER               -- last missing number, NULL: unknown whether any is missing
    ) STRICT;
    INSERT INTO new_gap SELECT id, before_verdict, utc_ns, why, epoch, first_seq, last_seq FROM gap;
    DROP TABLE gap;
    ALTER TABLE new_gap RENAME TO gap;
    CREATE TABLE audit (                     -- who has changed what
        id     INTEGER PRIMARY KEY,
        utc_ns INTEGER NOT NULL,
        kind   TEXT    NOT NULL,
        who    TEXT    NOT NULL,
        what   TEXT    NOT NULL,
        epoch  INTEGER NOT NULL,             -- of the message that told it: it may come twice
        seq    INTEGER NOT NULL,
        UNIQUE (epoch, seq)
    ) STRICT;
    CREATE TABLE known (                     -- what the line ran with last
        kind TEXT PRIMARY KEY,
        what TEXT NOT NULL
    ) STRICT;
",
    "
    ALTER TABLE verdict ADD COLUMN part TEXT NOT NULL DEFAULT '';  -- the part that was worked on; empty: none was given
",
    "
    ALTER TABLE account ADD COLUMN part TEXT;  -- the part id that the PLC has given last; NULL: it gives none
    ALTER TABLE verdict ADD COLUMN note TEXT NOT NULL DEFAULT 'None';    -- what was not shown before
    ALTER TABLE verdict ADD COLUMN broken TEXT NOT NULL DEFAULT 'None';  -- how the order of the job was broken
    ALTER TABLE verdict ADD COLUMN broken_activity INTEGER;              -- in relation to which activity
    ALTER TABLE verdict ADD COLUMN broken_runs INTEGER NOT NULL DEFAULT 0;  -- and how many runs kept it
",
    "
    ALTER TABLE verdict ADD COLUMN measure TEXT NOT NULL DEFAULT 'None';  -- which measure was out of its bounds
    ALTER TABLE verdict ADD COLUMN measured REAL;   -- what it was: seconds, strokes, metres or degrees
    ALTER TABLE verdict ADD COLUMN shown_min REAL;  -- the least that was shown
    ALTER TABLE verdict ADD COLUMN shown_max REAL;  -- the most that was shown
",
    "
    ALTER TABLE verdict ADD COLUMN captured_percent INTEGER;  -- how many of a hundred frames of the IU came
    ALTER TABLE verdict ADD COLUMN seen_percent INTEGER;      -- in how many of them the hand and each object was seen
    ALTER TABLE verdict ADD COLUMN missing_hand TEXT NOT NULL DEFAULT '';  -- the hand that was not seen
    ALTER TABLE verdict ADD COLUMN missing_object INTEGER;    -- the object that was not seen
    ALTER TABLE verdict ADD COLUMN missing_s REAL;            -- for how long
    ALTER TABLE verdict ADD COLUMN missing_percent INTEGER;   -- how many of a hundred frames came, where those were too few
    ALTER TABLE verdict ADD COLUMN needed_percent INTEGER;    -- how many the job needs
",
    "
    -- Every consumer of the journal has an account; the one that was there is the PLC's.
    CREATE TABLE new_account (
        consumer        TEXT    PRIMARY KEY, -- the role that it is of
        boot            INTEGER NOT NULL,    -- counts the starts of the role
        number          INTEGER NOT NULL,    -- counts the changes in one start
        row             INTEGER NOT NULL,    -- id of the newest verdict that was acknowledged, or numbered for the PLC
        epoch           INTEGER NOT NULL,    -- and its key
        seq             INTEGER NOT NULL,
        sequence        INTEGER NOT NULL,    -- and its number; from here on the columns are the PLC's
        lost            INTEGER NOT NULL,
        has_overrun     INTEGER NOT NULL,
        error           INTEGER NOT NULL,
        error_detail    INTEGER NOT NULL,
        shown_row       INTEGER NOT NULL,    -- id of the verdict that was offered last
        shown_sequence  INTEGER NOT NULL,    -- and its number
        is_acknowledged INTEGER NOT NULL,
        waiting         TEXT    NOT NULL,    -- ids and numbers of those behind it
        wanted_job      INTEGER NOT NULL,    -- the job that the PLC has loaded
        wanted_hash     INTEGER NOT NULL,
        part            TEXT                 -- the part id that the PLC has given last; NULL: it gives none
    ) STRICT;
    INSERT INTO new_account SELECT 'plc', boot, number, row, epoch, seq, sequence, lost, has_overrun, error, error_detail,
        shown_row, shown_sequence, is_acknowledged, waiting, wanted_job, wanted_hash, part FROM account;
    DROP TABLE account;
    ALTER TABLE new_account RENAME TO account;
",
];

/// Configures the connection and brings the schema up to date. A column that a verdict has and the table has not is added. It holds what is written to
/// it, and of older verdicts nothing, which is read as none. Another version of the program writes and reads the other columns as before.
pub(super) fn prepare(connection: &mut Connection, path: &Path) -> Result<(), JournalError> {
    let failed = |source| JournalError::of(path, 0, source);
    // Must precede the first table; it lets the file shrink when old rows are removed.
    connection.pragma_update(None, "auto_vacuum", "INCREMENTAL").map_err(failed)?;
    connection.pragma_update(None, "journal_mode", "WAL").map_err(failed)?;
    connection.pragma_update(None, "synchronous", "FULL").map_err(failed)?;
    // Truncates a WAL that has grown during a long read to 4 MB, the size at which SQLite checkpoints it by default.
    connection.pragma_update(None, "journal_size_limit", 4 << 20).map_err(failed)?;

    // An up-to-date schema is not written, so that the journal opens on a full disk too.
    let is_current = version(connection).map_err(failed)? == MIGRATIONS.len() as u32;
    if is_current && missing_columns(connection).map_err(failed)?.is_empty() {
        return Ok(());
    }
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate).map_err(failed)?;
    let (found, known) = (version(&transaction).map_err(failed)?, MIGRATIONS.len() as u32);
    if found > known {
        return Err(JournalError::Newer { path: path.into(), found, known });
    }
    for migration in MIGRATIONS.iter().skip(found as usize) {
        transaction.execute_batch(migration).map_err(failed)?;
    }
    for column in missing_columns(&transaction).map_err(failed)? {
        let add = format!("ALTER TABLE verdict ADD COLUMN {column} ANY");
        transaction.execute_batch(&add).map_err(failed)?;
    }
    transaction.pragma_update(None, "user_version", known).map_err(failed)?;
    transaction.commit().map_err(failed)
}

/// The columns of a verdict that the table has not.
fn missing_columns(connection: &Connection) -> rusqlite::Result<Vec<&'static str>> {
    let mut statement = connection.prepare("SELECT name FROM pragma_table_info('verdict')")?;
    let there: Vec<String> = statement.query_map([], |row| row.get(0))?.collect::<Result<_, _>>()?;
    let is_missing = |name: &&str| there.iter().all(|known| known != name);
    Ok(COLUMNS.iter().map(|column| column.name).filter(is_missing).collect())
}

fn version(connection: &Connection) -> rusqlite::Result<u32> {
    connection.query_row("SELECT user_version FROM pragma_user_version", [], |row| row.get(0))
}
