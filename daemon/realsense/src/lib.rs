//! RealSense frames in, nothing else: colour and depth of a D400 camera, live or from a `.bag` recording.
//!
//! A [`settings::Settings`] is opened to a `Source`, which hands out frames; a frame tells its [`frame::FrameInfo`] and
//! is then written once, colour before depth, into memory that the caller has loaned (DESIGN 2, channel `frame`):
//!
//! ```ignore
//! let mut source = andon_realsense::Source::open(settings)?;
//! match source.next(Duration::from_millis(200)) {
//!     Next::Frame(frame) => {
//!         let mut loan = frames.loan(frame.info().bytes())?;
//!         frame.write_to(loan.bytes_mut())?;
//!     }
//!     Next::Lost(why) => tracing::warn!("{why}"), // it comes back by itself
//!     Next::Nothing => {}
//!     Next::Ended => return Ok(()),
//! }
//! ```
//!
//! Only the feature `realsense` brings `Source`; librealsense itself is loaded at run time from the folder that
//! `provision.py` fills, so that nothing here needs it to be built. What can be wrong is decided without it too, and
//! tested without a camera: [`clock`] maps the sensor's time to CLOCK_MONOTONIC, [`recovery`] brings an unplugged camera
//! back, [`usb`] finds out why no camera is there.

pub mod clock;
pub mod error;
pub mod frame;
pub mod recovery;
pub mod settings;
pub mod usb;

#[cfg(feature = "realsense")]
mod sdk;
#[cfg(feature = "realsense")]
pub use sdk::{Frame, Source};

pub use error::Error;
pub use recovery::Next;
