//! Couples in, the beginnings and ends of ERUs, IUs, activities and jobs out (paper III-B).

mod filter;
mod hand;
mod job;
mod measures;
mod way;

pub use hand::Segmenter;
pub use job::JobSegmenter;
pub(crate) use measures::{FRAMES_PER_REVERSAL, HIDDEN_SLACK, WORLDS};
pub use measures::{MOVED_M, Measures};

use crate::couple::{Context, Motion};
use crate::input::Side;

/// An Interaction Unit (IU) that has ended: the time in which the context of a hand is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Iu {
    /// Its context.
    pub context: Context,
    /// When its context began, in nanoseconds.
    pub began_ns: u64,
    /// When the next context began, in nanoseconds.
    pub ended_ns: u64,
    /// Its length in frames of the grid.
    pub frames: u32,
    /// In how many of them the hand waited for the other one ([`Waiting::Yes`](crate::couple::Waiting)).
    pub waited: u32,
    /// In how many of them its motion was measured.
    pub measured: u32,
    /// In how many of them the hand and each object of its context were seen.
    pub seen: u32,
    /// What was measured of it in metres.
    pub measures: Measures,
    /// The same if in each gap its motion went on at its pace before it came back.
    pub measures_at_pace: Measures,
    /// Whether all its couples were in sight ([`Couple::is_in_sight`](crate::couple::Couple::is_in_sight)).
    pub is_in_sight: bool,
}

/// How a job began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Start {
    /// With a touch, and some of it may have happened before that.
    #[default]
    Unseen,
    /// With the first touch after a pause in which nothing moved, so that nothing of it can have happened before.
    Seen,
    /// On command, so that nothing of it counts that happened before.
    Commanded,
}

/// An event of the segmentation. Times are those of the couples (`captured_ns`). Ends are exclusive: what follows begins there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A job began, with its first touch or on command.
    JobBegan {
        /// When, in nanoseconds.
        began_ns: u64,
        /// How it began.
        start: Start,
        /// Since when an unseen hand had worked before, if nobody has been told, at this job or at a piece before it.
        unseen_since_ns: Option<u64>,
    },
    /// Something happened to what this hand does.
    Hand(Side, HandEvent),
    /// A job ended.
    JobEnded {
        /// When, in nanoseconds.
        began_ns: u64,
        /// When its last IU ended, in nanoseconds.
        ended_ns: u64,
    },
}

/// An event of the segmentation of one hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HandEvent {
    /// An activity began: the hand touches another object.
    ActivityBegan {
        /// The context of its first IU.
        context: Context,
        /// When, in nanoseconds.
        began_ns: u64,
    },
    /// An IU began.
    IuBegan {
        /// Its context.
        context: Context,
        /// When, in nanoseconds.
        began_ns: u64,
    },
    /// The IU that was interrupted last goes on: the hand has taken again what it had let go of.
    IuResumed,
    /// The next frame of the IU has left the opening-closing filter, which delays it by some frames.
    IuFrame {
        /// Its filtered motion.
        motion: Motion,
        /// Its time, in nanoseconds.
        captured_ns: u64,
    },
    /// As many frames of the IU come next of which no motion could be measured.
    IuUnmeasured(u32),
    /// An ERU ended: `X`, after the filter, was constant in it.
    Eru {
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
    IuEnded(Iu),
    /// An activity ended.
    ActivityEnded {
        /// The context of its first IU.
        context: Context,
        /// When its first IU began, in nanoseconds.
        began_ns: u64,
        /// When its last IU ended, in nanoseconds.
        ended_ns: u64,
    },
}
