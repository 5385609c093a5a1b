//! Who has changed what, and when.

use rusqlite::{OptionalExtension, params};
use shm_schemas::{Audit, AuditKind, MessageId};

use super::row::signed;
use super::{Journal, JournalError};

/// One thing that was done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AuditEntry {
    /// When, nanoseconds since 1970 UTC.
    pub utc_ns: u64,
    /// A word of [`AuditKind`].
    pub kind: String,
    /// Who did it: the address of a client, a user, a role.
    pub who: String,
    /// What was done.
    pub what: String,
}

impl Journal {
    /// Writes what a role has told. What came before is not written twice.
    ///
    /// # Errors
    /// [`JournalError`] when it could not be written; nothing is kept for later.
    pub fn record(&mut self, audit: &Audit) -> Result<(), JournalError> {
        let kind = AuditKind::try_from(audit.kind).map_or("?", AuditKind::name);
        self.insert_audit(audit.utc_ns, kind, (audit.who(), audit.what()), audit.stamp.id())
    }

    /// Writes what this process itself has found or done.
    ///
    /// # Errors
    /// As [`Journal::record`].
    pub fn note(&mut self, utc_ns: u64, kind: AuditKind, who: &str, what: &str) -> Result<(), JournalError> {
        // The epochs of messages are times since the boot, so that a time since 1970 never equals one.
        let id = MessageId { epoch: utc_ns, seq: kind.code().into() };
        self.insert_audit(utc_ns, kind.name(), (who, what), id)
    }

    /// Writes that the line runs with something else than it did last; nothing where it is the same. The first is no change.
    ///
    /// # Errors
    /// As [`Journal::record`].
    pub fn note_change(
        &mut self,
        utc_ns: u64,
        kind: AuditKind,
        who: &str,
        what: &str,
    ) -> Result<(), JournalError> {
        let query = "SELECT what FROM known WHERE kind = ?1";
        let known: Option<String> = self
            .connection
            .query_row(query, params![kind.name()], |row| row.get(0))
            .optional()
            .map_err(|source| self.failed(source))?;
        if known.as_deref() == Some(what) {
            return Ok(());
        }
        if let Some(known) = known {
            self.note(utc_ns, kind, who, &format!("{what}, before: {known}"))?;
        }
        let insert = "INSERT OR REPLACE INTO known (kind, what) VALUES (?1, ?2)";
        let written = self.connection.execute(insert, params![kind.name(), what]);
        written.map(drop).map_err(|source| self.failed(source))
    }

    fn insert_audit(
        &mut self,
        utc_ns: u64,
        kind: &str,
        (who, what): (&str, &str),
        id: MessageId,
    ) -> Result<(), JournalError> {
        let written = self.connection.execute(
            "INSERT OR IGNORE INTO audit (utc_ns, kind, who, what, epoch, seq) VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
            params![signed(utc_ns), kind, who, what, signed(id.epoch), signed(id.seq)],
        );
        written.map(drop).map_err(|source| self.failed(source))
    }
}
