//! Channel `command`: what the PLC or a person asks of the judge.

use crate::code::codes;
use crate::layout::{message, wire};
use crate::stamp::Stamp;

codes! {
    /// What is asked.
    enum CommandKind: u8 {
        /// Watch. Until then nothing is judged.
        Enable = 1,
        /// Stop watching; the running job is `NotJudged`.
        Disable = 2,
        /// Load the job `job_id`; `model_hash` 0 accepts any version of it.
        LoadJob = 3,
        /// The job begins now.
        Start = 4,
        /// The job ends now.
        Abort = 5,
        /// The verdict with `seq` = `argument` has been taken over.
        Acknowledge = 6,
        /// Leave the fault state.
        ResetError = 7,
    }
}

codes! {
    /// Who asks.
    enum CommandSource: u8 {
        /// The PLC.
        Plc = 1,
        /// A person, by the tool `andond`.
        Tool = 2,
    }
}

wire! { "andon.Command", 64;
    /// One command.
    struct Command {
        /// The stamp.
        stamp: Stamp,
        /// The version of the job, for `LoadJob`.
        model_hash: u64,
        /// What the kind says; otherwise 0.
        argument: u64,
        /// The job, for `LoadJob`.
        job_id: u32,
        /// A [`CommandKind`]. Zero is none: an empty message is no command.
        kind: u8,
        /// A [`CommandSource`].
        source: u8,
        /// Keeps the size a multiple of 8.
        reserved: [u8; 2],
    }
}
message!(Command);
