//! What every message begins with.

use crate::layout::wire;

wire! { "andon.Stamp", 40;
    /// Who sent a message when, and which frame it comes from: enough for any reader to compute every latency and every loss.
    struct Stamp {
        /// Number of this message among its writer's, from 1 in every epoch. 0: never sent.
        seq: u64,
        /// One per start of its writer. A reader starts counting anew when it changes.
        epoch: u64,
        /// `seq` of the newest frame that this message rests on; 0 where it rests on none.
        frame_seq: u64,
        /// When that frame was captured, CLOCK_MONOTONIC in nanoseconds; 0 where it rests on none.
        captured_ns: u64,
        /// When this message was sent, CLOCK_MONOTONIC in nanoseconds.
        sent_ns: u64,
    }
}
