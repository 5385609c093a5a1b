//! Why a track file was refused.

use andon_core::capacity::{HANDS, INTERACTION_POINTS, OBJECTS};

/// A track file was refused: which file, which line, why.
#[derive(Debug, thiserror::Error)]
#[error("{file}, line {line}: {fault}")]
pub struct TrackError {
    /// The file as the caller named it.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
    /// What is wrong there.
    pub fault: TrackFault,
}

/// What is wrong with a line of a track file, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum TrackFault {
    /// There is no line at all, or only a part of the first.
    #[error(
        "there is no header; the first line must be {{\"format\": \"andon.tracks\", \"version\": 1, ...}}"
    )]
    NoHeader,
    /// The first line is of another format.
    #[error("the format is {0:?}, not \"andon.tracks\"")]
    Format(String),
    /// The first line is of another version.
    #[error("version {0} of the track format is not known; this program reads version 1")]
    Version(i64),
    /// The line is no JSON object of the right shape.
    #[error("{0}")]
    Json(#[from] serde_json::Error),
    /// The line is longer than any frame can be.
    #[error("the line is longer than {0} bytes")]
    LongLine(usize),
    /// Reading the file failed.
    #[error("reading failed: {0}")]
    Io(#[from] std::io::Error),
    /// A number is infinite, or too large for a coordinate.
    #[error("{0} is not a finite number of a sensible size")]
    NotFinite(&'static str),
    /// A number of the header is out of its range.
    #[error("{name} is {value}; it must be in {range}")]
    Range {
        /// The key.
        name: &'static str,
        /// What it is.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// `t` is not greater than that of the frame before.
    #[error("t is {t} s and the frame before had {before} s; t must increase")]
    Time {
        /// Of this line.
        t: f64,
        /// Of the line before.
        before: f64,
    },
    /// A hand has a wrong number of landmarks.
    #[error("a hand has {found} landmarks; the header promises {expected}")]
    Landmarks {
        /// What the line has.
        found: usize,
        /// What the header says.
        expected: usize,
    },
    /// The header asks for a number of landmarks that has no meaning.
    #[error("\"landmarks\" is {0}; it must be 21 or 5")]
    LandmarkCount(u64),
    /// An object that the header lacks.
    #[error("object {0} is not in the header")]
    UnknownObject(u16),
    /// A hand that the header lacks.
    #[error("the {0} hand is not in the header")]
    UnknownHand(&'static str),
    /// The same id, or the same hand, twice in one line.
    #[error("{0} is there twice")]
    Twice(String),
    /// An object has no id, or 0.
    #[error("an object has id 0; ids are 1 to 65535")]
    ZeroId,
    /// An object has no interaction point, or too many.
    #[error("object {id} has {found} interaction points; it must have 1 to {INTERACTION_POINTS}")]
    InteractionPoints {
        /// The object.
        id: u16,
        /// How many it has.
        found: usize,
    },
    /// More objects or hands than the method can hold.
    #[error("there are {found} {what}; at most {OBJECTS} objects and {HANDS} hands can be followed")]
    Full {
        /// Objects or hands.
        what: &'static str,
        /// How many there are.
        found: usize,
    },
    /// A quaternion that is no rotation.
    #[error("q of object {0} has length {1}; a rotation is a unit quaternion [w, x, y, z]")]
    Quaternion(u16, f32),
}
