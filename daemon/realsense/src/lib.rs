//! RealSense frames in, nothing else: colour and depth of a D400 camera, live or from a `.bag` recording.
//!
//! A [`settings::Settings`] is opened to a `Source`, which hands out frames. A frame tells its [`frame::FrameInfo`] and is then written
//! once, colour before depth, into memory that the caller provides:
//!
//! ```ignore
//! let mut source = andon_realsense::Source::open(settings)?;
//! while let Some(frame) = source.next_frame()? {
//!     let mut loan = frames.loan(frame.info().bytes())?;
//!     frame.write_to(loan.bytes_mut())?;
//! }
//! ```
//!
//! An [`Error`] ends the source: whoever owns it decides whether and when to open another one.
//!
//! Only the feature `realsense` brings `Source`. It loads librealsense at run time from the folder that `provision.py` fills, so nothing here needs
//! the library to be built. Whatever can be decided without the library is tested without it. [`clock`] maps the sensor's time to CLOCK_MONOTONIC,
//! and [`pair`] finds the depth of a colour picture. [`wait`] says when a camera is silent, and [`usb`] finds out why no camera is there.
//!
//! It is a crate of its own because its calls into a library that may be missing are `unsafe`. The crate boundary keeps them in one place.

pub mod clock;
pub mod error;
pub mod frame;
pub mod pair;
pub mod settings;
pub mod usb;
pub mod wait;

#[cfg(feature = "realsense")]
mod sdk;
#[cfg(feature = "realsense")]
pub use sdk::{Frame, Source};

pub use error::Error;
