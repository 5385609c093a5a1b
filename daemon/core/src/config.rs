//! The constants of the method. The caller reads them from its configuration; reasons stand beside the defaults.
//!
//! Beside many constants of this crate stands how many of 3,700 drawn streams differ where one is changed alone. Of these 700 are of any couples, 2,500
//! of scripted work with faults and gaps, and 500 of frames with gaps and noise. A stream differs if a verdict does, or a couple that is made of frames.

use crate::capacity::{FILTER_FRAMES, PERSIST_FRAMES};
use crate::input::Space;

/// Contact by distance with hysteresis: an edge begins below `on_m` and ends above `off_m`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// An edge begins when the minimum distance of two interaction points falls below this, in metres.
    pub on_m: f32,
    /// It ends when the distance rises above this, in metres; at least `on_m`.
    pub off_m: f32,
}

impl Contact {
    /// Whether an edge can begin and end by it.
    pub fn is_valid(&self) -> bool {
        self.on_m > 0.0 && self.off_m >= self.on_m && self.off_m < f32::INFINITY
    }
}

/// All constants of the method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Method {
    /// Which coordinates are used.
    pub space: Space,
    /// The grid: couples per second. Frames that are missing on it are filled by holding the last poses.
    pub rate_hz: f32,
    /// N, the number of direction bins around the circle.
    pub bins: u8,
    /// Contact of a hand with an object.
    pub hand_contact: Contact,
    /// Contact of an object with an object.
    pub object_contact: Contact,
    /// Frames that a contact must last before it is believed. Also the delay of the couples.
    pub persist_frames: u8,
    /// Below this speed a hand or object is at rest, in m/s.
    pub rest_speed_m_s: f32,
    /// Below this tangential acceleration the speed is constant, in m/s².
    pub dead_band_m_s2: f32,
    /// Window of the opening-closing filter on `x_m`, an odd number of frames; 1 filters nothing.
    pub filter_frames: u8,
    /// A hand or object that has not been seen for longer than this is out of sight, in milliseconds.
    pub blind_ms: u32,
    /// A pause: no hand has been seen for this long, in milliseconds. See [`JobSegmenter`](crate::segment::JobSegmenter).
    pub idle_end_ms: u32,
}

impl Default for Method {
    fn default() -> Self {
        Self {
            space: Space::Plane,
            // As most cameras have.
            rate_hz: 30.0,
            // Four directions and those between them. With 4 or 16, every stream of frames differs, and 3 tests fail.
            bins: 8,
            // A fingertip pad is 1 cm from its landmark, and a grasp frame stands for about 4 cm of handle. A top view adds 1 cm of parallax. 3 cm is
            // half of their sum.
            hand_contact: Contact { on_m: 0.030, off_m: 0.045 },
            object_contact: Contact { on_m: 0.030, off_m: 0.045 },
            // With 3 or 7, 554 or 574 of the drawn streams differ, and 21 or 17 tests of the method fail.
            persist_frames: 5,
            // Halved or doubled, every stream of frames differs, and 2 tests or 1 fail.
            rest_speed_m_s: 0.03,
            // Halved or doubled, 490 or all of the 500 streams of frames differ, and no test fails.
            dead_band_m_s2: 0.25,
            // Quick strokes to and fro change the sign of their acceleration every fourth frame: five would take that away from the quick only.
            filter_frames: 3,
            // Halved or doubled, 344 or 300 of the drawn streams differ, and 11 or 7 tests of the method fail.
            blind_ms: 700,
            // Halved or doubled, 66 or 46 of the drawn streams differ, and 3 or 4 tests fail.
            idle_end_ms: 4000,
        }
    }
}

/// A constant of the method is out of its range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{key} is out of its range: it must be {allowed}")]
pub struct MethodFault {
    /// The name of the constant, as in [`Method`].
    pub key: &'static str,
    /// What is allowed.
    pub allowed: &'static str,
}

impl Method {
    /// The time from one frame of the grid to the next, in nanoseconds.
    pub fn period_ns(&self) -> u64 {
        // The rate is at least 1 Hz.
        libm::round(1e9 / f64::from(self.rate_hz)) as u64
    }

    /// Checks that every constant is in its range.
    ///
    /// # Errors
    /// The first constant that is not.
    pub fn check(&self) -> Result<(), MethodFault> {
        let from_zero = |value: f32| (0.0..f32::INFINITY).contains(&value);
        let [persist, filter] = [self.persist_frames, self.filter_frames].map(usize::from);
        let checks = [
            // 240 Hz is the fastest rate of the cameras and motion capture systems that fit a bench.
            ((1.0..=240.0).contains(&self.rate_hz), "rate_hz", "1 to 240"),
            // A quarter turn must be at least one whole bin; a motion is stored as `i8`.
            ((4..=120).contains(&self.bins), "bins", "4 to 120"),
            (self.hand_contact.is_valid(), "hand_contact", "0 < on_m <= off_m, in metres"),
            (self.object_contact.is_valid(), "object_contact", "0 < on_m <= off_m, in metres"),
            ((1..=PERSIST_FRAMES).contains(&persist), "persist_frames", "1 to 15 frames"),
            (from_zero(self.rest_speed_m_s), "rest_speed_m_s", "0 or more, in m/s"),
            (from_zero(self.dead_band_m_s2), "dead_band_m_s2", "0 or more, in m/s²"),
            (filter % 2 == 1 && filter <= FILTER_FRAMES, "filter_frames", "odd, 1 to 31 frames"),
            // This also bounds how many couples one step may emit.
            (self.blind_ms <= 60_000, "blind_ms", "at most 60000 ms"),
            // Ten minutes, as in the configuration of a station: nobody waits longer for the end of a job.
            (self.idle_end_ms <= 600_000, "idle_end_ms", "at most 600000 ms"),
        ];
        match checks.into_iter().find(|(right, ..)| !right) {
            Some((_, key, allowed)) => Err(MethodFault { key, allowed }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pause_of_more_than_ten_minutes_is_refused() {
        let with = |idle_end_ms| Method { idle_end_ms, ..Method::default() }.check();
        assert_eq!(with(600_000), Ok(()));
        assert_eq!(with(600_001).map_err(|fault| fault.key), Err("idle_end_ms"));
    }
}
