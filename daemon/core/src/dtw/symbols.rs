//! Motions as bytes by which their costs are looked up.

use super::cost::IntegerCosts;
use crate::capacity::IU_FRAMES;
use crate::couple::Motion;

/// Cells that are computed together: as many as a vector has bytes.
pub(super) const BLOCK: usize = 32;

/// Bytes of one motion: one for the ordered features `a_h, jm_hj, jm_jl` together, then `φ_hj, φ_jl, θ_hj, θ_jl`. The
/// elevations come last because plane mode has none.
pub(super) const PLANES: usize = 5;

/// Bytes of one motion without elevations.
pub(super) const PLANES_FLAT: usize = 3;

/// Number of symbols of one feature: a shuffle looks up four bits.
const SYMBOLS: usize = 16;

/// The symbol of rest among directions on a circle. Its lowest four bits are 0, no direction, and it is at least 49 off every direction.
const REST: u8 = 64;

/// Costs of symbols. A motion has symbols if all its features are in range and there are at most 15 bins.
#[derive(Clone, Debug)]
pub(super) struct Tables {
    /// For the ordered features, by the exclusive or of the symbols.
    pub(super) ordered: [i32; SYMBOLS],
    /// For a direction, by the difference of the symbols; the last entry is for 15 or more.
    pub(super) apart: [i32; SYMBOLS],
    /// For a direction, by the lowest four bits of both symbols.
    direction: [[i32; SYMBOLS]; SYMBOLS],
    /// The symbol of rest.
    pub(super) rest: u8,
    /// Maximum direction.
    pub(super) max: u8,
}

impl Tables {
    /// `None` if there are too many bins.
    pub(super) fn new(costs: &IntegerCosts) -> Option<Self> {
        let circle = costs.bins > 0;
        let max = if circle { costs.bins } else { SYMBOLS as u8 - 1 };
        if usize::from(max) >= SYMBOLS {
            return None;
        }
        let scale = costs.scale;
        let ordered = core::array::from_fn(|differ| {
            // Two bits for a_h (see `symbols`) and one for each jm.
            let a_h = [0, 1, 1, 4][differ & 3];
            costs.step * a_h + scale * ((differ as i32 >> 2 & 1) + (differ as i32 >> 3))
        });
        let direction = core::array::from_fn(|a| core::array::from_fn(|b| costs.direction(a as i8, b as i8)));
        let apart = core::array::from_fn(|apart| match apart {
            15 if circle => scale,
            apart if circle && apart >= usize::from(max) => 0,
            apart if circle => costs.direction(1, 1 + apart as i8),
            apart => costs.direction(0, apart as i8),
        });
        Some(Self { ordered, apart, direction, rest: if circle { REST } else { 0 }, max })
    }

    /// The symbols of a motion; `None` if a feature is out of range.
    #[inline]
    pub(super) fn symbols(&self, motion: &Motion) -> Option<[u8; PLANES]> {
        let [a_h, theta_hj, phi_hj, jm_hj, theta_jl, phi_jl, jm_jl] = motion.0.map(|feature| feature as u8);
        // -1, 0, 1 become 00, 01, 11: the number of bits that differ is the difference of the values.
        let a_h = a_h.wrapping_add(1);
        let ordered = a_h | a_h >> 1 | jm_hj << 2 | jm_jl << 3;
        let mut directions = [phi_hj, phi_jl, theta_hj, theta_jl];
        let mut fits = (a_h <= 2) & (jm_hj <= 1) & (jm_jl <= 1);
        for direction in &mut directions {
            fits &= *direction <= self.max;
            *direction = if *direction == 0 { self.rest } else { *direction };
        }
        let [phi_hj, phi_jl, theta_hj, theta_jl] = directions;
        fits.then_some([ordered, phi_hj, phi_jl, theta_hj, theta_jl])
    }

    /// Calls `each` with the costs of a frame and each of the first `length` motions of a sequence, in order.
    #[inline]
    pub(super) fn costs(
        &self,
        frame: [u8; PLANES],
        sequence: &Symbols,
        length: usize,
        mut each: impl FnMut(i32),
    ) {
        let of_frame = |plane: usize| &self.direction[low(frame[plane])];
        let directions = [of_frame(1), of_frame(2), of_frame(3), of_frame(4)];
        let [ordered, planes @ ..] = sequence.planes.each_ref().map(|plane| &plane[..length]);
        for index in 0..length {
            let mut cost = self.ordered[low(ordered[index] ^ frame[0])];
            for (direction, plane) in directions.iter().zip(planes) {
                cost += direction[low(plane[index])];
            }
            each(cost);
        }
    }
}

fn low(symbol: u8) -> usize {
    usize::from(symbol) % SYMBOLS
}

/// What the symbols of a sequence tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// Nothing: the sequence has none under its costs.
    Nothing,
    /// All elevations are 0.
    Flat,
    /// Any elevation differs from 0.
    Elevated,
}

/// The symbols of a sequence: a plane for each byte of a motion.
#[derive(Clone, Debug)]
pub(super) struct Symbols {
    pub(super) planes: [[u8; IU_FRAMES]; PLANES],
    pub(super) content: Content,
}

impl Symbols {
    pub(super) const fn new() -> Self {
        Self { planes: [[0; IU_FRAMES]; PLANES], content: Content::Nothing }
    }

    /// Writes the symbols of at most [`IU_FRAMES`] motions; none, if a feature is out of range.
    pub(super) fn read(&mut self, tables: &Tables, motions: &[Motion]) {
        self.content = Content::Nothing;
        let mut elevations = 0;
        for (index, motion) in motions.iter().take(IU_FRAMES).enumerate() {
            let Some(symbols) = tables.symbols(motion) else { return };
            elevations |= motion.0[1] | motion.0[4];
            for (plane, symbol) in self.planes.iter_mut().zip(symbols) {
                plane[index] = symbol;
            }
        }
        self.content = if elevations != 0 { Content::Elevated } else { Content::Flat };
    }
}
