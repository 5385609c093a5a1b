//! The local cost of two motions as a whole number.

use super::simd::Simd;
use super::symbols::Tables;
use crate::couple::Motion;
use crate::job::LocalCost;
use core::f64::consts::TAU;

/// Greatest local cost. The least path to a cell is no longer than the longer sequence (along the diagonal, then straight), and
/// the sum of `IU_FRAMES` such costs is still under [`UNREACHED`], so no sum wraps. All ordinal costs of `i8` features
/// (7 * 255²) are smaller: the cap never changes an ordinal cost, and a circular one only where a feature is far out of range.
const COST_CAP: i32 = (1 << 20) - 1;

/// Sums count up from here. That leaves 0 for what is not reached, which is what the shifts of the SIMD path fill with.
pub(super) const ORIGIN: i32 = i32::MIN;

/// The value of a cell that no path has reached: greater than that of every reached one. All values from here up mean the same.
pub(super) const UNREACHED: i32 = 0;

/// Greatest local cost of two motions whose features are in range, in units of the scale: `a_h` differs by 2 at most and
/// two `jm` by 1, four directions by the diameter of the circle: 2² + 1 + 1 + 4 * 2².
pub(super) const COST_IN_RANGE: i32 = 22;

/// Greatest scale that [`COST_CAP`] leaves room for.
const SCALE_MOST: i32 = COST_CAP / COST_IN_RANGE;

/// Relative error of a rounded cost that is small enough: half of it is the error of the distance.
const ERROR_ENOUGH: f64 = 1e-5;

/// Direction bins that a motion's `i8` can hold.
const BINS_MOST: u8 = i8::MAX as u8;

/// Local costs as whole numbers, in units of `1 / scale`.
///
/// Sums of whole numbers do not depend on the order they are made in. That is why the online, the batch, the portable
/// and the SIMD path of this module give the same bits.
///
/// Ordinal costs are whole already (scale 1). A circular cost is `2 - 2 cos(k 2π/N)` between directions that are `k` bins
/// apart and 1 between a direction and rest; it is rounded at the scale that makes the relative error of every
/// cost at most 1e-5 (N = 8: scale 408, because 408 √2 = 576.999). A warping path's sum, and so the least one, has
/// at most the same relative error, the distance half of it: [`relative_error`](Self::relative_error).
#[derive(Clone, Debug)]
pub struct LocalCosts {
    /// Units of a cost of 1.
    scale: i32,
    /// Greatest relative error of a cost.
    error: f64,
    /// N, or 0 for ordinal costs.
    bins: u8,
    /// Cost of directions that differ by this many bins; unused for ordinal costs.
    circle: [i32; BINS_MOST as usize],
    /// Costs of symbols, where there are any.
    tables: Option<Tables>,
    /// The SIMD path, where there is one.
    simd: Option<Simd>,
}

impl LocalCosts {
    /// Rounds the costs and looks for the processor's SIMD path. `bins` of a circular cost over 127 count as 127, the most that a
    /// motion can hold, and 0 as 1.
    pub fn new(cost: LocalCost) -> Self {
        let portable = Self::portable(cost);
        let simd = portable.tables().and_then(Simd::new);
        Self { simd, ..portable }
    }

    /// As [`new`](Self::new), but without SIMD: the same results, slower.
    pub fn portable(cost: LocalCost) -> Self {
        let circle = [0; BINS_MOST as usize];
        let mut costs = Self { scale: 1, error: 0.0, bins: 0, circle, tables: None, simd: None };
        if let LocalCost::Circular { bins } = cost {
            costs.bins = bins.clamp(1, BINS_MOST);
            (costs.scale, costs.error) = choose_scale(costs.bins);
            for (apart, cost) in (0..costs.bins).zip(&mut costs.circle) {
                *cost = libm::round(exact_chord(apart, costs.bins) * f64::from(costs.scale)) as i32;
            }
        }
        costs.tables = Tables::new(&costs);
        costs
    }

    /// Costs of symbols, where there are any.
    pub(super) fn tables(&self) -> Option<&Tables> {
        self.tables.as_ref()
    }

    /// The SIMD path, where there is one.
    pub(super) fn simd(&self) -> Option<&Simd> {
        self.simd.as_ref()
    }

    /// Units of a cost of 1.
    pub(super) fn scale(&self) -> i32 {
        self.scale
    }

    /// N, or 0 for ordinal costs.
    pub(super) fn bins(&self) -> u8 {
        self.bins
    }

    /// How far a distance may be from the one that real numbers would give, relative to it.
    pub fn relative_error(&self) -> f64 {
        self.error / 2.0
    }

    /// Local cost of two motions, in units of `1 / scale`.
    pub(super) fn between(&self, a: &Motion, b: &Motion) -> i32 {
        // The places of `Motion`: a_h, θ_hj, φ_hj, jm_hj, θ_jl, φ_jl, jm_jl.
        let [a, b] = [&a.0, &b.0];
        if self.bins == 0 {
            return a.iter().zip(b).map(|(a, b)| square(a.abs_diff(*b))).sum();
        }
        let ordered = [0, 3, 6].map(|f| square(a[f].abs_diff(b[f])).saturating_mul(self.scale));
        let directions = [1, 2, 4, 5].map(|f| self.direction(a[f], b[f]));
        ordered.into_iter().chain(directions).fold(0, i32::saturating_add).min(COST_CAP)
    }

    /// Cost of two directions.
    pub(super) fn direction(&self, a: i8, b: i8) -> i32 {
        if self.bins == 0 {
            return square(a.abs_diff(b));
        }
        match (self.bin(a), self.bin(b)) {
            (0, 0) => 0,
            (0, _) | (_, 0) => self.scale,
            (a, b) => self.circle[usize::from(a.abs_diff(b))],
        }
    }

    /// The bin that a feature means: one beyond `1..=N` is counted on around the circle.
    fn bin(&self, feature: i8) -> u8 {
        if (0..=self.bins as i8).contains(&feature) {
            return feature as u8;
        }
        // In 1..=bins, and bins is at most 127.
        ((i16::from(feature) - 1).rem_euclid(i16::from(self.bins)) + 1) as u8
    }

    /// The distance that the value of a cell is.
    pub(super) fn distance_of(&self, value: i32) -> f64 {
        libm::sqrt(f64::from(value.abs_diff(ORIGIN)) / f64::from(self.scale))
    }

    /// The greatest value of a cell whose distance is at most `bound`; none if `bound` is negative or not a number.
    pub(super) fn greatest_value(&self, bound: f64) -> Option<i32> {
        if bound.is_nan() || bound < 0.0 {
            return None;
        }
        // The casts saturate. Rounding may put it one off, which the two loops mend.
        let sum = (bound * bound * f64::from(self.scale)) as i32;
        let mut value = ORIGIN + sum;
        while value > ORIGIN && self.distance_of(value) > bound {
            value -= 1;
        }
        while value < UNREACHED && self.distance_of(value + 1) <= bound {
            value += 1;
        }
        Some(value)
    }
}

fn square(difference: u8) -> i32 {
    i32::from(difference).pow(2)
}

/// Squared distance of two points of the unit circle that are `apart` of `bins` bins apart.
fn exact_chord(apart: u8, bins: u8) -> f64 {
    2.0 - 2.0 * libm::cos(TAU * f64::from(apart) / f64::from(bins))
}

/// Greatest relative error of the costs of `N` direction bins that are rounded at this scale, if it is under `limit`. `chords` are the
/// exact ones, of half the circle: the other half has the same.
fn rounding_error(chords: &[f64], scale: i32, limit: f64) -> Option<f64> {
    chords.iter().try_fold(0.0, |worst, chord| {
        let exact = chord * f64::from(scale);
        let worst = f64::max(worst, (libm::round(exact) - exact).abs() / exact);
        (worst < limit).then_some(worst)
    })
}

/// The least scale whose error is small enough, or where there is none the one with the least error; and the error.
fn choose_scale(bins: u8) -> (i32, f64) {
    let mut chords = [0.0; BINS_MOST as usize / 2];
    let half = bins / 2;
    for (apart, chord) in (1..=half).zip(&mut chords) {
        *chord = exact_chord(apart, bins);
    }
    let mut best = (1, f64::INFINITY);
    for scale in 1..=SCALE_MOST {
        if let Some(error) = rounding_error(&chords[..usize::from(half)], scale, best.1) {
            best = (scale, error);
            if error <= ERROR_ENOUGH {
                break;
            }
        }
    }
    best
}
