//! How the bytes of a picture are ordered.
//!
//! YUYV and NV12 stay as the camera sends them. Brightness is computed for the whole picture, colours only around the hands, because nobody
//! looks at the rest.

/// How the bytes of a picture are ordered.
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
    /// Brightness and colour as cameras send them (ITU-R BT.601, 16 to 235): Y0 U Y1 V for two pixels.
    Yuyv,
    /// The same numbers in two planes: one of Y, then one of half the rows, which has U V for four pixels.
    Nv12,
}

impl PixelFormat {
    /// Bytes per pixel, in the first plane.
    pub fn bytes(self) -> usize {
        match self {
            Self::Gray8 | Self::Nv12 => 1,
            Self::Yuyv => 2,
            Self::Bgr8 | Self::Rgb8 => 3,
            Self::Bgra8 | Self::Rgba8 => 4,
        }
    }

    /// Rows of all planes together of a picture of this height.
    pub(crate) fn rows(self, height: usize) -> usize {
        if self == Self::Nv12 { height + height / 2 } else { height }
    }

    /// How many pixels share their colour: width and height of a picture are multiples of it.
    pub(crate) fn share_colour(self) -> [usize; 2] {
        match self {
            Self::Yuyv => [2, 1],
            Self::Nv12 => [2, 2],
            _ => [1, 1],
        }
    }

    /// Offsets of red, green and blue within a pixel; `None` where they have to be computed.
    pub(crate) fn rgb_offsets(self) -> Option<[usize; 3]> {
        match self {
            Self::Gray8 => Some([0, 0, 0]),
            Self::Bgr8 | Self::Bgra8 => Some([2, 1, 0]),
            Self::Rgb8 | Self::Rgba8 => Some([0, 1, 2]),
            Self::Yuyv | Self::Nv12 => None,
        }
    }
}
