//! Frames in, detections out: ArUco markers, hands, calibration.
//!
//! The data path of plane mode, which the [`Perceiver`] puts together:
//!
//! [`ImageView`] a frame, read in place → an [`ObjectFinder`] corners in pixels, `hands` landmarks in pixels → [`bench`] metres in the bench frame →
//! [`Detections`].
//!
//! With depth, [`metric`] places the detections of a frame in three dimensions.
//!
//! Bench frame: metres, x right in the picture, y up in the picture (away from the worker), z towards the camera.
//! Pixels: x right, y down, the centre of the first pixel at (0, 0).
//!
//! The hand models and ONNX Runtime are not part of the build: `models/provision.py` fetches them into a folder, and
//! [`PerceptionConfig::runtime`] names it.
#![forbid(unsafe_code)]

pub mod bench;
pub mod config;
mod conversion;
pub mod detections;
mod dictionary;
mod error;
mod finder;
mod hands;
mod image;
mod markers;
pub mod metric;
mod perceiver;
mod picture;
mod pixel_format;
mod points;
mod print;
pub mod sight;
mod workers;

pub use config::PerceptionConfig;
pub use detections::Detections;
pub use dictionary::Dictionary;
pub use error::{PerceptionError, RuntimeFile};
pub use finder::{FoundObjects, ObjectFinder, SeenObject};
pub use image::{ImageView, MAX_SIDE_PX};
pub use perceiver::Perceiver;
pub use picture::Picture;
pub use pixel_format::PixelFormat;
pub use points::{BenchPoint, PixelPoint};
pub use print::{MarkerFinder, MarkerPattern};
