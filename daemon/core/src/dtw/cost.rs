//! The local cost of two motions as an integer.
//!
//! The paper divides `X` by its ranges into `[0, 1]`, which is the cost `normalised`. A stroke in the wrong direction then hardly counts. So 310 of 350
//! `J1` are missed on one simulator and 216 of 350 on the other. The default is `circular`.

use crate::couple::Motion;
use crate::job::LocalCost;
use core::f64::consts::TAU;

/// Maximum local cost. The sum of `IU_FRAMES` of them, the longest shortest path to a cell, is still below [`UNREACHED`]: no sum wraps. It never changes
/// an ordinal cost (at most 7 * 255²), and another one only if a feature is far out of range.
const COST_CAP: i32 = (1 << 20) - 1;

/// Sums start here. That leaves 0 for cells that are not reached, which is the value that the shifts of the SIMD path fill in.
pub(super) const ORIGIN: i32 = i32::MIN;

/// The value of a cell that no path has reached, greater than that of every reached one. All values from here up mean the same.
pub(super) const UNREACHED: i32 = 0;

/// Maximum local cost of two motions whose features are in range, in units of the scale. `a_h` differs by at most 2, two `jm` by 1, four directions
/// by the diameter of the circle: 2² + 1 + 1 + 4 * 2².
const COST_IN_RANGE: i32 = 22;

/// Maximum scale for which such a cost stays below [`COST_CAP`].
const MAX_SCALE: i32 = COST_CAP / COST_IN_RANGE;

/// A relative error of a rounded cost that is small enough; the error of the distance is half of it. Halved or doubled, none of 70 jobs differs.
const SUFFICIENT_ERROR: f64 = 1e-5;

/// Direction bins that a motion's `i8` can hold.
const MAX_BINS: u8 = i8::MAX as u8;

/// Local costs as integers, in units of `1 / scale`.
///
/// Ordinal costs are integers already (scale 1). Normalised costs are multiples of 1/4 (`a_h` has the range 2) and of 1/N² (directions have the range
/// N). So they are exact at the scale 4N², or N² if that is a multiple of 4. A circular cost is `2 - 2 cos(k 2π/N)` between directions that are `k`
/// bins apart, and 1 between a direction and rest. It is rounded at a scale that makes the relative error of every cost at most 1e-5. For N = 8 that is
/// 408, because 408 √2 = 576.999. That of the minimum sum along a warping path is no greater, and that of the distance half of it.
#[derive(Clone, Debug)]
pub(super) struct IntegerCosts {
    /// Units of a cost of 1.
    pub(super) scale: i32,
    /// Maximum relative error of a cost.
    pub(super) error: f64,
    /// Cost of an `a_h` that differs by 1.
    pub(super) step: i32,
    /// Cost of a direction, as a number, that differs by 1; unused for circular costs.
    bin: i32,
    /// N, or 0 where a direction is a number.
    pub(super) bins: u8,
    /// Cost of directions that differ by this many bins; unused where a direction is a number.
    circle: [i32; MAX_BINS as usize],
}

impl IntegerCosts {
    pub(super) fn new(cost: LocalCost) -> Self {
        let mut costs =
            Self { scale: 1, error: 0.0, step: 1, bin: 1, bins: 0, circle: [0; MAX_BINS as usize] };
        match cost {
            LocalCost::Ordinal => {}
            LocalCost::Normalised { bins } => {
                let square = square(bins.clamp(1, MAX_BINS));
                costs.scale = if square % 4 == 0 { square } else { 4 * square };
                (costs.step, costs.bin) = (costs.scale / 4, costs.scale / square);
            }
            LocalCost::Circular { bins } => costs.round_circle(bins.clamp(1, MAX_BINS)),
        }
        costs
    }

    /// Rounds the costs between `bins` directions on a circle.
    fn round_circle(&mut self, bins: u8) {
        self.bins = bins;
        (self.scale, self.error) = choose_scale(bins);
        self.step = self.scale;
        for (apart, cost) in (0..bins).zip(&mut self.circle) {
            *cost = libm::round(exact_chord(apart, bins) * f64::from(self.scale)) as i32;
        }
    }

    /// Local cost of two motions, in units of `1 / scale`.
    pub(super) fn between(&self, a: &Motion, b: &Motion) -> i32 {
        // The features of `Motion`: a_h, θ_hj, φ_hj, jm_hj, θ_jl, φ_jl, jm_jl.
        let [a, b] = [&a.0, &b.0];
        let number = |f: usize, unit: i32| square(a[f].abs_diff(b[f])).saturating_mul(unit);
        let ordered = [number(0, self.step), number(3, self.scale), number(6, self.scale)];
        let directions = [1, 2, 4, 5].map(|f| self.direction(a[f], b[f]));
        ordered.into_iter().chain(directions).fold(0, i32::saturating_add).min(COST_CAP)
    }

    /// Cost of two directions.
    pub(super) fn direction(&self, a: i8, b: i8) -> i32 {
        if self.bins == 0 {
            return square(a.abs_diff(b)).saturating_mul(self.bin);
        }
        match (self.bin_of(a), self.bin_of(b)) {
            (0, 0) => 0,
            (0, _) | (_, 0) => self.scale,
            (a, b) => self.circle[usize::from(a.abs_diff(b))],
        }
    }

    /// The bin that a feature stands for: a value beyond `1..=N` continues around the circle.
    fn bin_of(&self, feature: i8) -> u8 {
        if (0..=self.bins as i8).contains(&feature) {
            return feature as u8;
        }
        // In 1..=bins, and bins is at most 127.
        ((i16::from(feature) - 1).rem_euclid(i16::from(self.bins)) + 1) as u8
    }

    /// The distance that a cell's value stands for.
    pub(super) fn distance_of(&self, value: i32) -> f64 {
        libm::sqrt(f64::from(value.abs_diff(ORIGIN)) / f64::from(self.scale))
    }

    /// The maximum value of a cell whose distance is at most `bound`; `None` if `bound` is negative or not a number.
    pub(super) fn max_value(&self, bound: f64) -> Option<i32> {
        if bound.is_nan() || bound < 0.0 {
            return None;
        }
        // The cast saturates. Rounding may put the result one off, which the two loops correct.
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

/// Squared distance of two points on the unit circle that are `apart` of `bins` bins apart.
fn exact_chord(apart: u8, bins: u8) -> f64 {
    2.0 - 2.0 * libm::cos(TAU * f64::from(apart) / f64::from(bins))
}

/// Maximum relative error of the costs of `N` direction bins that are rounded at this scale, if it is below `limit`. `chords` are
/// the exact costs of half the circle; those of the other half are the same.
fn rounding_error(chords: &[f64], scale: i32, limit: f64) -> Option<f64> {
    chords.iter().try_fold(0.0, |worst, chord| {
        let exact = chord * f64::from(scale);
        let worst = f64::max(worst, (libm::round(exact) - exact).abs() / exact);
        (worst < limit).then_some(worst)
    })
}

/// The minimum scale whose error is small enough, or else the scale with the minimum error; and that error.
fn choose_scale(bins: u8) -> (i32, f64) {
    let mut chords = [0.0; MAX_BINS as usize / 2];
    let half = bins / 2;
    for (apart, chord) in (1..=half).zip(&mut chords) {
        *chord = exact_chord(apart, bins);
    }
    let mut best = (1, f64::INFINITY);
    for scale in 1..=MAX_SCALE {
        if let Some(error) = rounding_error(&chords[..usize::from(half)], scale, best.1) {
            best = (scale, error);
            if error <= SUFFICIENT_ERROR {
                break;
            }
        }
    }
    best
}
