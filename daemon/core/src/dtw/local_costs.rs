//! The local costs and the fastest way to sum them on this processor.

use super::cost::{IntegerCosts, UNREACHED};
use super::scratch::{Scratch, slot};
use super::simd::Simd;
use super::symbols::{BLOCK, Symbols};
use crate::couple::Motion;
use crate::job::LocalCost;

/// How two motions are compared, prepared for this processor.
///
/// Costs are integers, and sums of integers do not depend on the order of summation. That is why the online, the batch, the
/// portable and the SIMD path return the same bits.
#[derive(Clone, Debug)]
pub struct LocalCosts {
    pub(super) integers: IntegerCosts,
    /// The SIMD path; `None` where the processor or the costs do not allow it.
    simd: Option<Simd>,
}

impl LocalCosts {
    /// Rounds the costs and looks for a SIMD path. `bins` of a circular cost count as 1 to 127, the most that a motion can hold.
    pub fn new(cost: LocalCost) -> Self {
        let portable = Self::portable(cost);
        Self { simd: Simd::new(&portable.integers), ..portable }
    }

    /// As [`new`](Self::new), but without SIMD: slower, with the same results. Tests and benchmarks compare both.
    pub fn portable(cost: LocalCost) -> Self {
        Self { integers: IntegerCosts::new(cost), simd: None }
    }

    /// How far a distance may be from the one in real numbers, relative to it: costs are rounded to integers.
    pub fn relative_error(&self) -> f64 {
        self.integers.error / 2.0
    }

    /// Writes the symbols of a sequence. It has none without a SIMD path.
    pub(super) fn read(&self, motions: &[Motion], symbols: &mut Symbols) {
        symbols.length = 0;
        self.simd.iter().for_each(|simd| symbols.read(&simd.tables, motions));
    }

    /// Computes the next row in place by the fastest path and returns its minimum. It began with this reference.
    pub(super) fn advance(&self, scratch: &mut Scratch, frame: &Motion, reference: &[Motion]) -> i32 {
        if let Some(min) = self.simd.as_ref().and_then(|simd| simd.advance(frame, scratch)) {
            return min;
        }
        let mut diagonal = core::mem::replace(&mut scratch.border, UNREACHED);
        let (mut left, mut min) = (UNREACHED, UNREACHED);
        // A motion lasts for some frames, and each of them costs the same.
        let (mut before, mut cost) = (None, 0);
        for (index, motion) in reference.iter().enumerate() {
            if before != Some(motion) {
                (before, cost) = (Some(motion), self.integers.between(frame, motion));
            }
            let cell = &mut scratch.blocks[index / BLOCK][slot(index)];
            left = diagonal.min(*cell).min(left) + cost;
            diagonal = core::mem::replace(cell, left);
            min = min.min(left);
        }
        min
    }
}
