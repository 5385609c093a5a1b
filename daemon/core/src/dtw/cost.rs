//! The local cost of two motions as an integer.
//!
//! The paper divides `X` by its ranges into `[0, 1]`, which is the cost `normalised`. A stroke in the wrong direction then hardly counts. So 310 of 350
//! `J1` are missed on one simulator and 216 of 350 on the other. The default is `circular`.

use crate::couple::Motion;
use crate::job::LocalCost;
use core::f64::consts::TAU;
use heapless::Vec;

/// Maximum local cost. No sum of `IU_FRAMES` of them, the longest shortest path to a cell, wraps. It never changes an ordinal cost (at most
/// 7 * 255²), and another one only if a feature is far out of range.
const COST_CAP: u32 = (1 << 20) - 1;

/// Maximum local cost of two motions whose features are in range, in units of the scale. `a_h` differs by at most 2, two `jm` by 1, four directions
/// by the diameter of the circle: 2² + 1 + 1 + 4 * 2².
const COST_IN_RANGE: u32 = 22;

/// Maximum scale for which such a cost stays below [`COST_CAP`].
const MAX_SCALE: u32 = COST_CAP / COST_IN_RANGE;

/// A relative error of a rounded cost that is small enough; the error of the distance is half of it. Halved or doubled, none of 70 jobs differs.
const SUFFICIENT_ERROR: f64 = 1e-5;

/// Direction bins that a motion's `i8` can hold.
const MAX_BINS: u8 = i8::MAX as u8;

/// How two motions are compared: by local costs that are integers, in units of `1 / scale`. Their sums are the same on every processor.
///
/// Ordinal costs are integers already (scale 1). Normalised costs are multiples of 1/4 (`a_h` has the range 2) and of 1/N² (directions have the range
/// N). So they are exact at the scale 4N², or N² if that is a multiple of 4. A circular cost is `2 - 2 cos(k 2π/N)` between directions that are `k`
/// bins apart, and 1 between a direction and rest. It is rounded at a scale that makes the relative error of every cost at most 1e-5, with up to 37
/// bins. For N = 8 that is 408, because 408 √2 = 576.999. That of the minimum sum along a warping path is no greater, and that of the distance half
/// of it.
#[derive(Clone, Debug)]
pub struct LocalCosts {
    /// Units of a cost of 1.
    scale: u32,
    /// Cost of an `a_h` that differs by 1.
    step: u32,
    /// Cost of directions whose numbers differ by as much; around the circle, a number above N is a bin as well.
    turn: [u32; 256],
    /// Cost of rest and a direction where rest is the centre of their circle; `None` where it is one more number.
    rest: Option<u32>,
}

impl LocalCosts {
    /// Rounds the costs. The bins count as 1 to 127, the most that a motion can hold.
    pub fn new(cost: LocalCost) -> Self {
        let numbers = |scale, step, unit: u32| Self {
            scale,
            step,
            turn: core::array::from_fn(|apart| (apart * apart) as u32 * unit),
            rest: None,
        };
        match cost {
            LocalCost::Ordinal => numbers(1, 1, 1),
            LocalCost::Normalised { bins } => {
                let square = u32::from(bins.clamp(1, MAX_BINS)).pow(2);
                if square % 4 == 0 { numbers(square, square / 4, 1) } else { numbers(4 * square, square, 4) }
            }
            LocalCost::Circular { bins } => {
                let bins = bins.clamp(1, MAX_BINS);
                let scale = circular_scale(bins);
                let rounded =
                    |apart| libm::round(chord(apart % usize::from(bins), bins) * f64::from(scale)) as u32;
                Self { scale, step: scale, turn: core::array::from_fn(rounded), rest: Some(scale) }
            }
        }
    }

    /// Local cost of two motions, in units of `1 / scale`.
    pub(super) fn between(&self, a: &Motion, b: &Motion) -> u32 {
        // The features of `Motion`: a_h, θ_hj, φ_hj, jm_hj, θ_jl, φ_jl, jm_jl.
        let [a, b] = [&a.0, &b.0];
        let apart = |f: usize| a[f].abs_diff(b[f]);
        let number = |f: usize, unit: u32| u64::from(u32::from(apart(f)).pow(2)) * u64::from(unit);
        let direction = |f: usize| {
            let rest = self.rest.filter(|_| (a[f] == 0) != (b[f] == 0));
            u64::from(rest.unwrap_or(self.turn[usize::from(apart(f))]))
        };
        let numbers = number(0, self.step) + number(3, self.scale) + number(6, self.scale);
        let directions = direction(1) + direction(2) + direction(4) + direction(5);
        (numbers + directions).min(COST_CAP.into()) as u32
    }

    /// The distance that the sum of the costs along a path stands for.
    pub(super) fn distance_of(&self, sum: u32) -> f64 {
        libm::sqrt(f64::from(sum) / f64::from(self.scale))
    }
}

/// Squared distance of two points on the unit circle that are `apart` of `bins` bins apart.
fn chord(apart: usize, bins: u8) -> f64 {
    2.0 - 2.0 * libm::cos(TAU * apart as f64 / f64::from(bins))
}

/// The minimum scale whose costs are all rounded well enough, or else the maximum one. Those of half of the circle are those of the other half.
fn circular_scale(bins: u8) -> u32 {
    let half: Vec<f64, { MAX_BINS as usize / 2 }> =
        (1..=usize::from(bins / 2)).map(|apart| chord(apart, bins)).collect();
    let is_sufficient = |scale: &u32| {
        half.iter()
            .map(|chord| chord * f64::from(*scale))
            .all(|exact| (libm::round(exact) - exact).abs() / exact <= SUFFICIENT_ERROR)
    };
    (1..=MAX_SCALE).find(is_sufficient).unwrap_or(MAX_SCALE)
}
