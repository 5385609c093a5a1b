//! What a frame is: sizes, formats, optics and times of its two planes.

use crate::Error;

/// Bytes of one pixel, in memory order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelFormat {
    /// Red, green, blue, 8 bits each.
    Rgb8,
    /// Blue, green, red, 8 bits each.
    Bgr8,
    /// 4:2:2, Y0 U Y1 V for two pixels: what the colour sensor of a D400 sends.
    Yuyv,
    /// Grey, 8 bits.
    Grey8,
    /// Depth, 16 bits, little endian, in steps of [`DepthPlane::unit_m`]; 0 is unknown.
    Z16,
}

/// How [`Intrinsics::coefficients`] distort the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distortion {
    /// No distortion.
    None,
    /// Brown-Conrady (k1, k2, p1, p2, k3), as OpenCV: from undistorted to distorted.
    BrownConrady,
    /// The same polynomial, from distorted to undistorted: colour streams of a D400.
    InverseBrownConrady,
    /// Brown-Conrady with the tangential part applied to the already radially distorted point.
    ModifiedBrownConrady,
    /// A model that no D400 has; its coefficients must not be used.
    Other,
}

/// A camera's intrinsics, in pixels; pixel centres lie at whole numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    /// Focal length, x and y.
    pub focal: [f32; 2],
    /// Principal point, x and y.
    pub centre: [f32; 2],
    /// The model of `coefficients`.
    pub distortion: Distortion,
    /// k1, k2, p1, p2, k3.
    pub coefficients: [f32; 5],
}

/// A rigid motion: `p_to = rotation * p_from + translation_m`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extrinsics {
    /// Rows of the rotation matrix.
    pub rotation: [[f32; 3]; 3],
    /// Translation in metres.
    pub translation_m: [f32; 3],
}

/// Layout and optics of one picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Bytes from one row to the next.
    pub stride: u32,
    /// Format of a pixel.
    pub format: PixelFormat,
    /// The camera's intrinsics.
    pub intrinsics: Intrinsics,
}

impl Plane {
    /// Bytes of the whole picture.
    pub fn bytes(&self) -> usize {
        self.stride as usize * self.height as usize
    }
}

/// The depth picture of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthPlane {
    /// Layout and optics.
    pub plane: Plane,
    /// Metres of one step of depth.
    pub unit_m: f32,
    /// From the depth camera to the colour camera.
    pub colour_from_depth: Extrinsics,
}

/// All that is known of a frame besides its pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameInfo {
    /// The sensor's own number of the colour picture.
    pub number: u64,
    /// Number of frames that were lost just before this one, at the sensor or on the way, or had no depth of their moment.
    pub dropped: u32,
    /// When the colour picture was captured, or played from a recording, in nanoseconds on CLOCK_MONOTONIC.
    pub captured_ns: u64,
    /// Source time: `captured_ns` for a camera, nanoseconds since the first frame for a recording.
    pub source_ns: u64,
    /// Layout and optics of the colour picture.
    pub colour: Plane,
    /// The depth picture, `None` when depth is off.
    pub depth: Option<DepthPlane>,
}

impl FrameInfo {
    /// Bytes of the frame: the colour plane, then the depth plane.
    pub fn bytes(&self) -> usize {
        self.colour.bytes() + self.depth.map_or(0, |depth| depth.plane.bytes())
    }
}

/// Writes one plane after the other, each byte once, and returns their length.
///
/// # Errors
/// [`Error::Room`] when `target` is shorter than the planes together; nothing is written then.
pub fn write_planes(planes: [&[u8]; 2], target: &mut [u8]) -> Result<usize, Error> {
    let needed = planes[0].len() + planes[1].len();
    let given = target.len();
    if given < needed {
        return Err(Error::Room { needed, given });
    }
    let (colour, rest) = target.split_at_mut(planes[0].len());
    colour.copy_from_slice(planes[0]);
    rest[..planes[1].len()].copy_from_slice(planes[1]);
    Ok(needed)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn depth_follows_colour_without_a_gap() {
        let mut memory = [0xEE; 7];
        assert_eq!(write_planes([&[1, 2, 3], &[4, 5]], &mut memory).unwrap(), 5);
        assert_eq!(memory, [1, 2, 3, 4, 5, 0xEE, 0xEE]);
    }

    #[test]
    fn memory_that_is_too_small_is_refused_untouched() {
        let mut memory = [0xEE; 4];
        let refused = write_planes([&[1, 2, 3], &[4, 5]], &mut memory).unwrap_err();
        assert_eq!(refused, Error::Room { needed: 5, given: 4 });
        assert_eq!(memory, [0xEE; 4]);
    }
}
