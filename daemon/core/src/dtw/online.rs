//! One reference, frame by frame.

use super::Refused;
use super::cost::LocalCosts;
use crate::capacity::IU_FRAMES;
use crate::couple::Motion;

/// The value of a cell that no path has reached, greater than that of every reached one.
const UNREACHED: u32 = u32::MAX;

/// DTW of a growing sequence against one reference. Each frame adds a row to the matrix, in O(reference length) and fixed memory.
#[derive(Clone, Debug)]
pub struct OnlineDtw<'a> {
    costs: LocalCosts,
    reference: &'a [Motion],
    /// The newest frame, and what it costs against each frame of the reference.
    newest: Option<Motion>,
    frame_costs: [u32; IU_FRAMES],
    /// The cell before the first one of the newest row, and that row.
    border: u32,
    row: [u32; IU_FRAMES],
    /// Frames appended.
    frames: usize,
    /// Minimum of the newest row.
    min: u32,
}

impl<'a> OnlineDtw<'a> {
    /// Starts with no frame appended.
    ///
    /// # Errors
    /// If the reference is empty or longer than [`IU_FRAMES`].
    pub fn new(costs: &LocalCosts, reference: &'a [Motion]) -> Result<Self, Refused> {
        let [frame_costs, row] = [[0; IU_FRAMES], [UNREACHED; IU_FRAMES]];
        let (costs, newest) = (costs.clone(), None);
        let mut online = Self { costs, reference, newest, frame_costs, border: 0, row, frames: 0, min: 0 };
        online.begin(reference)?;
        Ok(online)
    }

    /// Starts again with another reference, in place.
    ///
    /// # Errors
    /// As [`new`](Self::new); then nothing has changed.
    pub fn begin(&mut self, reference: &'a [Motion]) -> Result<(), Refused> {
        match reference.len() {
            0 => return Err(Refused::Empty),
            frames if frames > IU_FRAMES => return Err(Refused::TooLong { frames }),
            frames => self.row[..frames].fill(UNREACHED),
        }
        (self.reference, self.newest) = (reference, None);
        (self.border, self.frames, self.min) = (0, 0, 0);
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
        self.frames += 1;
        let length = self.reference.len();
        if self.newest != Some(*frame) {
            self.newest = Some(*frame);
            // A motion lasts for some frames, and each of them costs the same.
            let (mut before, mut same) = (None, 0);
            for (cost, motion) in self.frame_costs.iter_mut().zip(self.reference) {
                if before != Some(motion) {
                    (before, same) = (Some(motion), self.costs.between(frame, motion));
                }
                *cost = same;
            }
        }
        let mut diagonal = core::mem::replace(&mut self.border, UNREACHED);
        let (mut left, mut min) = (UNREACHED, UNREACHED);
        for (cell, cost) in self.row[..length].iter_mut().zip(&self.frame_costs) {
            left = diagonal.min(*cell).min(left) + cost;
            diagonal = core::mem::replace(cell, left);
            min = min.min(left);
        }
        self.min = min;
        Ok(())
    }

    /// Appends any number of frames of which nothing is known: each costs nothing, whatever frames of the reference it is paired with.
    /// The distance then is the least that any motion in them could have led to.
    pub fn append_unknown(&mut self) {
        let mut min = core::mem::replace(&mut self.border, UNREACHED);
        for cell in &mut self.row[..self.reference.len()] {
            min = min.min(*cell);
            *cell = min;
        }
    }

    /// The newest row of the matrix: for each frame of the reference the minimum sum of a path that ends there, in units of the costs.
    pub fn row(&self) -> &[u32] {
        &self.row[..self.reference.len()]
    }

    /// The distance of all appended frames to the reference, as `dtw_ndim.distance` of dtaidistance; `None` before the first.
    pub fn distance(&self) -> Option<f64> {
        let sum = self.row().last().filter(|_| self.frames > 0)?;
        Some(self.costs.distance_of(*sum))
    }

    /// A lower bound of the distance, whatever frames are appended. It comes from the minimum of the newest row, which never falls, because every
    /// path to a later row passes through this one.
    pub fn lower_bound(&self) -> f64 {
        self.costs.distance_of(self.min)
    }
}
