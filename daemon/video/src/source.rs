//! Where pictures come from.

use andon_host::video::pipe::PictureFormat;
use shm_schemas::{ColourFormat, FrameHeader};

/// A source of pictures of one size.
pub trait Source {
    /// Size, format and rate.
    fn format(&self) -> PictureFormat;

    /// Bytes of a frame: the picture, and the depth that a source sends with it.
    fn frame_bytes(&self) -> usize {
        self.format().bytes()
    }

    /// Writes the next frame into `picture`, which is [`Source::frame_bytes`] long. Returns its time since the first frame in nanoseconds,
    /// `None` after the last.
    ///
    /// # Errors
    /// A message for a technician: which source, what happened, what to do.
    fn next_picture(&mut self, picture: &mut [u8]) -> Result<Option<u64>, String>;

    /// When the newest picture was captured, on CLOCK_MONOTONIC, where the source knows this better than its reader.
    fn captured_ns(&self) -> Option<u64> {
        None
    }

    /// Enters the layout and the optics of the newest frame into its header.
    fn describe(&self, header: &mut FrameHeader) {
        let format = self.format();
        header.width = format.width;
        header.height = format.height;
        header.stride = format.width * 3;
        header.colour_format = ColourFormat::Bgr8.code();
    }
}
