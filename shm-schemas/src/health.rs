//! Channel `health`: how each role is doing. Its data loop sends it at 1 Hz or faster.

use crate::code::codes;
use crate::layout::wire;
use crate::stamp::{Stamp, message};

codes! {
    /// A role of `andond`. Each is one process.
    enum RoleId: u8 {
        /// Owns the services and removes dead nodes.
        Steward = 1 as "steward",
        /// From the camera or a recording to frames.
        Capture = 2 as "capture",
        /// From frames to detections.
        Perceive = 3 as "perceive",
        /// From detections to feature couples.
        Encode = 4 as "encode",
        /// From feature couples to verdicts.
        Judge = 5 as "judge",
        /// From verdicts to SQLite.
        Journal = 6 as "journal",
        /// From verdicts to the PLC.
        Plc = 7 as "plc",
        /// A tool that a person runs.
        Tool = 8 as "tool",
        /// From everything to numbers for a monitoring system.
        Metrics = 9 as "metrics",
        /// From everything to recordings.
        Record = 10 as "record",
        /// From everything to pages for people.
        Board = 11 as "board",
        /// From what an engineer orders on the board to commands of `andond`.
        Executor = 12 as "executor",
    }
}

impl RoleId {
    /// Whether it is no part of the way from a picture to its verdict, so that the line watches without it.
    pub const fn is_beside(self) -> bool {
        matches!(
            self,
            Self::Steward
                | Self::Journal
                | Self::Plc
                | Self::Metrics
                | Self::Record
                | Self::Board
                | Self::Executor
        )
    }
}

codes! {
    /// What a role is doing.
    enum RoleState: u8 {
        /// Not ready yet.
        Starting = 1,
        /// Data flows.
        Running = 2,
        /// It is ready, and nothing comes from the role before it.
        Waiting = 3,
        /// It runs, and something is wrong: see `last_error`.
        Fault = 4,
        /// The source has ended and everything that follows from it has been sent.
        Finished = 5,
    }
}

codes! {
    /// What the role perceive can see of its bench. Other roles leave it at 0.
    enum Sight: u8 {
        /// It sees what it should.
        Clear = 1,
        /// The picture does not change at all.
        Frozen = 2,
        /// The picture is black.
        Black = 3,
        /// The picture is white.
        White = 4,
        /// Something lies over the lens.
        Covered = 5,
        /// The picture has lost its sharp edges.
        Blurred = 6,
        /// There is too much noise in the picture.
        Noisy = 7,
        /// Too few of the camera's pictures are processed.
        TooFewFrames = 8,
        /// The station's markers are not in the picture, and hands work there, or other markers lie there.
        NoMarkers = 9,
        /// Parts move, and no hand is found.
        NoHands = 10,
        /// The camera has been moved.
        CameraMoved = 11,
    }
}

wire! { "andon.Health", 144;
    /// How a role is doing. Counts are since its start.
    struct Health {
        /// The stamp, with the newest frame that the role has processed.
        stamp: Stamp,
        /// Messages sent on the role's data channel.
        sent: u64,
        /// The epoch of the writer of that channel; 0 where it has sent nothing. With `sent`, which is then the newest `seq`,
        /// a reader knows what must have come.
        sent_epoch: u64,
        /// Messages received on the role's data channel.
        received: u64,
        /// Steps of its work: for `capture` and `perceive` one per frame. The message that ends a recording does not count.
        steps: u64,
        /// Messages that it did not get or skipped, by the gaps in `seq`, and frames that their source itself lost.
        losses: u64,
        /// Messages that it received and could not use.
        refused: u64,
        /// A hash of the configuration that the role runs with.
        configuration: u64,
        /// CLOCK_MONOTONIC since when `sight` is what it is; 0 where it says nothing.
        sight_since_ns: u64,
        /// Steps per second in the last period.
        rate_hz: f32,
        /// Age of the newest message when it was taken, microseconds.
        lateness_us: u32,
        /// Median time of a step over the last period, microseconds.
        p50_us: u32,
        /// 99th percentile of it, microseconds.
        p99_us: u32,
        /// The number in the code of the last error (`AND-104` is 104); 0 is none.
        last_error: u32,
        /// Process id.
        pid: u32,
        /// How often this role saw the writer before it start again.
        restarts_seen: u32,
        /// How long this role may give no sign of life, as the station is configured, milliseconds; 0 where it has no deadline.
        deadline_ms: u32,
        /// A [`RoleId`].
        role: u8,
        /// A [`RoleState`].
        state: u8,
        /// A [`Sight`], from the role perceive; 0 from others.
        sight: u8,
        /// Keeps the size a multiple of 8.
        reserved: [u8; 5],
    }
}
message!(Health);
