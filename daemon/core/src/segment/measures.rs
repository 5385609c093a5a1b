//! What is measured of an IU in metres. DTW forgives a motion that was cut short, repeated too often or made small; measures do not.

use super::way::Way;
use crate::couple::geometry::distance;
pub use crate::couple::noise::MOVED_M;
use crate::input::Point;

/// In as many frames in a row that were not seen, a motion may have reversed: quick strokes change the sign of their acceleration every fourth frame.
/// Halved or doubled, 1 or 5 of 3,700 drawn streams differ.
pub(crate) const FRAMES_PER_REVERSAL: u32 = 4;

/// How far a bound gives way, as a multiple of what was not seen. Hidden motion may have been twice as fast as seen motion.
/// Halved or doubled, 6 or 4 of 3,700 drawn streams differ.
pub(crate) const HIDDEN_SLACK: f32 = 2.0;

/// The share of a frame that is missing between two that were seen: what happened in it can still be known. Halved or doubled, none or 2 of 3,700 drawn
/// streams differ.
const SINGLE_FRAME: f32 = 0.2;

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
    /// How often it may have reversed in addition: it was seen to come back, and how far was in a frame that is missing.
    pub cut_reversals: u32,
    /// By how much the strokes before reversals may have been longer in addition, and those behind them as well, in metres. That is so where the frame
    /// just before or behind the farthest one that was seen is missing. The pace beside it bounds it, and it counts for 15 mm at most.
    pub cut_m: f32,
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

/// Which frames are missing since just before the position that is farthest.
#[derive(Clone, Copy, Debug, Default)]
enum Gap {
    #[default]
    None,
    /// Only others than the one just before that position, and the one just behind it.
    Later,
    /// One of these two.
    Beside(Beyond),
}

/// Frames that are missing beside the farthest position. How far the motion went in the frame before them and in the one behind them, in metres.
#[derive(Clone, Copy, Debug, Default)]
struct Beyond {
    frames: u32,
    before_m: f32,
    /// `None` until that is known; infinite across a gap.
    behind_m: Option<f32>,
}

impl Beyond {
    /// With others that are missing as well.
    fn and(self, other: Self) -> Self {
        let before_m = self.before_m.max(self.behind_m.unwrap_or(0.0)).max(other.before_m);
        Self { frames: self.frames.saturating_add(other.frames), before_m, ..other }
    }

    /// How far beyond the farthest position the motion may have gone. A hand that is about to reverse is hardly ever faster than twice what was seen.
    fn most_m(&self) -> f32 {
        let behind_m = self.behind_m.unwrap_or(f32::INFINITY);
        HIDDEN_SLACK * self.frames as f32 * self.before_m.max(behind_m)
    }
}

/// Measures an IU frame by frame, in fixed memory.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Meter {
    frames: u32,
    /// Frames with a position, and without one since the newest.
    known: u32,
    unknown: u32,
    /// The newest position, and how far it is from the one in the frame before it; infinite where that is not known.
    newest: Option<Point>,
    pace_m: f32,
    /// Frames without a position, weighted by what may have happened in them.
    hidden: f32,
    hidden_reversals: u32,
    cut_reversals: u32,
    sum: [f64; 3],
    /// Where the first step began and the newest one ended.
    began: Point,
    step: Option<Point>,
    path_m: f32,
    /// The sum of the steps with their directions doubled.
    axis: [f32; 2],
    /// Where the motion last reversed, and the position since then that is farthest from there.
    reversed: Point,
    farthest: Point,
    /// How far the motion has come back from the farthest position so far, and what was missing since just before that.
    returned_m: f32,
    gap: Gap,
    cut_m: f32,
    reversals: u32,
    /// The sum of the lengths of whole strokes.
    strokes_m: f32,
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
        let missing = self.unknown;
        let newest = self.newest.replace(position).filter(|_| missing == 0);
        let pace_m = newest.map_or(f32::INFINITY, |newest| distance(newest, position));
        if let Gap::Beside(beyond) = &mut self.gap {
            beyond.behind_m.get_or_insert(pace_m);
        }
        self.end_gap();
        self.known = self.known.saturating_add(1);
        for (sum, value) in self.sum.iter_mut().zip(position) {
            *sum += f64::from(value);
        }
        match self.step {
            None => {
                (self.began, self.step) = (position, Some(position));
                (self.reversed, self.farthest) = (position, position);
                // What comes before it may have been the other way.
                self.cut_reversals = (missing > 0).into();
            }
            Some(from) => self.walk(from, position),
        }
        self.turn(position, missing);
        self.pace_m = pace_m;
    }

    /// Whether no position has been known so far.
    pub(super) fn is_empty(&self) -> bool {
        self.known == 0
    }

    fn end_gap(&mut self) {
        let unknown = core::mem::take(&mut self.unknown);
        self.hidden_reversals = self.hidden_reversals.saturating_add(unknown / FRAMES_PER_REVERSAL);
        self.hidden += if unknown > 1 { unknown as f32 } else { SINGLE_FRAME * unknown as f32 };
    }

    fn moved_m(&self) -> f32 {
        MOVED_M.max(self.drift_m)
    }

    /// Steps of at least `moved_m`, so that neither noise nor the frame rate lengthens the path.
    fn walk(&mut self, from: Point, to: Point) {
        let step_m = distance(from, to);
        if step_m < self.moved_m() {
            return;
        }
        self.step = Some(to);
        self.path_m += step_m;
        // cos 2α = (x² - y²) / r² and sin 2α = 2 x y / r².
        let [x, y] = [to[0] - from[0], to[1] - from[1]];
        self.axis[0] += (x * x - y * y) / step_m;
        self.axis[1] += 2.0 * x * y / step_m;
    }

    /// The motion has reversed at the farthest position once it has come back from there. `missing` frames have no position just before this one.
    fn turn(&mut self, position: Point, missing: u32) {
        let beyond = Beyond { frames: missing, before_m: self.pace_m, behind_m: None };
        if missing > 0 {
            self.gap = match self.gap {
                Gap::Beside(before) if self.returned_m == 0.0 => Gap::Beside(before.and(beyond)),
                Gap::Beside(before) => Gap::Beside(before),
                _ if self.returned_m > 0.0 => Gap::Later,
                _ => Gap::Beside(beyond),
            };
        }
        let length_m = distance(self.reversed, self.farthest);
        if distance(self.reversed, position) > length_m {
            // To and fro.
            self.cut_reversals = self.cut_reversals.saturating_add(2 * u32::from(self.may_have_reversed()));
            self.farthest = position;
        } else if length_m > self.moved_m() && distance(self.farthest, position) > self.moved_m() {
            // What comes before the first reversal is the way to the first stroke.
            self.strokes_m += if self.reversals > 0 { length_m } else { 0.0 };
            self.reversals = self.reversals.saturating_add(1);
            if let Gap::Beside(beyond) = self.gap {
                self.cut_m += beyond.most_m().min(MOVED_M);
            }
            (self.reversed, self.farthest) = (self.farthest, position);
        } else {
            self.returned_m = self.returned_m.max(distance(self.farthest, position));
            return;
        }
        self.returned_m = 0.0;
        self.gap = if missing > 0 { Gap::Beside(beyond) } else { Gap::None };
    }

    /// Whether the motion may have come back too little to count only because the frame in which it was farthest is missing.
    fn may_have_reversed(&self) -> bool {
        !matches!(self.gap, Gap::None) && self.returned_m > self.moved_m() / 2.0
    }

    /// The measures so far, with those of the way of which the IU is the newest part.
    pub(super) fn measures(&self, way: &Way) -> Measures {
        let mut ended = *self;
        if self.unknown > 0 {
            ended.gap = Gap::Later;
        }
        ended.end_gap();
        let per_path = |sum: f32| if self.path_m > 0.0 { sum / self.path_m } else { 0.0 };
        let (frames, known) = (self.frames.max(1) as f32, f64::from(self.known.max(1)));
        Measures {
            reversals: self.reversals,
            stroke_m: (self.reversals > 1).then(|| self.strokes_m / (self.reversals - 1) as f32),
            path_m: self.path_m,
            detour_m: self.path_m - self.step.map_or(0.0, |step| distance(self.began, step)),
            lateral_m: way.lateral_m,
            unseen_before_way: way.unseen_before,
            axis: self.axis.map(per_path),
            place_m: self.sum.map(|sum| (sum / known) as f32),
            hidden_reversals: ended.hidden_reversals,
            cut_reversals: ended.cut_reversals.saturating_add(ended.may_have_reversed().into()),
            cut_m: self.cut_m,
            hidden: (ended.hidden / frames).min(1.0),
            drift_m: self.drift_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::TAU;
    use std::vec::Vec;

    /// The measures of these positions, of which some frames are missing.
    fn measure(positions: &[Point], is_missing: impl Fn(usize) -> bool) -> Measures {
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
    fn a_frame_that_is_missing_may_have_shown_a_reversal() {
        // To and fro by 17 mm, of which the last 3 mm are in frame 5.
        let small = [0.0, 0.02, 0.04, 0.06, 0.046, 0.043, 0.046, 0.06, 0.08];
        let last = [0.0, 0.02, 0.04, 0.036, 0.032, 0.028, 0.024];
        let first = [0.0165, 0.009, 0.0, -0.01, -0.02];
        // What is right only with those that were cut is not right.
        for (way, missing, reversals, cut_reversals) in [
            (&small[..], usize::MAX, 2, 0),
            (&small[..], 5, 0, 2),
            (&small[..], 1, 2, 0),
            (&last[..], 6, 0, 1),
            (&first[..], 0, 0, 1),
        ] {
            let cut = measure(&along_x(way), |frame| frame == missing);
            let counted = (cut.reversals, cut.cut_reversals, cut.hidden_reversals);
            assert_eq!(counted, (reversals, cut_reversals, 0), "{way:?} without {missing}");
        }
    }

    #[test]
    fn strokes_may_be_longer_where_the_farthest_frame_is_missing_and_nowhere_else() {
        // To and fro by 6 cm, farthest in the frames 6 and 12.
        let far: Vec<f32> = (0..16i32).map(|frame| 0.01 * (6 - (frame % 12 - 6).abs()) as f32).collect();
        let is_longer = |missing: &usize| measure(&along_x(&far), |frame| frame == *missing).cut_m > 0.0;
        let all: Vec<usize> = (0..far.len()).filter(is_longer).collect();
        assert_eq!(all, [5, 6, 7, 11, 12, 13]);
    }
}
