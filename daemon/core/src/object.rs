//! What is known of an object before it is seen: its interaction points, and what the runs of a job have shown of it.

use crate::bounds::Around;
use crate::capacity::{CONTACT_REGIONS, INTERACTION_POINTS, OBJECTS};
use crate::config::Contact;
use crate::input::Point;
use heapless::Vec;

/// No finger tip is farther from the middle of what it carries, in metres. Halved, 55 of 3,700 drawn streams differ. Doubled, it is 42,
/// and what a hand is said to carry from afar fails 2 tests.
pub const REACH_M: f32 = 0.3;

/// The width of a hand, in metres. Nobody holds an object farther from where others do, or from where the station says. A shorter path has no
/// direction, and nobody notices a way that is less straight by this. Halved or doubled, 6 or 2 of 975 runs of people are judged otherwise.
pub const HAND_WIDTH_M: f32 = 0.1;

/// What is known of an object before it is seen: its id and where it can be touched.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjectShape {
    /// Its id, 1 to 65535.
    pub id: u16,
    /// Interaction points in metres in the object's frame.
    pub interaction_points: Vec<Point, INTERACTION_POINTS>,
    /// Where and how near runs have shown it to be met; else at its interaction points, as [`Method`](crate::config::Method) says.
    pub contact_regions: Vec<ContactRegion, CONTACT_REGIONS>,
    /// The ids of the objects with which it has no contact, however near they come: the runs of the job agree only without it. It is enough if one of
    /// the two names the other.
    pub incidental: Vec<u16, OBJECTS>,
    /// Its orientation means nothing, as that of a round part, and counts as that of the bench.
    pub is_position_only: bool,
    /// Where its position is in metres in the bench frame at the beginning of a job, in plane mode without z. The runs have shown it to lie there, and
    /// nowhere near it afterwards.
    pub start: Option<Around<3>>,
}

impl ObjectShape {
    /// Whether it is known where it is touched: it has an interaction point beside its origin.
    pub fn has_points(&self) -> bool {
        self.interaction_points.iter().any(|point| *point != [0.0; 3])
    }
}

/// Where and how near a hand or another object meets an object.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactRegion {
    /// The id of the other object, or [`ContactRegion::HAND`].
    pub with: u16,
    /// Where the finger tips, or the other object, then are, in metres in the frame of this one. Empty: at the interaction points.
    pub points: Vec<Point, INTERACTION_POINTS>,
    /// How near they come to these.
    pub contact: Contact,
}

impl ContactRegion {
    /// Either hand, instead of an object. No object has this id.
    pub const HAND: u16 = 0;
}
