//! Channel `confirmed`: which verdicts the journal has on disk.

use crate::layout::{message, wire};
use crate::stamp::Stamp;

wire! { "andon.Confirmed", 56;
    /// The journal has on disk every verdict of this epoch up to this one, or a row for the gap. It has also finished every earlier
    /// epoch.
    struct Confirmed {
        /// The stamp. It belongs to no frame.
        stamp: Stamp,
        /// The epoch of the judge that sent the verdict.
        verdict_epoch: u64,
        /// The verdict's `seq`.
        verdict_seq: u64,
    }
}
message!(Confirmed);
