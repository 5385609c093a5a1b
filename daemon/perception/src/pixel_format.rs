//! How the bytes of a pixel are ordered.

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
    /// Bytes per pixel.
    pub fn bytes(self) -> usize {
        match self {
            Self::Gray8 => 1,
            Self::Bgr8 | Self::Rgb8 => 3,
            Self::Bgra8 | Self::Rgba8 => 4,
        }
    }

    /// Offsets of red, green and blue within a pixel.
    pub(crate) fn rgb_offsets(self) -> [usize; 3] {
        match self {
            Self::Gray8 => [0, 0, 0],
            Self::Bgr8 | Self::Bgra8 => [2, 1, 0],
            Self::Rgb8 | Self::Rgba8 => [0, 1, 2],
        }
    }
}
