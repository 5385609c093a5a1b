//! Two whole sequences.

use super::cost::{LocalCosts, UNREACHED};
use super::online::next_row;
use super::{Refused, accept};
use crate::capacity::IU_FRAMES;
use crate::couple::Motion;

/// Working memory of [`distance`], [`distance_within`] and [`path`](super::path): reuse it, it needs no clearing.
#[derive(Clone, Debug)]
pub struct Scratch {
    pub(super) row: [u32; IU_FRAMES],
}

impl Scratch {
    /// New memory.
    pub const fn new() -> Self {
        Self { row: [UNREACHED; IU_FRAMES] }
    }
}

impl Default for Scratch {
    fn default() -> Self {
        Self::new()
    }
}

/// The DTW distance of two sequences: square root of the least sum of squared Euclidean local costs, no window
/// (DESIGN 4; `dtaidistance.dtw_ndim.distance`).
///
/// # Errors
/// If a sequence is empty or longer than [`IU_FRAMES`].
pub fn distance(
    costs: &LocalCosts,
    a: &[Motion],
    b: &[Motion],
    scratch: &mut Scratch,
) -> Result<f64, Refused> {
    // No sum is greater, so this bound never abandons.
    let sum = least_sum(costs, a, b, UNREACHED, scratch)?.unwrap_or(UNREACHED);
    Ok(costs.distance_of(sum))
}

/// [`distance`] if it is at most `bound`, else `None`, often long before the end.
///
/// # Errors
/// As [`distance`].
pub fn distance_within(
    costs: &LocalCosts,
    a: &[Motion],
    b: &[Motion],
    bound: f64,
    scratch: &mut Scratch,
) -> Result<Option<f64>, Refused> {
    accept(a)?;
    accept(b)?;
    let Some(bound) = costs.greatest_sum(bound) else { return Ok(None) };
    Ok(least_sum(costs, a, b, bound, scratch)?.map(|sum| costs.distance_of(sum)))
}

/// The least sum of a warping path if it is at most `bound`.
fn least_sum(
    costs: &LocalCosts,
    a: &[Motion],
    b: &[Motion],
    bound: u32,
    scratch: &mut Scratch,
) -> Result<Option<u32>, Refused> {
    accept(a)?;
    accept(b)?;
    let row = &mut scratch.row[..b.len()];
    row.fill(UNREACHED);
    for (i, frame) in a.iter().enumerate() {
        if next_row(costs, frame, b, i == 0, row) > bound {
            return Ok(None);
        }
    }
    Ok(Some(row[b.len() - 1]).filter(|&sum| sum <= bound))
}
