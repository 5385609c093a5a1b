//! Costs as bytes.

use crate::dtw::symbols::{PLANES, Tables};

/// A shuffle looks up bytes, so a cost has two digits, `low + DIGIT * high`. Five low ones sum up to at most 5 * 51 = 255.
pub(super) const DIGIT: i32 = 52;

const _: () = assert!(PLANES as i32 * (DIGIT - 1) <= 255);

/// Low and high digits of the costs in [`Tables`].
#[derive(Clone, Debug)]
pub(super) struct Digits {
    pub(super) ordered: [[u8; 16]; 2],
    pub(super) apart: [[u8; 16]; 2],
}

impl Digits {
    /// `None` if the sum of high digits could exceed 255.
    pub(super) fn new(tables: &Tables) -> Option<Self> {
        let max = |costs: &[i32; 16]| costs.iter().copied().fold(0, i32::max);
        let sum = max(&tables.ordered) + (PLANES as i32 - 1) * max(&tables.apart);
        let digits = |costs: &[i32; 16]| {
            [costs.map(|cost| (cost % DIGIT) as u8), costs.map(|cost| (cost / DIGIT) as u8)]
        };
        (sum / DIGIT <= 255).then(|| Self { ordered: digits(&tables.ordered), apart: digits(&tables.apart) })
    }
}
