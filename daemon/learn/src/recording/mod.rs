//! Recordings: what was seen, frame by frame, kept in a track file.
//!
//! A track file (`.tracks.jsonl`) is one JSON object a line: a header, then one line a frame in time order.
//! [`read`] is a pure function over bytes; it refuses what it cannot trust and says in which file and line.
//!
//! ```
//! let text = concat!(
//!     r#"{"format": "andon.tracks", "version": 1, "rate_hz": 30.0, "space": "plane", "hands": ["right"], "objects": []}"#,
//!     "\n", r#"{"t": 0.0, "hands": [], "objects": []}"#, "\n");
//! let recording = andon_learn::recording::read("empty.tracks.jsonl", text.as_bytes())?;
//! assert_eq!(recording.frames.len(), 1);
//! # Ok::<(), andon_learn::recording::TrackError>(())
//! ```

mod error;
mod line;
mod reader;
mod writer;

pub use error::{TrackError, TrackFault};
pub use reader::{TrackReader, Truncation, read};
pub use writer::{TrackWriter, write};

use andon_core::input::{Frame, ObjectShape, Side, Space};

/// How many landmarks of a hand a track file gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Landmarks {
    /// All 21, in the order of MediaPipe.
    All,
    /// Wrist, index tip, middle knuckle, middle tip, ring tip.
    Five,
}

/// An object that may appear in a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedObject {
    /// What a person calls it.
    pub name: String,
    /// Its identity and where it can be touched.
    pub shape: ObjectShape,
}

/// The first line of a track file.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Nominal frame rate.
    pub rate_hz: f32,
    /// The coordinates that are used.
    pub space: Space,
    /// Every hand that may appear.
    pub hands: Vec<Side>,
    /// How many landmarks each hand has.
    pub landmarks: Landmarks,
    /// Every object that may appear.
    pub objects: Vec<NamedObject>,
}

impl Header {
    /// The shapes alone, as the encoder takes them.
    pub fn shapes(&self) -> Vec<ObjectShape> {
        self.objects.iter().map(|object| object.shape.clone()).collect()
    }
}

/// A whole recording in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// What is known before the first frame.
    pub header: Header,
    /// Its frames in time order.
    pub frames: Vec<Frame>,
    /// Set when the file ends in mid-line.
    pub truncation: Option<Truncation>,
}
