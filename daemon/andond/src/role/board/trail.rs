//! Who has changed what, from the journal, while somebody looks at an engineer's page. It is read in a thread, because a disk may be slow, and without
//! the right to write.

use std::path::PathBuf;
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use andon_board::{Audited, Board};
use andon_journal::{AuditEntry, History, JournalError};
use shm_schemas::AuditKind;

use super::is_due;

/// How often it is read.
const LOOK: Duration = Duration::from_secs(2);

/// Rows that are shown: `andond history --audit` has all.
const NEWEST: u32 = 30;

/// Reads it again and again.
pub(super) struct Trail {
    path: PathBuf,
    looked: Option<Instant>,
    reading: Option<JoinHandle<Result<Vec<AuditEntry>, JournalError>>>,
}

impl Trail {
    pub(super) fn new(path: PathBuf) -> Self {
        Self { path, looked: None, reading: None }
    }

    /// Gives the board what was read, and begins to read where somebody looks.
    pub(super) fn turn(&mut self, board: &mut Board) {
        let read = self.reading.take_if(|reading| reading.is_finished()).map(JoinHandle::join);
        // What is wrong with the journal, whoever reads the past says. Until it is mended, what was read last stays.
        if let Some(Ok(Ok(entries))) = read {
            board.audited(entries.into_iter().map(told).collect());
        }
        if self.reading.is_none() && board.is_engineered() && is_due(&mut self.looked, LOOK) {
            let path = self.path.clone();
            let read = move || History::open_read_only(&path)?.newest_audit(NEWEST);
            // Without a thread it is read the next time.
            self.reading = Builder::new().name("trail".into()).spawn(read).ok();
        }
    }
}

/// An entry as the board shows it. Of an order, what became of it stands behind the first colon, as no name of a job has one.
fn told(entry: AuditEntry) -> Audited {
    let AuditEntry { utc_ns, kind, who, what } = entry;
    let parts = what.split_once(": ").filter(|_| kind == AuditKind::Task.name());
    let (what, became) =
        parts.map(|(what, became)| (what.to_owned(), became.to_owned())).unwrap_or((what, String::new()));
    Audited { utc_ns, kind, who, what, became }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_became_of_an_order_stands_apart_and_whatever_else_was_done_is_one_text() {
        let of = |kind: AuditKind, what: &str| {
            let (kind, what) = (kind.name().to_owned(), what.to_owned());
            let Audited { what, became, .. } =
                told(AuditEntry { utc_ns: 7, kind, who: "login eva".into(), what });
            [what, became]
        };
        let refused = "load polish: refused, because there is no job: polish";
        assert_eq!(of(AuditKind::Task, "load polish: done"), ["load polish", "done"]);
        assert_eq!(of(AuditKind::Task, refused)[1], "refused, because there is no job: polish");
        assert_eq!(of(AuditKind::Task, "markers"), ["markers", ""]);
        assert_eq!(of(AuditKind::Job, "job 3 refused: unknown"), ["job 3 refused: unknown", ""]);
    }
}
