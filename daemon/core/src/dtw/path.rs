//! The warping path, for barycentres.

use super::cost::UNREACHED;
use super::local_costs::LocalCosts;
use super::scratch::{Scratch, slot};
use super::symbols::BLOCK;
use super::{Refused, check};
use crate::couple::Motion;

/// Memory of [`path`] for up to 32 neighbouring cells of a row of the DTW matrix.
pub type Cells = [i32; BLOCK];

/// How many items of memory [`path`] needs for two sequences of these lengths, in frames.
pub const fn path_memory(a: usize, b: usize) -> usize {
    a * b.div_ceil(BLOCK)
}

/// The DTW distance of two sequences, equal to [`distance`](super::distance) in every bit, and a warping path with the minimum sum. The path is pairs of
/// indices `(i, j)` of `a` and `b`, from the last pair back to `(0, 0)`. Of equally good steps the diagonal one is taken, else the one along `a`, as
/// dtaidistance does. `memory` needs [`path_memory`] items; their contents do not matter.
///
/// # Errors
/// If a sequence is empty or longer than [`IU_FRAMES`](crate::capacity::IU_FRAMES), or `memory` is too short.
pub fn path<'m>(
    costs: &LocalCosts,
    a: &[Motion],
    b: &[Motion],
    memory: &'m mut [Cells],
    scratch: &mut Scratch,
) -> Result<(f64, impl Iterator<Item = (usize, usize)> + use<'m>), Refused> {
    check(a)?;
    check(b)?;
    let per_row = b.len().div_ceil(BLOCK);
    let (needed, given) = (path_memory(a.len(), b.len()), memory.len());
    let Some(blocks) = memory.get_mut(..needed) else { return Err(Refused::Memory { needed, given }) };
    scratch.begin(costs, b);
    for (frame, blocks) in a.iter().zip(blocks.chunks_exact_mut(per_row)) {
        costs.advance(scratch, frame, b);
        blocks.copy_from_slice(&scratch.blocks[..per_row]);
    }
    let distance = costs.integers.distance_of(scratch.cell(b.len() - 1));
    // The whole matrix; a cell outside it is reached by no path.
    let cell = move |i: Option<usize>, j: Option<usize>| {
        i.zip(j).map_or(UNREACHED, |(i, j)| blocks[i * per_row + j / BLOCK][slot(j)])
    };
    let before = move |&(i, j): &(usize, usize)| {
        let [up, left] = [i.checked_sub(1), j.checked_sub(1)];
        let [diagonal_cell, up_cell, left_cell] = [cell(up, left), cell(up, Some(j)), cell(Some(i), left)];
        if diagonal_cell <= up_cell.min(left_cell) {
            up.zip(left)
        } else if up_cell <= left_cell {
            up.map(|i| (i, j))
        } else {
            left.map(|j| (i, j))
        }
    };
    Ok((distance, core::iter::successors(Some((a.len() - 1, b.len() - 1)), before)))
}
