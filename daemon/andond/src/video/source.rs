//! Where pictures come from.

use shm_schemas::{ColourFormat, FrameHeader};

use super::pipe::PictureFormat;

/// Why a source cannot be opened, in words for a technician.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OpenError {
    /// It is not there, or does not answer. A camera may come back.
    #[error("{0}")]
    Gone(String),
    /// This user may not open it.
    #[error("{0}")]
    NotAllowed(String),
    /// It does not offer what the configuration asks for.
    #[error("{0}")]
    Refused(String),
    /// It is there and cannot work as it is connected.
    #[error("{0}")]
    Unfit(String),
    /// This build, or this installation, has nothing to open it with.
    #[error("{0}")]
    Unsupported(String),
}

/// A source of pictures of one size; `videoio` sources live in the binary `andond-video`.
pub trait Source {
    /// Size, format and rate.
    fn format(&self) -> PictureFormat;

    /// Bytes of a frame: the picture, and the depth that a source sends with it.
    fn frame_bytes(&self) -> usize {
        self.format().bytes()
    }

    /// Writes the next frame into `picture`, exactly [`Source::frame_bytes`] long, and tells its time since the
    /// first in nanoseconds; `None` after the last.
    ///
    /// # Errors
    /// In words for a technician: which source, what happened, what to do.
    fn next_picture(&mut self, picture: &mut [u8]) -> Result<Option<u64>, String>;

    /// When the newest picture was captured, CLOCK_MONOTONIC, where the source knows better than the one who reads it.
    fn captured_ns(&self) -> Option<u64> {
        None
    }

    /// Tells the layout and the optics of the newest frame.
    fn describe(&self, header: &mut FrameHeader) {
        let format = self.format();
        header.width = format.width;
        header.height = format.height;
        header.stride = format.width * 3;
        header.colour_format = ColourFormat::Bgr8.code();
    }
}
