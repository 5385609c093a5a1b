//! Bounds of the measures of an IU, with a stated rate of false alarms.
//!
//! A bound is a prediction interval of Student's t: what one more execution will measure, from the mean and the spread of those shown. A few runs
//! show their spread badly, so it is pooled with that of people in general (an empirical Bayes estimate, Smyth 2004). Lengths are compared by
//! their ratios, because people differ by them.

use super::bounds::UNBOUNDED;
use crate::statistics::{deviation, mean};
use andon_core::couple::Context;
use andon_core::job::{Around, Bounds, MeasureBounds, Range};
use andon_core::segment::Measures;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// As many runs as the spread of people in general counts for.
const PRIOR_FREEDOM: f64 = 6.0;

/// How people in general differ: in the logarithm of the length of a stroke and of a path, in the number of reversals, in the axis and in the
/// place in metres.
const PRIOR_STROKE: f64 = 0.12;
const PRIOR_PATH: f64 = 0.12;
const PRIOR_REVERSALS: f64 = 0.3;
const PRIOR_AXIS: f64 = 0.15;
const PRIOR_PLACE_M: f64 = 0.008;

/// A motion with fewer reversals than this is not a repeated one.
const MIN_REPEATED_REVERSALS: u32 = 3;

/// Somebody who corrects the place of a part goes back and forth once more.
const STRAY_REVERSALS: u32 = 2;

/// Nobody notices a path that is longer by this, in metres.
const STRAY_PATH_M: f64 = 0.05;

/// A shorter path has no direction, in metres.
const MIN_DIRECTED_M: f32 = 0.1;

/// The share of the job's rate of false alarms that the length of strokes has: people differ by it so much that half of a stroke is found only
/// near the limit. The four other measures share the rest.
const STROKE_SHARE: f64 = 0.45;

/// How often each measure of an IU may be out of its bounds in a right job. Each measure has a share of the rate of the job, and the IUs that have
/// it share that equally.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rates {
    reversals: f64,
    stroke: f64,
    path: f64,
    axis: f64,
    place: f64,
}

impl Rates {
    /// From the demonstrations of each IU of the job.
    pub(super) fn new<'a>(
        false_alarms: f64,
        ius: impl Iterator<Item = (Context, &'a [Measures])> + Clone,
    ) -> Self {
        let rate = |share: f64, has: &dyn Fn(Context, &[Measures]) -> bool| {
            let count =
                ius.clone().filter(|(context, shown)| context.is_touch() && has(*context, shown)).count();
            false_alarms * share / count.max(1) as f64
        };
        let other = (1.0 - STROKE_SHARE) / 4.0;
        Self {
            reversals: rate(other, &|_, _| true),
            stroke: rate(STROKE_SHARE, &|_, shown| is_repeated(shown)),
            path: rate(other, &|_, _| true),
            axis: rate(other, &|context, shown| is_directed(context, shown)),
            place: rate(other, &|context, _| is_at_another(context)),
        }
    }

    /// The bounds of reversals and of the measures in metres of one IU, from its demonstrations.
    pub(super) fn bounds(&self, context: Context, shown: &[Measures]) -> (Bounds, MeasureBounds) {
        if !context.is_touch() || self.path <= 0.0 {
            return (UNBOUNDED, MeasureBounds::ANY);
        }
        let any = MeasureBounds::ANY;
        let bounds = MeasureBounds {
            stroke_m: if is_repeated(shown) { self.stroke_m(shown) } else { any.stroke_m },
            path_m: self.path_m(shown),
            axis: if is_directed(context, shown) { self.axis(shown) } else { any.axis },
            place_m: if is_at_another(context) { self.place_m(shown) } else { any.place_m },
        };
        (self.reversals(shown), bounds)
    }

    fn reversals(&self, shown: &[Measures]) -> Bounds {
        let counts: Vec<f64> = shown.iter().map(|measures| f64::from(measures.reversals)).collect();
        let (centre, apart) = interval(&counts, PRIOR_REVERSALS, self.reversals);
        let most = shown.iter().map(|measures| measures.reversals).max().unwrap_or_default();
        let stray = if is_repeated(shown) { 0 } else { STRAY_REVERSALS };
        Bounds {
            min: if is_repeated(shown) { (centre - apart).ceil().max(0.0) as u32 } else { 0 },
            max: ((centre + apart).floor() as u32).max(most + stray),
        }
    }

    fn stroke_m(&self, shown: &[Measures]) -> Range {
        let lengths: Vec<f64> = shown
            .iter()
            .filter_map(|measures| measures.stroke_m)
            .map(|length| f64::from(length).ln())
            .collect();
        let (centre, apart) = interval(&lengths, PRIOR_STROKE, self.stroke);
        Range { min: (centre - apart).exp() as f32, max: (centre + apart).exp() as f32 }
    }

    fn path_m(&self, shown: &[Measures]) -> Range {
        let lengths: Vec<f64> =
            shown.iter().map(|measures| (f64::from(measures.path_m) + STRAY_PATH_M).ln()).collect();
        let (centre, apart) = interval(&lengths, PRIOR_PATH, self.path);
        let length = |logarithm: f64| (logarithm.exp() - STRAY_PATH_M).max(0.0) as f32;
        Range { min: length(centre - apart), max: length(centre + apart) }
    }

    fn axis(&self, shown: &[Measures]) -> Around<2> {
        around(&shown.iter().map(|measures| measures.axis).collect::<Vec<_>>(), PRIOR_AXIS, self.axis)
    }

    fn place_m(&self, shown: &[Measures]) -> Around<3> {
        around(&shown.iter().map(|measures| measures.place_m).collect::<Vec<_>>(), PRIOR_PLACE_M, self.place)
    }
}

fn is_repeated(shown: &[Measures]) -> bool {
    shown.iter().all(|measures| measures.reversals >= MIN_REPEATED_REVERSALS)
}

/// The directions of the bench are those of the parts on it only where one part moves along another.
fn is_directed(context: Context, shown: &[Measures]) -> bool {
    is_at_another(context) && shown.iter().all(|measures| measures.path_m >= MIN_DIRECTED_M)
}

fn is_at_another(context: Context) -> bool {
    context.0[3] != 0
}

/// The centre of these values, and how far from it one more may lie at this rate of false alarms.
fn interval(values: &[f64], prior: f64, false_alarms: f64) -> (f64, f64) {
    let count = values.len() as f64;
    let freedom = PRIOR_FREEDOM + count - 1.0;
    let squares = PRIOR_FREEDOM * prior.powi(2) + (count - 1.0) * deviation(values, 1).powi(2);
    let spread = (squares / freedom).sqrt() * (1.0 + 1.0 / count).sqrt();
    (mean(values), quantile(freedom, false_alarms) * spread)
}

/// The same in the plane or in space: the spread is that of one axis.
fn around<const N: usize>(values: &[[f32; N]], prior: f64, false_alarms: f64) -> Around<N> {
    let axes: [(f64, f64); N] = std::array::from_fn(|axis| {
        let along: Vec<f64> = values.iter().map(|value| f64::from(value[axis])).collect();
        interval(&along, prior, false_alarms)
    });
    let apart = axes.iter().map(|(_, apart)| apart.powi(2)).sum::<f64>().sqrt();
    Around { centre: axes.map(|(centre, _)| centre as f32), max: apart as f32 }
}

/// How many spreads apart a share of all executions is, on both sides together.
fn quantile(freedom: f64, false_alarms: f64) -> f64 {
    // The location, the scale and the freedom are always valid.
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(1.0 - false_alarms / 2.0))
}
