//! Channel `command`: what the PLC asks of the judge.

use crate::code::codes;
use crate::layout::{message, wire};
use crate::stamp::Stamp;

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
    }
}

wire! { "andon.Command", 64;
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
        /// A [`CommandKind`]. Zero is none: an empty message is no command.
        kind: u8,
        /// Keeps the size a multiple of 8.
        reserved: [u8; 3],
    }
}
message!(Command);
