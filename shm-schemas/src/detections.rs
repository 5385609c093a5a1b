//! Channel `detections`: the hands and objects of one frame.

use crate::layout::wire;
use crate::stamp::{Stamp, message};
use crate::{HANDS, OBJECTS, flag};

/// Landmarks of a hand, in the order of MediaPipe: 0 is the wrist. 8, 12 and 16 are the tips of index, middle and ring finger.
pub const LANDMARKS: usize = 21;

wire! { "andon.HandDetection", 428;
    /// A hand in one frame.
    struct HandDetection {
        /// Confidence of the detector, 0..1.
        score: f32,
        /// Landmarks in pixels of the colour picture, x right, y down.
        landmarks_px: [[f32; 2]; LANDMARKS],
        /// Landmarks in metres in the bench frame; NaN for those that could not be placed.
        landmarks_m: [[f32; 3]; LANDMARKS],
        /// A [`crate::HandCode`].
        hand: u8,
        /// Keeps the size a multiple of 4.
        reserved: [u8; 3],
    }
}

wire! { "andon.ObjectDetection", 68;
    /// An object in one frame.
    struct ObjectDetection {
        /// Identity, 1..=65535.
        id: u16,
        /// Bits of [`crate::flag`]: `SEEN`, `TWICE`.
        flags: u16,
        /// Confidence of the pose, 0..1.
        quality: f32,
        /// Origin of the object's frame in metres in the bench frame.
        position_m: [f32; 3],
        /// Unit quaternion (w, x, y, z), object frame to bench frame.
        orientation: [f32; 4],
        /// Corners of the marker in pixels of the colour picture. They mean nothing without `SEEN`.
        corners_px: [[f32; 2]; 4],
    }
}

wire! { "andon.Detections", 3096;
    /// What perception found in one frame.
    struct Detections {
        /// The stamp.
        stamp: Stamp,
        /// Source time in nanoseconds, as in [`crate::FrameHeader`].
        source_ns: u64,
        /// Bits of [`crate::flag`]: `END_OF_STREAM`, `PACED`.
        flags: u32,
        /// How many of `hands` are valid.
        hands_len: u32,
        /// How many of `objects` are valid.
        objects_len: u32,
        /// Hands, at most one per side.
        hands: [HandDetection; HANDS],
        /// Objects, at most one per id.
        objects: [ObjectDetection; OBJECTS],
        /// Keeps the size a multiple of 8.
        reserved: u32,
    }
}
message!(Detections);

impl Detections {
    /// The valid hands.
    pub fn hands(&self) -> &[HandDetection] {
        &self.hands[..(self.hands_len as usize).min(HANDS)]
    }

    /// The valid objects.
    pub fn objects(&self) -> &[ObjectDetection] {
        &self.objects[..(self.objects_len as usize).min(OBJECTS)]
    }

    /// The valid objects that were seen in this frame.
    pub fn seen_objects(&self) -> impl Iterator<Item = &ObjectDetection> {
        self.objects().iter().filter(|object| object.flags & flag::SEEN != 0)
    }
}
