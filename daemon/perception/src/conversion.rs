//! Brightness and colours of a picture, whatever its format. They are of the whole picture or of a part of it, so that nothing is converted that
//! nobody looks at.

use crate::error::{PerceptionError, while_doing};
use crate::image::{ImageView, with_plane};
use crate::pixel_format::PixelFormat;
use opencv::core::{self, Mat, Rect};
use opencv::{imgproc, prelude::*};

/// Black and white of Y (ITU-R BT.601).
const Y_BLACK: f64 = 16.0;
const Y_WHITE: f64 = 235.0;

impl ImageView<'_> {
    /// The brightness, 0 to 255, in a picture of the same size. `between` is memory for a step in between.
    pub(crate) fn write_gray(&self, between: &mut Mat, to: &mut Mat) -> opencv::Result<()> {
        let scale = 255.0 / (Y_WHITE - Y_BLACK);
        self.with_pixels(|pixels| match self.format() {
            PixelFormat::Gray8 => pixels.copy_to(to),
            PixelFormat::Bgr8 => imgproc::cvt_color_def(pixels, to, imgproc::COLOR_BGR2GRAY),
            PixelFormat::Rgb8 => imgproc::cvt_color_def(pixels, to, imgproc::COLOR_RGB2GRAY),
            PixelFormat::Bgra8 => imgproc::cvt_color_def(pixels, to, imgproc::COLOR_BGRA2GRAY),
            PixelFormat::Rgba8 => imgproc::cvt_color_def(pixels, to, imgproc::COLOR_RGBA2GRAY),
            PixelFormat::Nv12 => pixels.convert_to(to, core::CV_8U, scale, -Y_BLACK * scale),
            PixelFormat::Yuyv => {
                core::extract_channel(pixels, between, 0)?;
                between.convert_to(to, core::CV_8U, scale, -Y_BLACK * scale)
            }
        })
    }

    /// Blue, green and red of a part of the picture, whose edges lie between pixels that share no colour.
    pub(crate) fn write_bgr(&self, part: Rect, to: &mut Mat) -> opencv::Result<()> {
        self.with_pixels(|pixels| {
            let pixels = Mat::roi(pixels, part)?;
            match self.format() {
                PixelFormat::Bgr8 => pixels.copy_to(to),
                PixelFormat::Rgb8 => imgproc::cvt_color_def(&pixels, to, imgproc::COLOR_RGB2BGR),
                PixelFormat::Bgra8 => imgproc::cvt_color_def(&pixels, to, imgproc::COLOR_BGRA2BGR),
                PixelFormat::Rgba8 => imgproc::cvt_color_def(&pixels, to, imgproc::COLOR_RGBA2BGR),
                PixelFormat::Gray8 => imgproc::cvt_color_def(&pixels, to, imgproc::COLOR_GRAY2BGR),
                PixelFormat::Yuyv => imgproc::cvt_color_def(&pixels, to, imgproc::COLOR_YUV2BGR_YUY2),
                PixelFormat::Nv12 => with_plane(self.colours(), self.stride(), self.width(), 2, |colours| {
                    let half = Rect::new(part.x / 2, part.y / 2, part.width / 2, part.height / 2);
                    let colours = Mat::roi(colours, half)?;
                    imgproc::cvt_color_two_plane(&pixels, &colours, to, imgproc::COLOR_YUV2BGR_NV12)
                }),
            }
        })
    }

    /// The whole picture as blue, green and red, 8 bits each, without padding.
    ///
    /// # Errors
    /// [`PerceptionError::OpenCv`].
    pub fn bgr(&self) -> Result<Vec<u8>, PerceptionError> {
        let mut picture = Mat::default();
        let whole = Rect::new(0, 0, self.width() as i32, self.height() as i32);
        self.write_bgr(whole, &mut picture).map_err(while_doing("converting a picture"))?;
        Ok(picture.data_bytes().map_err(while_doing("reading a picture"))?.to_vec())
    }

    /// Red, green and blue of a pixel.
    pub(crate) fn rgb(&self, x: usize, y: usize) -> [u8; 3] {
        let pixel = y * self.stride() + x * self.format().bytes();
        if let Some(offsets) = self.format().rgb_offsets() {
            return offsets.map(|offset| self.data()[pixel + offset]);
        }
        let pair = match self.format() {
            PixelFormat::Nv12 => &self.colours()[y / 2 * self.stride() + (x & !1)..][..2],
            // Every second byte is a colour.
            _ => &[self.data()[(pixel & !3) + 1], self.data()[(pixel & !3) + 3]],
        };
        let y = (255.0 / (Y_WHITE - Y_BLACK)) as f32 * (f32::from(self.data()[pixel]) - Y_BLACK as f32);
        let [u, v] = [pair[0], pair[1]].map(|value| f32::from(value) - 128.0);
        // The casts saturate.
        [y + 1.596 * v, y - 0.813 * v - 0.391 * u, y + 2.018 * u].map(|value| value.round() as u8)
    }
}
