//! A row of the DTW matrix.

use super::cost::{ORIGIN, UNREACHED};
use super::symbols::BLOCK;
use crate::capacity::IU_FRAMES;

/// Values in one vector.
pub(super) const LANES: usize = 8;

/// The newest row and the border cell before it.
///
/// In a block of 32 cells, cell `c` is at `c / 4 + 8 * (c % 4)`: four vectors of eight. A cell and its left neighbour are in the same lane of
/// neighbouring vectors, and only every fourth cell needs a shuffle. The bytes of a vector widen in that order too.
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// The cell before the first one.
    pub(super) border: i32,
    pub(super) blocks: [[i32; BLOCK]; IU_FRAMES / BLOCK],
}

impl Row {
    pub(super) const fn new() -> Self {
        Self { border: ORIGIN, blocks: [[UNREACHED; BLOCK]; IU_FRAMES / BLOCK] }
    }

    /// The state before the first row: only the border has been reached.
    pub(super) fn begin(&mut self, length: usize) {
        self.border = ORIGIN;
        self.blocks[..length.div_ceil(BLOCK)].fill([UNREACHED; BLOCK]);
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
