//! The detections of one frame.

use crate::picture::Picture;
use heapless::Vec;

/// Maximum number of hands in a frame: those of one worker.
pub const HANDS: usize = 2;

/// Landmarks of a hand, in MediaPipe's order: 0 wrist, 1-4 thumb, 5-8 index, 9-12 middle, 13-16 ring, 17-20 little finger.
pub const LANDMARKS: usize = 21;

/// Maximum number of objects in a frame: more do not fit on a bench of 1.5 m with a marker each.
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
    pub(crate) fn other(self) -> Self {
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
    /// The hand's shape as the hand model guesses it, in metres around the middle of a hand of average size. x points right and y down in the
    /// picture, z away from the camera.
    pub shape_m: [[f32; 3]; LANDMARKS],
    /// Landmarks in metres in the bench frame; NaN until a marker has given the scale.
    pub landmarks_m: [[f32; 2]; LANDMARKS],
}

/// An object that was detected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectDetection {
    /// The object's id.
    pub id: u16,
    /// Corners of its marker, or of its outline, in pixels: top left, top right, bottom right, bottom left of its own picture.
    pub corners_px: [[f32; 2]; 4],
    /// Centre of the marker in metres in the bench frame; z is 0 in plane mode.
    pub position_m: [f32; 3],
    /// Unit quaternion (w, x, y, z), marker frame to bench frame; in plane mode a turn about z.
    pub orientation: [f32; 4],
    /// How well the marker's outline was seen, 0..1: the share of its four edges that were found sharp in the picture.
    pub quality: f32,
}

/// How long the parts of perception took, in nanoseconds; 0 for a part that did not run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timings {
    /// Palm detection.
    pub palm_ns: u64,
    /// Landmarks of all hands.
    pub landmarks_ns: u64,
    /// Markers.
    pub markers_ns: u64,
}

/// The detections of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Detections {
    /// When the frame was captured, in nanoseconds of the capturing clock.
    pub captured_ns: u64,
    /// At most one hand per side, and only the sides that are wanted.
    pub hands: Vec<HandDetection, HANDS>,
    /// At most one object per id, and only configured ids, in order of their ids.
    pub objects: Vec<ObjectDetection, OBJECTS>,
    /// Configured ids that are in view twice. None of them is in `objects`.
    pub twice: Vec<u16, OBJECTS>,
    /// Hands in the picture, wanted or not.
    pub hands_in_view: usize,
    /// Markers in the picture that belong to no configured object. They have another id or, while none of the configured ones has been seen, another
    /// dictionary.
    pub foreign_markers: usize,
    /// How well the picture can be seen.
    pub picture: Picture,
    /// How long it took. The measurement of perception's accuracy reads it.
    pub timings: Timings,
}
