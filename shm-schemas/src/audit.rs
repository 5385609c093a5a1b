//! Channel `audit`: who has changed what, for the journal.

use crate::code::codes;
use crate::layout::wire;
use crate::stamp::{Stamp, message};
use crate::text::{read_text, write_text};

codes! {
    /// What kind of thing was done.
    enum AuditKind: u8 {
        /// A client of the PLC's side has commanded something.
        Command = 1 as "command",
        /// The judge has loaded a job, or has refused one.
        Job = 2 as "job",
        /// The line runs with another configuration than before.
        Configuration = 3 as "configuration",
        /// The line runs with another program than before.
        Program = 4 as "program",
        /// A process has died.
        Death = 5 as "death",
        /// The journal's own file was replaced or restored.
        Journal = 6 as "journal",
        /// Recordings were removed by a person.
        Recording = 7 as "recording",
        /// A person has said whether a verdict was right.
        Confirmation = 8 as "confirmation",
        /// A login of the board was made, changed or removed.
        Login = 9 as "login",
        /// Somebody has let a command of `andond` run by a page of the board.
        Task = 10 as "task",
    }
}

wire! { "andon.Audit", 288;
    /// One thing that was done.
    struct Audit {
        /// The stamp. It belongs to no frame.
        stamp: Stamp,
        /// When, nanoseconds since 1970 UTC.
        utc_ns: u64,
        /// An [`AuditKind`]. Zero is none: an empty message says nothing.
        kind: u8,
        /// The [`crate::RoleId`] that tells it.
        role: u8,
        /// Keeps the size a multiple of 8.
        reserved: [u8; 6],
        /// Who did it, in UTF-8, with zeros behind it; in pieces, because only short arrays have a default.
        who: [[u8; 16]; 4],
        /// What was done, in UTF-8, with zeros behind it.
        what: [[u8; 8]; 21],
    }
}
message!(Audit);

impl Audit {
    /// Who did it.
    pub fn who(&self) -> &str {
        read_text(self.who.as_flattened())
    }

    /// What was done.
    pub fn what(&self) -> &str {
        read_text(self.what.as_flattened())
    }

    /// Says who did what; a text that is too long is cut.
    pub fn say(&mut self, who: &str, what: &str) {
        write_text(who, self.who.as_flattened_mut());
        write_text(what, self.what.as_flattened_mut());
    }
}
