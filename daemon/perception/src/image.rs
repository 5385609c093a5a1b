//! A picture that is read in place.

use crate::error::PerceptionError;
use crate::pixel_format::PixelFormat;
use opencv::boxed_ref::BoxedRef;
use opencv::core::{Mat, Rect};
use opencv::prelude::*;

/// A picture that belongs to someone else. Nothing of it is copied.
#[derive(Clone, Copy)]
pub struct ImageView<'a> {
    width: usize,
    height: usize,
    stride: usize,
    format: PixelFormat,
    data: &'a [u8],
}

/// Maximum width and height: 8K cameras. It keeps every index within `i32`, which OpenCV counts in.
const MAX_SIDE_PX: usize = 8192;

impl<'a> ImageView<'a> {
    /// `stride` is the number of bytes from one row to the next; `data` holds at least `height * stride` bytes.
    ///
    /// # Errors
    /// [`PerceptionError::Image`] when the sizes contradict one another.
    pub fn new(
        width: usize,
        height: usize,
        stride: usize,
        format: PixelFormat,
        data: &'a [u8],
    ) -> Result<Self, PerceptionError> {
        let fits = (1..=MAX_SIDE_PX).contains(&width)
            && (1..=MAX_SIDE_PX).contains(&height)
            && stride >= width * format.bytes()
            // Leaves room for padding and keeps a row within `i32`, too.
            && stride <= 16 * MAX_SIDE_PX
            && data.len() >= height * stride;
        if !fits {
            return Err(PerceptionError::Image { width, height, stride, format, bytes: data.len() });
        }
        Ok(Self { width, height, stride, format, data })
    }

    /// Pixels per row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Bytes from one row to the next.
    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

    /// How the bytes of a pixel are ordered.
    pub(crate) fn format(&self) -> PixelFormat {
        self.format
    }

    /// The bytes, `height * stride` of them.
    pub(crate) fn data(&self) -> &'a [u8] {
        &self.data[..self.height * self.stride]
    }

    /// Red, green and blue of a pixel.
    pub(crate) fn rgb(&self, x: usize, y: usize) -> [u8; 3] {
        let pixel = y * self.stride + x * self.format.bytes();
        self.format.rgb_offsets().map(|offset| self.data[pixel + offset])
    }

    /// Shows OpenCV the pixels where they lie.
    pub(crate) fn with_pixels<T>(
        &self,
        look: impl FnOnce(&BoxedRef<'_, Mat>) -> opencv::Result<T>,
    ) -> opencv::Result<T> {
        // First rows with their padding, then without it, then pixels.
        let rows = Mat::new_rows_cols_with_data(self.height as i32, self.stride as i32, self.data())?;
        let row_bytes = (self.width * self.format.bytes()) as i32;
        let rows = Mat::roi(&rows, Rect::new(0, 0, row_bytes, self.height as i32))?;
        let pixels = rows.reshape(self.format.bytes() as i32, 0)?;
        look(&pixels)
    }
}
