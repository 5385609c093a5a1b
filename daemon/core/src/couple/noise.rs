//! The noise of positions, from the positions themselves: a displacement within the noise is no motion.
//!
//! Jitter differs from frame to frame, and shows in third differences. Drift is correlated over frames. It shows in how far a part seems to move while
//! all hands are seen and none acts on anything. Constants would fit one tracker only. With errors of 2.5 mm, 624 of 672 right jobs of two hands are
//! right; with constants none was.

use super::geometry::{dot, squared_distance};
use crate::capacity::PERSIST_FRAMES;
use crate::input::Point;
use heapless::Vec;

/// A movement shorter than this is none, in metres: above the noise of landmarks and markers, and below the strokes of a tool. Halved, 9 fewer of 435
/// right runs of people are accepted, and doubled 4. Doubled, 11 fewer of 540 faults are found.
pub const MOVED_M: f32 = 0.015;

/// Whether what was at one of two places and is at the other one has moved.
pub(super) fn has_moved(from: Point, to: Point) -> bool {
    squared_distance(from, to) > MOVED_M * MOVED_M
}

/// Two positions of an object at rest are hardly ever farther apart than this multiple of the standard deviation of one. In the plane that is once in
/// 270,000 times if the deviation is known. As it is estimated here, that is once in some thousand times.
const NOISE_BOUND_SIGMAS: f32 = 5.0;

/// The variance of a third difference, as a multiple of that of a position: 1 + 9 + 9 + 1.
const THIRD_DIFFERENCE_VARIANCE: f32 = 20.0;

/// Squares of third differences are clipped at this multiple of their median: of errors one in 500 exceeds it. Halved or doubled, 1 or none of 975
/// runs of people is judged otherwise.
const CLIP_AT_MEDIANS: f32 = 9.0;

/// Fewer third differences tell nothing: one position that is misread is in four.
const MIN_DIFFERENCES: usize = 4;

/// The maximum number that is used, the first ones: room for those of all frames that are remembered.
const MAX_DIFFERENCES: usize = 2 * PERSIST_FRAMES;

/// Fewer frames tell nothing of the drift. At most the second number is remembered: 10 s of the default frame rate. The first one halved or doubled, 9
/// or 17 of 3,700 drawn streams differ; with the second one none does.
const MIN_DRIFT_FRAMES: u16 = 10;
const MAX_DRIFT_FRAMES: u16 = 300;

/// A few frames hold few independent errors of a drift. In this many its variance counts as twice as large, or as half as large where it is asked
/// whether something moves. Halved or doubled, 271 of 3,700 drawn streams differ, those that have noise.
const UNCERTAIN_FRAMES: f32 = 30.0;

/// More than this is motion, not drift, in metres, while a change is believed and while the hands rest. A tracker that drifts more cannot resolve a
/// contact. Halved, 153 of 3,700 drawn streams differ, and 41 doubled.
pub(super) const MAX_DRIFT_M: f32 = 0.03;

/// Squares of the drift are clipped at this multiple of their mean. In the plane one in 8,000 exceeds it, and so does a part that is moved unseen.
/// Halved, doubled or without it, none of 975 runs of people is judged otherwise.
const CLIP_AT_MEANS: f32 = 9.0;

/// The bound of how far apart jitter lets two positions of an object at rest seem, in metres. It comes from these `positions`, one per frame, and is 0
/// where too few in a row are known to tell.
///
/// In third differences the motion of a hand leaves next to nothing: two strokes of 7 cm per second leave 0.2 mm. One position that is misread is in
/// four of them, which count no more than large errors do.
pub fn jitter_bound_m(positions: impl Iterator<Item = Option<Point>>) -> f32 {
    let mut squares: Vec<f32, MAX_DIFFERENCES> = Vec::new();
    // The newest three, the newest first.
    let mut before = [None; 3];
    for position in positions {
        if let (Some(fourth), [Some(third), Some(second), Some(first)]) = (position, before) {
            let [first, second, third, fourth]: [Point; 4] = [first, second, third, fourth];
            let difference =
                [0, 1, 2].map(|axis| fourth[axis] - first[axis] + 3.0 * (second[axis] - third[axis]));
            let square = dot(difference, difference);
            // What is exactly where it was is the same measurement once more. There is room for all of a window; of more, the first tell as much.
            if square > 0.0 {
                let _ = squares.push(square);
            }
        }
        before = [position, before[0], before[1]];
    }
    if squares.len() < MIN_DIFFERENCES {
        return 0.0;
    }
    let middle = (squares.len() - 1) / 2;
    let max = CLIP_AT_MEDIANS * *squares.select_nth_unstable_by(middle, f32::total_cmp).1;
    let mean = squares.iter().map(|square| square.min(max)).sum::<f32>() / squares.len() as f32;
    NOISE_BOUND_SIGMAS * libm::sqrtf(mean / THIRD_DIFFERENCE_VARIANCE)
}

/// How far something that nobody acts on seems to move while a change is believed. Most trackers filter, so that their errors are correlated, and
/// third differences show little of them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Drift {
    known: MeanSquare,
    /// What was known when the hands came to rest; `None` once an unseen hand has moved it since then, which may work with it until they rest again.
    before: Option<MeanSquare>,
    /// Where it lay first since then.
    lay: Option<Point>,
}

/// The mean of squared distances, and of how many.
#[derive(Clone, Copy, Debug, Default)]
struct MeanSquare {
    mean: f32,
    count: u16,
}

impl Drift {
    /// The hands have come to rest: what is known so far counts, unless too little was seen to tell whether it is motion.
    pub(super) fn begin(&mut self) {
        if self.known.count < MIN_DRIFT_FRAMES {
            self.known = MeanSquare::default();
        }
        (self.before, self.lay) = (Some(self.known), None);
    }

    /// Takes where it seems to be `now`, and to have been `persist_frames` `before`. If a hand has been seen by then, it rests.
    pub(super) fn push(&mut self, now: Point, before: Point, has_seen_hand: bool) {
        let Some(known_before) = self.before else { return };
        let lay = *self.lay.get_or_insert(before);
        let is_away = |at: Point| squared_distance(at, lay) > MAX_DRIFT_M * MAX_DRIFT_M;
        self.known.push(squared_distance(now, before));
        // One position that is misread says nothing. Hands that nobody has seen may make strokes about where it lay.
        if is_away(now) && is_away(before) || !has_seen_hand && self.known.is_motion() {
            // A hand moves it that is not seen, and did so perhaps from the beginning.
            (self.known, self.before) = (known_before, None);
        }
    }

    /// As [`jitter_bound_m`]; `None` where it has not been seen to lie still for long enough.
    pub(super) fn bound_m(&self) -> Option<f32> {
        self.known.bound_m()
    }
}

impl MeanSquare {
    fn bound_m(self) -> Option<f32> {
        let is_known = self.count >= MIN_DRIFT_FRAMES;
        is_known.then(|| self.apart_m(self.uncertainty()).min(MAX_DRIFT_M))
    }

    /// Whether it is more than any drift.
    fn is_motion(self) -> bool {
        self.count >= MIN_DRIFT_FRAMES && self.apart_m(1.0 / self.uncertainty()) > MAX_DRIFT_M
    }

    /// How far apart two positions are if the variance is such a multiple of what it seems.
    fn apart_m(self, multiple: f32) -> f32 {
        // Two positions have their errors.
        NOISE_BOUND_SIGMAS * libm::sqrtf(self.mean / 2.0 * multiple)
    }

    /// How much larger the variance may be than it seems.
    fn uncertainty(self) -> f32 {
        1.0 + UNCERTAIN_FRAMES / f32::from(self.count)
    }

    fn push(&mut self, square: f32) {
        // What is exactly where it was is the same measurement once more.
        if square > 0.0 {
            let is_known = self.count >= MIN_DRIFT_FRAMES;
            let square = if is_known { square.min(CLIP_AT_MEANS * self.mean) } else { square };
            self.count = (self.count + 1).min(MAX_DRIFT_FRAMES);
            self.mean += (square - self.mean) / f32::from(self.count);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of positions on a line that are given for each frame.
    fn along(position: impl Fn(i32) -> f32) -> f32 {
        jitter_bound_m((0..2 * PERSIST_FRAMES as i32).map(|frame| Some([position(frame), 0.0, 0.0])))
    }

    /// Each frame has an error of its own, of a standard deviation of 1 mm.
    fn error(frame: i32) -> f32 {
        0.001 * libm::sqrtf(2.0) * libm::sinf((frame * frame) as f32)
    }

    #[test]
    fn errors_are_seen_in_what_lies_still_and_motion_is_not_taken_for_errors() {
        // Two strokes of 7 cm per second.
        let stroke = |frame: i32| 0.035 * libm::sinf(frame as f32 * 4.0 * core::f32::consts::PI / 30.0);
        let last = 2 * PERSIST_FRAMES as i32 - 10;
        for (what, bound_m, expected_m) in [
            ("still", along(error), 0.004..0.0065),
            ("strokes", along(stroke), 0.0..0.004),
            ("strokes with errors", along(|frame| stroke(frame) + error(frame)), 0.004..0.009),
            // What is repeated is one measurement.
            ("repeated", along(|frame| error(frame.max(last))), 0.004..0.0065),
        ] {
            assert!(expected_m.contains(&bound_m), "{what}: {bound_m}");
        }
        let seen = |frame: i32| (frame % 4 > 0).then_some([(frame % 3) as f32, 0.0, 0.0]);
        assert_eq!(jitter_bound_m((0..100).map(seen)), 0.0, "every fourth frame is missing");
    }

    #[test]
    fn what_lies_still_shows_its_drift_and_nothing_of_being_moved_unseen() {
        let mut drift = Drift::default();
        let drift_m = NOISE_BOUND_SIGMAS * 0.002 / libm::sqrtf(2.0);
        let is_about = |drift: &Drift, share: f32| {
            let apart_m = drift.bound_m();
            apart_m.is_some_and(|apart_m| (drift_m..share * drift_m).contains(&apart_m))
        };
        let lie = |drift: &mut Drift, frames: usize| {
            (0..frames).for_each(|frame| {
                let [now, before] = [frame, frame + 1].map(|frame| [(frame % 2) as f32 * 0.002, 0.0, 0.0]);
                drift.push(now, before, true);
            });
        };
        // Strokes of 4.5 cm about where it was first seen, and at 10 cm from there: nothing in them lies still.
        let stroke = |brought_m: f32, frames: u16, drift: &mut Drift| {
            for frame in 0..frames {
                let way_m = (f32::from(frame) / 100.0).min(brought_m);
                let at = |frame: u16| [way_m + 0.0225 * libm::sinf(f32::from(frame) / 4.0), 0.0, 0.0];
                drift.push(at(frame + 5), at(frame), false);
            }
        };
        stroke(0.0, 9, &mut drift);
        for brought_m in [0.0, 0.1] {
            drift.begin();
            stroke(brought_m, 300, &mut drift);
            lie(&mut drift, 20);
            assert_eq!(drift.bound_m(), None);
        }
        drift.begin();
        lie(&mut drift, 9);
        assert_eq!(drift.bound_m(), None, "too little to tell");
        lie(&mut drift, 291);
        assert!(is_about(&drift, 1.1), "{drift:?}");
        drift.begin();
        drift.push([0.3, 0.0, 0.0], [0.0; 3], true);
        lie(&mut drift, 10);
        assert!(is_about(&drift, 1.1), "{drift:?}");
    }
}
