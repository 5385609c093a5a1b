//! Channel `confirmed`: what the journal has on disk.

use crate::layout::{message, wire};
use crate::stamp::Stamp;

wire! { "andon.Confirmed", 56;
    /// The journal has every verdict of this epoch up to this one on disk, or a row for the gap; and it is through with
    /// every earlier epoch.
    struct Confirmed {
        /// The stamp. It rests on no frame.
        stamp: Stamp,
        /// The epoch of the judge that sent the verdict.
        verdict_epoch: u64,
        /// The verdict's `seq`.
        verdict_seq: u64,
    }
}
message!(Confirmed);
