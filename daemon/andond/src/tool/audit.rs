//! Lets the journal keep what a person has done by a command: through the running station, or in its database where none runs.

use std::time::{Duration, Instant};

use andon_host::config::Config;
use andon_ipc::{Node, UtcTime, Wake, Writer};
use andon_journal::{AuditEntry, History, Journal, JournalError};
use shm_schemas::{Audit, AuditKind, RoleId};

use super::ToolError;
use super::join::join;
use crate::identity::own_user;
use crate::role::retention;

/// A journal that runs writes within one turn.
const PATIENCE: Duration = Duration::from_secs(5);
/// A journal that was just starting has not heard the first one.
const AGAIN: Duration = Duration::from_millis(250);

/// Returns when it is on disk.
///
/// # Errors
/// That the journal does not answer, or cannot be written.
pub(super) fn keep(config: &Config, kind: AuditKind, what: &str) -> Result<(), ToolError> {
    let is_running = config.ipc_station().map_err(ToolError::Station)?.is_in_use();
    if is_running { tell(config, &join(config)?, kind, what) } else { note(config, kind, what) }
}

fn note(config: &Config, kind: AuditKind, what: &str) -> Result<(), ToolError> {
    // As the role opens it: what it may remove belongs to it.
    let mut journal = Journal::open(&config.journal_path(), retention(config))?;
    Ok(journal.note(UtcTime::now().nanoseconds(), kind, &own_user(), what)?)
}

fn tell(config: &Config, node: &Node, kind: AuditKind, what: &str) -> Result<(), ToolError> {
    let mut audits: Writer<Audit> = node.writer()?;
    let (who, utc_ns) = (own_user(), UtcTime::now().nanoseconds());
    let mut message = audits.loan()?;
    (message.utc_ns, message.kind, message.role) = (utc_ns, kind.code(), RoleId::Tool.code());
    message.say(&who, what);
    let expected = AuditEntry {
        utc_ns,
        kind: kind.name().into(),
        who: message.who().into(),
        what: message.what().into(),
    };
    audits.send(message)?;
    // The writer hands what it has sent to a journal that comes up meanwhile.
    let began = Instant::now();
    while began.elapsed() < PATIENCE {
        if node.wait(&mut [&mut audits], AGAIN)? == Wake::Stop {
            break;
        }
        if is_kept(config, &expected)? {
            return Ok(());
        }
    }
    Err(ToolError::Unkept)
}

fn is_kept(config: &Config, expected: &AuditEntry) -> Result<bool, JournalError> {
    let mut found = false;
    History::open(&config.journal_path())?.visit_audit(Some(expected.utc_ns), |entry| {
        found |= entry == *expected;
        Ok(())
    })?;
    Ok(found)
}
