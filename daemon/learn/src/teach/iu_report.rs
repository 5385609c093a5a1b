//! What teaching found for one IU.

use super::kind::MotionKind;
use super::threshold::Learned;
use crate::job_file::TaughtIu;
use crate::statistics::{deviation, mean};
use andon_core::bounds::Bounds;
use andon_core::couple::Context;
use andon_core::job::MeasureBounds;

/// What teaching found for one IU of a nominal activity.
#[derive(Clone, Debug, PartialEq)]
pub struct IuReport {
    /// Index of the activity in the job, from 0.
    pub activity: u16,
    /// Index of the IU in the activity, from 0.
    pub iu: usize,
    /// The context of the IU.
    pub context: Context,
    /// Number of demonstrations.
    pub demonstrations: usize,
    /// Mean of the DTW distances that the threshold is derived from.
    pub mean_distance: f64,
    /// Their standard deviation.
    pub distance_deviation: f64,
    /// Maximum DTW distance of a correct execution.
    pub threshold: f32,
    /// Bounds of duration, in frames of the grid.
    pub frames: Bounds,
    /// Bounds of the number of reversals.
    pub reversals: Bounds,
    /// The demonstrations do not agree in the number of strokes.
    pub is_by_feel: bool,
    /// Bounds of what it measures in metres, and what was shown.
    pub measures: MeasureBounds,
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
            context: taught.context,
            demonstrations: learned.own.len(),
            mean_distance: mean(distances),
            distance_deviation: deviation(distances, 1),
            threshold: taught.threshold,
            frames: taught.frames,
            reversals: taught.reversals,
            is_by_feel: kind.is_by_feel(),
            measures: taught.measures,
        }
    }

    /// The threshold, in words where the motion is no law.
    pub(super) fn threshold_words(&self) -> String {
        if self.threshold < f32::MAX { format!("{:.2}", self.threshold) } else { "any".to_owned() }
    }
}
