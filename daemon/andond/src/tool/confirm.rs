//! `andond confirm`: what a person says of the work that a verdict is on.

use std::collections::BTreeMap;

use andon_host::config::Config;
use andon_host::exit::Code;
use andon_journal::History;
use shm_schemas::{AuditKind, MessageId};

use super::{ToolError, audit, clip, running_config};
use crate::cli::{Confirm, Was};

/// Runs the command; it ends when the journal has it.
///
/// # Errors
/// A row that the journal does not have, and a journal that does not answer.
pub fn run(arguments: &Confirm) -> Result<Code, ToolError> {
    let config = running_config(&arguments.config)?.config;
    let verdict = clip::verdict(&config, arguments.row)?;
    let confirmed = Confirmed { row: arguments.row, id: verdict.stamp.id(), was: arguments.was };
    audit::keep(&config, AuditKind::Confirmation, &confirmed.text())?;
    println!("kept: verdict {} was on work that was {}", arguments.row, word(arguments.was));
    Ok(Code::Stopped)
}

/// What a person has said of a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Confirmed {
    pub(super) row: u64,
    pub(super) id: MessageId,
    pub(super) was: Was,
}

fn word(was: Was) -> &'static str {
    match was {
        Was::Right => "right",
        Was::Wrong => "wrong",
    }
}

impl Confirmed {
    /// As the journal has it.
    fn text(self) -> String {
        let Self { row, id: MessageId { epoch, seq }, was } = self;
        format!("verdict {row} of {epoch}-{seq} was on work that was {}", word(was))
    }

    fn read(text: &str) -> Option<Self> {
        let words: Vec<&str> = text.split(' ').collect();
        let ["verdict", row, "of", id, "was", "on", "work", "that", "was", was] = words.as_slice() else {
            return None;
        };
        let (epoch, seq) = id.split_once('-')?;
        let id = MessageId { epoch: epoch.parse().ok()?, seq: seq.parse().ok()? };
        let was = [Was::Right, Was::Wrong].into_iter().find(|known| word(*known) == *was)?;
        Some(Self { row: row.parse().ok()?, id, was })
    }
}

/// What people have said, by verdict; of each the newest counts. In a new journal the number of a row means another verdict.
///
/// # Errors
/// That the journal cannot be read.
pub(super) fn confirmed(config: &Config) -> Result<BTreeMap<(u64, u64), Confirmed>, ToolError> {
    let mut found = BTreeMap::new();
    History::open(&config.journal_path())?.visit_audit(None, |entry| {
        if entry.kind == AuditKind::Confirmation.name()
            && let Some(confirmed) = Confirmed::read(&entry.what)
        {
            let MessageId { epoch, seq } = confirmed.id;
            found.insert((epoch, seq), confirmed);
        }
        Ok(())
    })?;
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_person_has_said_is_read_as_it_was_written_and_nothing_else_is() {
        for was in [Was::Right, Was::Wrong] {
            let said = Confirmed { row: 4711, id: MessageId { epoch: u64::MAX, seq: u64::MAX }, was };
            assert_eq!(Confirmed::read(&said.text()), Some(said));
            // As much as an audit entry holds.
            assert!(said.text().len() <= 168);
        }
        for text in ["", "verdict 4 was right", "verdict 4 of 1-x was on work that was right"] {
            assert_eq!(Confirmed::read(text), None, "{text}");
        }
    }
}
