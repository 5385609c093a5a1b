//! Working memory, which holds a row of the DTW matrix, and the distance of two whole sequences.

use super::cost::{ORIGIN, UNREACHED};
use super::local_costs::LocalCosts;
use super::symbols::{BLOCK, Symbols};
use super::{Refused, check};
use crate::capacity::IU_FRAMES;
use crate::couple::Motion;

/// Values in one vector.
pub(super) const LANES: usize = 8;

/// Working memory of [`distance`], [`distance_within`] and [`path`](super::path). It can be reused without clearing.
///
/// It holds the newest row. In a block of 32 cells, cell `c` is at `c / 4 + 8 * (c % 4)`: four vectors of eight. A cell and its left neighbour are in
/// the same lane of neighbouring vectors, and only every fourth cell needs a shuffle. The bytes of a vector widen in that order too.
#[derive(Clone, Debug)]
pub struct Scratch {
    /// The cell before the first one.
    pub(super) border: i32,
    pub(super) blocks: [[i32; BLOCK]; IU_FRAMES / BLOCK],
    /// Those of the reference.
    pub(super) symbols: Symbols,
}

impl Default for Scratch {
    fn default() -> Self {
        Self { border: ORIGIN, blocks: [[UNREACHED; BLOCK]; IU_FRAMES / BLOCK], symbols: Symbols::new() }
    }
}

impl Scratch {
    /// Before the first row of this reference: only the border has been reached.
    pub(super) fn begin(&mut self, costs: &LocalCosts, reference: &[Motion]) {
        costs.read(reference, &mut self.symbols);
        self.border = ORIGIN;
        self.blocks[..reference.len().div_ceil(BLOCK)].fill([UNREACHED; BLOCK]);
    }

    /// Computes the next row of a frame that costs nothing anywhere: each cell becomes the minimum of those up to it.
    pub(super) fn advance_free(&mut self, length: usize) {
        let mut min = core::mem::replace(&mut self.border, UNREACHED);
        for index in 0..length {
            let cell = &mut self.blocks[index / BLOCK][slot(index)];
            min = min.min(*cell);
            *cell = min;
        }
    }

    /// The value of a cell.
    pub(super) fn cell(&self, index: usize) -> i32 {
        self.blocks[index / BLOCK][slot(index)]
    }
}

/// Where the cell with this index lies in its block.
pub(super) fn slot(index: usize) -> usize {
    let index = index % BLOCK;
    index / (BLOCK / LANES) + LANES * (index % (BLOCK / LANES))
}

/// The DTW distance of two sequences, as `dtw_ndim.distance` of dtaidistance.
///
/// # Errors
/// If a sequence is empty or longer than [`IU_FRAMES`].
pub fn distance(
    costs: &LocalCosts,
    a: &[Motion],
    b: &[Motion],
    scratch: &mut Scratch,
) -> Result<f64, Refused> {
    // No distance is greater than this bound, so the computation never stops early.
    Ok(distance_within(costs, a, b, f64::INFINITY, scratch)?.unwrap_or(f64::INFINITY))
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
    // Fewer rows are faster.
    let [frames, reference] = if a.len() <= b.len() { [a, b] } else { [b, a] };
    scratch.begin(costs, reference);
    for frame in frames {
        if costs.advance(scratch, frame, reference) > bound {
            return Ok(None);
        }
    }
    let value = scratch.cell(reference.len() - 1);
    Ok((value <= bound).then(|| costs.integers.distance_of(value)))
}
