//! Positions that are misread: a marker or a hand that is taken for another one is elsewhere from one frame to the next.

use crate::config::Method;
use crate::couple::geometry::{add, norm, subtract};
use crate::couple::poses::Source;
use crate::input::Point;

/// Nothing is accelerated so much by hand at a bench, in m/s²: a quick reach has 20 to 30.
const MAX_ACCELERATION_M_S2: f32 = 60.0;

/// The positions of hands and markers are as uncertain from one frame to the next, in metres.
const NOISE_M: f32 = 0.05;

/// Where something was when it was last believed to be seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct LastSeen {
    position: Point,
    /// How far it had moved in the frame before that.
    step: Point,
    /// Frames since then.
    unseen: u32,
}

impl LastSeen {
    /// From the position and its source in the newest frame and in the one before; `None` of what has never been seen.
    pub(super) fn new([newest, before]: [(Point, Source); 2], unseen: u32) -> Option<Self> {
        let is_step_seen = [newest, before].iter().all(|(_, source)| *source == Source::Seen);
        let step = if is_step_seen { subtract(newest.0, before.0) } else { [0.0; 3] };
        (newest.1 != Source::Never).then_some(Self { position: newest.0, step, unseen })
    }
}

/// What has leapt to where it is seen is not seen there unless it stays for as long as a change takes to be believed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Leap {
    /// Where it was seen in the newest frame if that was not believed, and how many frames in a row were not.
    newest: Point,
    frames: u8,
}

impl Leap {
    /// Whether to believe that something is seen here now.
    pub(super) fn believes(&mut self, last: &LastSeen, seen: Point, method: &Method) -> bool {
        let frames = last.unseen.saturating_add(1);
        // It rests or goes on as it moved, and was pushed meanwhile.
        let moved = last.step.map(|step| step * frames as f32);
        let ahead = [last.position, add(last.position, moved)];
        let is_reached = ahead.iter().any(|ahead| is_within_reach(*ahead, seen, frames, method));
        let stays = self.frames > 0 && is_within_reach(self.newest, seen, 1, method);
        let is_believed = is_reached && !stays || self.frames >= method.persist_frames;
        *self = if is_believed { Self::default() } else { Self { newest: seen, frames: self.frames + 1 } };
        is_believed
    }
}

fn is_within_reach(from: Point, to: Point, frames: u32, method: &Method) -> bool {
    let elapsed_s = frames as f32 / method.rate_hz;
    norm(subtract(to, from)) <= f32::max(NOISE_M, MAX_ACCELERATION_M_S2 * elapsed_s * elapsed_s)
}
