//! Statistics of small samples.

use statrs::distribution::{Beta, ContinuousCDF, StudentsT};

/// The mean; 0 if there are no values.
pub fn mean(values: &[f64]) -> f64 {
    if values.is_empty() { 0.0 } else { values.iter().sum::<f64>() / values.len() as f64 }
}

/// The standard deviation with `n - freedom` in the denominator; 0 if the denominator is not positive.
pub fn deviation(values: &[f64], freedom: usize) -> f64 {
    let centre = mean(values);
    let squares = values.iter().map(|value| (value - centre).powi(2)).sum::<f64>();
    match values.len().checked_sub(freedom) {
        None | Some(0) => 0.0,
        Some(count) => (squares / count as f64).sqrt(),
    }
}

/// As many values as what is known in general counts for in [`variance_of_one_more`]. Halved, no verdict on 198 simulated and recorded jobs
/// changes, and doubled, one right job is not accepted.
const PRIOR_FREEDOM: f64 = 16.0;

/// The degrees of freedom of [`variance_of_one_more`] from this number of values, at least one.
pub(crate) fn pooled_freedom(count: usize) -> f64 {
    PRIOR_FREEDOM + count as f64 - 1.0
}

/// The variance of one more value around the mean of these. A few values show their variance badly. It is pooled with `prior`, that of such values in
/// general (an empirical Bayes estimate, Smyth 2004).
pub(crate) fn variance_of_one_more(values: &[f64], prior: f64) -> f64 {
    let count = values.len() as f64;
    let squares = (count - 1.0) * deviation(values, 1).powi(2);
    (PRIOR_FREEDOM * prior + squares) / pooled_freedom(values.len()) * (1.0 + 1.0 / count)
}

/// The first and the last of values that are sorted; 0 if there are none.
pub(crate) fn ends<T: Copy + Default>(sorted: &[T]) -> [T; 2] {
    [sorted.first(), sorted.last()].map(|end| end.copied().unwrap_or_default())
}

/// The median, for an even number of values the mean of the two in the middle; 0 if there are no values.
pub(crate) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let from = sorted.len().saturating_sub(1) / 2;
    mean(&sorted[from..(sorted.len() / 2 + 1).min(sorted.len())])
}

/// The median of each coordinate; 0 if there are no points.
pub(crate) fn median_point(points: impl Iterator<Item = [f32; 3]> + Clone) -> [f32; 3] {
    [0, 1, 2]
        .map(|axis| median(&points.clone().map(|point| f64::from(point[axis])).collect::<Vec<_>>()) as f32)
}

/// The value that Student's t with `freedom` degrees of freedom exceeds with this probability.
pub(crate) fn student_t(freedom: f64, exceeded: f64) -> f64 {
    // The location and the scale are valid, and so is any positive freedom.
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(1.0 - exceeded))
}

/// The greatest share of which so many of a number of trials are not too few, with this confidence (Clopper and Pearson 1934).
pub(crate) fn at_most(count: usize, of: usize, confidence: f64) -> f64 {
    if count >= of {
        return 1.0;
    }
    Beta::new(count as f64 + 1.0, (of - count) as f64).map_or(1.0, |share| share.inverse_cdf(confidence))
}

/// Frames in which the errors of positions are measured. A marker that jumps is seen in few of them. Halved or doubled, no verdict on 198 jobs
/// changes.
const NOISE_FRAMES: usize = 12;

/// How far apart two of these positions of an object at rest seem to be at most, as a rule, in metres. It is 0 where too few frames show it.
pub(crate) fn noise_m(places: &[Option<[f32; 3]>]) -> f32 {
    let of =
        |places: &[Option<[f32; 3]>]| f64::from(andon_core::couple::jitter_bound_m(places.iter().copied()));
    let known: Vec<f64> = places.chunks(NOISE_FRAMES).map(of).filter(|noise_m| *noise_m > 0.0).collect();
    median(&known) as f32
}
