//! Dynamic time warping (DTW) of motions (paper III-C.1).
//!
//! Multi-dimensional and dependent, with squared Euclidean local cost and without a window; the distance is the square root of
//! the sum. [`OnlineDtw`] compares a growing sequence with one reference, frame by frame, in fixed memory.

mod cost;
mod online;

pub use cost::LocalCosts;
pub use online::OnlineDtw;

use crate::capacity::IU_FRAMES;

/// Why there is no distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    /// A sequence without a frame has no distance to anything.
    #[error("a sequence without frames has no DTW distance: give at least one frame")]
    Empty,
    /// A sequence is longer than [`IU_FRAMES`].
    #[error("a sequence of {frames} frames is longer than the {IU_FRAMES} that an IU may have: cut it")]
    TooLong {
        /// Its length in frames.
        frames: usize,
    },
}
