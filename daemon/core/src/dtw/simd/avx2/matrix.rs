//! The whole matrix of two sequences.

use super::costs::Pairs;
use super::{rotate, store, with_first};
use crate::dtw::cost::{ORIGIN, UNREACHED};
use crate::dtw::row::LANES;
use crate::dtw::simd::digits::Digits;
use crate::dtw::simd::{BORDER_ZERO, Border};
use crate::dtw::symbols::{BLOCK, Content, FRONT, PLANES, PLANES_FLAT, Symbols};
use pulp::NullaryFnOnce;
use pulp::bytemuck::cast;
use pulp::x86::V3;

/// The value of the last cell; `None` if it is above `bound`. `y` is backwards.
pub(super) struct LastCell<'a> {
    pub(super) v3: V3,
    pub(super) digits: &'a Digits,
    pub(super) x: (&'a Symbols, usize),
    pub(super) y: (&'a Symbols, usize),
    pub(super) bound: i32,
    pub(super) border: &'a mut Border,
}

impl NullaryFnOnce for LastCell<'_> {
    type Output = Option<i32>;

    #[inline(always)]
    fn call(self) -> Option<i32> {
        if [self.x.0, self.y.0].iter().all(|symbols| symbols.content == Content::Flat) {
            self.planes::<PLANES_FLAT>()
        } else {
            self.planes::<PLANES>()
        }
    }
}

impl LastCell<'_> {
    /// Works in strips of 32 rows. In step `t` of a strip, row `i` is at column `t - i`. These are 32 cells that do not depend on each other, in the
    /// order of `Row`. The values for the next step stay in registers, and the last row of the strip goes to the next strip through `border`.
    ///
    /// Before its first and after its last column a row computes cells that no other cell needs. Those before have only unreached predecessors, and
    /// no cell depends on a column after its own.
    #[inline(always)]
    fn planes<const N: usize>(self) -> Option<i32> {
        let Self { v3, x: (x, rows), y: (y, columns), border, .. } = self;
        let (avx, avx2) = (v3.avx, v3.avx2);
        let pairs = Pairs::new(self.digits);
        let unreached = avx._mm256_set1_epi32(UNREACHED);
        border[BORDER_ZERO + 1 - columns..=BORDER_ZERO].fill(UNREACHED);
        let mut newest = [unreached; BLOCK / LANES];
        for start in (0..rows).step_by(BLOCK) {
            let strip = BLOCK.min(rows - start);
            let mut x_symbols = [unreached; N];
            for (symbols, plane) in x_symbols.iter_mut().zip(&x.planes) {
                *symbols = cast(plane[FRONT + start..].as_chunks::<BLOCK>().0[0]);
            }
            newest = [unreached; BLOCK / LANES];
            let mut corner = newest;
            if start == 0 {
                corner[0] = with_first(v3, avx._mm256_set1_epi32(ORIGIN), unreached);
            }
            for step in 0..columns + strip - 1 {
                let mut y_symbols = [unreached; N];
                for (symbols, plane) in y_symbols.iter_mut().zip(&y.planes) {
                    *symbols = cast(plane[FRONT + columns - 1 - step..].as_chunks::<BLOCK>().0[0]);
                }
                let cost = pairs.costs(v3, &x_symbols, &y_symbols);
                let above = avx._mm256_set1_epi32(border[BORDER_ZERO - step]);
                let up = [with_first(v3, above, rotate(v3, newest[3])), newest[0], newest[1], newest[2]];
                for r in 0..4 {
                    let best = avx2._mm256_min_epi32(up[r], corner[r]);
                    newest[r] = avx2._mm256_add_epi32(avx2._mm256_min_epi32(newest[r], best), cost[r]);
                }
                corner = up;
                // The last lane is the last row of the strip, at column step + 1 - BLOCK.
                store(border, BORDER_ZERO + BLOCK - LANES - step, newest[3]);
            }
            // Every path passes through the last row of the strip.
            let last_row = &border[BORDER_ZERO + 1 - columns..=BORDER_ZERO];
            if strip == BLOCK && last_row.iter().fold(UNREACHED, |min, &cell| min.min(cell)) > self.bound {
                return None;
            }
        }
        let last = (rows - 1) % BLOCK;
        let lanes: [i32; LANES] = cast(newest[last % 4]);
        Some(lanes[last / 4]).filter(|&value| value <= self.bound)
    }
}
