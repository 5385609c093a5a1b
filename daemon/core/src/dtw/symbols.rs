//! Motions as bytes by which their costs are looked up.

use super::cost::IntegerCosts;
use crate::capacity::IU_FRAMES;
use crate::couple::Motion;

/// Cells that are computed together: as many as a vector has bytes.
pub(super) const BLOCK: usize = 32;

/// Bytes of one motion: one for the ordered features `a_h, jm_hj, jm_jl` together, then `φ_hj, φ_jl, θ_hj, θ_jl`.
pub(super) const PLANES: usize = 5;

/// Number of symbols of one feature: a shuffle looks up four bits.
const SYMBOLS: usize = 16;

/// A shuffle looks up bytes, so a cost has two digits, `low + DIGIT * high`. Five low ones sum up to at most 5 * 51 = 255.
pub(super) const DIGIT: i32 = 52;

const _: () = assert!(PLANES as i32 * (DIGIT - 1) <= 255);

/// Low and high digits of the costs of one symbol against each.
pub(super) type Digits = [[u8; SYMBOLS]; 2];

/// Costs of symbols. A motion has symbols if all its features are in range and there are at most 15 bins.
#[derive(Clone, Debug)]
pub(super) struct Tables {
    /// For the ordered features, by the symbol of one motion.
    pub(super) ordered: [Digits; SYMBOLS],
    /// For a direction, by its symbol, which is the number of the bin.
    pub(super) direction: [Digits; SYMBOLS],
    /// Maximum direction.
    max: u8,
}

impl Tables {
    /// `None` if there are too many bins, or if the sum of high digits could exceed 255.
    pub(super) fn new(costs: &IntegerCosts) -> Option<Self> {
        let max = if costs.bins > 0 { costs.bins } else { SYMBOLS as u8 - 1 };
        if usize::from(max) >= SYMBOLS {
            return None;
        }
        let ordered = |one: usize, other: usize| {
            let differ = (one ^ other) as i32;
            // Two bits for a_h (see `symbols`) and one for each jm.
            let a_h = [0, 1, 1, 4][(differ & 3) as usize];
            costs.step * a_h + costs.scale * ((differ >> 2 & 1) + (differ >> 3))
        };
        let direction = |one: usize, other: usize| costs.direction(one as i8, other as i8);
        let ((ordered, most), (direction, most_of_direction)) = (digits(ordered), digits(direction));
        let sum = most + (PLANES as i32 - 1) * most_of_direction;
        (sum / DIGIT <= 255).then_some(Self { ordered, direction, max })
    }

    /// The symbols of a motion; `None` if a feature is out of range.
    #[inline]
    pub(super) fn symbols(&self, motion: &Motion) -> Option<[u8; PLANES]> {
        let [a_h, theta_hj, phi_hj, jm_hj, theta_jl, phi_jl, jm_jl] = motion.0.map(|feature| feature as u8);
        // -1, 0, 1 become 00, 01, 11: the number of bits that differ is the difference of the values.
        let a_h = a_h.wrapping_add(1);
        let ordered = a_h | a_h >> 1 | jm_hj << 2 | jm_jl << 3;
        let directions = [phi_hj, phi_jl, theta_hj, theta_jl];
        let fits = a_h <= 2 && jm_hj <= 1 && jm_jl <= 1 && directions.iter().all(|bin| *bin <= self.max);
        fits.then_some([ordered, phi_hj, phi_jl, theta_hj, theta_jl])
    }
}

/// The digits of the costs of each symbol, and the greatest cost.
fn digits(cost: impl Fn(usize, usize) -> i32) -> ([Digits; SYMBOLS], i32) {
    let costs: [[i32; SYMBOLS]; SYMBOLS] =
        core::array::from_fn(|one| core::array::from_fn(|other| cost(one, other)));
    let most = costs.iter().flatten().copied().fold(0, i32::max);
    (
        costs.map(|costs| [costs.map(|cost| (cost % DIGIT) as u8), costs.map(|cost| (cost / DIGIT) as u8)]),
        most,
    )
}

/// The symbols of a sequence: a plane for each byte of a motion.
#[derive(Clone, Debug)]
pub(super) struct Symbols {
    pub(super) planes: [[u8; IU_FRAMES]; PLANES],
    /// How many motions there are; 0 where any of them has no symbols.
    pub(super) length: usize,
}

impl Symbols {
    pub(super) const fn new() -> Self {
        Self { planes: [[0; IU_FRAMES]; PLANES], length: 0 }
    }

    /// Writes the symbols of at most [`IU_FRAMES`] motions.
    pub(super) fn read(&mut self, tables: &Tables, motions: &[Motion]) {
        for (index, motion) in motions.iter().enumerate() {
            let Some(symbols) = tables.symbols(motion) else { return };
            for (plane, symbol) in self.planes.iter_mut().zip(symbols) {
                plane[index] = symbol;
            }
        }
        self.length = motions.len();
    }
}
