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
pub const MAX_SIDE_PX: usize = 8192;

impl<'a> ImageView<'a> {
    /// `stride` is the number of bytes from one row to the next; `data` holds all planes, at least `height * stride` bytes.
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
            && width.is_multiple_of(format.share_colour()[0])
            && height.is_multiple_of(format.share_colour()[1])
            && stride >= width * format.bytes()
            // Leaves room for padding and keeps a row within `i32`, too.
            && stride <= 16 * MAX_SIDE_PX
            && data.len() >= format.rows(height) * stride;
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
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// How the bytes of a pixel are ordered.
    pub fn format(&self) -> PixelFormat {
        self.format
    }

    /// The bytes of the first plane, `height * stride` of them.
    pub fn data(&self) -> &'a [u8] {
        &self.data[..self.height * self.stride]
    }

    /// The plane of the colours behind it; empty for formats of one plane.
    pub(crate) fn colours(&self) -> &'a [u8] {
        &self.data[self.height * self.stride..self.format.rows(self.height) * self.stride]
    }

    /// Shows OpenCV the pixels of the first plane where they lie.
    pub(crate) fn with_pixels<T>(
        &self,
        look: impl FnOnce(&BoxedRef<'_, Mat>) -> opencv::Result<T>,
    ) -> opencv::Result<T> {
        let row_bytes = self.width * self.format.bytes();
        with_plane(self.data(), self.stride, row_bytes, self.format.bytes(), look)
    }
}

/// Shows OpenCV the pixels of a plane where they lie. Each has so many bytes, and all rows have the same length, with and without padding.
pub(crate) fn with_plane<T>(
    data: &[u8],
    stride: usize,
    row_bytes: usize,
    pixel_bytes: usize,
    look: impl FnOnce(&BoxedRef<'_, Mat>) -> opencv::Result<T>,
) -> opencv::Result<T> {
    // First rows with their padding, then without it, then pixels.
    let count = (data.len() / stride) as i32;
    let rows = Mat::new_rows_cols_with_data(count, stride as i32, data)?;
    let rows = Mat::roi(&rows, Rect::new(0, 0, row_bytes as i32, count))?;
    let pixels = rows.reshape(pixel_bytes as i32, 0)?;
    look(&pixels)
}
