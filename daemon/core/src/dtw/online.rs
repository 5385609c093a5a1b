//! One reference, one frame at a time.

use super::cost::{LocalCosts, ORIGIN, UNREACHED};
use super::simd::{ROW, Symbols};
use super::{Refused, accept};
use crate::capacity::IU_FRAMES;
use crate::couple::Motion;

/// DTW of a growing sequence against one reference.
///
/// Each appended frame makes the next row of the DTW matrix from the row before, in O(reference length) and fixed memory.
#[derive(Clone, Debug)]
pub struct OnlineDtw<'a> {
    costs: LocalCosts,
    reference: &'a [Motion],
    /// The reference for the SIMD path, if that can take it.
    symbols: Symbols,
    symbols_fit: bool,
    /// The newest row: the border, then for every place of the reference the least sum of a path that ends there.
    row: [i32; ROW],
    /// Frames appended.
    frames: usize,
    /// Least value of the newest row.
    least: i32,
}

impl<'a> OnlineDtw<'a> {
    /// Starts with no frame appended.
    ///
    /// # Errors
    /// If the reference is empty or longer than [`IU_FRAMES`].
    pub fn new(costs: &LocalCosts, reference: &'a [Motion]) -> Result<Self, Refused> {
        let mut online = Self {
            costs: costs.clone(),
            reference,
            symbols: Symbols::new(),
            symbols_fit: false,
            row: [UNREACHED; ROW],
            frames: 0,
            least: ORIGIN,
        };
        online.begin(reference)?;
        Ok(online)
    }

    /// Starts anew with another reference, in place.
    ///
    /// # Errors
    /// As [`new`](Self::new); then nothing has changed.
    pub fn begin(&mut self, reference: &'a [Motion]) -> Result<(), Refused> {
        accept(reference)?;
        self.reference = reference;
        self.symbols_fit =
            self.costs.simd().is_some_and(|simd| self.symbols.read(&simd.tables, reference.iter()));
        self.row[0] = ORIGIN;
        self.row[1..=reference.len()].fill(UNREACHED);
        self.frames = 0;
        self.least = ORIGIN;
        Ok(())
    }

    /// Appends one frame.
    ///
    /// # Errors
    /// If [`IU_FRAMES`] frames have been appended; then nothing has changed.
    pub fn append(&mut self, frame: &Motion) -> Result<(), Refused> {
        if self.frames == IU_FRAMES {
            return Err(Refused::TooLong { frames: IU_FRAMES + 1 });
        }
        let places = self.reference.len();
        let by_simd = match self.costs.simd() {
            Some(simd) if self.symbols_fit => simd.next_row(frame, &self.symbols, places, &mut self.row),
            _ => None,
        };
        self.least = by_simd.unwrap_or_else(|| next_row(&self.costs, frame, self.reference, &mut self.row));
        self.frames += 1;
        Ok(())
    }

    /// The DTW distance of all appended frames and the reference, equal to [`distance`](super::distance) in every bit; `None` before
    /// the first frame.
    pub fn distance(&self) -> Option<f64> {
        (self.frames > 0).then(|| self.costs.distance_of(self.row[self.reference.len()]))
    }

    /// A bound that the distance cannot fall under any more, whatever is appended: from the least value of the newest row,
    /// which never falls, because every path to a later row passes through this one.
    pub fn lower_bound(&self) -> f64 {
        self.costs.distance_of(self.least)
    }

    /// Frames appended.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// The reference.
    pub fn reference(&self) -> &'a [Motion] {
        self.reference
    }
}

/// Makes the next row of the DTW matrix in place and returns its least value. The row begins with the border.
pub(super) fn next_row(costs: &LocalCosts, frame: &Motion, reference: &[Motion], row: &mut [i32]) -> i32 {
    let Some((border, cells)) = row.split_first_mut() else { return UNREACHED };
    let mut diagonal = core::mem::replace(border, UNREACHED);
    let mut left = UNREACHED;
    let mut least = UNREACHED;
    for (cell, place) in cells.iter_mut().zip(reference) {
        let up = *cell;
        left = diagonal.min(up).min(left) + costs.between(frame, place);
        *cell = left;
        diagonal = up;
        least = least.min(left);
    }
    least
}
