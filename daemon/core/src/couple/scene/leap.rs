//! Positions that are misread: a marker or a hand that is taken for another one is elsewhere within a frame.

use crate::config::Method;

/// Nothing on a bench is moved by hand at such a speed, in m/s: a throw is slower.
const MAX_SPEED_M_S: f32 = 6.0;

/// The way from where something was last seen to where it is seen now.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// Its length in metres.
    pub(super) path_m: f32,
    /// Frames since it was last believed to be seen.
    pub(super) unseen: u32,
}

/// What has leapt to where it is seen is not seen there until it stays away for as long as a change takes to be believed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Leap {
    /// In how many frames since it was last believed to be seen it was somewhere else.
    frames: u32,
}

impl Leap {
    /// Whether something can have come this way, or has stayed where it has leapt to.
    pub(super) fn allows(&mut self, way: Way, method: &Method) -> bool {
        // It had no time to move while it was seen elsewhere.
        let frames = way.unseen.saturating_add(1).saturating_sub(self.frames).max(1);
        let is_reached = way.path_m * method.rate_hz <= MAX_SPEED_M_S * frames as f32;
        let is_believed = is_reached || self.frames >= method.persist_frames.into();
        self.frames = if is_believed { 0 } else { self.frames + 1 };
        is_believed
    }
}
