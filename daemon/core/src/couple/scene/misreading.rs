//! Positions that are misread: a marker or a hand that is taken for another one is elsewhere from one frame to the next. Two markers that are taken
//! for each other would make every path too long.

use crate::config::Method;
use crate::couple::geometry::{add, distance, subtract};
use crate::couple::poses::{Fix, Source};
use crate::input::Point;

/// Nothing is accelerated so much by hand at a bench, in m/s²: a quick reach has 20 to 30. Halved or doubled, none of 975 runs of people is judged
/// otherwise.
const MAX_ACCELERATION_M_S2: f32 = 60.0;

/// The positions of hands and markers are as uncertain from one frame to the next, in metres. With less than 35 frames per second the
/// acceleration alone allows more. Markers side by side are farther apart. Halved or doubled, 11 or 21 of 3,700 drawn streams differ.
const NOISE_M: f32 = 0.05;

/// What has jumped to where it is seen counts as unseen, unless it stays for as long as a change takes to be believed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Misreading {
    /// Where it was seen last if that was not believed, and how many frames in a row were not.
    newest: Point,
    frames: u8,
}

impl Misreading {
    /// Whether to believe that what was here in the newest frame and in the one before is seen there now.
    pub(super) fn believes(&mut self, fixes: [Fix; 2], seen: Point, method: &Method) -> bool {
        let [newest, _] = fixes;
        if newest.source == Source::Never {
            return true;
        }
        let is_reached = is_reached(fixes, seen, newest.unseen.saturating_add(1), method);
        let stays = self.frames > 0 && distance(self.newest, seen) <= reach_m(1, method);
        let is_believed = is_reached && !stays || self.frames >= method.persist_frames;
        *self = if is_believed { Self::default() } else { Self { newest: seen, frames: self.frames + 1 } };
        is_believed
    }
}

/// Whether something that was at these two fixes may now be at `seen`, if it has been pushed for this many frames.
pub(super) fn is_reached(fixes: [Fix; 2], seen: Point, pushed: u32, method: &Method) -> bool {
    off_course_m(fixes, seen) <= reach_m(pushed, method)
}

/// How far in metres what was here is from where it would be if it rested or moved on, whichever is nearer.
pub(super) fn off_course_m([newest, before]: [Fix; 2], seen: Point) -> f32 {
    let (from, frames) = (newest.place, newest.unseen.saturating_add(1));
    // What was not seen before the newest frame is kept where it was seen last, and has come from there since.
    let is_step_seen = newest.source == Source::Seen && matches!(before.source, Source::Seen | Source::Kept);
    let step = if is_step_seen {
        let since = before.unseen.saturating_add(1) as f32;
        subtract(from, before.place).map(|way| way / since)
    } else {
        [0.0; 3]
    };
    let ahead = [from, add(from, step.map(|step| step * frames as f32))];
    ahead.iter().map(|ahead| distance(*ahead, seen)).fold(f32::INFINITY, f32::min)
}

/// How far what is pushed for as many frames comes off its course, in metres.
fn reach_m(frames: u32, method: &Method) -> f32 {
    let elapsed_s = frames as f32 / method.rate_hz;
    f32::max(NOISE_M, MAX_ACCELERATION_M_S2 * elapsed_s * elapsed_s)
}
