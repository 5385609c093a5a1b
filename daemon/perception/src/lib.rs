//! Frames in, detections out: ArUco markers, hands, calibration.
//!
//! The data path, in the order of the modules:
//!
//! [`image`] a frame, read in place → [`markers`] corners in pixels, [`hands`] landmarks in pixels →
//! [`bench`] metres in the bench frame → [`held`] what a hand carries and hides → [`detections`], all of it put together by
//! the [`Perceiver`].
//!
//! Bench frame: metres, x right in the picture, y up in the picture (away from the worker), z towards the camera.
//! Pixels: x right, y down, the centre of the first pixel at (0, 0).
//!
//! The hand models and ONNX Runtime are not part of the build: `models/provision.py` fetches them into a folder, and the
//! [`Perceiver`] is told which ([`PerceptionConfig::runtime`]).
#![forbid(unsafe_code)]

pub mod bench;
pub mod config;
pub mod detections;
pub mod error;
pub mod hands;
pub mod held;
pub mod image;
pub mod markers;
pub mod metric;
mod perceiver;

pub use config::PerceptionConfig;
pub use detections::Detections;
pub use error::PerceptionError;
pub use image::{ImageView, PixelFormat};
pub use perceiver::Perceiver;
