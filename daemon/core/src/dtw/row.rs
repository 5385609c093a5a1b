//! A row of the DTW matrix.

use super::cost::{LocalCosts, ORIGIN, UNREACHED};
use super::symbols::{BLOCK, Symbols};
use crate::capacity::IU_FRAMES;
use crate::couple::Motion;

/// Values in one vector.
pub(super) const LANES: usize = 8;

/// The newest row, and the border cell before it.
///
/// In a block of 32 cells, cell `c` is at `c / 4 + 8 * (c % 4)`: four vectors of eight, so that a cell and its left neighbour are in the same
/// lane of neighbouring vectors and only every fourth cell needs a shuffle. The bytes of a vector widen in that order, too.
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// The cell before the first.
    pub(super) border: i32,
    pub(super) blocks: [[i32; BLOCK]; IU_FRAMES / BLOCK],
}

impl Row {
    pub(super) const fn new() -> Self {
        Self { border: ORIGIN, blocks: [[UNREACHED; BLOCK]; IU_FRAMES / BLOCK] }
    }

    /// The state before the first row: only the border has been reached.
    pub(super) fn begin(&mut self, places: usize) {
        self.border = ORIGIN;
        self.blocks[..places.div_ceil(BLOCK)].fill([UNREACHED; BLOCK]);
    }

    pub(super) fn cell(&self, place: usize) -> i32 {
        self.blocks[place / BLOCK][slot(place)]
    }

    /// Makes the next row in place by the fastest way and returns its least value. `symbols` are those of the reference, if it has any.
    pub(super) fn advance(
        &mut self,
        costs: &LocalCosts,
        frame: &Motion,
        reference: &[Motion],
        symbols: Option<&Symbols>,
    ) -> i32 {
        if let (Some(simd), Some(tables), Some(symbols)) = (costs.simd(), costs.tables(), symbols)
            && let Some(least) = simd.advance(tables, frame, symbols, reference.len(), self)
        {
            return least;
        }
        self.advance_with(costs, frame, reference, symbols, |_, _, _| {})
    }

    /// Makes the next row in place and returns its least value. Calls `visit` for each cell in order with the values of its three
    /// predecessors: diagonal, up, left.
    #[inline]
    pub(super) fn advance_with(
        &mut self,
        costs: &LocalCosts,
        frame: &Motion,
        reference: &[Motion],
        symbols: Option<&Symbols>,
        mut visit: impl FnMut(i32, i32, i32),
    ) -> i32 {
        let mut diagonal = core::mem::replace(&mut self.border, UNREACHED);
        let (mut left, mut least) = (UNREACHED, UNREACHED);
        let mut place = 0;
        let next = |cost: i32| {
            let cell = &mut self.blocks[place / BLOCK][slot(place)];
            let up = *cell;
            visit(diagonal, up, left);
            left = diagonal.min(up).min(left) + cost;
            *cell = left;
            diagonal = up;
            least = least.min(left);
            place += 1;
        };
        let by_symbols = symbols.zip(costs.tables());
        match by_symbols.and_then(|(symbols, tables)| Some((symbols, tables, tables.symbols(frame)?))) {
            Some((symbols, tables, frame)) => tables.costs(frame, symbols, reference.len(), next),
            None => reference.iter().map(|place| costs.between(frame, place)).for_each(next),
        }
        least
    }
}

/// Where a place is in its block.
pub(super) fn slot(place: usize) -> usize {
    let place = place % BLOCK;
    place / (BLOCK / LANES) + LANES * (place % (BLOCK / LANES))
}
