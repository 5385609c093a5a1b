//! What is measured of an IU in metres. DTW forgives a motion that was cut short, repeated too often or made small; measures do not.

use super::way::Way;
use crate::couple::geometry::{distance, norm, subtract};
pub use crate::couple::noise::MOVED_M;
use crate::input::Point;
use core::array::from_fn;

/// In as many frames in a row that were not seen, a motion may have reversed: quick strokes change the sign of their acceleration every fourth frame.
/// Halved or doubled, 1 or 5 of 3,700 drawn streams differ.
pub(crate) const FRAMES_PER_REVERSAL: u32 = 4;

/// How far a bound gives way, as a multiple of what was not seen. Hidden motion may have been twice as fast as seen motion.
/// Halved or doubled, 6 or 4 of 3,700 drawn streams differ.
pub(crate) const HIDDEN_SLACK: f32 = 2.0;

/// The share of a frame that is missing between two that were seen: what happened in it can still be known. Halved or doubled, none or 2 of 3,700 drawn
/// streams differ.
const SINGLE_FRAME: f32 = 0.2;

/// The longest gap that both paths cross, in frames. In a longer one a motion may have reversed more often than where it went on and came back.
const MAX_ON: u32 = 2 * FRAMES_PER_REVERSAL;

/// What may have happened in a gap: the motion went straight across it, or went on at its pace before it came back.
pub(crate) const WORLDS: usize = 2;

/// The measures of one IU, so far or whole.
///
/// They depend on the position of `o_j` in the frame of reference of `o_l` if there is one. Else they depend on that of the finger tips on the bench
/// ([`Couple::position`](crate::couple::Couple::position)).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measures {
    /// How often the motion reversed, that is came back by more than 15 mm, or more than the drift. A stroke lies between two reversals.
    pub reversals: u32,
    /// Mean length of a stroke in metres; `None` before the first whole one.
    pub stroke_m: Option<f32>,
    /// Length of the path in metres, in steps of 15 mm, or more where positions drift.
    pub path_m: f32,
    /// How much longer the path is than the straight way from its beginning to where it is now, in metres. It never becomes less.
    pub detour_m: f32,
    /// The lateral deviation so far, in metres: how far off the straight line the way of the hand on the bench has led. The way begins where the hand
    /// took `o_j`, or came with it to the `o_l` that it has left. Until it ends, with the time at the next one, it never becomes less.
    pub lateral_m: f32,
    /// In how many frames just before that way the hand was not seen.
    pub unseen_before_way: u32,
    /// The direction of the path in the plane of `o_l`, weighted by its length, where opposite directions are the same. It is `cos 2α` and `sin 2α`
    /// for a path along the angle `α` from the x axis, and shorter the more the path turns. Zero before the first step.
    pub axis: [f32; 2],
    /// Mean position in metres.
    pub place_m: Point,
    /// How often the motion may have reversed in addition, in frames that were not seen.
    pub hidden_reversals: u32,
    /// The share of the frames that were not seen, where what happened in them cannot be known; 0 to 1.
    pub hidden: f32,
    /// How far apart two positions may be by drift, in metres; 0 where that is not known.
    pub drift_m: f32,
}

impl Measures {
    /// How many reversals were hidden if the motion went on at the pace at which it was seen.
    pub fn hidden_reversals_at_pace(&self) -> u32 {
        let hidden = self.reversals as f32 * self.hidden / (1.0 - self.hidden);
        (libm::roundf(hidden) as u32).min(self.hidden_reversals)
    }
}

/// Measures the path of an IU, position by position.
#[derive(Clone, Copy, Debug, Default)]
struct Path {
    /// Where the first step began and the newest one ended.
    began: Point,
    step: Option<Point>,
    path_m: f32,
    /// The sum of the steps with their directions doubled.
    axis: [f32; 2],
    /// Where the motion last reversed, and the position since then that is farthest from there.
    reversed: Point,
    farthest: Point,
    reversals: u32,
    /// The sum of the lengths of whole strokes.
    strokes_m: f32,
}

impl Path {
    /// Takes the next position. What is shorter than `moved_m` may be errors.
    fn push(&mut self, position: Point, moved_m: f32) {
        match self.step {
            None => {
                (self.began, self.step) = (position, Some(position));
                (self.reversed, self.farthest) = (position, position);
            }
            Some(from) => self.walk(from, position, moved_m),
        }
        self.turn(position, moved_m);
    }

    /// Goes straight to where it is after as many frames and one more.
    fn go(&mut self, from: Point, to: Point, frames: u32, moved_m: f32) {
        let step = subtract(to, from).map(|metres| metres / (frames + 1) as f32);
        (1..=frames).for_each(|frames| self.push(along(from, step, frames as f32), moved_m));
    }

    /// Steps of at least `moved_m`, so that neither noise nor the frame rate lengthens the path.
    fn walk(&mut self, from: Point, to: Point, moved_m: f32) {
        let step_m = distance(from, to);
        if step_m < moved_m {
            return;
        }
        self.step = Some(to);
        self.path_m += step_m;
        // cos 2α = (x² - y²) / r² and sin 2α = 2 x y / r².
        let [x, y] = [to[0] - from[0], to[1] - from[1]];
        self.axis[0] += (x * x - y * y) / step_m;
        self.axis[1] += 2.0 * x * y / step_m;
    }

    /// The motion has reversed at the farthest position once it has come back from there.
    fn turn(&mut self, position: Point, moved_m: f32) {
        let length_m = distance(self.reversed, self.farthest);
        if distance(self.reversed, position) > length_m {
            self.farthest = position;
        } else if length_m > moved_m && distance(self.farthest, position) > moved_m {
            // What comes before the first reversal is the way to the first stroke.
            self.strokes_m += if self.reversals > 0 { length_m } else { 0.0 };
            self.reversals = self.reversals.saturating_add(1);
            (self.reversed, self.farthest) = (self.farthest, position);
        }
    }
}

/// Where a motion is after as many steps.
fn along(from: Point, step: Point, steps: f32) -> Point {
    from_fn(|k| from[k] + steps * step[k])
}

/// Measures an IU frame by frame, in fixed memory.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Meter {
    frames: u32,
    /// Frames with a position, and without one since the newest.
    known: u32,
    unknown: u32,
    /// The newest position, and the mean step of a frame to it from the position before, zero if there was none.
    newest: Point,
    pace: Point,
    /// Frames without a position, weighted by what may have happened in them.
    hidden: f32,
    hidden_reversals: u32,
    /// Those of them in gaps that both paths have crossed: on the second one they are reversals already.
    crossed_reversals: u32,
    sum: [f64; 3],
    /// The path that went straight across each gap, and the one that went on at its pace before it came back.
    paths: [Path; WORLDS],
    /// The drift that came with the newest position, in metres; 0 where it is not known.
    drift_m: f32,
}

impl Meter {
    /// Takes the next frame, with the position if it is known. What is shorter than `drift_m` may be errors.
    pub(super) fn push(&mut self, position: Option<Point>, drift_m: f32) {
        self.drift_m = drift_m;
        self.frames = self.frames.saturating_add(1);
        let Some(position) = position else {
            self.unknown = self.unknown.saturating_add(1);
            return;
        };
        self.cross_gap(Some(position));
        if !self.is_empty() {
            self.pace = subtract(position, self.newest).map(|metres| metres / (self.unknown + 1) as f32);
        }
        // What comes before the first position may have been the other way.
        let hidden_at_start = u32::from(self.is_empty() && self.unknown > 0);
        self.end_gap();
        self.hidden_reversals = self.hidden_reversals.max(hidden_at_start);
        self.newest = position;
        self.known = self.known.saturating_add(1);
        for (sum, value) in self.sum.iter_mut().zip(position) {
            *sum += f64::from(value);
        }
        let moved_m = self.moved_m();
        self.paths.iter_mut().for_each(|path| path.push(position, moved_m));
    }

    /// Whether no position has been known so far.
    pub(super) fn is_empty(&self) -> bool {
        self.known == 0
    }

    /// What may have happened in the frames that are missing before this position, or until now.
    fn cross_gap(&mut self, behind: Option<Point>) {
        let (missing, moved_m) = (self.unknown, self.moved_m());
        if self.is_empty() || !(1..=MAX_ON).contains(&missing) {
            return;
        }
        self.crossed_reversals += missing / FRAMES_PER_REVERSAL;
        let [straight, at_pace] = &mut self.paths;
        let (newest, pace) = (self.newest, self.pace);
        let after = |frames: u32| along(newest, pace, frames as f32);
        let may_come_back = |frames: u32| {
            let left = (missing + 1 - frames) as f32;
            behind.is_none_or(|behind| distance(after(frames), behind) <= HIDDEN_SLACK * norm(pace) * left)
        };
        let on = (1..=missing).rev().find(|frames| may_come_back(*frames)).unwrap_or(0);
        (1..=on).for_each(|frames| at_pace.push(after(frames), moved_m));
        if let Some(behind) = behind {
            straight.go(newest, behind, missing, moved_m);
            at_pace.go(after(on), behind, missing - on, moved_m);
        }
    }

    fn end_gap(&mut self) {
        let unknown = core::mem::take(&mut self.unknown);
        self.hidden_reversals = self.hidden_reversals.saturating_add(unknown / FRAMES_PER_REVERSAL);
        self.hidden += if unknown > 1 { unknown as f32 } else { SINGLE_FRAME * unknown as f32 };
    }

    fn moved_m(&self) -> f32 {
        MOVED_M.max(self.drift_m)
    }

    /// The measures so far in each world, with those of the way of which the IU is the newest part.
    pub(super) fn measures(&self, way: &Way) -> [Measures; WORLDS] {
        let mut ended = *self;
        ended.cross_gap(None);
        ended.end_gap();
        let (frames, known) = (self.frames.max(1) as f32, f64::from(self.known.max(1)));
        let hidden_reversals =
            [ended.hidden_reversals, ended.hidden_reversals.saturating_sub(ended.crossed_reversals)];
        from_fn(|world| {
            let Path { began, step, path_m, axis, reversals, strokes_m, .. } = ended.paths[world];
            let per_path = |sum: f32| if path_m > 0.0 { sum / path_m } else { 0.0 };
            Measures {
                reversals,
                stroke_m: (reversals > 1).then(|| strokes_m / (reversals - 1) as f32),
                path_m,
                detour_m: path_m - step.map_or(0.0, |step| distance(began, step)),
                lateral_m: way.lateral_m,
                unseen_before_way: way.unseen_before,
                axis: axis.map(per_path),
                place_m: self.sum.map(|sum| (sum / known) as f32),
                hidden_reversals: hidden_reversals[world],
                hidden: (ended.hidden / frames).min(1.0),
                drift_m: self.drift_m,
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::TAU;
    use std::vec::Vec;

    /// The measures of these positions as they were seen, where some frames are missing.
    fn measure(positions: &[Point], is_missing: impl Fn(usize) -> bool) -> Measures {
        worlds(positions, is_missing)[0]
    }

    fn worlds(positions: &[Point], is_missing: impl Fn(usize) -> bool) -> [Measures; WORLDS] {
        let mut meter = Meter::default();
        let seen = positions.iter().enumerate().map(|(frame, at)| (!is_missing(frame)).then_some(*at));
        seen.for_each(|position| meter.push(position, 0.0));
        meter.measures(&Way::after(0))
    }

    fn along_x(way: &[f32]) -> Vec<Point> {
        way.iter().map(|x| [*x, 0.0, 0.0]).collect()
    }

    /// Strokes of 7 cm along the angle, each to and fro in 24 frames, from the middle.
    fn strokes(count: usize, angle: f32) -> Vec<Point> {
        let at = |frame: usize| 0.035 * libm::sinf(frame as f32 * TAU / 24.0);
        let position = |frame: usize| [at(frame) * libm::cosf(angle), at(frame) * libm::sinf(angle), 0.0];
        (0..=24 * count).map(position).collect()
    }

    #[test]
    fn strokes_to_and_fro_reverse_twice_each_and_have_a_length_a_path_a_place_and_an_axis() {
        for (angle, axis) in [(0.0, [1.0, 0.0]), (TAU / 4.0, [-1.0, 0.0]), (TAU / 8.0, [0.0, 1.0])] {
            let measures = measure(&strokes(6, angle), |_| false);
            assert_eq!((measures.reversals, measures.hidden), (12, 0.0));
            assert!((measures.stroke_m.unwrap_or_default() - 0.07).abs() < 0.001, "{measures:?}");
            assert!((0.7..=0.84).contains(&measures.path_m), "{measures:?}");
            assert!(measures.place_m[0].abs() < 0.001, "{measures:?}");
            assert!((0..2).all(|k| (measures.axis[k] - axis[k]).abs() < 0.01), "{measures:?}");
        }
    }

    #[test]
    fn noise_adds_neither_path_nor_reversals_and_a_circle_reverses_twice() {
        let noise = [0.0, 0.004, -0.004, 0.003, -0.002];
        let still: Vec<Point> = (0..500).map(|frame| [noise[frame % 5], noise[frame % 3], 0.0]).collect();
        let measures = measure(&still, |_| false);
        assert_eq!((measures.reversals, measures.path_m, measures.axis), (0, 0.0, [0.0; 2]));
        let angle = |frame: usize| frame as f32 * TAU / 40.0;
        let at = |frame| [0.05 * libm::cosf(angle(frame)), 0.05 * libm::sinf(angle(frame)), 0.0];
        let circles: Vec<Point> = (0..=200).map(at).collect();
        assert_eq!(measure(&circles, |_| false).reversals, 9);
    }

    #[test]
    fn frames_that_are_not_seen_lengthen_nothing_and_are_counted() {
        let [whole, half, gap] = [
            measure(&strokes(6, 0.0), |_| false),
            measure(&strokes(6, 0.0), |frame| frame % 2 == 1),
            measure(&strokes(6, 0.0), |frame| (20..60).contains(&frame)),
        ];
        assert_eq!((half.reversals, half.hidden_reversals), (12, 0));
        assert!((half.path_m / whole.path_m - 1.0).abs() < 0.1, "{half:?}");
        assert!((half.hidden - 0.1).abs() < 0.01, "{half:?}");
        // At the pace as often as in the other 105 frames.
        let counted = (gap.reversals, gap.hidden_reversals, gap.hidden_reversals_at_pace());
        assert_eq!(counted, (10, 10, 4));
        assert!((gap.hidden - 40.0 / 145.0).abs() < 0.01, "{gap:?}");
    }

    #[test]
    fn what_all_frames_measure_lies_between_the_worlds_whichever_frame_is_missing() {
        // To and fro by 17 mm in the middle of a way, strokes that end late, and strokes of 6 cm.
        let small = [0.0, 0.02, 0.04, 0.06, 0.046, 0.043, 0.046, 0.06, 0.08];
        let last = [0.0, 0.02, 0.04, 0.036, 0.032, 0.028, 0.024];
        let first = [0.0165, 0.009, 0.0, -0.01, -0.02];
        let long: Vec<f32> = (0..16i32).map(|frame| 0.01 * (6 - (frame % 12 - 6).abs()) as f32).collect();
        for way in [&small[..], &last, &first, &long] {
            let whole = measure(&along_x(way), |_| false);
            for missing in 0..way.len() {
                let [seen, at_pace] = worlds(&along_x(way), |frame| frame == missing);
                let fewest = seen.reversals.min(at_pace.reversals);
                let most = seen.reversals.max(at_pace.reversals) + seen.hidden_reversals;
                assert!(
                    (fewest..=most).contains(&whole.reversals),
                    "{way:?} without {missing}: {fewest} to {most}"
                );
                let metres = [seen, whole, at_pace].map(|measures| measures.stroke_m.unwrap_or_default());
                assert!(
                    metres[1] <= metres[0].max(metres[2]) + 0.001,
                    "{way:?} without {missing}: {metres:?}"
                );
            }
        }
    }
}
