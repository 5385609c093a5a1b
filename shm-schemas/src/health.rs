//! Channel `health`: how each role is doing, at 1 Hz or faster from its data loop.

use crate::code::codes;
use crate::layout::{message, wire};
use crate::stamp::Stamp;

codes! {
    /// A role of `andond`, one process each.
    enum RoleId: u8 {
        /// Owns the services, removes dead nodes.
        Steward = 1,
        /// Frames in.
        Capture = 2,
        /// Frames to detections.
        Perceive = 3,
        /// Detections to feature couples.
        Encode = 4,
        /// Feature couples to verdicts.
        Judge = 5,
        /// Verdicts to SQLite.
        Journal = 6,
        /// Verdicts to the PLC.
        Plc = 7,
        /// The operator's display.
        Board = 8,
        /// A tool that a person runs.
        Tool = 9,
    }
}

codes! {
    /// What a role is doing.
    enum RoleState: u8 {
        /// Not ready yet.
        Starting = 1,
        /// Data flows.
        Running = 2,
        /// Ready, and nothing comes from the role before it.
        Waiting = 3,
        /// Running, and something is wrong: see `last_error`.
        Fault = 4,
        /// The source has ended and everything that follows from it has been sent.
        Finished = 5,
    }
}

wire! { "andon.Health", 112;
    /// How a role is doing. Counts are since its start.
    struct Health {
        /// The stamp; its frame is the newest one that the role has dealt with.
        stamp: Stamp,
        /// Messages sent on the role's data channel.
        sent: u64,
        /// Messages received on its data channel.
        received: u64,
        /// Messages that it did not receive: gaps in `seq`.
        losses: u64,
        /// Messages that it received and could not use.
        refused: u64,
        /// Steps a second over the last period.
        rate_hz: f32,
        /// Age of the newest message when it was taken, microseconds.
        lateness_us: u32,
        /// Median time of a step over the last period, microseconds.
        p50_us: u32,
        /// 99th percentile of it, microseconds.
        p99_us: u32,
        /// Number of the last error's code (`AND-104` is 104); 0 is none.
        last_error: u32,
        /// Process id.
        pid: u32,
        /// Resets of the writer before it in the chain, as seen by this role.
        restarts_seen: u32,
        /// A [`RoleId`].
        role: u8,
        /// A [`RoleState`].
        state: u8,
        /// Keeps the size a multiple of 8.
        reserved: [u8; 10],
    }
}
message!(Health);
