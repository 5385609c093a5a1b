//! The kernels for x86-64-v3.
//!
//! Everything that computes with vectors is in types that implement `NullaryFnOnce` or in functions that are always inlined. Other functions would be
//! compiled without the vector instructions and called for each of them.

mod costs;
mod row;

use crate::couple::Motion;
use crate::dtw::cost::IntegerCosts;
use crate::dtw::row::{LANES, Row};
use crate::dtw::symbols::{Symbols, Tables};
use core::arch::x86_64::__m256i;
use pulp::bytemuck::cast;
use pulp::x86::V3;

/// The SIMD path: the proof that the processor has it, and the costs.
#[derive(Clone, Debug)]
pub(crate) struct Simd {
    v3: V3,
    tables: Tables,
}

impl Simd {
    /// `None` if the processor or the costs do not allow it.
    pub(crate) fn new(costs: &IntegerCosts) -> Option<Self> {
        Some(Self { v3: V3::try_new()?, tables: Tables::new(costs)? })
    }

    /// [`Symbols::read`].
    pub(crate) fn read(&self, motions: &[Motion], symbols: &mut Symbols) {
        symbols.read(&self.tables, motions);
    }

    /// Computes the next row in place and returns its minimum. `None` if the reference or the frame has no symbols, and then nothing has changed.
    pub(crate) fn advance(&self, frame: &Motion, reference: &Symbols, row: &mut Row) -> Option<i32> {
        let (v3, tables) = (self.v3, &self.tables);
        let frame = tables.symbols(frame).filter(|_| reference.length > 0)?;
        Some(v3.vectorize(row::Advance { v3, tables, frame, reference, row }))
    }
}

#[inline(always)]
fn load(values: &[i32], at: usize) -> __m256i {
    cast(values[at..at + LANES].as_chunks::<LANES>().0[0])
}

/// All values moved by one lane, the last one into the first lane.
#[inline(always)]
fn rotate(v3: V3, vector: __m256i) -> __m256i {
    v3.avx2._mm256_permutevar8x32_epi32(vector, cast([7, 0, 1, 2, 3, 4, 5, 6]))
}

/// The first lane of one vector with the other lanes of another.
#[inline(always)]
fn with_first(v3: V3, first: __m256i, others: __m256i) -> __m256i {
    v3.avx2._mm256_blend_epi32::<1>(others, first)
}
