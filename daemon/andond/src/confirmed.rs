//! What people say of the work that verdicts are on, as the journal keeps it.

use std::collections::BTreeMap;

use andon_board::Was;
use andon_journal::{History, JournalError};
use shm_schemas::{AuditKind, MessageId};

/// What a person has said of a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Confirmed {
    pub(crate) row: u64,
    pub(crate) id: MessageId,
    pub(crate) was: Was,
}

impl Confirmed {
    /// As the journal has it.
    pub(crate) fn text(self) -> String {
        let Self { row, id, was } = self;
        format!("verdict {row} of {id} was on work that was {}", was.name())
    }

    /// What the journal has, if it is one of these.
    pub(crate) fn read(kind: &str, text: &str) -> Option<Self> {
        let words: Vec<&str> = text.split(' ').collect();
        let ["verdict", row, "of", id, "was", "on", "work", "that", "was", was] = words.as_slice() else {
            return None;
        };
        if kind != AuditKind::Confirmation.name() {
            return None;
        }
        let was = Was::ALL.into_iter().find(|known| known.name() == *was)?;
        Some(Self { row: row.parse().ok()?, id: MessageId::named(id)?, was })
    }
}

/// What was said last, and by whom, of each verdict.
pub(crate) type Said = BTreeMap<MessageId, (Confirmed, String)>;

/// What people have said since this time, by verdict, and who has; of each the newest counts. In a new journal the number of a row means another
/// verdict.
///
/// # Errors
/// That the journal cannot be read.
pub(crate) fn since(history: &History, utc_ns: Option<u64>) -> Result<Said, JournalError> {
    let mut found = BTreeMap::new();
    history.visit_audit(utc_ns, |entry| {
        if let Some(confirmed) = Confirmed::read(&entry.kind, &entry.what) {
            found.insert(confirmed.id, (confirmed, entry.who));
        }
        Ok(())
    })?;
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    const KIND: &str = AuditKind::Confirmation.name();

    #[test]
    fn what_a_person_has_said_is_read_as_it_was_written_and_nothing_else_is() {
        for was in Was::ALL {
            let said = Confirmed { row: 4711, id: MessageId { epoch: u64::MAX, seq: u64::MAX }, was };
            assert_eq!(Confirmed::read(KIND, &said.text()), Some(said));
            assert_eq!(Confirmed::read("login", &said.text()), None);
            // As much as an audit entry holds.
            assert!(said.text().len() <= 168);
        }
        for text in ["", "verdict 4 was right", "verdict 4 of 1-x was on work that was right"] {
            assert_eq!(Confirmed::read(KIND, text), None, "{text}");
        }
    }
}
