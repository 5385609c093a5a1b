//! What can go wrong in metric mode. Each message is a sentence that says what to do.

use crate::error::PerceptionError;

/// Why there is no metric bench, or no depth.
#[derive(Debug, thiserror::Error)]
pub enum MetricError {
    /// The sizes of a depth picture contradict one another.
    #[error(
        "a depth picture of {width} x {height} with {stride} bytes per row, {unit_m} m per step and {bytes} bytes in all cannot be read"
    )]
    Depth {
        /// Pixels per row.
        width: usize,
        /// Number of rows.
        height: usize,
        /// Bytes from one row to the next.
        stride: usize,
        /// One step of depth in metres.
        unit_m: f64,
        /// Number of bytes in all.
        bytes: usize,
    },
    /// The frames do not describe the optics of the camera.
    #[error(
        "the frames do not describe the optics of colour and depth; update the camera's firmware, or use bench.space = \"plane\""
    )]
    Optics,
    /// The bench was not found.
    #[error(
        "the bench was not found: {reason}; clear the bench, let the camera look down on it, and calibrate again"
    )]
    NoBench {
        /// What was found.
        reason: String,
    },
    /// OpenCV failed.
    #[error(transparent)]
    Perception(#[from] PerceptionError),
}
