//! Two whole sequences.

use super::cost::UNREACHED;
use super::local_costs::LocalCosts;
use super::row::Row;
use super::symbols::Symbols;
use super::{Refused, check};
use crate::couple::Motion;

/// Working memory of [`distance`], [`distance_within`] and [`path`](super::path). It can be reused without clearing.
#[derive(Clone, Debug)]
pub struct Scratch {
    pub(super) row: Row,
    pub(super) symbols: Symbols,
}

impl Scratch {
    /// New memory.
    pub const fn new() -> Self {
        Self { row: Row::new(), symbols: Symbols::new() }
    }

    /// Before the first row of this reference.
    pub(super) fn begin(&mut self, costs: &LocalCosts, reference: &[Motion]) {
        costs.read(reference, &mut self.symbols);
        self.row.begin(reference.len());
    }
}

impl Default for Scratch {
    fn default() -> Self {
        Self::new()
    }
}

/// The DTW distance of two sequences, as `dtw_ndim.distance` of dtaidistance.
///
/// # Errors
/// If a sequence is empty or longer than [`IU_FRAMES`](crate::capacity::IU_FRAMES).
pub fn distance(
    costs: &LocalCosts,
    a: &[Motion],
    b: &[Motion],
    scratch: &mut Scratch,
) -> Result<f64, Refused> {
    // No value is greater than this bound, so the computation never stops early.
    let value = last_cell(costs, a, b, UNREACHED, scratch)?.unwrap_or(UNREACHED);
    Ok(costs.integers.distance_of(value))
}

/// [`distance`] if it is at most `bound`, else `None`; that is often known long before the end.
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
    check(a)?;
    check(b)?;
    let Some(bound) = costs.integers.max_value(bound) else { return Ok(None) };
    Ok(last_cell(costs, a, b, bound, scratch)?.map(|value| costs.integers.distance_of(value)))
}

/// The value of the last cell of the DTW matrix if it is at most `bound`.
fn last_cell(
    costs: &LocalCosts,
    a: &[Motion],
    b: &[Motion],
    bound: i32,
    scratch: &mut Scratch,
) -> Result<Option<i32>, Refused> {
    check(a)?;
    check(b)?;
    // Fewer rows are faster.
    let [frames, reference] = if a.len() <= b.len() { [a, b] } else { [b, a] };
    scratch.begin(costs, reference);
    for frame in frames {
        if costs.advance(scratch, frame, reference) > bound {
            return Ok(None);
        }
    }
    Ok(Some(scratch.row.cell(reference.len() - 1)).filter(|&value| value <= bound))
}
