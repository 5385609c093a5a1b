//! Recordings: what was detected, frame by frame, kept in a track file.
//!
//! A track file (`.tracks.jsonl`) has one JSON object per line: a header, then one line per frame in the order of time. [`read`] is a pure function
//! of the bytes; it refuses what it cannot trust and names the file and the line. What other trackers write is read where it is certain what it
//! means. Such are `null` or NaN for what was not seen, times since 1970, other line ends, a byte order mark. Other units and another order of a
//! quaternion are refused by their names.
//!
//! ```
//! let text = concat!(
//!     r#"{"format": "andon.tracks", "version": 1, "rate_hz": 30.0, "space": "plane", "hands": ["right"], "objects": []}"#,
//!     "\n", r#"{"t": 0.0, "hands": [], "objects": []}"#, "\n");
//! let recording = andon_learn::recording::read("empty.tracks.jsonl", text.as_bytes())?;
//! assert_eq!(recording.frames.len(), 1);
//! # Ok::<(), andon_learn::recording::TrackError>(())
//! ```

mod convention;
mod line;
mod reader;
mod repeats;
mod writer;

pub(crate) use line::SpaceName;
pub use reader::{TrackError, TrackReader, Truncation, read};
pub use repeats::SeenTracks;
pub use writer::{TrackWriter, write};

use andon_core::input::{Frame, Side, Space};
use andon_core::object::ObjectShape;

/// Which landmarks of a hand a track file has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Landmarks {
    /// All 21, in MediaPipe's order.
    All,
    /// Five: wrist, index tip, middle knuckle, middle tip, ring tip.
    Five,
}

/// An object that may appear in a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedObject {
    /// The name that people use for it.
    pub name: String,
    /// Its id, and its interaction points in metres in the object's own frame.
    pub shape: ObjectShape,
}

/// The shapes of objects without their names, as the encoder needs them.
pub(crate) fn shapes(objects: &[NamedObject]) -> Vec<ObjectShape> {
    objects.iter().map(|object| object.shape.clone()).collect()
}

/// What a person calls an object: its name in this list, or its id if the list does not have it.
pub fn object_name(objects: &[NamedObject], id: u16) -> String {
    objects
        .iter()
        .find(|object| object.shape.id == id)
        .map_or_else(|| format!("object {id}"), |object| object.name.clone())
}

/// The number of the person whom the name of a recording begins with, such as `p3_none_r1` or `subject3_run1`.
pub fn person_of(file: &str) -> Option<u32> {
    let (person, _) = file.split_once('_')?;
    let words = ["person", "subject", "worker", "p"];
    words.iter().find_map(|word| person.strip_prefix(word)?.parse().ok())
}

/// The names of the pairs of these objects that come near each other by chance only. So a contact between them does not count.
pub fn incidental_pairs(objects: &[NamedObject]) -> Vec<[String; 2]> {
    let of = |object: &NamedObject| -> Vec<[String; 2]> {
        let others = object.shape.incidental.iter();
        others.map(|other| [object.name.clone(), object_name(objects, *other)]).collect()
    };
    objects.iter().flat_map(of).collect()
}

/// The first line of a track file.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Nominal frame rate.
    pub rate_hz: f32,
    /// The space that the coordinates are in.
    pub space: Space,
    /// Every hand that may appear.
    pub hands: Vec<Side>,
    /// The landmarks that each hand has.
    pub landmarks: Landmarks,
    /// Every object that may appear.
    pub objects: Vec<NamedObject>,
}

impl Header {
    /// The shapes without the names, as the encoder needs them.
    pub fn shapes(&self) -> Vec<ObjectShape> {
        shapes(&self.objects)
    }
}

/// A whole recording in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// What is known before the first frame.
    pub header: Header,
    /// The frames in the order of time.
    pub frames: Vec<Frame>,
    /// Where the file was cut off, if it was.
    pub truncation: Option<Truncation>,
}
