//! What was seen in one frame.

use crate::held::PlacedObject;
use heapless::Vec;

/// Hands in one frame: one worker, two hands.
pub const HANDS: usize = 2;

/// Landmarks of a hand, in MediaPipe's order: 0 wrist, 1-4 thumb, 5-8 index, 9-12 middle, 13-16 ring, 17-20 little finger.
pub const LANDMARKS: usize = 21;

/// Objects in one frame: what a bench of 1.5 m holds with a marker each.
pub const OBJECTS: usize = 32;

/// Which hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// The worker's right hand.
    Right,
    /// The worker's left hand.
    Left,
}

impl Side {
    /// The other hand.
    pub fn other(self) -> Self {
        match self {
            Self::Right => Self::Left,
            Self::Left => Self::Right,
        }
    }
}

/// A hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandDetection {
    /// Which hand.
    pub side: Side,
    /// Confidence that it is a hand, 0..1.
    pub score: f32,
    /// Landmarks in pixels.
    pub landmarks_px: [[f32; 2]; LANDMARKS],
    /// The hand's shape as the hand model guesses it: metres around the middle of a hand of average size, x right and
    /// y down in the picture, z away from the camera.
    pub shape_m: [[f32; 3]; LANDMARKS],
    /// Landmarks in metres in the bench frame; NaN while no marker has told the scale yet.
    pub landmarks_m: [[f32; 2]; LANDMARKS],
}

/// An object, seen by its marker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectDetection {
    /// The marker's id, which is the object's.
    pub id: u16,
    /// Corners of the marker in pixels: top left, top right, bottom right, bottom left of the marker's own picture.
    pub corners_px: [[f32; 2]; 4],
    /// Centre of the marker in metres in the bench frame; z is 0 in plane mode.
    pub position_m: [f32; 3],
    /// Unit quaternion (w, x, y, z), marker frame to bench frame; in plane mode a turn about z.
    pub orientation: [f32; 4],
    /// How well the marker's outline was seen, 0..1: the share of its four edges that were found sharp in the picture.
    pub quality: f32,
}

/// What else there is to know of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flags {
    /// Palm detection ran on this frame.
    pub palm_detection_ran: bool,
    /// Frames were missing before this one: hands were looked for anew.
    pub after_gap: bool,
    /// No marker has told the scale yet: positions in metres of hands are NaN.
    pub no_scale: bool,
}

/// Where the time went, in nanoseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spent {
    /// Palm detection.
    pub palm_ns: u64,
    /// Landmarks of all hands.
    pub landmarks_ns: u64,
    /// Markers.
    pub markers_ns: u64,
}

/// What was seen in one frame. What was not seen is left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Detections {
    /// Number of the frame, from its writer.
    pub frame_seq: u64,
    /// When the frame was captured, in nanoseconds of the capturing clock.
    pub captured_ns: u64,
    /// At most one a side, only the sides that are wanted.
    pub hands: Vec<HandDetection, HANDS>,
    /// At most one an id, only ids that are configured, in order of their ids.
    pub objects: Vec<ObjectDetection, OBJECTS>,
    /// Carried objects whose markers are hidden, placed by the motion of the hand: none of them is in `objects`.
    pub held: Vec<PlacedObject, OBJECTS>,
    /// What else there is to know.
    pub flags: Flags,
    /// Where the time went.
    pub spent: Spent,
}
