//! What can go wrong, each in one sentence that says where and what to do.

use crate::image::PixelFormat;
use std::path::PathBuf;

/// What makes the files of [`PerceptionConfig::runtime`](crate::PerceptionConfig::runtime).
pub(crate) const REMEDY: &str = "run `make setup`";

/// Why there is no perceiver, or no detections.
#[derive(Debug, thiserror::Error)]
pub enum PerceptionError {
    /// A file that the perceiver needs is not there.
    #[error("{what} is missing: {} does not exist; {REMEDY}", path.display())]
    Missing {
        /// What the file is.
        what: &'static str,
        /// Where it was looked for.
        path: PathBuf,
    },
    /// A file that the perceiver needs cannot be read.
    #[error("{what} cannot be read from {}: {source}; let this user read it, or {REMEDY}", path.display())]
    Unreadable {
        /// What the file is.
        what: &'static str,
        /// Where it is.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file is there and is not the one that was provisioned.
    #[error("{what} is corrupt: {} does not have the pinned SHA-256; {REMEDY}", path.display())]
    Corrupt {
        /// What the file is.
        what: &'static str,
        /// Where it is.
        path: PathBuf,
    },
    /// ONNX Runtime refuses a file.
    #[error("{what} cannot be loaded from {}: {reason}; {REMEDY}", path.display())]
    Refused {
        /// What the file is.
        what: &'static str,
        /// Where it is.
        path: PathBuf,
        /// What ONNX Runtime says.
        reason: String,
    },
    /// A setting is out of its range.
    #[error("{key} is {value}: {range}")]
    Setting {
        /// The setting's name.
        key: &'static str,
        /// Its value.
        value: String,
        /// What is allowed.
        range: &'static str,
    },
    /// The sizes of a picture do not fit one another.
    #[error(
        "a picture of {width} x {height} {format:?} with {stride} bytes a row and {bytes} bytes in all is none that can be read"
    )]
    Image {
        /// Pixels a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Bytes from one row to the next.
        stride: usize,
        /// How the bytes of a pixel are ordered.
        format: PixelFormat,
        /// Bytes in all.
        bytes: usize,
    },
    /// The calibration is for pictures of another size.
    #[error(
        "the calibration is for pictures of {} x {}, this one is {width} x {height}; calibrate again", for_pictures[0], for_pictures[1]
    )]
    CalibratedFor {
        /// Width and height that it is for.
        for_pictures: [usize; 2],
        /// Pixels a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// A hand model failed on a frame.
    #[error("{what} failed on a frame: {reason}")]
    Inference {
        /// Which model.
        what: &'static str,
        /// What ONNX Runtime says.
        reason: String,
    },
    /// OpenCV failed.
    #[error("OpenCV failed while {doing}: {source}")]
    OpenCv {
        /// What was being done.
        doing: &'static str,
        /// What OpenCV says.
        source: opencv::Error,
    },
}

/// Names what was being done when OpenCV failed.
pub(crate) fn while_doing(doing: &'static str) -> impl Fn(opencv::Error) -> PerceptionError {
    move |source| PerceptionError::OpenCv { doing, source }
}
