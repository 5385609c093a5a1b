//! The constants of the method. The caller reads them from its configuration; the defaults say why.

use crate::input::Space;

/// Contact by distance, with hysteresis: an edge begins under `on_m` and ends over `off_m` (DESIGN 4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// An edge begins when the least distance of two interaction points falls under this, in metres.
    pub on_m: f32,
    /// It ends when the distance rises over this, in metres; at least `on_m`.
    pub off_m: f32,
}

/// All constants of the method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Method {
    /// The coordinates that are used.
    pub space: Space,
    /// The grid: couples a second. Frames that are missing on it are filled by holding.
    pub rate_hz: f32,
    /// N, direction bins around the circle.
    pub bins: u8,
    /// Hand against object.
    pub hand_contact: Contact,
    /// Object against object.
    pub object_contact: Contact,
    /// Frames that a contact must hold before it is believed. Also the delay of the couples.
    pub persist_frames: u8,
    /// Under this speed a thing is at rest, in m/s.
    pub rest_speed_m_s: f32,
    /// Under this tangential acceleration the speed is constant, in m/s².
    pub dead_band_m_s2: f32,
    /// Window of the opening-closing filter on `x_m`, in frames, odd; 1 filters nothing.
    pub filter_frames: u8,
    /// What has not been seen for longer than this is not held any more, in milliseconds.
    pub blind_ms: u32,
    /// Without a hand for this long the job ends, in milliseconds.
    pub idle_end_ms: u32,
}

impl Default for Method {
    fn default() -> Self {
        Self {
            space: Space::Plane,
            rate_hz: 30.0,
            bins: 8,
            // A fingertip pad is 1 cm from its landmark, a grasp frame stands for some 4 cm of handle, and a
            // top view adds 1 cm of parallax: 3 cm is the sum of half of each.
            hand_contact: Contact { on_m: 0.030, off_m: 0.045 },
            object_contact: Contact { on_m: 0.030, off_m: 0.045 },
            persist_frames: 5,
            rest_speed_m_s: 0.03,
            dead_band_m_s2: 0.25,
            filter_frames: 5,
            blind_ms: 700,
            idle_end_ms: 4000,
        }
    }
}
