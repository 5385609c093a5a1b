//! Couples in, ERU, IU, activity and job events out (paper III-B; DESIGN 4, "Segmentation").

mod filter;
mod hand;
mod job;
mod reversals;

pub use hand::Segmenter;
pub use job::JobSegmenter;

use crate::couple::{Context, Motion};
use crate::input::Side;

/// One Interaction Unit that has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Iu {
    /// The context that it was in.
    pub context: Context,
    /// When its context began, in nanoseconds.
    pub began_ns: u64,
    /// When the next context began, in nanoseconds.
    pub ended_ns: u64,
    /// Its length in frames of the grid.
    pub frames: u32,
    /// How often its motion turned back: by more than a quarter turn from the direction that it held, rest ignored. It tells a
    /// repeated motion (polishing strokes) that was cut short.
    pub reversals: u32,
    /// False where a couple of it was not sighted.
    pub sighted: bool,
}

/// What the segmenter says. Times are those of the couples (`captured_ns`), ends are exclusive: what follows begins there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A job began: the first touch, or the command.
    JobBegan {
        /// When, in nanoseconds.
        began_ns: u64,
    },
    /// An activity began: the hand touches a new object.
    ActivityBegan {
        /// Whose.
        side: Side,
        /// The context of its first IU.
        context: Context,
        /// When, in nanoseconds.
        began_ns: u64,
    },
    /// An IU began.
    IuBegan {
        /// Whose.
        side: Side,
        /// Its context.
        context: Context,
        /// When, in nanoseconds.
        began_ns: u64,
    },
    /// The next frame of the IU after the opening-closing filter, some frames late.
    IuFrame {
        /// Whose.
        side: Side,
        /// Its filtered motion.
        motion: Motion,
        /// Its time, in nanoseconds.
        captured_ns: u64,
        /// How often the motion of the IU has turned back so far.
        reversals: u32,
    },
    /// An ERU ended: `X` (after the filter) was constant in it.
    Eru {
        /// Whose.
        side: Side,
        /// Its context.
        context: Context,
        /// Its motion.
        motion: Motion,
        /// When it began, in nanoseconds.
        began_ns: u64,
        /// When the next one began, in nanoseconds.
        ended_ns: u64,
    },
    /// An IU ended.
    IuEnded {
        /// Whose.
        side: Side,
        /// What it was.
        iu: Iu,
    },
    /// An activity ended.
    ActivityEnded {
        /// Whose.
        side: Side,
        /// The context of its first IU.
        context: Context,
        /// When its first IU began, in nanoseconds.
        began_ns: u64,
        /// When its last IU ended, in nanoseconds.
        ended_ns: u64,
    },
    /// A job ended.
    JobEnded {
        /// When, in nanoseconds.
        began_ns: u64,
        /// When its last IU ended, in nanoseconds.
        ended_ns: u64,
    },
}
