//! A frame, read where it lies.

use crate::error::PerceptionError;

/// How the bytes of a pixel are ordered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelFormat {
    /// Blue, green, red.
    Bgr8,
    /// Red, green, blue.
    Rgb8,
    /// Blue, green, red, unused.
    Bgra8,
    /// Red, green, blue, unused.
    Rgba8,
    /// Brightness.
    Gray8,
}

impl PixelFormat {
    /// Bytes a pixel.
    pub fn bytes(self) -> usize {
        match self {
            Self::Gray8 => 1,
            Self::Bgr8 | Self::Rgb8 => 3,
            Self::Bgra8 | Self::Rgba8 => 4,
        }
    }

    /// Where red, green and blue lie within a pixel.
    pub(crate) fn rgb_offsets(self) -> [usize; 3] {
        match self {
            Self::Gray8 => [0, 0, 0],
            Self::Bgr8 | Self::Bgra8 => [2, 1, 0],
            Self::Rgb8 | Self::Rgba8 => [0, 1, 2],
        }
    }
}

/// A picture that belongs to someone else. Nothing of it is copied.
#[derive(Clone, Copy)]
pub struct ImageView<'a> {
    width: usize,
    height: usize,
    stride: usize,
    format: PixelFormat,
    data: &'a [u8],
}

/// Greatest width and height: 8K cameras. It keeps every index within `i32`, which OpenCV counts in.
const MOST_PIXELS_A_SIDE: usize = 8192;

impl<'a> ImageView<'a> {
    /// `stride` is the bytes from one row to the next; `data` holds `height * stride` bytes at least.
    ///
    /// # Errors
    /// [`PerceptionError::Image`] when the sizes do not fit one another.
    pub fn new(
        width: usize,
        height: usize,
        stride: usize,
        format: PixelFormat,
        data: &'a [u8],
    ) -> Result<Self, PerceptionError> {
        let fits = (1..=MOST_PIXELS_A_SIDE).contains(&width)
            && (1..=MOST_PIXELS_A_SIDE).contains(&height)
            && stride >= width * format.bytes()
            // Padding, not more: it keeps the row within `i32` too.
            && stride <= 16 * MOST_PIXELS_A_SIDE
            && data.len() >= height * stride;
        if !fits {
            return Err(PerceptionError::Image { width, height, stride, format, bytes: data.len() });
        }
        Ok(Self { width, height, stride, format, data })
    }

    /// Pixels a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
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

    /// The bytes, `height * stride` of them.
    pub fn data(&self) -> &'a [u8] {
        &self.data[..self.height * self.stride]
    }
}
