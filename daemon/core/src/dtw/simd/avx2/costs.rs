//! Costs of 32 cells at once.

use crate::dtw::row::LANES;
use crate::dtw::symbols::{BLOCK, DIGIT, Digits, PLANES, Tables};
use core::arch::x86_64::__m256i;
use pulp::bytemuck::cast;
use pulp::x86::V3;

/// Costs of 32 cells in the order of `Row`.
pub(super) type Costs = [__m256i; BLOCK / LANES];

/// Low and high digits for each value of four bits.
type DigitTables = [__m256i; 2];

#[inline(always)]
fn table(digits: Digits) -> DigitTables {
    [cast([digits[0], digits[0]]), cast([digits[1], digits[1]])]
}

/// Both digits for 32 cells.
#[inline(always)]
fn look_up(v3: V3, tables: DigitTables, indices: __m256i) -> [__m256i; 2] {
    [v3.avx2._mm256_shuffle_epi8(tables[0], indices), v3.avx2._mm256_shuffle_epi8(tables[1], indices)]
}

#[inline(always)]
fn add(v3: V3, sums: [__m256i; 2], digits: [__m256i; 2]) -> [__m256i; 2] {
    [v3.avx2._mm256_add_epi8(sums[0], digits[0]), v3.avx2._mm256_add_epi8(sums[1], digits[1])]
}

/// Combines the digits. Byte `4 k + r` goes to lane `k` of vector `r`, without shuffles, which are the bottleneck here.
#[inline(always)]
fn widen(v3: V3, [low, high]: [__m256i; 2]) -> Costs {
    let (avx, avx2) = (v3.avx, v3.avx2);
    let even = avx2._mm256_add_epi16(
        avx2._mm256_maddubs_epi16(low, avx._mm256_set1_epi16(1)),
        avx2._mm256_maddubs_epi16(high, avx._mm256_set1_epi16(DIGIT as i16)),
    );
    let odd = avx2._mm256_add_epi16(
        avx2._mm256_maddubs_epi16(low, avx._mm256_set1_epi16(1 << 8)),
        avx2._mm256_maddubs_epi16(high, avx._mm256_set1_epi16((DIGIT as i16) << 8)),
    );
    let mask = avx._mm256_set1_epi32(0xffff);
    [
        avx2._mm256_and_si256(even, mask),
        avx2._mm256_and_si256(odd, mask),
        avx2._mm256_srli_epi32::<16>(even),
        avx2._mm256_srli_epi32::<16>(odd),
    ]
}

/// Tables for one frame against any symbol, one pair per plane.
#[derive(Clone, Copy)]
pub(super) struct OfFrame([DigitTables; PLANES]);

impl OfFrame {
    #[inline(always)]
    pub(super) fn new(costs: &Tables, frame: [u8; PLANES]) -> Self {
        let [ordered, directions @ ..] = frame.map(usize::from);
        let mut tables = [table(costs.ordered[ordered]); PLANES];
        for (table_of, direction) in tables[1..].iter_mut().zip(directions) {
            *table_of = table(costs.direction[direction]);
        }
        Self(tables)
    }

    /// Costs of the frame against 32 motions, with one vector of symbols per plane.
    #[inline(always)]
    pub(super) fn costs(&self, v3: V3, symbols: &[__m256i; PLANES]) -> Costs {
        let mut sums = look_up(v3, self.0[0], symbols[0]);
        #[allow(
            clippy::needless_range_loop,
            reason = "zipped iterators are not unrolled here: twice as slow"
        )]
        for plane in 1..PLANES {
            sums = add(v3, sums, look_up(v3, self.0[plane], symbols[plane]));
        }
        widen(v3, sums)
    }
}
