//! One reference, frame by frame.

use super::cost::ORIGIN;
use super::local_costs::LocalCosts;
use super::scratch::Scratch;
use super::{Refused, check};
use crate::capacity::IU_FRAMES;
use crate::couple::Motion;

/// DTW of a growing sequence against one reference. Each frame adds a row to the matrix, in O(reference length) and fixed memory.
#[derive(Clone, Debug)]
pub struct OnlineDtw<'a> {
    costs: LocalCosts,
    reference: &'a [Motion],
    /// Its row is the newest one: for each frame of the reference the minimum sum of a path that ends there.
    scratch: Scratch,
    /// Frames appended.
    frames: usize,
    /// Minimum of the newest row.
    min: i32,
}

impl<'a> OnlineDtw<'a> {
    /// Starts with no frame appended.
    ///
    /// # Errors
    /// If the reference is empty or longer than [`IU_FRAMES`].
    pub fn new(costs: &LocalCosts, reference: &'a [Motion]) -> Result<Self, Refused> {
        let mut online =
            Self { costs: costs.clone(), reference, scratch: Scratch::default(), frames: 0, min: ORIGIN };
        online.begin(reference)?;
        Ok(online)
    }

    /// Starts again with another reference, in place.
    ///
    /// # Errors
    /// As [`new`](Self::new); then nothing has changed.
    pub fn begin(&mut self, reference: &'a [Motion]) -> Result<(), Refused> {
        check(reference)?;
        self.reference = reference;
        self.scratch.begin(&self.costs, reference);
        self.frames = 0;
        self.min = ORIGIN;
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
        self.min = self.costs.advance(&mut self.scratch, frame, self.reference);
        self.frames += 1;
        Ok(())
    }

    /// Appends any number of frames of which nothing is known: each costs nothing, whatever frames of the reference it is paired with.
    /// The distance then is the least that any motion in them could have led to.
    pub fn append_unknown(&mut self) {
        self.scratch.advance_free(self.reference.len());
    }

    /// The distance of all appended frames to the reference, as [`distance`](super::distance) in every bit; `None` before the first.
    pub fn distance(&self) -> Option<f64> {
        (self.frames > 0)
            .then(|| self.costs.integers.distance_of(self.scratch.cell(self.reference.len() - 1)))
    }

    /// A lower bound of the distance, whatever frames are appended. It comes from the minimum of the newest row, which never falls, because every
    /// path to a later row passes through this one.
    pub fn lower_bound(&self) -> f64 {
        self.costs.integers.distance_of(self.min)
    }
}
