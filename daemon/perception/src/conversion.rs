//! Brightness and colours of a picture, whatever its format. They are of the whole picture or of a part of it, so that nothing is converted that
//! nobody looks at.

use crate::error::{PerceptionError, while_doing};
use crate::image::{ImageView, with_plane};
use crate::pixel_format::PixelFormat;
use opencv::core::{self, Mat, Rect, ToOutputArray, Vec3b};
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
    pub(crate) fn write_bgr(&self, part: Rect, to: &mut impl ToOutputArray) -> opencv::Result<()> {
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
        let mut pixels = Vec::new();
        self.write_packed_bgr(&mut pixels)?;
        Ok(pixels)
    }

    /// As [`ImageView::bgr`], into memory that may have held another picture.
    ///
    /// # Errors
    /// [`PerceptionError::OpenCv`].
    pub fn write_packed_bgr(&self, pixels: &mut Vec<u8>) -> Result<(), PerceptionError> {
        let whole = Rect::new(0, 0, self.width() as i32, self.height() as i32);
        pixels.resize(3 * self.width() * self.height(), 0);
        Mat::new_rows_cols_with_bytes_mut::<Vec3b>(whole.height, whole.width, pixels)
            // What it writes has this size and this type: OpenCV makes no memory of its own for it.
            .and_then(|mut picture| self.write_bgr(whole, &mut picture))
            .map_err(while_doing("converting a picture"))
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
