//! What a row of the journal says.

use shm_schemas::{RoleId, Sight, Verdict};

/// A row of the journal, in the order of writing.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// A verdict, as it was sent.
    Verdict(Box<Verdict>),
    /// Missing verdicts. Every query returns them, since any verdict may have been among them.
    Gap(Gap),
    /// A time in which the line did not see its bench. Every query returns them, since anything may have happened in it.
    NotWatching(NotWatching),
}

/// Verdicts that are not in the journal.
#[derive(Clone, Debug, PartialEq)]
pub struct Gap {
    /// When the first verdict after it was decided, nanoseconds since 1970 UTC.
    pub utc_ns: u64,
    /// `lost`: they never arrived, or the queue was full. `restart`: the judge has restarted, and verdicts from before may be
    /// missing. `retention`: they were removed because of their age or number. `removed`: the database was removed under its
    /// writer. `damaged`: it was damaged and put aside.
    pub why: String,
    /// Their epoch; for `retention` that of the newest.
    pub epoch: u64,
    /// Number of the first.
    pub first_seq: u64,
    /// Number of the last; `None` where it is unknown whether any is missing, or which.
    pub last_seq: Option<u64>,
}

/// A time in which the line did not watch, in nanoseconds since 1970 UTC.
#[derive(Clone, Debug, PartialEq)]
pub struct NotWatching {
    /// Its begin.
    pub began_utc_ns: u64,
    /// Its end; `None` while it lasts, and where nobody saw its end.
    pub ended_utc_ns: Option<u64>,
    /// A word of [`Sight`], or what was down.
    pub why: String,
}

impl NotWatching {
    /// Whether the line watched all the same: only a process beside the data path was down.
    pub fn is_beside(&self) -> bool {
        let role = self.why.strip_suffix(" was down");
        RoleId::ALL.iter().any(|of| of.is_beside() && role == Some(of.name()))
    }

    /// What was wrong, in a sentence; the word itself where this build does not know it.
    pub fn meaning(&self) -> &str {
        let sight = Sight::ALL.iter().find(|sight| sight.name() == self.why);
        sight.map_or(&self.why, |sight| sight.meaning())
    }
}
