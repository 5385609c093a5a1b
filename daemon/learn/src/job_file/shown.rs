//! What each of the runs measured, kept with the job so that people can see whether an accusation is right.

use crate::statistics::ends;
use andon_core::bounds::{Bounds, Range};
use andon_core::job::Shown;
use serde::Deserialize;
use std::fmt::Write as _;

/// So many values of a measure are kept. Of more runs these are kept in even steps from the minimum to the maximum.
const MAX_KEPT: usize = 20;

/// A tenth of a millimetre: more decimals say nothing to anybody.
const PER_UNIT: f64 = 1e4;

/// What each of the runs measured in an IU, in the units of the bounds; each measure is sorted. It decides nothing.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ShownValues {
    /// How long they lasted without what the hand waited for the other one, in frames of the grid.
    pub frames: Vec<f32>,
    /// How often the motion reversed; where some of it was hidden, as often as it most likely did.
    pub reversals: Vec<f32>,
    /// Mean length of a stroke, of those that have a whole one.
    pub stroke_m: Vec<f32>,
    /// Length of the path.
    pub path_m: Vec<f32>,
    /// How much longer than the straight way it was.
    pub detour_m: Vec<f32>,
    /// The lateral deviation: how far off the straight line the way of the hand led.
    #[serde(rename = "lateral_deviation_m", alias = "bow_m")]
    pub lateral_m: Vec<f32>,
    /// How far the direction of the path was away from the centre of the right ones; empty where any is right.
    pub axis: Vec<f32>,
    /// How far the mean position was away from the centre of the right ones; empty where any is right.
    pub place_m: Vec<f32>,
    /// DTW distances from the motion of the others, from which the threshold comes.
    pub distance: Vec<f32>,
}

impl ShownValues {
    fn by_key(&self) -> [(&'static str, &[f32]); 9] {
        [
            ("frames", &self.frames),
            ("reversals", &self.reversals),
            ("stroke_m", &self.stroke_m),
            ("path_m", &self.path_m),
            ("detour_m", &self.detour_m),
            ("lateral_deviation_m", &self.lateral_m),
            ("axis", &self.axis),
            ("place_m", &self.place_m),
            ("distance", &self.distance),
        ]
    }

    /// From minimum to maximum, as verdicts name it.
    pub(crate) fn ranges(&self) -> Shown {
        let range = |values: &[f32]| {
            let [min, max] = ends(values);
            Range { min, max }
        };
        let counts = |values: &[f32]| {
            let [min, max] = ends(values).map(|end| end as u32);
            Bounds { min, max }
        };
        Shown {
            frames: counts(&self.frames),
            reversals: counts(&self.reversals),
            stroke_m: range(&self.stroke_m),
            path_m: range(&self.path_m),
            detour_m: range(&self.detour_m).max,
            lateral_m: range(&self.lateral_m).max,
            axis: range(&self.axis).max,
            place_m: range(&self.place_m).max,
        }
    }

    /// The section of an IU in a job file.
    pub(super) fn write(&self, text: &mut String) {
        text.push_str("[activity.iu.runs]\n");
        for (key, values) in self.by_key().into_iter().filter(|(_, values)| !values.is_empty()) {
            let values: Vec<String> = values.iter().map(ToString::to_string).collect();
            // Writing to a `String` cannot fail.
            let _ = writeln!(text, "{key} = [{}]", values.join(", "));
        }
    }

    /// The key of a measure whose values cannot have been written by [`of_runs`].
    pub(super) fn misfit(&self) -> Option<&'static str> {
        let is_kept = |values: &[f32]| {
            values.len() <= MAX_KEPT
                && values.is_sorted()
                && values.iter().all(|value| value.is_sign_positive() && *value < 1e9)
        };
        self.by_key().into_iter().find(|(_, values)| !is_kept(values)).map(|(key, _)| key)
    }
}

/// The values of a measure as they are kept.
pub(crate) fn of_runs(values: impl Iterator<Item = f64>) -> Vec<f32> {
    let mut sorted: Vec<f32> = values.map(|value| ((value * PER_UNIT).round() / PER_UNIT) as f32).collect();
    sorted.sort_by(f32::total_cmp);
    let last = sorted.len().saturating_sub(1);
    match sorted.len() {
        ..=MAX_KEPT => sorted,
        _ => (0..MAX_KEPT).map(|step| sorted[step * last / (MAX_KEPT - 1)]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_runs_the_minimum_the_maximum_and_even_steps_between_them_are_kept() {
        assert_eq!(of_runs([0.30004, 0.1, 0.2].into_iter()), [0.1, 0.2, 0.3]);
        let kept = of_runs((0..=190).rev().map(f64::from));
        assert_eq!(kept, (0..=19).map(|step| 10.0 * step as f32).collect::<Vec<_>>());
    }
}
