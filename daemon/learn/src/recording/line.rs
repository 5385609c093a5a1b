//! The lines of a track file as they are on disk.

use super::Landmarks;
use andon_core::input::{Side, Space};
use serde::{Deserialize, Deserializer, Serialize};

pub(super) const FORMAT: &str = "andon.tracks";

pub(super) const VERSION: i64 = 1;

/// The part of the first line that every version has.
#[derive(Deserialize)]
pub(super) struct Magic {
    pub(super) format: String,
    pub(super) version: i64,
}

/// The names of [`Space`].
#[derive(Serialize, Deserialize)]
#[serde(remote = "Space", rename_all = "lowercase")]
pub(crate) enum SpaceName {
    Plane,
    Metric,
}

#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum HandName {
    Right,
    Left,
}

impl From<HandName> for Side {
    fn from(name: HandName) -> Self {
        match name {
            HandName::Right => Self::Right,
            HandName::Left => Self::Left,
        }
    }
}

impl From<Side> for HandName {
    fn from(side: Side) -> Self {
        match side {
            Side::Right => Self::Right,
            Side::Left => Self::Left,
        }
    }
}

#[derive(Serialize, Deserialize)]
pub(super) struct HeaderLine {
    pub(super) format: String,
    pub(super) version: i64,
    pub(super) rate_hz: f64,
    #[serde(with = "SpaceName")]
    pub(super) space: Space,
    #[serde(default = "all_landmarks")]
    pub(super) landmarks: u64,
    pub(super) hands: Vec<HandName>,
    pub(super) objects: Vec<HeaderObject>,
}

/// A header without this key has all landmarks.
fn all_landmarks() -> u64 {
    21
}

#[derive(Serialize, Deserialize)]
pub(super) struct HeaderObject {
    pub(super) id: u16,
    #[serde(default)]
    pub(super) name: String,
    #[serde(default = "centre")]
    pub(super) interaction_points: Vec<[f64; 3]>,
}

/// An object without points has one where it is, as in a station file: the runs show where it is touched.
fn centre() -> Vec<[f64; 3]> {
    vec![[0.0; 3]]
}

#[derive(Serialize, Deserialize)]
pub(super) struct FrameLine {
    pub(super) t: f64,
    #[serde(default)]
    pub(super) hands: Vec<HandEntry>,
    #[serde(default)]
    pub(super) objects: Vec<ObjectEntry>,
    /// Nobody was watching: only what a station recorded says so.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    pub(super) unseen: bool,
}

/// Numbers that a tracker writes `null` or NaN for, all of them or one, where it has not seen what they measure.
pub(super) type Numbers<const N: usize> = Option<[Option<f64>; N]>;

/// The numbers, if all of them are there.
pub(super) fn all<const N: usize>(numbers: &Numbers<N>) -> Option<[f64; N]> {
    let numbers = numbers.filter(|numbers| numbers.iter().all(Option::is_some))?;
    Some(numbers.map(Option::unwrap_or_default))
}

/// A gap is written as one: a key that is missing is a mistake.
fn required<'de, D: Deserializer<'de>, T: Deserialize<'de>>(from: D) -> Result<T, D::Error> {
    T::deserialize(from)
}

#[derive(Serialize, Deserialize)]
pub(super) struct HandEntry {
    pub(super) id: HandName,
    #[serde(default = "certain")]
    pub(super) score: f64,
    #[serde(deserialize_with = "required")]
    pub(super) landmarks: Option<Vec<Numbers<3>>>,
}

/// A hand without a score was detected with certainty.
fn certain() -> f64 {
    1.0
}

#[derive(Serialize, Deserialize)]
pub(super) struct ObjectEntry {
    pub(super) id: u16,
    #[serde(deserialize_with = "required")]
    pub(super) p: Numbers<3>,
    #[serde(deserialize_with = "required")]
    pub(super) q: Numbers<4>,
}

impl Landmarks {
    /// The number of landmarks of a hand.
    pub(super) const fn count(self) -> usize {
        match self {
            Self::All => 21,
            Self::Five => 5,
        }
    }

    /// The indices of wrist, middle knuckle, index tip, middle tip and ring tip in a hand's list.
    pub(super) const fn indices(self) -> [usize; 5] {
        match self {
            Self::All => [0, 9, 8, 12, 16],
            Self::Five => [0, 2, 1, 3, 4],
        }
    }
}
