//! One reference, one frame at a time.

use super::cost::{LocalCosts, ORIGIN};
use super::row::Row;
use super::symbols::Symbols;
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
    symbols: Symbols,
    /// Whether the reference has symbols.
    has_symbols: bool,
    /// The newest row: for every place of the reference the least sum of a path that ends there.
    row: Row,
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
            has_symbols: false,
            row: Row::new(),
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
        self.has_symbols = self.symbols.read_for(&self.costs, reference, false);
        self.row.begin(reference.len());
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
        let symbols = Some(&self.symbols).filter(|_| self.has_symbols);
        self.least = self.row.advance(&self.costs, frame, self.reference, symbols);
        self.frames += 1;
        Ok(())
    }

    /// The DTW distance of all appended frames and the reference, equal to [`distance`](super::distance) in every bit; `None` before
    /// the first frame.
    pub fn distance(&self) -> Option<f64> {
        (self.frames > 0).then(|| self.costs.distance_of(self.row.cell(self.reference.len() - 1)))
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
