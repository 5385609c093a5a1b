//! Two whole sequences.

use super::cost::{LocalCosts, ORIGIN, UNREACHED};
use super::online::next_row;
use super::simd::{ROW, Symbols};
use super::{Refused, accept};
use crate::couple::Motion;

/// Working memory of [`distance`], [`distance_within`] and [`path`](super::path): reuse it, it needs no clearing.
#[derive(Clone, Debug)]
pub struct Scratch {
    /// The newest diagonals of the matrix, or in the first the newest row.
    pub(super) cells: [[i32; ROW]; 3],
    /// The sequences for the SIMD path.
    symbols: [Symbols; 2],
}

impl Scratch {
    /// New memory.
    pub const fn new() -> Self {
        Self { cells: [[UNREACHED; ROW]; 3], symbols: [const { Symbols::new() }; 2] }
    }

    /// Room for a row of the matrix, before its first row.
    pub(super) fn row(&mut self, columns: usize) -> &mut [i32] {
        let row = &mut self.cells[0][..=columns];
        row.fill(UNREACHED);
        row[0] = ORIGIN;
        row
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
    if let Some(simd) = costs.simd() {
        let [x, y] = &mut scratch.symbols;
        if x.read(&simd.tables, a.iter()) && y.read(&simd.tables, b.iter().rev()) {
            return Ok(simd.last_cell((x, a.len()), (y, b.len()), bound, &mut scratch.cells));
        }
    }
    let row = scratch.row(b.len());
    for frame in a {
        if next_row(costs, frame, b, row) > bound {
            return Ok(None);
        }
    }
    Ok(Some(row[b.len()]).filter(|&value| value <= bound))
}
