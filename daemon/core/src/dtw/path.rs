//! The warping path, for barycentres.

use super::batch::Scratch;
use super::local_costs::LocalCosts;
use super::{Refused, check};
use crate::couple::Motion;

/// The best path to a cell comes from the frames before, of both sequences.
const DIAGONAL: u8 = 0;
/// It comes from the same frame of `b` and the frame before of `a`.
const UP: u8 = 1;
/// It comes from the same frame of `a` and the frame before of `b`.
const LEFT: u8 = 2;

/// A warping path with the minimum sum: pairs of indices `(i, j)` of `a` and `b`, from the last pair back to `(0, 0)`.
///
/// Of equally good steps the diagonal one is taken, else the one along `a`, as dtaidistance does.
#[derive(Clone, Debug)]
pub struct Path<'m> {
    moves: &'m [u8],
    columns: usize,
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
        self.at = match self.moves[i * self.columns + j] {
            DIAGONAL => i.checked_sub(1).zip(j.checked_sub(1)),
            UP => i.checked_sub(1).map(|i| (i, j)),
            _ => j.checked_sub(1).map(|j| (i, j)),
        };
        Some((i, j))
    }
}

/// The warping path of two sequences. `moves` needs `a.len() * b.len()` bytes, one per cell; their contents do not matter.
///
/// # Errors
/// If a sequence is empty or longer than [`IU_FRAMES`](crate::capacity::IU_FRAMES), or `moves` is too short.
pub fn path<'m>(
    costs: &LocalCosts,
    a: &[Motion],
    b: &[Motion],
    moves: &'m mut [u8],
    scratch: &mut Scratch,
) -> Result<Path<'m>, Refused> {
    check(a)?;
    check(b)?;
    let columns = b.len();
    let (needed, given) = (a.len() * columns, moves.len());
    let Some(moves) = moves.get_mut(..needed) else { return Err(Refused::Memory { needed, given }) };
    let symbols = &mut scratch.symbols[0];
    let symbols = costs.read(b, false, symbols).then_some(&*symbols);
    scratch.row.begin(columns);
    for (frame, moves) in a.iter().zip(moves.chunks_exact_mut(columns)) {
        let mut moves = moves.iter_mut();
        costs.advance_with(&mut scratch.row, frame, b, symbols, |diagonal, up, left| {
            if let Some(step) = moves.next() {
                *step = if diagonal <= up.min(left) {
                    DIAGONAL
                } else if up <= left {
                    UP
                } else {
                    LEFT
                };
            }
        });
    }
    let distance = costs.distance_of(scratch.row.cell(columns - 1));
    Ok(Path { moves, columns, at: Some((a.len() - 1, columns - 1)), distance })
}
