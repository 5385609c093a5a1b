//! What was seen in one picture, as far as the line's own sight is judged by it.

use crate::detections::{Detections, HANDS, LANDMARKS, OBJECTS, ObjectDetection};
use crate::picture::Picture;

/// The corners of a marker in pixels, in the order of its own picture.
pub type Corners = [[f32; 2]; 4];

/// A marker of the station in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenMarker {
    /// Its id.
    pub id: u16,
    /// Where it is.
    pub corners: Corners,
}

impl SeenMarker {
    /// Its centre in units of its own side.
    pub(super) fn place(&self) -> [f32; 2] {
        centre(&self.corners).map(|coordinate| coordinate / side(&self.corners))
    }
}

/// What was seen in one picture.
#[derive(Clone, Debug)]
pub struct Observation {
    /// When it was captured, in nanoseconds of the capturing clock.
    pub at_ns: u64,
    /// Pictures before this one that were not processed.
    pub dropped: u32,
    /// Measures of the picture.
    pub picture: Picture,
    /// The station's markers.
    pub markers: heapless::Vec<SeenMarker, OBJECTS>,
    /// Markers that are not the station's.
    pub foreign_markers: usize,
    /// Hands, wanted or not.
    pub hands: usize,
    /// The landmarks of those that are wanted, in pixels.
    pub hands_px: heapless::Vec<[[f32; 2]; LANDMARKS], HANDS>,
}

impl Observation {
    /// What the detections of a frame say. `dropped` are the frames before it that were not processed.
    pub fn new(seen: &Detections, dropped: u32) -> Self {
        let marker = |object: &ObjectDetection| SeenMarker { id: object.id, corners: object.corners_px };
        Self {
            at_ns: seen.captured_ns,
            dropped,
            picture: seen.picture,
            markers: seen.objects.iter().map(marker).collect(),
            foreign_markers: seen.foreign_markers,
            hands: seen.hands_in_view,
            hands_px: seen.hands.iter().map(|hand| hand.landmarks_px).collect(),
        }
    }
}

pub(super) fn distance(one: [f32; 2], other: [f32; 2]) -> f32 {
    (one[0] - other[0]).hypot(one[1] - other[1])
}

pub(super) fn side(corners: &Corners) -> f32 {
    distance(corners[0], corners[1]).max(1.0)
}

/// The diagonal's middle.
pub(super) fn centre(corners: &Corners) -> [f32; 2] {
    [0, 1].map(|axis| (corners[0][axis] + corners[2][axis]) / 2.0)
}
