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
    /// Places are in another unit than metres: the median length of a hand in the file, and the unit that makes a hand of it.
    #[error(
        "a hand is {0:.1} long, from its wrist to the tip of its middle finger: places are in metres, and these seem to be in {1}"
    )]
    Lengths(f64, &'static str),
    /// A point of an object is metres away from it.
    #[error(
        "an interaction point of object {0} lies {1} from it: points are in metres, as places are: 100 mm is 0.1"
    )]
    FarPoint(u16, f64),
    /// Times are in another unit than seconds. It has the median step, and the rate of the header with its step. It has the unit, and how many of
    /// them a second has.
    #[error(
        "t goes on by {0} from frame to frame, and at rate_hz {1} it should by {2:.4}: t is in seconds, and this seems to be in \
         {3}; divide it by {4}"
    )]
    Times(f64, f64, f64, &'static str, f64),
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
    /// The number of this key is out of this range.
    #[error("{0} is {1}; it must be in {2}")]
    Range(&'static str, f64, &'static str),
    /// `t` is not greater than in the previous frame, both in seconds.
    #[error("t is {0} s after {1} s in the previous frame; t must increase")]
    Time(f64, f64),
    /// A hand has another number of landmarks than the header promises.
    #[error("a hand has {0} landmarks; the header promises {1}")]
    Landmarks(usize, usize),
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
    /// The object with this id has no interaction point, or too many of them.
    #[error("object {0} has {1} interaction points; it must have 1 to {INTERACTION_POINTS}")]
    InteractionPoints(u16, usize),
    /// There are more "objects" or "hands" than the method can follow.
    #[error("there are {1} {0}; at most {OBJECTS} objects and {HANDS} hands can be followed")]
    Full(&'static str, usize),
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
