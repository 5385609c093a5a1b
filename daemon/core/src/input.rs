//! What was seen in one frame, in the bench frame: metres, x right, y away from the worker, z up.

use crate::capacity::{HANDS, INTERACTION_POINTS, OBJECTS};
use heapless::Vec;

/// A point or a vector in metres.
pub type Point = [f32; 3];

/// Which hand. Its number is `ID_h` in the context features.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// The right hand, `ID_h` = 1.
    Right = 1,
    /// The left hand, `ID_h` = 2.
    Left = 2,
}

impl Side {
    /// Both hands, in the order that they have wherever there is one item a hand.
    pub const ALL: [Self; HANDS] = [Self::Right, Self::Left];

    /// The place of this hand in [`ALL`](Self::ALL).
    pub fn place(self) -> usize {
        match self {
            Self::Right => 0,
            Self::Left => 1,
        }
    }
}

/// The coordinates that are used (DESIGN 4, "Spaces").
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// In the plane of the bench: z and tilt are ignored, there is no elevation (the paper's 2-D set-up).
    Plane,
    /// Right-handed bench frame with z up; elevation is used.
    Metric,
}

/// The five landmarks of a hand that the method uses, in metres in the bench frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hand {
    /// Which hand.
    pub side: Side,
    /// Confidence of the detector, 0..1.
    pub score: f32,
    /// Landmark 0.
    pub wrist: Point,
    /// Landmark 9, where velocity and acceleration of the hand are measured (paper III-A.1).
    pub middle_knuckle: Point,
    /// Landmarks 8, 12 and 16: the interaction points of the hand (paper III-A.1).
    pub tips: [Point; 3],
}

/// Where an object is in this frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Object {
    /// Identity, 1..=65535.
    pub id: u16,
    /// Origin of the object's frame in metres in the bench frame.
    pub position: Point,
    /// Unit quaternion (w, x, y, z), object frame to bench frame. In plane mode only its turn about z counts.
    pub orientation: [f32; 4],
}

/// All that was seen in one frame. What was not seen is left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// When the frame was captured, in nanoseconds of the capturing clock.
    pub captured_ns: u64,
    /// The hands seen, at most one per side.
    pub hands: Vec<Hand, HANDS>,
    /// The objects seen, at most one per id.
    pub objects: Vec<Object, OBJECTS>,
}

/// What is known of an object before it is seen: its identity and where it can be touched.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectShape {
    /// Identity, 1..=65535.
    pub id: u16,
    /// Interaction points in metres in the object's frame.
    pub interaction_points: Vec<Point, INTERACTION_POINTS>,
}
