//! One reference, one frame at a time.

use super::cost::{LocalCosts, UNREACHED};
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
    /// The newest row: the least sum of a path that ends at the newest frame and this place of the reference.
    row: [u32; IU_FRAMES],
    /// Frames appended.
    frames: usize,
    /// Least value of the newest row.
    least: u32,
}

impl<'a> OnlineDtw<'a> {
    /// Starts with no frame appended.
    ///
    /// # Errors
    /// If the reference is empty or longer than [`IU_FRAMES`].
    pub fn new(costs: &LocalCosts, reference: &'a [Motion]) -> Result<Self, Refused> {
        accept(reference)?;
        Ok(Self { costs: costs.clone(), reference, row: [UNREACHED; IU_FRAMES], frames: 0, least: 0 })
    }

    /// Starts anew with another reference, in place.
    ///
    /// # Errors
    /// As [`new`](Self::new); then nothing has changed.
    pub fn begin(&mut self, reference: &'a [Motion]) -> Result<(), Refused> {
        accept(reference)?;
        self.reference = reference;
        self.row[..reference.len()].fill(UNREACHED);
        self.frames = 0;
        self.least = 0;
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
        let row = &mut self.row[..self.reference.len()];
        self.least = next_row(&self.costs, frame, self.reference, self.frames == 0, row);
        self.frames += 1;
        Ok(())
    }

    /// The DTW distance of all appended frames and the reference, equal to [`distance`](super::distance) in every bit; `None` before
    /// the first frame.
    pub fn distance(&self) -> Option<f64> {
        (self.frames > 0).then(|| self.costs.distance_of(self.row[self.reference.len() - 1]))
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

/// Makes the next row of the DTW matrix in place and returns its least value. `first`: there is no row before.
pub(super) fn next_row(
    costs: &LocalCosts,
    frame: &Motion,
    reference: &[Motion],
    first: bool,
    row: &mut [u32],
) -> u32 {
    // Before the first row only the corner has been reached.
    let mut diagonal = if first { 0 } else { UNREACHED };
    let mut left = UNREACHED;
    let mut least = UNREACHED;
    for (cell, place) in row.iter_mut().zip(reference) {
        let up = *cell;
        left = diagonal.min(up).min(left) + costs.between(frame, place);
        *cell = left;
        diagonal = up;
        least = least.min(left);
    }
    least
}
