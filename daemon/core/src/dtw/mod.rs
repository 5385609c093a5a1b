//! Dynamic time warping (DTW) of motions (paper III-C.1).
//!
//! Multi-dimensional and dependent, with squared Euclidean local cost and without a window; the distance is the square root of
//! the sum. [`OnlineDtw`] compares a growing sequence with one reference, frame by frame; [`distance`] compares two whole
//! sequences; both return the same bits. [`path`] returns the warping path as well. All memory is fixed or the caller's.

mod cost;
mod local_costs;
mod online;
mod path;
mod scratch;
mod simd;
mod symbols;

pub use local_costs::LocalCosts;
pub use online::OnlineDtw;
pub use path::{Cells, path, path_memory};
pub use scratch::{Scratch, distance, distance_within};

use crate::capacity::IU_FRAMES;
use crate::couple::Motion;

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
    /// The caller's memory is too small.
    #[error("DTW needs memory for {needed} items and was given {given}")]
    Memory {
        /// Items needed.
        needed: usize,
        /// Items given.
        given: usize,
    },
}

/// Checks that a sequence can be compared.
fn check(sequence: &[Motion]) -> Result<(), Refused> {
    match sequence.len() {
        0 => Err(Refused::Empty),
        frames if frames > IU_FRAMES => Err(Refused::TooLong { frames }),
        _ => Ok(()),
    }
}
