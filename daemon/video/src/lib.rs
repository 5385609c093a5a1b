//! Cameras and films in, films out: the part of the daemon that links OpenCV's `videoio`, as a library for its binary and its tests.
//!
//! [`capture`] is the role; [`open`] gives it the [`source`] that the configuration names. [`film`] serves the tools of `andond` over a pipe.
#![forbid(unsafe_code)]

pub mod capture;
mod container;
mod device;
mod encoding;
mod error;
pub mod film;
mod folder;
mod jpeg;
mod rate;
#[cfg(feature = "realsense")]
mod realsense;
mod recording;
pub mod source;
mod whole;

use andon_host::config::{Config, Source as Configured};

pub use error::{CaptureError, OpenError};
use source::Source;

/// Opens the source that the configuration names.
///
/// # Errors
/// [`OpenError`]: what is wrong with the camera or the recording, and what to do about it.
pub fn open(config: &Config) -> Result<Box<dyn Source>, OpenError> {
    let camera = &config.camera;
    let path = camera.path.clone().unwrap_or_default();
    match camera.source {
        Configured::Video | Configured::Images => {
            recording::open(&path, camera.rate_hz.into()).map_err(|message| {
                let message = format!("{}: {message}", path.display());
                // What was moved may be moved back; what is no film stays none.
                if path.exists() { OpenError::NoRecording(message) } else { OpenError::Gone(message) }
            })
        }
        Configured::V4l2 => Ok(Box::new(device::Device::open(camera)?)),
        Configured::Tracks => Err(OpenError::Refused(
            "a track file has no pictures: the role perceive plays it, capture is not needed".into(),
        )),
        #[cfg(feature = "realsense")]
        Configured::Realsense | Configured::Bag => Ok(Box::new(realsense::RealSense::open(config)?)),
        #[cfg(not(feature = "realsense"))]
        Configured::Realsense | Configured::Bag => Err(OpenError::Unsupported(
            "this build has no RealSense support: build with --features andon-video/realsense".into(),
        )),
    }
}
