//! The SIMD path: 32 cells at once with the 256-bit vectors of x86-64-v3, found at run time.
//!
//! It computes the same whole numbers as `LocalCosts::between` and the portable loops. It takes only motions whose features are in
//! range and costs that two bytes can hold (ordinal, and circular with 4, 5, 6, 8, 10 or 12 bins); all else goes the portable way.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod symbols;

pub(super) use symbols::{ROOM, Symbols, Tables};

use super::cost::LocalCosts;
use crate::couple::Motion;

/// Proof that the processor has the instructions.
#[cfg(target_arch = "x86_64")]
type Token = pulp::x86::V3;

/// No other processor has a SIMD path yet.
#[cfg(not(target_arch = "x86_64"))]
#[derive(Clone, Copy, Debug)]
enum Token {}

/// What the SIMD path needs of the costs.
#[derive(Clone, Debug)]
pub(super) struct Simd {
    token: Token,
    pub(super) tables: Tables,
}

/// A row of the DTW matrix: the border, the cells, and the rest of the last block.
pub(super) const ROW: usize = 1 + ROOM + 8;

impl Simd {
    /// `None` where the processor or the costs do not allow it.
    #[cfg(target_arch = "x86_64")]
    pub(super) fn new(costs: &LocalCosts) -> Option<Self> {
        Some(Self { token: Token::try_new()?, tables: Tables::new(costs)? })
    }

    /// `None`: there is no SIMD path for this processor.
    #[cfg(not(target_arch = "x86_64"))]
    pub(super) fn new(_: &LocalCosts) -> Option<Self> {
        None
    }

    /// `online::next_row` for a reference of which the symbols are known. `None` if the frame has a feature that is out of range; then
    /// nothing has changed.
    pub(super) fn next_row(
        &self,
        frame: &Motion,
        reference: &Symbols,
        places: usize,
        row: &mut [i32; ROW],
    ) -> Option<i32> {
        #[cfg(target_arch = "x86_64")]
        return avx2::next_row(self.token, &self.tables, frame, reference, places, row);
        #[cfg(not(target_arch = "x86_64"))]
        match self.token {}
    }

    /// Value of the last cell of the DTW matrix of two sequences, `x` read forwards and `y` backwards; `None` if it is over `bound`.
    pub(super) fn last_cell(
        &self,
        x: (&Symbols, usize),
        y: (&Symbols, usize),
        bound: i32,
        diagonals: &mut [[i32; ROW]; 3],
    ) -> Option<i32> {
        #[cfg(target_arch = "x86_64")]
        return avx2::last_cell(self.token, &self.tables, x, y, bound, diagonals);
        #[cfg(not(target_arch = "x86_64"))]
        match self.token {}
    }
}
