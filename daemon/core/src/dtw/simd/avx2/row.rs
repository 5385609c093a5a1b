//! The next row for one reference.

use super::costs::OfFrame;
use super::{load, rotate, with_first};
use crate::dtw::cost::UNREACHED;
use crate::dtw::row::{LANES, Row};
use crate::dtw::symbols::{BLOCK, PLANES, Symbols, Tables};
use core::arch::x86_64::__m256i;
use pulp::NullaryFnOnce;
use pulp::bytemuck::cast;
use pulp::x86::V3;

/// Computes the next row in place and returns its minimum.
pub(super) struct Advance<'a> {
    pub(super) v3: V3,
    pub(super) tables: &'a Tables,
    pub(super) frame: [u8; PLANES],
    pub(super) reference: &'a Symbols,
    pub(super) row: &'a mut Row,
}

impl NullaryFnOnce for Advance<'_> {
    type Output = i32;

    /// In a plain loop each cell waits for the cell to its left: a minimum and an addition. Here the 32 cells of a block are first computed as if
    /// nothing came from the left, four in each lane. Then the lanes are combined in three steps of doubling width, without waiting for the block
    /// before. Last, the value from that block is added. Only one addition, one minimum and one broadcast then remain in the chain from block to
    /// block.
    #[inline(always)]
    fn call(self) -> i32 {
        let Self { v3, row, .. } = self;
        let (avx, avx2, length) = (v3.avx, v3.avx2, self.reference.length);
        let of_frame = OfFrame::new(self.tables, self.frame);
        let unreached = avx._mm256_set1_epi32(UNREACHED);
        let mut corner = avx._mm256_set1_epi32(row.border);
        row.border = UNREACHED;
        let mut carry = unreached;
        let mut min = unreached;
        for (block, cells) in row.blocks[..length.div_ceil(BLOCK)].iter_mut().enumerate() {
            let mut symbols = [unreached; PLANES];
            for (symbols, plane) in symbols.iter_mut().zip(&self.reference.planes) {
                *symbols = cast(plane.as_chunks::<BLOCK>().0[block]);
            }
            let cost = of_frame.costs(v3, &symbols);

            // From above, and along the four cells of a lane. `from_left` is the cost of a path that enters the lane from the left.
            let up = [load(cells, 0), load(cells, LANES), load(cells, 2 * LANES), load(cells, 3 * LANES)];
            let last_up = rotate(v3, up[3]);
            let mut best = [avx2._mm256_min_epi32(with_first(v3, corner, last_up), up[0]); 4];
            corner = last_up;
            best[0] = avx2._mm256_add_epi32(best[0], cost[0]);
            let mut from_left = cost;
            for r in 1..4 {
                let above = avx2._mm256_min_epi32(up[r], up[r - 1]);
                best[r] = avx2._mm256_add_epi32(avx2._mm256_min_epi32(above, best[r - 1]), cost[r]);
                from_left[r] = avx2._mm256_add_epi32(from_left[r - 1], cost[r]);
            }

            // From lane to lane. The shifts fill in 0, which as a sum is `UNREACHED` and as a cost is nothing.
            let (mut through, mut whole) = (best[3], from_left[3]);
            through = avx2._mm256_min_epi32(
                through,
                avx2._mm256_add_epi32(avx2._mm256_slli_si256::<4>(through), whole),
            );
            whole = avx2._mm256_add_epi32(whole, avx2._mm256_slli_si256::<4>(whole));
            through = avx2._mm256_min_epi32(
                through,
                avx2._mm256_add_epi32(avx2._mm256_slli_si256::<8>(through), whole),
            );
            whole = avx2._mm256_add_epi32(whole, avx2._mm256_slli_si256::<8>(whole));
            through =
                avx2._mm256_min_epi32(through, avx2._mm256_add_epi32(first_half_end(v3, through), whole));
            whole = avx2._mm256_add_epi32(whole, first_half_end(v3, whole));

            // From the block before.
            best[3] = avx2._mm256_min_epi32(through, avx2._mm256_add_epi32(carry, whole));
            let left = with_first(v3, carry, rotate(v3, best[3]));
            carry = avx2._mm256_permutevar8x32_epi32(best[3], avx._mm256_set1_epi32(LANES as i32 - 1));
            for r in 0..3 {
                best[r] = avx2._mm256_min_epi32(best[r], avx2._mm256_add_epi32(left, from_left[r]));
            }

            let remaining = length - block * BLOCK;
            let mut indices = cast([0, 4, 8, 12, 16, 20, 24, 28]);
            for (best, cells) in best.iter_mut().zip(cells.as_chunks_mut::<LANES>().0) {
                *cells = cast(*best);
                if remaining < BLOCK {
                    // Cells beyond the reference must not count: all bits set is above every reached value.
                    let beyond =
                        avx2._mm256_cmpgt_epi32(indices, avx._mm256_set1_epi32(remaining as i32 - 1));
                    *best = avx2._mm256_or_si256(*best, beyond);
                    indices = avx2._mm256_add_epi32(indices, avx._mm256_set1_epi32(1));
                }
                min = avx2._mm256_min_epi32(min, *best);
            }
        }
        cast::<__m256i, [i32; LANES]>(min).into_iter().fold(UNREACHED, i32::min)
    }
}

/// Zeros in the first half; the last value of the first half in all lanes of the second.
#[inline(always)]
fn first_half_end(v3: V3, vector: __m256i) -> __m256i {
    v3.avx2._mm256_permute2x128_si256::<0x08>(v3.avx2._mm256_shuffle_epi32::<0xff>(vector), vector)
}
