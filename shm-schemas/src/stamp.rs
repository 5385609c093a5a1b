//! The stamp with which every message begins.

use crate::layout::wire;

wire! { "andon.Stamp", 40;
    /// Who sent a message and when, and from which frame it comes: enough for any reader to compute every latency and every loss.
    struct Stamp {
        /// The number of this message among those of its writer, from 1 in every epoch; 0 before it is sent.
        seq: u64,
        /// A number of its own for each start of the writer. When it changes, a reader starts to count again.
        epoch: u64,
        /// `seq` of the newest frame that this message depends on; 0 when it depends on none.
        frame_seq: u64,
        /// When that frame was captured, CLOCK_MONOTONIC in nanoseconds; 0 when it depends on none.
        captured_ns: u64,
        /// When this message was sent, CLOCK_MONOTONIC in nanoseconds.
        sent_ns: u64,
    }
}
