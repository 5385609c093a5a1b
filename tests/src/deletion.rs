//! Observations deleted from a recording: what a camera, a detector or a busy machine may miss.

use crate::simulator::Random;
use andon_learn::recording::Recording;

/// What is deleted in a stretch of time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hidden {
    /// Both hands.
    Hands,
    /// The object with this index in the header.
    Object(usize),
    /// All objects.
    Objects,
    /// The frames themselves.
    Everything,
}

/// A deletion of observations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Deletion {
    /// Something is not seen from a time on, for so long, both in seconds.
    Stretch(Hidden, f64, f64),
    /// Only every so many frames come.
    Every(usize),
    /// Frames are lost at random, each with this probability.
    Lost(f64),
    /// The recording begins later, by so many seconds.
    Late(f64),
}

impl Deletion {
    /// Any deletion that a recording of this length in seconds and with so many objects can have.
    pub fn any(random: &mut Random, length_s: f64, objects: usize) -> Self {
        let hidden = match random.index(4) {
            0 => Hidden::Hands,
            1 => Hidden::Object(random.index(objects)),
            2 => Hidden::Objects,
            _ => Hidden::Everything,
        };
        match random.index(8) {
            0 => Self::Every(2 + random.index(7)),
            1 => Self::Lost(random.between(0.05, 0.95)),
            2 => Self::Late(random.between(0.0, length_s)),
            _ => Self::Stretch(hidden, random.between(0.0, length_s), random.between(0.03, 4.0)),
        }
    }

    /// What is left of a recording.
    #[must_use]
    pub fn of(self, recording: &Recording, random: &mut Random) -> Recording {
        let mut left = recording.clone();
        let objects = recording.header.shapes();
        let began_ns = left.frames.first().map_or(0, |frame| frame.captured_ns);
        let at_s = |captured_ns: u64| (captured_ns - began_ns) as f64 * 1e-9;
        match self {
            Self::Every(count) => {
                let mut index = 0;
                left.frames.retain(|_| {
                    index += 1;
                    (index - 1) % count == 0
                });
            }
            Self::Lost(share) => left.frames.retain(|_| random.uniform() >= share),
            Self::Late(seconds) => left.frames.retain(|frame| at_s(frame.captured_ns) >= seconds),
            Self::Stretch(hidden, from_s, seconds) => {
                let is_within = |captured_ns| (from_s..from_s + seconds).contains(&at_s(captured_ns));
                if hidden == Hidden::Everything {
                    left.frames.retain(|frame| !is_within(frame.captured_ns));
                }
                for frame in left.frames.iter_mut().filter(|frame| is_within(frame.captured_ns)) {
                    match hidden {
                        Hidden::Hands => frame.hands.clear(),
                        Hidden::Objects => frame.objects.clear(),
                        Hidden::Object(index) => {
                            frame.objects.retain(|object| object.id != objects[index].id)
                        }
                        Hidden::Everything => {}
                    }
                }
            }
        }
        left
    }
}

/// Recordings one after the other, with a pause of so many seconds without frames between them. The parts of the next piece then lie
/// where that recording has them.
pub fn one_after_the_other(recordings: &[&Recording], pause_s: f64) -> Recording {
    let mut all = recordings[0].clone();
    for recording in &recordings[1..] {
        let newest_ns = all.frames.last().map_or(0, |frame| frame.captured_ns);
        let first_ns = recording.frames.first().map_or(0, |frame| frame.captured_ns);
        let shift_ns = newest_ns + (pause_s * 1e9) as u64;
        for frame in &recording.frames {
            let mut frame = frame.clone();
            frame.captured_ns = frame.captured_ns - first_ns + shift_ns;
            all.frames.push(frame);
        }
    }
    all
}
