//! Why a track file was refused.

use crate::file::NotText;
use andon_core::capacity::{HANDS, INTERACTION_POINTS, OBJECTS};

/// A track file was refused.
#[derive(Debug, thiserror::Error)]
#[error("{file}, line {line}: {fault}")]
pub struct TrackError {
    /// The file's name as the caller gave it.
    pub file: String,
    /// The number of the line, from 1.
    pub line: usize,
    /// What is wrong with it.
    pub fault: TrackFault,
}

/// What is wrong with a line of a track file.
#[derive(Debug, thiserror::Error)]
pub enum TrackFault {
    /// There is nothing in the file.
    #[error("the file is empty")]
    Empty,
    /// The file is text in another encoding, or no text.
    #[error("{0}")]
    NotText(#[from] NotText),
    /// There is no line at all, or only a part of the first one.
    #[error(
        "the header is missing; the first line must be {{\"format\": \"andon.tracks\", \"version\": 1, ...}}"
    )]
    NoHeader,
    /// The first line is no header, and it shows what other kind of text the file is.
    #[error("{0}")]
    OtherText(&'static str),
    /// Another header comes after frames.
    #[error("another recording begins here: give each of them as a file of its own")]
    SecondHeader,
    /// A header and nothing more.
    #[error(
        "no frame comes after the header, so there is nothing to judge: was the recording stopped at once?"
    )]
    NoFrames,
    /// The file has another format.
    #[error("the format is {0:?}, not \"andon.tracks\"")]
    Format(String),
    /// The file has another version of the format.
    #[error("version {0} of the track format is unknown; this program reads version 1")]
    Version(i64),
    /// The line is not a JSON object of the expected shape.
    #[error("{}", without_its_line(.0))]
    Json(#[from] serde_json::Error),
    /// The line is longer than any frame can make it.
    #[error("the line is longer than {0} bytes")]
    LongLine(usize),
    /// The file cannot be read.
    #[error("the file cannot be read: {0}")]
    Io(#[from] std::io::Error),
    /// A number is infinite, or too large for a coordinate.
    #[error("{0} is infinite or larger than any bench; places are in metres: 100 mm is 0.1")]
    NotFinite(&'static str),
    /// A word stands where a number is expected.
    #[error(
        "{0} is no place; write null, or leave the part or the hand out of a frame in which it is not seen"
    )]
    Infinite(&'static str),
    /// Places are in another unit than metres: that of the hands, by the length of a hand.
    #[error(
        "a hand is {length:.1} long, from its wrist to the tip of its middle finger: places are in metres, and these seem to be in {unit}"
    )]
    Lengths {
        /// The median length of a hand, as the file has it.
        length: f64,
        /// The unit that makes a hand of it, and how it is converted.
        unit: &'static str,
    },
    /// A point of an object is metres away from it.
    #[error(
        "an interaction point of object {0} lies {1} from it: points are in metres, as places are: 100 mm is 0.1"
    )]
    FarPoint(u16, f64),
    /// Times are in another unit than seconds, by the rate of the header.
    #[error(
        "t goes on by {step} from frame to frame, and at rate_hz {rate_hz} it should by {expected:.4}: t is in seconds, and this seems to be in \
         {unit}; divide it by {factor}"
    )]
    Times {
        /// The median step.
        step: f64,
        /// The rate of the header.
        rate_hz: f64,
        /// The step at that rate.
        expected: f64,
        /// The unit that makes this rate of it.
        unit: &'static str,
        /// How many of them a second has.
        factor: f64,
    },
    /// Quaternions have their real part last.
    #[error(
        "q of object {0} and of all others turns about no axis that a part on a bench turns about, unless its numbers stand in the order x, y, z, \
         w; here it is [w, x, y, z]: put the last one first"
    )]
    RealPartLast(u16),
    /// Everything lies on one line of the plane.
    #[error(
        "all hands and parts have the same y, {0}, and their z differ: in space \"plane\" the bench is x and y, and these places seem to have their \
         height second; write [x, z, y], and turn q likewise"
    )]
    HeightSecond(f64),
    /// A number is out of its range.
    #[error("{name} is {value}; it must be in {range}")]
    Range {
        /// The key.
        name: &'static str,
        /// The value.
        value: f64,
        /// The values that are allowed.
        range: &'static str,
    },
    /// `t` is not greater than in the previous frame.
    #[error("t is {t} s after {before} s in the previous frame; t must increase")]
    Time {
        /// `t` of this line, in seconds.
        t: f64,
        /// `t` of the previous frame, in seconds.
        before: f64,
    },
    /// A hand has a wrong number of landmarks.
    #[error("a hand has {found} landmarks; the header promises {expected}")]
    Landmarks {
        /// The number in this line.
        found: usize,
        /// The number in the header.
        expected: usize,
    },
    /// The header has a number of landmarks other than 21 and 5.
    #[error("\"landmarks\" is {0}; it must be 21 or 5")]
    LandmarkCount(u64),
    /// The object is not in the header.
    #[error("object {0} is not in the header")]
    UnknownObject(u16),
    /// The hand is not in the header.
    #[error("the {0} hand is not in the header")]
    UnknownHand(&'static str),
    /// The same id, or the same hand, occurs twice in one line.
    #[error("{0} occurs twice")]
    Twice(String),
    /// An object has id 0.
    #[error("an object has id 0; ids are 1 to 65535")]
    ZeroId,
    /// An object has no interaction point, or too many of them.
    #[error("object {id} has {found} interaction points; it must have 1 to {INTERACTION_POINTS}")]
    InteractionPoints {
        /// The object's id.
        id: u16,
        /// The number of its interaction points.
        found: usize,
    },
    /// There are more objects or hands than the method can follow.
    #[error("there are {found} {what}; at most {OBJECTS} objects and {HANDS} hands can be followed")]
    Full {
        /// "objects" or "hands".
        what: &'static str,
        /// Their number.
        found: usize,
    },
    /// A quaternion is not a rotation: object and length.
    #[error("q of object {0} has length {1}; a rotation is a unit quaternion [w, x, y, z]")]
    Quaternion(u16, f32),
}

/// What is wrong with a line, which is all that the parser was given: only the column of its place says something.
fn without_its_line(error: &serde_json::Error) -> String {
    let text = error.to_string();
    match text.rsplit_once(" at line 1 column ") {
        Some((what, column)) => format!("{what}, at column {column}"),
        None => text,
    }
}
