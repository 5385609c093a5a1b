//! What was seen in one frame, in the bench frame: metres, x to the right, y away from the worker, z up.

use crate::capacity::{HANDS, OBJECTS};
use heapless::Vec;

/// A point or a vector in metres.
pub type Point = [f32; 3];

/// Whether a point can be on a bench: finite, and within a kilometre, so that no square of it overflows.
pub fn is_on_bench(point: Point) -> bool {
    point.iter().all(|value| value.abs() < 1000.0)
}

/// Which hand. Its number is `ID_h` in the context features.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// The right hand, `ID_h` = 1.
    Right = 1,
    /// The left hand, `ID_h` = 2.
    Left = 2,
}

impl Side {
    /// Both hands, in the order of every array with one item per hand.
    pub const ALL: [Self; HANDS] = [Self::Right, Self::Left];

    /// The other hand.
    pub const fn other(self) -> Self {
        Self::ALL[1 - self.index()]
    }

    /// The index of this hand in [`ALL`](Self::ALL).
    pub const fn index(self) -> usize {
        self as usize - 1
    }

    /// `right` or `left`: how people, files and programs outside name this hand.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Left => "left",
        }
    }
}

/// Which coordinates are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// The plane of the bench: z and tilt are ignored and there is no elevation (the paper's 2-D set-up).
    Plane,
    /// The right-handed bench frame with z up, and elevation.
    Metric,
}

impl Space {
    /// Both spaces.
    pub const ALL: [Self; 2] = [Self::Plane, Self::Metric];

    /// `plane` or `metric`: how people and files name it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Plane => "plane",
            Self::Metric => "metric",
        }
    }

    /// A point as far as it counts: in the plane without z.
    pub const fn flat(self, [x, y, z]: Point) -> Point {
        match self {
            Self::Plane => [x, y, 0.0],
            Self::Metric => [x, y, z],
        }
    }
}

/// The five landmarks of a hand that the method uses, in metres in the bench frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hand {
    /// Which hand.
    pub side: Side,
    /// Confidence of the detector, 0 to 1.
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
    /// Its id, 1 to 65535.
    pub id: u16,
    /// Origin of the object's frame in metres in the bench frame.
    pub position: Point,
    /// Unit quaternion (w, x, y, z) from the object's frame to the bench frame. In plane mode only its rotation about z counts.
    pub orientation: [f32; 4],
}

/// Everything that was seen in one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// When the frame was captured, in nanoseconds of the capturing clock.
    pub captured_ns: u64,
    /// The hands seen, at most one per side.
    pub hands: Vec<Hand, HANDS>,
    /// The objects seen, at most one per id.
    pub objects: Vec<Object, OBJECTS>,
    /// Nobody was watching when it was captured, as where the picture is black or stands still: it counts as a frame that never came.
    pub is_unseen: bool,
    /// The ids of what is not among the objects because its marker is in view twice. Nobody knows which of the two lies on it.
    pub twice: Vec<u16, OBJECTS>,
}
