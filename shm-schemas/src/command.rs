//! Channel `command`: what the PLC, or a person or scanner by `andond part` and `andond use`, asks of the judge.

use crate::code::codes;
use crate::layout::wire;
use crate::part::PartId;
use crate::stamp::{Stamp, message};

codes! {
    /// What is asked.
    enum CommandKind: u8 {
        /// Watch. Until then nothing is judged.
        Enable = 1,
        /// Stop watching; the running job is not judged.
        Disable = 2,
        /// Load the job `job_id`; `model_hash` 0 accepts any version of it.
        LoadJob = 3,
        /// A job begins now.
        Start = 4,
        /// The running job ends now.
        Abort = 5,
        /// The jobs that begin from now on are done to `part`.
        SetPart = 6,
    }
}

codes! {
    /// Who asks.
    enum CommandSource: u8 {
        /// The PLC.
        Plc = 1 as "plc",
        /// A person or a scanner, by a command of `andond`.
        Tool = 2 as "tool",
    }
}

wire! { "andon.Command", 96;
    /// One command.
    struct Command {
        /// The stamp.
        stamp: Stamp,
        /// A number that no other command has. The judge does nothing twice, and names it in its answer.
        number: u64,
        /// The version of the job, for `LoadJob`.
        model_hash: u64,
        /// The job, for `LoadJob`.
        job_id: u32,
        /// A [`CommandKind`]. Zero is none: an empty message is not a command.
        kind: u8,
        /// A [`CommandSource`].
        source: u8,
        /// Keeps the size a multiple of 8.
        reserved: [u8; 2],
        /// The part id, for `SetPart`.
        part: PartId,
    }
}
message!(Command);
