//! Channel `audit`: who has changed what, for the journal.

use crate::code::codes;
use crate::layout::wire;
use crate::stamp::{Stamp, message};

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

/// Writes as much of a text as fits, and never half a character.
fn write_text(text: &str, to: &mut [u8]) {
    let end = text.char_indices().map(|(at, c)| at + c.len_utf8()).take_while(|end| *end <= to.len()).last();
    to.fill(0);
    let bytes = text.as_bytes().get(..end.unwrap_or(0)).unwrap_or_default();
    for (to, from) in to.iter_mut().zip(bytes) {
        *to = *from;
    }
}

/// The text up to its zeros; empty where it is not UTF-8.
fn read_text(from: &[u8]) -> &str {
    let text = from.split(|&byte| byte == 0).next().unwrap_or_default();
    core::str::from_utf8(text).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_that_is_too_long_ends_at_a_whole_character() {
        let mut bytes = [7; 4];
        write_text("aüß", &mut bytes);
        assert_eq!(read_text(&bytes), "aü");
        write_text("", &mut bytes);
        assert_eq!(read_text(&bytes), "");
    }
}
