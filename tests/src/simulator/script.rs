//! What a person does, and what it means.

use super::Vector;
use super::bench::Pose;
use andon_core::couple::Context;
use andon_core::input::Side;

/// One action of a person.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Reaches for the part with this id and takes it.
    Take(u16),
    /// Brings the tip of the held part to the work point of another part.
    Bring {
        /// Id of the other part.
        to: u16,
        /// Direction in which the held part points and arrives, in radians in the frame of the other part.
        heading: f64,
        /// Distance that remains between tip and work point, in metres.
        gap_m: f64,
    },
    /// Pulls the held part away from the part that it touches, by this vector in metres in the frame of the held part.
    Pull(Vector),
    /// Moves the held part to this pose on the bench, where it can be released.
    Put(Pose),
    /// Rubs a part back and forth.
    Stroke {
        /// Id of the part that is rubbed.
        on: u16,
        /// Number of strokes, each back and forth.
        count: u32,
        /// Direction of the strokes in radians, in the frame of the part that is rubbed.
        along: f64,
    },
    /// Holds still for this time in seconds.
    Hold(f64),
    /// Stops in the middle of the next movement for this time in seconds.
    Hesitate(f64),
    /// Releases the held part.
    Release,
    /// Moves the hand to its rest position.
    Rest,
    /// Takes the hand out of the picture for this time in seconds.
    LeavePicture(f64),
    /// From here on, every action takes this multiple of its usual time.
    Tempo(f64),
}

/// What one hand does.
#[derive(Clone, Debug, PartialEq)]
pub struct Script {
    /// The hand.
    pub side: Side,
    /// Its actions in order.
    pub actions: Vec<Action>,
}

/// An IU that the script intends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrueIu {
    /// Its context.
    pub context: Context,
    /// The time in seconds at which the hand arrives or the parts meet, within about 0.3 s of the contact by distance.
    pub began_s: f64,
}

/// The contexts that a script intends, activity by activity. When a part is released while it touches another part, the context is
/// `[0, 0, j, l]` until the hand takes something else.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Labels {
    /// The IUs of each activity.
    pub activities: Vec<Vec<TrueIu>>,
}

impl Labels {
    /// The contexts of each activity, without the times.
    pub fn contexts(&self) -> Vec<Vec<Context>> {
        self.activities.iter().map(|ius| ius.iter().map(|iu| iu.context).collect()).collect()
    }
}
