//! The local costs and the fastest way to sum them on this processor.

use super::cost::{IntegerCosts, UNREACHED};
use super::row::{Row, slot};
use super::simd::Simd;
use super::symbols::{BLOCK, Content, Symbols, Tables};
use crate::couple::Motion;
use crate::job::LocalCost;

/// How two motions are compared, prepared for this processor.
///
/// Costs are integers, and sums of integers do not depend on the order of summation. That is why the online, the batch, the
/// portable and the SIMD path return the same bits.
#[derive(Clone, Debug)]
pub struct LocalCosts {
    pub(super) integers: IntegerCosts,
    /// Costs of symbols; `None` where motions have no symbols.
    tables: Option<Tables>,
    /// The SIMD path; `None` where the processor or the costs do not allow it.
    pub(super) simd: Option<Simd>,
}

impl LocalCosts {
    /// Rounds the costs and looks for a SIMD path. `bins` of a circular cost count as 1 to 127, the most that a motion can hold.
    pub fn new(cost: LocalCost) -> Self {
        let portable = Self::portable(cost);
        let simd = portable.tables.as_ref().and_then(Simd::new);
        Self { simd, ..portable }
    }

    /// As [`new`](Self::new), but without SIMD: slower, with the same results. Tests and benchmarks compare both.
    pub fn portable(cost: LocalCost) -> Self {
        let integers = IntegerCosts::new(cost);
        let tables = Tables::new(&integers);
        Self { integers, tables, simd: None }
    }

    /// How far a distance may be from the one in real numbers, relative to it: costs are rounded to integers.
    pub fn relative_error(&self) -> f64 {
        self.integers.error / 2.0
    }

    /// Writes the symbols of a sequence. It has none where these costs have none.
    pub(super) fn read(&self, motions: &[Motion], symbols: &mut Symbols) {
        if let Some(tables) = &self.tables {
            symbols.read(tables, motions);
        }
    }

    /// Computes the next row in place by the fastest path and returns its minimum. `symbols` are those of the reference.
    pub(super) fn advance(
        &self,
        row: &mut Row,
        frame: &Motion,
        reference: &[Motion],
        symbols: &Symbols,
    ) -> i32 {
        let tables = self.tables.as_ref().filter(|_| symbols.content != Content::Nothing);
        if let (Some(simd), Some(tables)) = (&self.simd, tables)
            && let Some(min) = simd.advance(tables, frame, symbols, reference.len(), row)
        {
            return min;
        }
        let mut diagonal = core::mem::replace(&mut row.border, UNREACHED);
        let (mut left, mut min) = (UNREACHED, UNREACHED);
        let mut index = 0;
        let next = |cost: i32| {
            let cell = &mut row.blocks[index / BLOCK][slot(index)];
            let up = *cell;
            left = diagonal.min(up).min(left) + cost;
            *cell = left;
            diagonal = up;
            min = min.min(left);
            index += 1;
        };
        match tables.and_then(|tables| Some((tables, tables.symbols(frame)?))) {
            Some((tables, frame)) => tables.costs(frame, symbols, reference.len(), next),
            None => reference.iter().map(|motion| self.integers.between(frame, motion)).for_each(next),
        }
        min
    }
}
