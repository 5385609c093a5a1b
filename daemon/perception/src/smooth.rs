//! Smooths a noisy picture for the hand models.
//!
//! The models were trained on ordinary photographs. Noise of single pixels makes them lose fingers that a person still sees.

use crate::error::{PerceptionError, while_doing};
use crate::image::ImageView;
use opencv::core::{BORDER_REPLICATE, Mat, Size};
use opencv::{imgproc, prelude::*};

/// From this noise on, in grey levels, a picture is smoothed. A camera in the light of a workplace has 1 to 2.
const NOISY: f32 = 3.0;
/// How far each pixel is spread, in pixels: it takes four fifths of the noise away, and fingers are ten times as wide.
const SIGMA: f64 = 1.3;

/// Holds the smoothed picture.
#[derive(Default)]
pub(crate) struct Smoother {
    smooth: Mat,
}

impl Smoother {
    /// The picture without most of its noise, or the picture itself where there is little.
    ///
    /// # Errors
    /// [`PerceptionError::OpenCv`].
    pub(crate) fn smooth<'a>(
        &'a mut self,
        image: &ImageView<'a>,
        noise: f32,
    ) -> Result<ImageView<'a>, PerceptionError> {
        if noise < NOISY {
            return Ok(*image);
        }
        image
            .with_pixels(|pixels| {
                imgproc::gaussian_blur(
                    pixels,
                    &mut self.smooth,
                    Size::new(0, 0),
                    SIGMA,
                    SIGMA,
                    BORDER_REPLICATE,
                )
            })
            .map_err(while_doing("smoothing a picture"))?;
        let data = self.smooth.data_bytes().map_err(while_doing("reading a smoothed picture"))?;
        let stride = image.width() * image.format().bytes();
        ImageView::new(image.width(), image.height(), stride, image.format(), data)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::pixel_format::PixelFormat;

    #[test]
    fn a_noisy_picture_loses_its_noise_and_a_quiet_one_is_the_same_to_the_bit() {
        let noisy: Vec<u8> =
            (0..64 * 48 * 3).map(|index| if index / 3 % 2 == 0 { 80 } else { 160 }).collect();
        let image = ImageView::new(64, 48, 64 * 3, PixelFormat::Bgr8, &noisy).unwrap();
        let mut smoother = Smoother::default();
        assert_eq!(smoother.smooth(&image, NOISY - 0.1).unwrap().data(), noisy);
        let smooth = smoother.smooth(&image, 6.0).unwrap();
        let inside = |index: usize| (8..56).contains(&(index / 3 % 64));
        let furthest = smooth.data().iter().enumerate().filter(|(index, _)| inside(*index));
        assert!(furthest.map(|(_, value)| value.abs_diff(120)).max().unwrap() < 10);
    }
}
