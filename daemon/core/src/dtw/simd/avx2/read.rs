//! Symbols of a sequence.

use crate::couple::Motion;
use crate::dtw::symbols::{BLOCK, Content, FRONT, Order, Symbols, Tables};
use core::arch::x86_64::__m256i;
use pulp::NullaryFnOnce;
use pulp::bytemuck::cast;
use pulp::x86::V3;

/// Writes the symbols of a sequence; says [`Content::Nothing`] if a feature is out of range.
pub(super) struct Read<'a> {
    pub(super) v3: V3,
    pub(super) tables: &'a Tables,
    pub(super) motions: &'a [Motion],
    pub(super) order: Order,
    pub(super) symbols: &'a mut Symbols,
}

impl NullaryFnOnce for Read<'_> {
    type Output = Content;

    #[inline(always)]
    fn call(self) -> Content {
        let Self { v3, tables, motions, order, symbols: out } = self;
        let (avx, avx2) = (v3.avx, v3.avx2);
        let max = avx._mm256_set1_epi8(tables.max as i8);
        let rest = avx._mm256_set1_epi8(tables.rest as i8);
        let one = avx._mm256_set1_epi8(1);
        let two = avx._mm256_set1_epi8(2);
        let zero = avx._mm256_setzero_si256();
        let (mut out_of_range, mut elevations) = (zero, zero);
        for block in 0..motions.len().div_ceil(BLOCK) {
            let [a_h, theta_hj, phi_hj, jm_hj, theta_jl, phi_jl, jm_jl, _] =
                transpose(v3, &gather(motions, block * BLOCK, order));
            // See `Tables::symbols`: -1, 0, 1 become 00, 01, 11.
            let a_h = avx2._mm256_add_epi8(a_h, one);
            let mut over = avx2._mm256_subs_epu8(a_h, two);
            let a_h = avx2._mm256_sub_epi8(a_h, avx2._mm256_cmpeq_epi8(a_h, two));
            let [jm_hj_2, jm_jl_2] = [avx2._mm256_add_epi8(jm_hj, jm_hj), avx2._mm256_add_epi8(jm_jl, jm_jl)];
            let jm = avx2._mm256_or_si256(jm_hj_2, avx2._mm256_add_epi8(jm_jl_2, jm_jl_2));
            let ordered = avx2._mm256_or_si256(a_h, avx2._mm256_add_epi8(jm, jm));
            let jm = avx2._mm256_or_si256(jm_hj, jm_jl);
            over = avx2._mm256_or_si256(over, avx2._mm256_subs_epu8(jm, one));
            let mut symbols = [ordered, phi_hj, phi_jl, theta_hj, theta_jl];
            for direction in &mut symbols[1..] {
                over = avx2._mm256_or_si256(over, avx2._mm256_subs_epu8(*direction, max));
                let at_rest = avx2._mm256_and_si256(avx2._mm256_cmpeq_epi8(*direction, zero), rest);
                *direction = avx2._mm256_or_si256(*direction, at_rest);
            }
            out_of_range = avx2._mm256_or_si256(out_of_range, over);
            elevations = avx2._mm256_or_si256(elevations, avx2._mm256_or_si256(theta_hj, theta_jl));
            for (plane, symbols) in out.planes.iter_mut().zip(symbols) {
                plane[FRONT..].as_chunks_mut::<BLOCK>().0[block] = cast(symbols);
            }
        }
        if avx._mm256_testz_si256(out_of_range, out_of_range) == 0 {
            return Content::Nothing;
        }
        if avx._mm256_testz_si256(elevations, elevations) == 0 { Content::Elevated } else { Content::Flat }
    }
}

/// 32 motions from `start` on, one in each eight bytes, with zeros after the last one, in the order that [`transpose`] takes.
#[inline(always)]
fn gather(motions: &[Motion], start: usize, order: Order) -> [[u64; 4]; 8] {
    let mut rows = [[0; 4]; 8];
    let count = BLOCK.min(motions.len() - start);
    let block = if order == Order::Backwards {
        &motions[motions.len() - start - count..motions.len() - start]
    } else {
        &motions[start..start + count]
    };
    for (index, motion) in block.iter().enumerate() {
        let index = if order == Order::Backwards { count - 1 - index } else { index };
        let [a, b, c, d, e, f, g] = motion.0.map(|feature| feature as u8);
        rows[index % 16 / 2][index / 16 * 2 + index % 2] = u64::from_le_bytes([a, b, c, d, e, f, g, 0]);
    }
    rows
}

/// From motions to features. Vector `i` of eight holds motions `2 i` and `2 i + 1`, those of the first 16 in its first half. Those of the second 16
/// are in its second half.
#[inline(always)]
fn transpose(v3: V3, rows: &[[u64; 4]; 8]) -> [__m256i; 8] {
    let avx2 = v3.avx2;
    let pair = [0u8, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15];
    let pair = cast([pair, pair]);
    let zero = v3.avx._mm256_setzero_si256();
    // Brings two values of each feature together, then four, eight and sixteen.
    let mut two = [zero; 8];
    for (two, row) in two.iter_mut().zip(rows) {
        *two = avx2._mm256_shuffle_epi8(cast(*row), pair);
    }
    let mut four = [zero; 8];
    for i in 0..4 {
        four[i] = avx2._mm256_unpacklo_epi16(two[2 * i], two[2 * i + 1]);
        four[4 + i] = avx2._mm256_unpackhi_epi16(two[2 * i], two[2 * i + 1]);
    }
    let mut features = [zero; 8];
    for half in 0..2 {
        let [a, b, c, d] = [four[4 * half], four[4 * half + 1], four[4 * half + 2], four[4 * half + 3]];
        let (ab, cd) = (avx2._mm256_unpacklo_epi32(a, b), avx2._mm256_unpacklo_epi32(c, d));
        features[4 * half] = avx2._mm256_unpacklo_epi64(ab, cd);
        features[4 * half + 1] = avx2._mm256_unpackhi_epi64(ab, cd);
        let (ab, cd) = (avx2._mm256_unpackhi_epi32(a, b), avx2._mm256_unpackhi_epi32(c, d));
        features[4 * half + 2] = avx2._mm256_unpacklo_epi64(ab, cd);
        features[4 * half + 3] = avx2._mm256_unpackhi_epi64(ab, cd);
    }
    features
}
