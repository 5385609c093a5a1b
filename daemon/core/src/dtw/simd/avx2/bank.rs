//! The next rows for 32 references.

use super::costs::OfFrame;
use super::load;
use crate::dtw::bank::{Column, Group};
use crate::dtw::cost::UNREACHED;
use crate::dtw::row::LANES;
use crate::dtw::simd::digits::Digits;
use crate::dtw::symbols::{BLOCK, PLANES, PLANES_FLAT};
use core::arch::x86_64::__m256i;
use pulp::NullaryFnOnce;
use pulp::bytemuck::cast;
use pulp::x86::V3;

/// Makes the next rows of a group in place.
pub(super) struct AdvanceGroup<'a> {
    pub(super) v3: V3,
    pub(super) digits: &'a Digits,
    pub(super) rest: u8,
    pub(super) frame: [u8; PLANES],
    pub(super) elevated: bool,
    pub(super) border: i32,
    pub(super) group: &'a mut Group,
    pub(super) columns: &'a mut [Column],
}

impl NullaryFnOnce for AdvanceGroup<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        if self.elevated { self.planes::<PLANES>() } else { self.planes::<PLANES_FLAT>() }
    }
}

impl AdvanceGroup<'_> {
    #[inline(always)]
    fn planes<const N: usize>(self) {
        let Self { v3, group, columns, .. } = self;
        let (avx, avx2) = (v3.avx, v3.avx2);
        let of_frame = OfFrame::<N>::new(v3, self.digits, self.rest, self.frame);
        let unreached = avx._mm256_set1_epi32(UNREACHED);
        let mut diagonal = [avx._mm256_set1_epi32(self.border); BLOCK / LANES];
        let mut left = [unreached; BLOCK / LANES];
        let mut least = left;
        let low = avx._mm256_set1_epi8(15);
        for (place, column) in columns.iter_mut().enumerate() {
            let mut symbols = [unreached; N];
            for (plane, symbols) in symbols.iter_mut().enumerate() {
                let packed: __m256i = cast(column.symbols[plane / 2]);
                let packed = if plane % 2 == 0 { packed } else { avx2._mm256_srli_epi16::<4>(packed) };
                *symbols = avx2._mm256_and_si256(packed, low);
            }
            let cost = of_frame.costs(v3, &symbols);
            for r in 0..4 {
                let up = load(&column.sums, r * LANES);
                let best = avx2._mm256_min_epi32(avx2._mm256_min_epi32(up, diagonal[r]), left[r]);
                diagonal[r] = up;
                left[r] = avx2._mm256_add_epi32(best, cost[r]);
                column.sums.as_chunks_mut::<LANES>().0[r] = cast(left[r]);
            }
            if place < group.shortest {
                for r in 0..4 {
                    least[r] = avx2._mm256_min_epi32(least[r], left[r]);
                }
            } else {
                let place = avx._mm256_set1_epi32(place as i32);
                for r in 0..4 {
                    // Cells beyond a reference must not count: all ones is over all that is reached.
                    let within = avx2._mm256_cmpgt_epi32(load(&group.lengths, r * LANES), place);
                    let beyond = avx2._mm256_andnot_si256(within, avx._mm256_set1_epi32(-1));
                    least[r] = avx2._mm256_min_epi32(least[r], avx2._mm256_or_si256(left[r], beyond));
                }
            }
        }
        group.least = cast(least);
    }
}
