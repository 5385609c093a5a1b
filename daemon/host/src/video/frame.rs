//! The picture of a frame, where it lies.

use andon_perception::{ImageView, PerceptionError, PixelFormat};
use shm_schemas::{ColourFormat, FrameHeader};

/// The colour plane of a frame as a picture.
///
/// # Errors
/// [`PerceptionError::Setting`] for a format that nobody knows, [`PerceptionError::Image`] when the sizes contradict one another.
pub fn view<'a>(header: &FrameHeader, colour: &'a [u8]) -> Result<ImageView<'a>, PerceptionError> {
    let format = match ColourFormat::try_from(header.colour_format) {
        Ok(ColourFormat::Rgb8) => PixelFormat::Rgb8,
        Ok(ColourFormat::Bgr8) => PixelFormat::Bgr8,
        Ok(ColourFormat::Grey8) => PixelFormat::Gray8,
        Ok(ColourFormat::Yuyv) => PixelFormat::Yuyv,
        Ok(ColourFormat::Nv12) => PixelFormat::Nv12,
        Err(_) => {
            return Err(PerceptionError::Setting {
                key: "the colour format of the frames",
                value: header.colour_format.to_string(),
                range: "RGB, BGR or grey of 8 bits, YUYV or NV12",
            });
        }
    };
    ImageView::new(header.width as usize, header.height as usize, header.stride as usize, format, colour)
}
