//! The SIMD path: 32 cells at once with the 256-bit vectors of x86-64-v3, found at run time.
//!
//! It computes the same integers as the portable path. It takes only motions that have symbols and costs that fit two bytes. Those are ordinal costs,
//! normalised ones with up to 15 bins, and circular ones with 4, 5, 6, 8, 10 or 12 bins. Everything else takes the portable path.
//!
//! Everything that computes with vectors is in types that implement `NullaryFnOnce` or in functions that are always inlined. Other functions would be
//! compiled without the vector instructions and called for each of them.

use super::cost::{IntegerCosts, UNREACHED};
use super::scratch::{LANES, Scratch};
use super::symbols::{BLOCK, DIGIT, Digits, PLANES, Tables};
use crate::couple::Motion;
use core::arch::x86_64::__m256i;
use pulp::NullaryFnOnce;
use pulp::bytemuck::cast;
use pulp::x86::V3;

/// The proof that the processor has the vectors, and the costs.
#[derive(Clone, Debug)]
pub(super) struct Simd {
    v3: V3,
    pub(super) tables: Tables,
}

impl Simd {
    /// `None` if the processor or the costs do not allow it.
    pub(super) fn new(costs: &IntegerCosts) -> Option<Self> {
        Some(Self { v3: V3::try_new()?, tables: Tables::new(costs)? })
    }

    /// Computes the next row in place and returns its minimum. `None` if the reference or the frame has no symbols, and then nothing has changed.
    pub(super) fn advance(&self, frame: &Motion, scratch: &mut Scratch) -> Option<i32> {
        let (v3, tables) = (self.v3, &self.tables);
        let frame = tables.symbols(frame).filter(|_| scratch.symbols.length > 0)?;
        Some(v3.vectorize(Advance { v3, tables, frame, scratch }))
    }
}

/// Low and high digits: of each symbol, or of the costs of 32 cells.
type DigitPair = [__m256i; 2];

/// The digits of 32 cells of which these are the symbols.
#[inline(always)]
fn look_up(v3: V3, digits: &Digits, symbols: __m256i) -> DigitPair {
    let [low, high] = *digits;
    [
        v3.avx2._mm256_shuffle_epi8(cast([low, low]), symbols),
        v3.avx2._mm256_shuffle_epi8(cast([high, high]), symbols),
    ]
}

/// `low * low_unit + high * high_unit` for the two bytes of each `i16`.
#[inline(always)]
fn combine(v3: V3, [low, high]: DigitPair, low_unit: i16, high_unit: i16) -> __m256i {
    v3.avx2._mm256_add_epi16(
        v3.avx2._mm256_maddubs_epi16(low, v3.avx._mm256_set1_epi16(low_unit)),
        v3.avx2._mm256_maddubs_epi16(high, v3.avx._mm256_set1_epi16(high_unit)),
    )
}

/// Combines the digits. Byte `4 k + r` goes to lane `k` of vector `r`, without shuffles, which are the bottleneck here.
#[inline(always)]
fn widen(v3: V3, digits: DigitPair) -> [__m256i; BLOCK / LANES] {
    let even = combine(v3, digits, 1, DIGIT as i16);
    let odd = combine(v3, digits, 1 << 8, (DIGIT as i16) << 8);
    let mask = v3.avx._mm256_set1_epi32(0xffff);
    [
        v3.avx2._mm256_and_si256(even, mask),
        v3.avx2._mm256_and_si256(odd, mask),
        v3.avx2._mm256_srli_epi32::<16>(even),
        v3.avx2._mm256_srli_epi32::<16>(odd),
    ]
}

#[inline(always)]
fn add(v3: V3, one: __m256i, other: __m256i) -> __m256i {
    v3.avx2._mm256_add_epi32(one, other)
}

#[inline(always)]
fn min(v3: V3, one: __m256i, other: __m256i) -> __m256i {
    v3.avx2._mm256_min_epi32(one, other)
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

/// Zeros in the first half; the last value of the first half in all lanes of the second.
#[inline(always)]
fn first_half_end(v3: V3, vector: __m256i) -> __m256i {
    v3.avx2._mm256_permute2x128_si256::<0x08>(v3.avx2._mm256_shuffle_epi32::<0xff>(vector), vector)
}

/// Computes the next row in place and returns its minimum.
struct Advance<'a> {
    v3: V3,
    tables: &'a Tables,
    frame: [u8; PLANES],
    scratch: &'a mut Scratch,
}

impl Advance<'_> {
    /// Costs of the frame against the 32 motions of a block of the reference.
    #[inline(always)]
    fn costs(&self, of_frame: &[&Digits; PLANES], block: usize) -> [__m256i; BLOCK / LANES] {
        let (avx2, mut sums) = (self.v3.avx2, [self.v3.avx._mm256_setzero_si256(); 2]);
        #[allow(clippy::needless_range_loop, reason = "zipped iterators are not unrolled: twice as slow")]
        for plane in 0..PLANES {
            let symbols = self.scratch.symbols.planes[plane].as_chunks::<BLOCK>().0[block];
            let [low, high] = look_up(self.v3, of_frame[plane], cast(symbols));
            sums = [avx2._mm256_add_epi8(sums[0], low), avx2._mm256_add_epi8(sums[1], high)];
        }
        widen(self.v3, sums)
    }
}

impl NullaryFnOnce for Advance<'_> {
    type Output = i32;

    /// In a plain loop each cell waits for the cell to its left: a minimum and an addition. Here the 32 cells of a block are first computed as if
    /// nothing came from the left, four in each lane. Then the lanes are combined in three steps of doubling width, without waiting for the block
    /// before. Last, the value from that block is added. Only one addition, one minimum and one broadcast then remain in the chain from block to
    /// block.
    #[inline(always)]
    fn call(self) -> i32 {
        let (v3, avx, avx2, length) = (self.v3, self.v3.avx, self.v3.avx2, self.scratch.symbols.length);
        let [ordered, directions @ ..] = self.frame.map(usize::from);
        let [a, b, c, d] = directions.map(|direction| &self.tables.direction[direction]);
        let of_frame = [&self.tables.ordered[ordered], a, b, c, d];
        let unreached = avx._mm256_set1_epi32(UNREACHED);
        let mut corner = avx._mm256_set1_epi32(core::mem::replace(&mut self.scratch.border, UNREACHED));
        let (mut carry, mut least) = (unreached, unreached);
        for block in 0..length.div_ceil(BLOCK) {
            let cost = self.costs(&of_frame, block);
            let cells = self.scratch.blocks[block].as_chunks_mut::<LANES>().0;

            // From above, and along the four cells of a lane. `from_left` is the cost of a path that enters the lane from the left.
            let up: [__m256i; BLOCK / LANES] =
                [cast(cells[0]), cast(cells[1]), cast(cells[2]), cast(cells[3])];
            let last_up = rotate(v3, up[3]);
            let mut best = [add(v3, min(v3, with_first(v3, corner, last_up), up[0]), cost[0]); 4];
            corner = last_up;
            let mut from_left = cost;
            for r in 1..4 {
                best[r] = add(v3, min(v3, min(v3, up[r], up[r - 1]), best[r - 1]), cost[r]);
                from_left[r] = add(v3, from_left[r - 1], cost[r]);
            }

            // From lane to lane. The shifts fill in 0, which as a sum is `UNREACHED` and as a cost is nothing.
            let (mut through, mut whole) = (best[3], from_left[3]);
            through = min(v3, through, add(v3, avx2._mm256_slli_si256::<4>(through), whole));
            whole = add(v3, whole, avx2._mm256_slli_si256::<4>(whole));
            through = min(v3, through, add(v3, avx2._mm256_slli_si256::<8>(through), whole));
            whole = add(v3, whole, avx2._mm256_slli_si256::<8>(whole));
            through = min(v3, through, add(v3, first_half_end(v3, through), whole));
            whole = add(v3, whole, first_half_end(v3, whole));

            // From the block before.
            best[3] = min(v3, through, add(v3, carry, whole));
            let left = with_first(v3, carry, rotate(v3, best[3]));
            carry = avx2._mm256_permutevar8x32_epi32(best[3], avx._mm256_set1_epi32(LANES as i32 - 1));
            for r in 0..3 {
                best[r] = min(v3, best[r], add(v3, left, from_left[r]));
            }

            let remaining = length - block * BLOCK;
            let mut indices = cast([0, 4, 8, 12, 16, 20, 24, 28]);
            for (best, cells) in best.iter_mut().zip(cells) {
                *cells = cast(*best);
                if remaining < BLOCK {
                    // Cells beyond the reference must not count: all bits set is above every reached value.
                    let last = avx._mm256_set1_epi32(remaining as i32 - 1);
                    *best = avx2._mm256_or_si256(*best, avx2._mm256_cmpgt_epi32(indices, last));
                    indices = add(v3, indices, avx._mm256_set1_epi32(1));
                }
                least = min(v3, least, *best);
            }
        }
        cast::<__m256i, [i32; LANES]>(least).into_iter().fold(UNREACHED, i32::min)
    }
}
