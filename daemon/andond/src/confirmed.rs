//! What people say of the work that verdicts are on, as the journal keeps it.

use std::collections::BTreeMap;

use andon_journal::{History, JournalError};
use shm_schemas::{AuditKind, MessageId};

use crate::cli::Was;

/// What a person has said of a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Confirmed {
    pub(crate) row: u64,
    pub(crate) id: MessageId,
    pub(crate) was: Was,
}

/// The word for it.
pub(crate) fn word(was: Was) -> &'static str {
    match was {
        Was::Right => "right",
        Was::Wrong => "wrong",
    }
}

impl Confirmed {
    /// As the journal has it.
    pub(crate) fn text(self) -> String {
        let Self { row, id: MessageId { epoch, seq }, was } = self;
        format!("verdict {row} of {epoch}-{seq} was on work that was {}", word(was))
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
        let (epoch, seq) = id.split_once('-')?;
        let id = MessageId { epoch: epoch.parse().ok()?, seq: seq.parse().ok()? };
        let was = [Was::Right, Was::Wrong].into_iter().find(|known| word(*known) == *was)?;
        Some(Self { row: row.parse().ok()?, id, was })
    }
}

/// What was said last, and by whom, of each verdict, by epoch and number.
pub(crate) type Said = BTreeMap<(u64, u64), (Confirmed, String)>;

/// What people have said since this time, by verdict, and who has; of each the newest counts. In a new journal the number of a row means another
/// verdict.
///
/// # Errors
/// That the journal cannot be read.
pub(crate) fn since(history: &History, utc_ns: Option<u64>) -> Result<Said, JournalError> {
    let mut found = BTreeMap::new();
    history.visit_audit(utc_ns, |entry| {
        if let Some(confirmed) = Confirmed::read(&entry.kind, &entry.what) {
            let MessageId { epoch, seq } = confirmed.id;
            found.insert((epoch, seq), (confirmed, entry.who));
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
        for was in [Was::Right, Was::Wrong] {
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
