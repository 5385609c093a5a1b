//! Two whole sequences.

use super::cost::{LocalCosts, UNREACHED};
use super::row::Row;
use super::simd::{BORDER_ROOM, Border};
use super::symbols::{BLOCK, Symbols};
use super::{Refused, accept};
use crate::couple::Motion;

/// Working memory of [`distance`], [`distance_within`] and [`path`](super::path): reuse it, it needs no clearing.
#[derive(Clone, Debug)]
pub struct Scratch {
    pub(super) row: Row,
    border: Border,
    pub(super) symbols: [Symbols; 2],
}

impl Scratch {
    /// New memory.
    pub const fn new() -> Self {
        Self { row: Row::new(), border: [UNREACHED; BORDER_ROOM], symbols: [const { Symbols::new() }; 2] }
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
/// If a sequence is empty or longer than [`IU_FRAMES`](crate::capacity::IU_FRAMES).
pub fn distance(
    costs: &LocalCosts,
    a: &[Motion],
    b: &[Motion],
    scratch: &mut Scratch,
) -> Result<f64, Refused> {
    // No value is greater, so this bound never abandons.
    let value = last_cell(costs, a, b, UNREACHED, scratch)?.unwrap_or(UNREACHED);
    Ok(costs.distance_of(value))
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
    let Some(bound) = costs.greatest_value(bound) else { return Ok(None) };
    Ok(last_cell(costs, a, b, bound, scratch)?.map(|value| costs.distance_of(value)))
}

/// Value of the last cell of the DTW matrix if it is at most `bound`.
fn last_cell(
    costs: &LocalCosts,
    a: &[Motion],
    b: &[Motion],
    bound: i32,
    scratch: &mut Scratch,
) -> Result<Option<i32>, Refused> {
    accept(a)?;
    accept(b)?;
    // The matrix is done in strips of rows: the fewer, the better.
    let [a, b] =
        if a.len().div_ceil(BLOCK) * b.len() <= b.len().div_ceil(BLOCK) * a.len() { [a, b] } else { [b, a] };
    let [x, y] = &mut scratch.symbols;
    if let Some(simd) = costs.simd()
        && x.read_for(costs, a, false)
        && y.read_for(costs, b, true)
    {
        return Ok(simd.last_cell((x, a.len()), (y, b.len()), bound, &mut scratch.border));
    }
    let symbols = y.read_for(costs, b, false).then_some(&*y);
    scratch.row.begin(b.len());
    for frame in a {
        if scratch.row.advance(costs, frame, b, symbols) > bound {
            return Ok(None);
        }
    }
    Ok(Some(scratch.row.cell(b.len() - 1)).filter(|&value| value <= bound))
}
