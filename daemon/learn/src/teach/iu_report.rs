//! What teaching found for one IU.

use super::kind::MotionKind;
use super::threshold::Learned;
use crate::job_file::TaughtIu;
use crate::statistics::{deviation, mean};

/// What was taught of one IU of a nominal activity, and what it depends on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct IuReport {
    /// Index of the activity in the job, from 0.
    pub(super) activity: u16,
    /// Index of the IU in the activity, from 0.
    pub(super) iu: usize,
    pub(super) taught: TaughtIu,
    /// Mean and standard deviation of the DTW distances that the threshold is derived from.
    pub(super) distance: [f64; 2],
    /// The demonstrations do not agree in the number of strokes.
    pub(super) is_by_feel: bool,
}

impl IuReport {
    pub(super) fn new(
        activity: u16,
        iu: usize,
        learned: &Learned,
        kind: MotionKind,
        taught: &TaughtIu,
    ) -> Self {
        let distances = learned.distances();
        Self {
            activity,
            iu,
            taught: taught.clone(),
            distance: [mean(distances), deviation(distances, 1)],
            is_by_feel: kind.is_by_feel(),
        }
    }

    /// The threshold, in words where the motion is no law.
    pub(super) fn threshold_words(&self) -> String {
        let threshold = self.taught.threshold;
        if threshold < f32::MAX { format!("{threshold:.2}") } else { "any".to_owned() }
    }
}
