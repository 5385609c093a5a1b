//! Which measure of an IU is not right.

use super::observation::{ENDS, IuObservation};
use crate::bounds::Around;
use crate::job::{MeasureBounds, NominalIu, Shown};
use crate::segment::{HIDDEN_SLACK, MOVED_M, Measures};
use crate::verdict::{Measure, Measured, Reason};

/// A stroke goes to and fro.
const PER_STROKE: u32 = 2;

impl IuObservation {
    /// The rule that a measure breaks, with the one that says most to a person: strokes rather than their time. With `may_be_hidden` only if no motion
    /// in the frames that were not seen could have kept it.
    pub(super) fn broken(&self, iu: &NominalIu<'_>, may_be_hidden: bool) -> Option<(Reason, Measure)> {
        let broken = self.broken_by(&self.measures, iu, may_be_hidden)?;
        let is_broken_at_pace = || self.broken_by(&self.measures_at_pace, iu, may_be_hidden).is_some();
        (!may_be_hidden || is_broken_at_pace()).then_some(broken)
    }

    /// The rule that these measures break. A path that was seen is not too long only because something else was not.
    fn broken_by(
        &self,
        measures: &Measures,
        iu: &NominalIu<'_>,
        may_be_hidden: bool,
    ) -> Option<(Reason, Measure)> {
        let hidden = if may_be_hidden { self.hidden() } else { 0.0 };
        let [min_frames, max_frames] =
            if may_be_hidden { self.possible_frames() } else { [self.worked_frames(), self.frames] };
        // With fewer frames contacts are believed later. Gaps at the ends are in the possible frames already.
        let missing = if may_be_hidden { measures.hidden } else { 0.0 };
        let max_frames = max_frames as f32 * (1.0 + HIDDEN_SLACK * missing);
        let hidden_reversals =
            if may_be_hidden { self.possible_reversals(measures) } else { self.assumed_reversals() };
        let MeasureBounds { path_m, .. } = iu.measures;
        let speed = path_m.max.min(f32::MAX) / iu.quickest().max(1) as f32;
        // Hidden motion may have been faster than seen motion.
        let share = HIDDEN_SLACK * hidden;
        let hidden_m = share * self.frames as f32 * speed;
        let Measures { reversals, path_m: walked_m, detour_m, lateral_m, unseen_before_way, drift_m, .. } =
            *measures;
        // Which frames were seen decides where the steps of a path end, at each reversal and at last. So do errors, where nothing says how large
        // they are.
        let is_noise_unknown = may_be_hidden && drift_m == 0.0;
        let is_inexact = hidden > 0.0 || is_noise_unknown;
        let step_m = if is_inexact { (reversals + 1) as f32 * MOVED_M } else { 0.0 };
        let is_detour = if iu.measures.max_detour_m.is_finite() {
            detour_m > iu.measures.max_detour_m + step_m
        } else {
            walked_m > path_m.max + step_m
        };
        // Where the hand was not seen before its way, that may have begun elsewhere.
        let unseen = if may_be_hidden { unseen_before_way as f32 } else { 0.0 };
        let is_way_inexact = is_inexact || unseen > 0.0;
        let lateral_step_m = if is_way_inexact { ENDS as f32 * MOVED_M + unseen * speed } else { 0.0 };
        let is_lateral = lateral_m > iu.measures.max_lateral_m + lateral_step_m;
        let doubtful_turns = if may_be_hidden { self.doubtful_turns() } else { 0 };
        let too_long = first(&[
            (reversals.saturating_sub(doubtful_turns) > iu.reversals.max, Measure::Strokes),
            (min_frames > iu.frames.max, Measure::Duration),
            (is_lateral, Measure::LateralDeviation),
            (is_detour, Measure::Path),
        ]);
        let too_short = || {
            first(&[
                (reversals.saturating_add(hidden_reversals) < iu.reversals.min, Measure::Strokes),
                (max_frames < iu.frames.min as f32, Measure::Duration),
                (walked_m + hidden_m + step_m < path_m.min, Measure::Path),
            ])
        };
        if let Some(measure) = too_long {
            return Some((Reason::TooLong, measure));
        } else if !self.ended {
            return None;
        }
        // Where nothing says how large errors are, each end of a stroke may be wrong.
        let cut_m = if is_noise_unknown { reversals as f32 * MOVED_M } else { 0.0 };
        let possible =
            Possible { share, hidden_m, cut_m, reversals: if may_be_hidden { hidden_reversals } else { 0 } };
        let elsewhere = first(&elsewhere_broken(measures, &iu.measures, possible));
        match (too_short(), elsewhere) {
            // Strokes that are small or go across are counted badly.
            (Some(Measure::Strokes), Some(other))
                if other != Measure::Place && reversals + PER_STROKE >= iu.reversals.min =>
            {
                Some((Reason::TooShort, other))
            }
            (Some(measure), _) => Some((Reason::TooShort, measure)),
            (None, elsewhere) => elsewhere.map(|measure| (Reason::Motion, measure)),
        }
    }

    /// What the measure is that breaks this rule, in its unit, beside what was shown of the IU. `rate_hz` is the frame rate of the grid.
    pub(super) fn measured(
        &self,
        iu: &NominalIu<'_>,
        (reason, measure): (Reason, Measure),
        rate_hz: f32,
    ) -> Option<Measured> {
        let bounds = &iu.measures;
        let Shown { frames, reversals, stroke_m, path_m, lateral_m, axis, place_m, .. } = bounds.shown?;
        let seconds = |frames: u32| frames as f32 / rate_hz;
        let [value, shown_min, shown_max] = match measure {
            Measure::Duration => {
                let lasted = if reason == Reason::TooLong { self.worked_frames() } else { self.frames };
                [lasted, frames.min, frames.max].map(seconds)
            }
            Measure::Strokes => strokes([self.measures.reversals, reversals.min, reversals.max]),
            Measure::StrokeLength => [self.measures.stroke_m?, stroke_m.min, stroke_m.max],
            Measure::Path => [self.measures.path_m, path_m.min, path_m.max],
            Measure::LateralDeviation => [self.measures.lateral_m, 0.0, lateral_m],
            Measure::Direction => [degrees(bounds.axis.distance(self.measures.axis)), 0.0, degrees(axis)],
            Measure::Place => [bounds.place_m.distance(self.measures.place_m), 0.0, place_m],
        };
        Some(Measured { measure, value, shown_min, shown_max })
    }
}

/// What of an IU may have happened unseen.
#[derive(Clone, Copy)]
struct Possible {
    /// How much of it, as a share of the motion that was seen.
    share: f32,
    /// Over how long a way, in metres, if it was as fast as anything shown.
    hidden_m: f32,
    /// By how much the strokes on one side of all reversals may have been longer, in metres.
    cut_m: f32,
    /// How often the motion reversed in it.
    reversals: u32,
}

/// Whether size, direction and place of the motion are wrong, whatever was hidden.
fn elsewhere_broken(measures: &Measures, bounds: &MeasureBounds, possible: Possible) -> [(bool, Measure); 3] {
    let moved_m = possible.share * (measures.path_m + possible.hidden_m);
    let [least, most] = possible_stroke_m(measures, possible);
    [
        (most < bounds.stroke_m.min || least > bounds.stroke_m.max, Measure::StrokeLength),
        (!bounds.axis.has(measures.axis, possible.share), Measure::Direction),
        (!bounds.place_m.has(measures.place_m, moved_m), Measure::Place),
    ]
}

/// The minimum and maximum of the mean length of a stroke. Each reversal that was not seen may have parted the strokes that were, or let one more
/// begin before them or end behind them: together they are a part of the path. Strokes may have been longer on both sides of a reversal.
fn possible_stroke_m(measures: &Measures, possible: Possible) -> [f32; 2] {
    let Measures { reversals, stroke_m, path_m, .. } = *measures;
    let Some(stroke_m) = stroke_m else { return [0.0, f32::INFINITY] };
    let strokes = (reversals - 1) as f32;
    let sum_m = stroke_m * strokes;
    // Unseen motion may have been a part of any stroke, or of the one more.
    let unseen_m = possible.share * path_m + ENDS as f32 * possible.cut_m;
    let with_one_more_m = (path_m.max(sum_m) + unseen_m) / (strokes + 1.0);
    let most_m = if possible.reversals > 0 { with_one_more_m } else { 0.0 };
    [sum_m / (strokes + possible.reversals as f32), most_m.max((sum_m + unseen_m) / strokes)]
}

/// The first measure that is broken.
fn first(measures: &[(bool, Measure)]) -> Option<Measure> {
    measures.iter().find(|(is_broken, _)| *is_broken).map(|(_, measure)| *measure)
}

/// The strokes to and fro in these numbers of reversals, two each: of the IU, and the minimum and maximum that were shown. Where a hand comes from or
/// goes to makes one more or less, so people count whole strokes. A half is counted only where it makes the difference.
fn strokes([value, min, max]: [u32; 3]) -> [f32; 3] {
    let most = max / PER_STROKE;
    let least = min.div_ceil(PER_STROKE).min(most);
    let whole = value / PER_STROKE;
    if (least..=most).contains(&whole) {
        [value, min, max].map(|count| count as f32 / PER_STROKE as f32)
    } else {
        [whole, least, most].map(|count| count as f32)
    }
}

/// The angle of a path to another one, from the distance of their axes: that is the chord of twice the angle.
fn degrees(distance: f32) -> f32 {
    libm::asinf((distance / 2.0).min(1.0)).to_degrees()
}

impl<const N: usize> Around<N> {
    fn has(&self, value: [f32; N], slack: f32) -> bool {
        self.distance(value) <= self.max + slack
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Bounds;
    use crate::couple::Context;

    #[test]
    fn whole_strokes_are_counted_unless_a_half_makes_the_difference() {
        assert_eq!(strokes([9, 12, 13]), [4.0, 6.0, 6.0]);
        assert_eq!(strokes([15, 12, 13]), [7.0, 6.0, 6.0]);
        assert_eq!(strokes([10, 11, 13]), [5.0, 6.0, 6.0]);
        assert_eq!(strokes([9, 11, 11]), [4.0, 5.0, 5.0]);
        assert_eq!(strokes([13, 11, 12]), [6.5, 5.5, 6.0]);
    }

    #[test]
    fn a_frame_that_is_missing_at_either_end_hides_no_pause_and_many_may() {
        let iu = NominalIu {
            context: Context([1, 6, 6, 3]),
            reference: &[],
            threshold: 0.0,
            frames: Bounds { min: 19, max: u32::MAX },
            reversals: Bounds { min: 0, max: u32::MAX },
            measures: MeasureBounds::ANY,
        };
        let broken = |gap: u32| {
            let measures = Measures { hidden: 0.03, ..Measures::default() };
            let (gap_before, gap_after, ended) = (gap, gap, true);
            let observation = IuObservation {
                frames: 12,
                assumed: 2,
                measures,
                gap_before,
                gap_after,
                ended,
                ..IuObservation::default()
            };
            observation.broken(&iu, true)
        };
        assert_eq!(broken(1), Some((Reason::TooShort, Measure::Duration)));
        assert_eq!(broken(5), None);
    }
}
