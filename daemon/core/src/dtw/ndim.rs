//! DTW of real vectors, for features that are not [`Motion`](crate::couple::Motion)s.

use super::Refused;

/// The DTW distance of two sequences of `D`-dimensional vectors: squared Euclidean local cost, no window, square root of
/// the sum, as `dtaidistance.dtw_ndim.distance` 2.5.1. `row` is working memory of at least `b.len()`; its contents do not matter.
///
/// # Errors
/// If a sequence is empty or `row` too short.
pub fn distance_ndim<const D: usize>(
    a: &[[f64; D]],
    b: &[[f64; D]],
    row: &mut [f64],
) -> Result<f64, Refused> {
    let (needed, given) = (b.len(), row.len());
    let (Some(row), false) = (row.get_mut(..needed), a.is_empty() || b.is_empty()) else {
        return Err(if given < needed { Refused::Memory { needed, given } } else { Refused::Empty });
    };
    row.fill(f64::INFINITY);
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = if i == 0 { 0.0 } else { f64::INFINITY };
        let mut left = f64::INFINITY;
        for (cell, y) in row.iter_mut().zip(b) {
            let up = *cell;
            let cost: f64 = x.iter().zip(y).map(|(x, y)| (x - y) * (x - y)).sum();
            left = diagonal.min(up).min(left) + cost;
            *cell = left;
            diagonal = up;
        }
    }
    Ok(libm::sqrt(row[needed - 1]))
}
