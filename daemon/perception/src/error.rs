//! What can go wrong. Each message is a sentence that says where, and what to do.

use crate::pixel_format::PixelFormat;
use std::path::PathBuf;

/// The command that makes the files of [`PerceptionConfig::runtime`](crate::PerceptionConfig::runtime).
pub(crate) const REMEDY: &str = "run `make setup`";

/// A file of [`PerceptionConfig::runtime`](crate::PerceptionConfig::runtime).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RuntimeFile {
    /// The library that runs the models.
    OnnxRuntime,
    /// The model that finds palms.
    PalmModel,
    /// The model that finds the landmarks of a hand.
    LandmarkModel,
}

impl std::fmt::Display for RuntimeFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::OnnxRuntime => "ONNX Runtime",
            Self::PalmModel => "the palm model",
            Self::LandmarkModel => "the hand landmark model",
        })
    }
}

/// Why there is no perceiver, or no detections.
#[derive(Debug, thiserror::Error)]
pub enum PerceptionError {
    /// A file that the perceiver needs is not there.
    #[error("{what} is missing: {} does not exist; {REMEDY}", path.display())]
    Missing {
        /// The file.
        what: RuntimeFile,
        /// Where it was looked for.
        path: PathBuf,
    },
    /// A file that the perceiver needs cannot be read.
    #[error("{what} cannot be read from {}: {source}; let this user read it, or {REMEDY}", path.display())]
    Unreadable {
        /// The file.
        what: RuntimeFile,
        /// Where it is.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A file is not the one that was provisioned.
    #[error("{what} is corrupt: {} does not have the pinned SHA-256; {REMEDY}", path.display())]
    Corrupt {
        /// The file.
        what: RuntimeFile,
        /// Where it is.
        path: PathBuf,
    },
    /// ONNX Runtime refuses a file.
    #[error("{what} cannot be loaded from {}: {reason}; {REMEDY}", path.display())]
    Refused {
        /// The file.
        what: RuntimeFile,
        /// Where it is.
        path: PathBuf,
        /// ONNX Runtime's reason.
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
    /// The system refuses the threads.
    #[error(
        "the threads that look at the pictures cannot be started: {reason}; raise the number of tasks that this process may have"
    )]
    Threads {
        /// The system's reason.
        reason: String,
    },
    /// The sizes of a picture contradict one another.
    #[error(
        "a picture of {width} x {height} {format:?} with {stride} bytes per row and {bytes} bytes in all cannot be read"
    )]
    Image {
        /// Pixels per row.
        width: usize,
        /// Number of rows.
        height: usize,
        /// Bytes from one row to the next.
        stride: usize,
        /// How the bytes of a pixel are ordered.
        format: PixelFormat,
        /// Number of bytes in all.
        bytes: usize,
    },
    /// The calibration is for pictures of another size.
    #[error(
        "the calibration is for pictures of {} x {}, this one is {width} x {height}; calibrate again", for_pictures[0], for_pictures[1]
    )]
    CalibratedFor {
        /// Width and height of the pictures that it is for.
        for_pictures: [usize; 2],
        /// Pixels per row.
        width: usize,
        /// Number of rows.
        height: usize,
    },
    /// A hand model failed on a frame.
    #[error("{what} failed on a frame: {reason}")]
    Inference {
        /// The model.
        what: RuntimeFile,
        /// ONNX Runtime's reason.
        reason: String,
    },
    /// OpenCV failed.
    #[error("OpenCV failed while {doing}: {source}")]
    OpenCv {
        /// What was being done.
        doing: &'static str,
        /// OpenCV's reason.
        source: opencv::Error,
    },
}

impl PerceptionError {
    /// The file of the runtime folder that is missing, damaged or refused, if it is one.
    pub fn unusable_file(&self) -> Option<RuntimeFile> {
        match self {
            Self::Missing { what, .. }
            | Self::Unreadable { what, .. }
            | Self::Corrupt { what, .. }
            | Self::Refused { what, .. } => Some(*what),
            _ => None,
        }
    }
}

/// Names what was being done when OpenCV failed.
pub(crate) fn while_doing(doing: &'static str) -> impl Fn(opencv::Error) -> PerceptionError {
    move |source| PerceptionError::OpenCv { doing, source }
}
