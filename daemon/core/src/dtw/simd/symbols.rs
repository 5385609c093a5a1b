//! Motions as bytes whose cost is looked up by shuffles.

use crate::capacity::IU_FRAMES;
use crate::couple::Motion;
use crate::dtw::cost::{COST_IN_RANGE, LocalCosts};

/// Cells that are computed together: the bytes of a vector.
pub(in crate::dtw) const BLOCK: usize = 32;

/// Room for a sequence and the rest of its last block.
pub(in crate::dtw) const ROOM: usize = IU_FRAMES + BLOCK;

/// Bytes of one motion: the ordered features `a_h, jm_hj, jm_jl` together, then `φ_hj, φ_jl, θ_hj, θ_jl`. The elevations come
/// last because plane mode leaves them out.
pub(in crate::dtw) const PLANES: usize = 5;

/// Bytes of one motion without elevation.
pub(in crate::dtw) const FLAT_PLANES: usize = 3;

/// A shuffle looks up bytes, so a cost is two digits, `low + DIGIT * high`. The low digits of [`PLANES`] lookups add up to at
/// most 5 * 51 = 255.
pub(in crate::dtw) const DIGIT: i32 = 52;

/// Greatest scale at which the high digits add up to at most 255, too.
pub(in crate::dtw) const SCALE_DIGITS: i32 = 255 * DIGIT / COST_IN_RANGE;

/// Greatest direction that a symbol can be. On a circle such directions are at most 14 apart, which leaves 15 for rest.
const DIRECTION_MOST: u8 = 15;

/// The symbol of rest among directions on a circle: 49 or more from every direction, and 0 in the four bits that a shuffle sees.
const REST: u8 = 64;

/// Costs of symbols, by how they differ.
#[derive(Clone, Debug)]
pub(in crate::dtw) struct Tables {
    /// Low and high digits for ordered features, by the exclusive or of the symbols.
    pub(super) ordered: [[u8; 16]; 2],
    /// Low and high digits for a direction, by how far the symbols are apart; the last entry for 15 or more.
    pub(super) direction: [[u8; 16]; 2],
    /// The symbol of rest.
    pub(super) rest: u8,
    /// Greatest direction.
    most: u8,
}

impl Tables {
    /// `None` where the costs do not fit.
    pub(in crate::dtw) fn new(costs: &LocalCosts) -> Option<Self> {
        let circle = costs.bins() > 0;
        if costs.scale() > SCALE_DIGITS || costs.bins() > DIRECTION_MOST {
            return None;
        }
        let digits = |cost: i32| [(cost % DIGIT) as u8, (cost / DIGIT) as u8];
        let mut tables = Self {
            ordered: [[0; 16]; 2],
            direction: [[0; 16]; 2],
            rest: if circle { REST } else { 0 },
            most: if circle { costs.bins() } else { DIRECTION_MOST },
        };
        for index in 0..16 {
            // Two bits for a_h, see `Tables::symbols`, and one for each jm.
            let a_h = [0, 1, 1, 4][index & 3];
            let cost = costs.scale() * (a_h + (index as i32 >> 2 & 1) + (index as i32 >> 3));
            [tables.ordered[0][index], tables.ordered[1][index]] = digits(cost);
            // Directions that are `index` apart, all of which are in range; the last entry is rest on a circle.
            let cost = match index as i8 {
                15 if circle => costs.direction(0, 1),
                apart if circle && apart >= costs.bins() as i8 => 0,
                apart if circle => costs.direction(1, 1 + apart),
                apart => costs.direction(0, apart),
            };
            [tables.direction[0][index], tables.direction[1][index]] = digits(cost);
        }
        Some(tables)
    }

    /// The symbols of a motion, and whether all its features are in range: only then do they mean it.
    #[inline(always)]
    pub(super) fn symbols(&self, motion: &Motion) -> ([u8; PLANES], bool) {
        let [a_h, theta_hj, phi_hj, jm_hj, theta_jl, phi_jl, jm_jl] = motion.0.map(|feature| feature as u8);
        // -1, 0, 1 become 00, 01, 11: as many bits differ as the values are apart.
        let a_h = a_h.wrapping_add(1);
        let ordered = a_h | a_h >> 1 | jm_hj << 2 | jm_jl << 3;
        let fits = (a_h <= 2) & (jm_hj <= 1) & (jm_jl <= 1);
        let directions = [phi_hj, phi_jl, theta_hj, theta_jl];
        let fits = directions.iter().fold(fits, |fits, &direction| fits & (direction <= self.most));
        let [phi_hj, phi_jl, theta_hj, theta_jl] =
            directions.map(|direction| if direction == 0 { self.rest } else { direction });
        ([ordered, phi_hj, phi_jl, theta_hj, theta_jl], fits)
    }
}

/// The symbols of a sequence, a plane for each byte of a motion.
#[derive(Clone, Debug)]
pub(in crate::dtw) struct Symbols {
    pub(super) planes: [[u8; ROOM]; PLANES],
    /// Any elevation is not 0.
    pub(super) elevated: bool,
}

impl Symbols {
    pub(in crate::dtw) const fn new() -> Self {
        Self { planes: [[0; ROOM]; PLANES], elevated: false }
    }

    /// Reads a sequence of at most [`IU_FRAMES`] motions. False if one has a feature that is out of range.
    pub(in crate::dtw) fn read<'m>(
        &mut self,
        tables: &Tables,
        motions: impl Iterator<Item = &'m Motion>,
    ) -> bool {
        let mut all_fit = true;
        let mut elevations = 0;
        for (place, motion) in motions.take(IU_FRAMES).enumerate() {
            let (symbols, fits) = tables.symbols(motion);
            all_fit &= fits;
            elevations |= motion.0[1] | motion.0[4];
            for (plane, symbol) in self.planes.iter_mut().zip(symbols) {
                plane[place] = symbol;
            }
        }
        self.elevated = elevations != 0;
        all_fit
    }
}
