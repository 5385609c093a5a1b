//! The warping path, for barycentres.

use super::batch::Scratch;
use super::cost::UNREACHED;
use super::local_costs::LocalCosts;
use super::row::slot;
use super::symbols::BLOCK;
use super::{Refused, check};
use crate::couple::Motion;

/// Memory of [`path`] for up to 32 neighbouring cells of a row of the DTW matrix.
pub type Cells = [i32; BLOCK];

/// A warping path with the minimum sum: pairs of indices `(i, j)` of `a` and `b`, from the last pair back to `(0, 0)`.
///
/// Of equally good steps the diagonal one is taken, else the one along `a`, as dtaidistance does.
#[derive(Clone, Debug)]
pub struct Path<'m> {
    matrix: Matrix<'m>,
    /// The next pair to return.
    at: Option<(usize, usize)>,
    distance: f64,
}

impl Path<'_> {
    /// The DTW distance, equal to [`distance`](super::distance) in every bit.
    pub fn distance(&self) -> f64 {
        self.distance
    }
}

impl Iterator for Path<'_> {
    type Item = (usize, usize);

    fn next(&mut self) -> Option<Self::Item> {
        let (i, j) = self.at?;
        let [up, left] = [i.checked_sub(1), j.checked_sub(1)];
        let [diagonal_cell, up_cell, left_cell] =
            [(up, left), (up, Some(j)), (Some(i), left)].map(|(i, j)| self.matrix.cell(i, j));
        self.at = if diagonal_cell <= up_cell.min(left_cell) {
            up.zip(left)
        } else if up_cell <= left_cell {
            up.map(|i| (i, j))
        } else {
            left.map(|j| (i, j))
        };
        Some((i, j))
    }
}

/// The whole DTW matrix, row by row, with the cells of a row in the order of [`Row`](super::row::Row).
#[derive(Clone, Debug)]
struct Matrix<'m> {
    blocks: &'m [Cells],
    blocks_per_row: usize,
}

impl Matrix<'_> {
    /// The value of a cell; one outside the matrix is reached by no path.
    fn cell(&self, i: Option<usize>, j: Option<usize>) -> i32 {
        i.zip(j).map_or(UNREACHED, |(i, j)| self.blocks[i * self.blocks_per_row + j / BLOCK][slot(j)])
    }
}

/// How many items of memory [`path`] needs for two sequences of these lengths, in frames.
pub const fn path_memory(a: usize, b: usize) -> usize {
    a * b.div_ceil(BLOCK)
}

/// The warping path of two sequences. `memory` needs [`path_memory`] items; their contents do not matter.
///
/// # Errors
/// If a sequence is empty or longer than [`IU_FRAMES`](crate::capacity::IU_FRAMES), or `memory` is too short.
pub fn path<'m>(
    costs: &LocalCosts,
    a: &[Motion],
    b: &[Motion],
    memory: &'m mut [Cells],
    scratch: &mut Scratch,
) -> Result<Path<'m>, Refused> {
    check(a)?;
    check(b)?;
    let blocks_per_row = b.len().div_ceil(BLOCK);
    let (needed, given) = (path_memory(a.len(), b.len()), memory.len());
    let Some(blocks) = memory.get_mut(..needed) else { return Err(Refused::Memory { needed, given }) };
    let symbols = &mut scratch.symbols[0];
    let symbols = costs.read(b, false, symbols).then_some(&*symbols);
    scratch.row.begin(b.len());
    for (frame, blocks) in a.iter().zip(blocks.chunks_exact_mut(blocks_per_row)) {
        costs.advance(&mut scratch.row, frame, b, symbols);
        blocks.copy_from_slice(&scratch.row.blocks[..blocks_per_row]);
    }
    let distance = costs.distance_of(scratch.row.cell(b.len() - 1));
    Ok(Path { matrix: Matrix { blocks, blocks_per_row }, at: Some((a.len() - 1, b.len() - 1)), distance })
}
