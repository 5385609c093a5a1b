//! The kernels for x86-64-v3.

use super::ROW;
use super::symbols::{BLOCK, DIGIT, FLAT_PLANES, PLANES, Symbols, Tables};
use crate::couple::Motion;
use crate::dtw::cost::{ORIGIN, UNREACHED};
use core::arch::x86_64::{__m128i, __m256i};
use pulp::NullaryFnOnce;
use pulp::bytemuck::cast;
use pulp::x86::V3;

/// Values in one vector.
const LANES: usize = 8;

/// Costs of 32 cells in four vectors, in the order of the cells.
type Costs = [__m256i; BLOCK / LANES];

#[inline(always)]
fn load(values: &[i32], at: usize) -> __m256i {
    cast(values[at..at + LANES].as_chunks::<LANES>().0[0])
}

#[inline(always)]
fn store(values: &mut [i32], at: usize, vector: __m256i) {
    values[at..at + LANES].as_chunks_mut::<LANES>().0[0] = cast(vector);
}

#[inline(always)]
fn broadcast(table: [u8; 16]) -> __m256i {
    cast([table, table])
}

/// Adds up the digits of the planes and widens them.
#[inline(always)]
fn widen(v3: V3, low: __m256i, high: __m256i) -> Costs {
    let (avx, avx2) = (v3.avx, v3.avx2);
    // Quarters 0, 2, 1, 3: so that unpacking, which works in halves, keeps the order of the cells.
    let low = avx2._mm256_permute4x64_epi64::<0b11_01_10_00>(low);
    let high = avx2._mm256_permute4x64_epi64::<0b11_01_10_00>(high);
    let digits = avx._mm256_set1_epi16(1 | (DIGIT as i16) << 8);
    let first = avx2._mm256_maddubs_epi16(avx2._mm256_unpacklo_epi8(low, high), digits);
    let second = avx2._mm256_maddubs_epi16(avx2._mm256_unpackhi_epi8(low, high), digits);
    let [a, b]: [__m128i; 2] = cast(first);
    let [c, d]: [__m128i; 2] = cast(second);
    [
        avx2._mm256_cvtepu16_epi32(a),
        avx2._mm256_cvtepu16_epi32(b),
        avx2._mm256_cvtepu16_epi32(c),
        avx2._mm256_cvtepu16_epi32(d),
    ]
}

/// Both digits that two tables have for the same 32 places.
#[inline(always)]
fn look_up(v3: V3, tables: [__m256i; 2], places: __m256i) -> [__m256i; 2] {
    [v3.avx2._mm256_shuffle_epi8(tables[0], places), v3.avx2._mm256_shuffle_epi8(tables[1], places)]
}

/// How far direction symbols are apart, 15 for all that is farther.
#[inline(always)]
fn apart(v3: V3, x: __m256i, y: __m256i) -> __m256i {
    // Symbols are at most 64, so that their difference is a signed byte.
    let apart = v3.avx2._mm256_abs_epi8(v3.avx2._mm256_sub_epi8(x, y));
    v3.avx2._mm256_min_epu8(apart, v3.avx._mm256_set1_epi8(15))
}

/// Costs of 32 pairs of symbols.
#[inline(always)]
fn pair_costs<const N: usize>(
    v3: V3,
    tables: &Tables,
    x: &[&[[u8; BLOCK]]; N],
    y: &[&[[u8; BLOCK]]; N],
    block: usize,
) -> Costs {
    let ordered = [broadcast(tables.ordered[0]), broadcast(tables.ordered[1])];
    let direction = [broadcast(tables.direction[0]), broadcast(tables.direction[1])];
    let differ = v3.avx2._mm256_xor_si256(cast(x[0][block]), cast(y[0][block]));
    let [mut low, mut high] = look_up(v3, ordered, differ);
    for plane in 1..N {
        let digits = look_up(v3, direction, apart(v3, cast(x[plane][block]), cast(y[plane][block])));
        low = v3.avx2._mm256_add_epi8(low, digits[0]);
        high = v3.avx2._mm256_add_epi8(high, digits[1]);
    }
    widen(v3, low, high)
}

/// The digits of the costs of one frame against every symbol, a pair of tables for each plane.
#[inline(always)]
fn frame_tables<const N: usize>(v3: V3, tables: &Tables, frame: [u8; PLANES]) -> [[__m256i; 2]; N] {
    let mut symbols = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];
    let ordered = [broadcast(tables.ordered[0]), broadcast(tables.ordered[1])];
    let direction = [broadcast(tables.direction[0]), broadcast(tables.direction[1])];
    let differ = v3.avx2._mm256_xor_si256(broadcast(symbols), v3.avx._mm256_set1_epi8(frame[0] as i8));
    symbols[0] = tables.rest;
    let mut of_frame = [look_up(v3, ordered, differ); N];
    for plane in 1..N {
        let own = v3.avx._mm256_set1_epi8(frame[plane] as i8);
        of_frame[plane] = look_up(v3, direction, apart(v3, broadcast(symbols), own));
    }
    of_frame
}

/// Costs of one frame against 32 symbols.
#[inline(always)]
fn frame_costs<const N: usize>(
    v3: V3,
    tables: &[[__m256i; 2]; N],
    symbols: &[&[[u8; BLOCK]]; N],
    block: usize,
) -> Costs {
    let [mut low, mut high] = look_up(v3, tables[0], cast(symbols[0][block]));
    for plane in 1..N {
        let digits = look_up(v3, tables[plane], cast(symbols[plane][block]));
        low = v3.avx2._mm256_add_epi8(low, digits[0]);
        high = v3.avx2._mm256_add_epi8(high, digits[1]);
    }
    widen(v3, low, high)
}

/// See [`super::Simd::next_row`].
pub(super) fn next_row(
    v3: V3,
    tables: &Tables,
    frame: &Motion,
    reference: &Symbols,
    places: usize,
    row: &mut [i32; ROW],
) -> Option<i32> {
    let (symbols, fits) = tables.symbols(frame);
    if !fits {
        return None;
    }
    let elevated = reference.elevated || frame.0[1] != 0 || frame.0[4] != 0;
    Some(v3.vectorize(Row { v3, tables, frame: symbols, reference, places, row, elevated }))
}

/// [`row_of`] and what it works on: a type of its own because a closure would not be compiled with the vector instructions.
struct Row<'a> {
    v3: V3,
    tables: &'a Tables,
    frame: [u8; PLANES],
    reference: &'a Symbols,
    places: usize,
    row: &'a mut [i32; ROW],
    elevated: bool,
}

impl NullaryFnOnce for Row<'_> {
    type Output = i32;

    #[inline(always)]
    fn call(self) -> i32 {
        let Self { v3, tables, frame, reference, places, row, elevated } = self;
        if elevated {
            row_of::<PLANES>(v3, tables, frame, reference, places, row)
        } else {
            row_of::<FLAT_PLANES>(v3, tables, frame, reference, places, row)
        }
    }
}

/// A row in steps of eight cells. In a plain loop each cell waits for the cell before it: a minimum and an addition. Here
/// the eight are combined in three steps of doubling width, as a sum of costs and the best value that has come in from above;
/// that does not wait for the eight before, so that only one shuffle, addition and minimum remain in the chain.
#[inline(always)]
fn row_of<const N: usize>(
    v3: V3,
    tables: &Tables,
    frame: [u8; PLANES],
    reference: &Symbols,
    places: usize,
    row: &mut [i32; ROW],
) -> i32 {
    let (avx, avx2) = (v3.avx, v3.avx2);
    let tables = frame_tables::<N>(v3, tables, frame);
    let planes: [&[[u8; BLOCK]]; N] = core::array::from_fn(|plane| reference.planes[plane].as_chunks().0);
    let last = avx._mm256_set1_epi32(LANES as i32 - 1);
    let mut places_left = avx._mm256_set1_epi32(places as i32);
    let mut left = avx._mm256_set1_epi32(UNREACHED);
    let mut least = left;
    let mut diagonal = load(row, 0);
    row[0] = UNREACHED;
    let lane = cast([0, 1, 2, 3, 4, 5, 6, 7]);
    for block in 0..places.div_ceil(BLOCK) {
        let costs = frame_costs::<N>(v3, &tables, &planes, block);
        for (part, &(mut cost)) in costs.iter().enumerate() {
            let at = 1 + block * BLOCK + part * LANES;
            let mut best = avx2._mm256_add_epi32(avx2._mm256_min_epi32(load(row, at), diagonal), cost);
            // Before the cell at its start is overwritten.
            diagonal = load(row, at + LANES - 1);
            best =
                avx2._mm256_min_epi32(best, avx2._mm256_add_epi32(avx2._mm256_slli_si256::<4>(best), cost));
            cost = avx2._mm256_add_epi32(cost, avx2._mm256_slli_si256::<4>(cost));
            best =
                avx2._mm256_min_epi32(best, avx2._mm256_add_epi32(avx2._mm256_slli_si256::<8>(best), cost));
            cost = avx2._mm256_add_epi32(cost, avx2._mm256_slli_si256::<8>(cost));
            best = avx2._mm256_min_epi32(best, avx2._mm256_add_epi32(end_of_first_half(v3, best), cost));
            cost = avx2._mm256_add_epi32(cost, end_of_first_half(v3, cost));
            best = avx2._mm256_min_epi32(best, avx2._mm256_add_epi32(left, cost));
            left = avx2._mm256_permutevar8x32_epi32(best, last);
            store(row, at, best);
            // What lies beyond the reference must not count: -1 is over all that is reached.
            let beyond = avx2._mm256_cmpgt_epi32(lane, avx2._mm256_sub_epi32(places_left, one(v3)));
            least = avx2._mm256_min_epi32(least, avx2._mm256_or_si256(best, beyond));
            places_left = avx2._mm256_sub_epi32(places_left, avx._mm256_set1_epi32(LANES as i32));
        }
    }
    cast::<__m256i, [i32; LANES]>(least).into_iter().fold(UNREACHED, i32::min)
}

#[inline(always)]
fn one(v3: V3) -> __m256i {
    v3.avx._mm256_set1_epi32(1)
}

/// Zeros, then the last value of the first half four times.
#[inline(always)]
fn end_of_first_half(v3: V3, vector: __m256i) -> __m256i {
    v3.avx2._mm256_permute2x128_si256::<0x08>(v3.avx2._mm256_shuffle_epi32::<0xff>(vector), vector)
}

/// Diagonals between two looks at the bound.
const BOUND_EVERY: usize = 16;

/// See [`super::Simd::last_cell`].
pub(super) fn last_cell(
    v3: V3,
    tables: &Tables,
    x: (&Symbols, usize),
    y: (&Symbols, usize),
    bound: i32,
    diagonals: &mut [[i32; ROW]; 3],
) -> Option<i32> {
    v3.vectorize(Matrix { v3, tables, x, y, bound, diagonals })
}

/// [`matrix`] and what it works on.
struct Matrix<'a> {
    v3: V3,
    tables: &'a Tables,
    x: (&'a Symbols, usize),
    y: (&'a Symbols, usize),
    bound: i32,
    diagonals: &'a mut [[i32; ROW]; 3],
}

impl NullaryFnOnce for Matrix<'_> {
    type Output = Option<i32>;

    #[inline(always)]
    fn call(self) -> Option<i32> {
        let Self { v3, tables, x, y, bound, diagonals } = self;
        if x.0.elevated || y.0.elevated {
            matrix::<PLANES>(v3, tables, x, y, bound, diagonals)
        } else {
            matrix::<FLAT_PLANES>(v3, tables, x, y, bound, diagonals)
        }
    }
}

/// The matrix by anti-diagonals, whose cells do not depend on each other. Three are kept; cell `(i, j)` is at `i + 1`.
#[inline(always)]
fn matrix<const N: usize>(
    v3: V3,
    tables: &Tables,
    (x, rows): (&Symbols, usize),
    (y, columns): (&Symbols, usize),
    bound: i32,
    diagonals: &mut [[i32; ROW]; 3],
) -> Option<i32> {
    for diagonal in diagonals.iter_mut() {
        diagonal[..1 + rows + BLOCK].fill(UNREACHED);
    }
    let [mut before, mut newest, mut next] = diagonals.each_mut();
    before[0] = ORIGIN;
    for sum in 0..rows + columns - 1 {
        let first = (sum + 1).saturating_sub(columns);
        let end = rows.min(sum + 1);
        let blocks = (end - first).div_ceil(BLOCK);
        // y is backwards: column sum - i is at columns - 1 - sum + i.
        let x_planes: [&[[u8; BLOCK]]; N] =
            core::array::from_fn(|plane| &x.planes[plane][first..].as_chunks().0[..blocks]);
        let y_planes: [&[[u8; BLOCK]]; N] = core::array::from_fn(|plane| {
            &y.planes[plane][columns - 1 + first - sum..].as_chunks().0[..blocks]
        });
        let corner = &before[first..].as_chunks::<BLOCK>().0[..blocks];
        let up = &newest[first..].as_chunks::<BLOCK>().0[..blocks];
        let left = &newest[first + 1..].as_chunks::<BLOCK>().0[..blocks];
        let out = &mut next[first + 1..].as_chunks_mut::<BLOCK>().0[..blocks];
        for block in 0..blocks {
            let costs = pair_costs::<N>(v3, tables, &x_planes, &y_planes, block);
            for (part, &cost) in costs.iter().enumerate() {
                let at = part * LANES;
                let best = v3.avx2._mm256_min_epi32(load(&up[block], at), load(&left[block], at));
                let best = v3.avx2._mm256_min_epi32(best, load(&corner[block], at));
                store(&mut out[block], at, v3.avx2._mm256_add_epi32(best, cost));
            }
        }
        // Every path has a cell in one of two neighbouring diagonals. Older cells beside the newest of `newest` only make this later.
        if sum % BOUND_EVERY == BOUND_EVERY - 1 {
            let cells = first + 1..end + 1;
            let least = next[cells.clone()]
                .iter()
                .chain(&newest[cells])
                .fold(UNREACHED, |least, &cell| least.min(cell));
            if least > bound {
                return None;
            }
        }
        before[0] = UNREACHED;
        (before, newest, next) = (newest, next, before);
    }
    Some(newest[rows]).filter(|&value| value <= bound)
}
