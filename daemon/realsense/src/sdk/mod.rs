//! The SDK's side: the only code that calls librealsense.
//!
//! [`library`] loads it. [`camera`] opens an attached camera and [`live`] waits for its pictures; [`recording`] opens a file and [`playback`] plays
//! it with the SDK's [`player`]. The [`picture`]s of both take the same path.

mod camera;
mod library;
mod live;
mod picture;
mod playback;
mod player;
mod recording;

use realsense_rust::frame::FrameEx;

use crate::Error;
use crate::settings::{Origin, Settings};

pub use picture::Frame;

/// A camera or a recording that frames come from.
///
/// Where depth is captured, every frame has it. A colour picture without a depth picture of its moment ([`crate::pair`]) is not a frame, and counts
/// as dropped.
///
/// A frame lies in one of the sensor's own buffers, of which there are few. Write it out and drop it before the next wait.
#[derive(Debug)]
pub struct Source {
    kind: Kind,
    optics: picture::Optics,
    last_number: Option<u64>,
}

/// What differs between the two.
#[derive(Debug)]
enum Kind {
    Camera(live::Live),
    Recording(playback::Playback),
}

impl Source {
    /// Loads librealsense and opens what the settings name.
    ///
    /// # Errors
    /// Every [`Error`] says what to do about it.
    pub fn open(settings: &Settings) -> Result<Self, Error> {
        let api = library::load(&settings.library)?;
        match &settings.origin {
            Origin::Camera(wanted) => camera::open(wanted, settings.depth),
            Origin::Recording(file) => recording::open(api, file, settings.depth),
        }
    }

    /// Waits for the next frame; `None` at the end of a recording.
    ///
    /// # Errors
    /// [`Error::Silent`] after 2 s without a frame of a camera, and [`Error::Unplugged`] when it is gone. [`Error::Recording`] when no picture of a
    /// recording has depth of its moment, and what the SDK refuses. A camera that has failed must be opened again.
    pub fn next_frame(&mut self) -> Result<Option<Frame>, Error> {
        let pictures = match &mut self.kind {
            Kind::Camera(live) => Some(live.next(self.last_number)?),
            Kind::Recording(playback) => playback.next()?,
        };
        let Some(pictures) = pictures else { return Ok(None) };
        let number = pictures.colour.frame_number();
        // A camera that has restarted counts from the start again: that is no loss.
        let dropped = self.last_number.map_or(0, |last| number.saturating_sub(last + 1));
        self.last_number = Some(number);
        let dropped = u32::try_from(dropped).unwrap_or(u32::MAX);
        Frame::new(pictures, &self.optics, dropped).map(Some)
    }
}

fn sdk(step: &'static str, error: impl std::fmt::Display) -> Error {
    Error::Sdk { step, detail: error.to_string() }
}
