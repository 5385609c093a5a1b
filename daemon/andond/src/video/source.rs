//! Where pictures come from.

use super::pipe::PictureFormat;

/// A source of pictures of one size; `videoio` sources live in the binary `andond-video`.
pub trait Source {
    /// Size, format and rate.
    fn format(&self) -> PictureFormat;

    /// Writes the next picture into `picture`, exactly [`PictureFormat::bytes`] long, and tells its time since the
    /// first in nanoseconds; `None` after the last.
    ///
    /// # Errors
    /// In words for a technician: which source, what happened, what to do.
    fn next_picture(&mut self, picture: &mut [u8]) -> Result<Option<u64>, String>;
}
