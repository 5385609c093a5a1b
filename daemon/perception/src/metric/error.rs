//! What can go wrong in metric mode, each in one sentence that says what to do.

use crate::error::PerceptionError;

/// Why there is no metric bench, or no depth.
#[derive(Debug, thiserror::Error)]
pub enum MetricError {
    /// The sizes of a depth picture do not fit one another.
    #[error(
        "a depth picture of {width} x {height} with {stride} bytes a row, {unit_m} m a step and {bytes} bytes in all is none that can be read"
    )]
    Depth {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Bytes from one row to the next.
        stride: usize,
        /// Metres of one step of depth.
        unit_m: f64,
        /// Bytes in all.
        bytes: usize,
    },
    /// Frames do not tell how the camera sees.
    #[error(
        "the frames do not tell the optics of colour and depth; update the camera's firmware, or use bench.space = \"plane\""
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
