//! Channel `frame`: the header of a `[u8]` slice that holds the colour plane and then the depth plane, as the sensor gives them. Behind these is the
//! JPEG of a camera that sends its pictures so.

use crate::code::codes;
use crate::layout::wire;
use crate::stamp::{Stamp, message};

codes! {
    /// How the colour plane holds its pixels, in memory order.
    enum ColourFormat: u32 {
        /// Red, green, blue, 8 bits each.
        Rgb8 = 1,
        /// Blue, green, red, 8 bits each.
        Bgr8 = 2,
        /// Grey, 8 bits.
        Grey8 = 3,
        /// 4:2:2 as V4L2 names it `YUYV`: Y0 U Y1 V for two pixels.
        Yuyv = 4,
        /// 4:2:0 as V4L2 names it `NV12`: a plane of Y, then one of half the rows, U V for four pixels.
        Nv12 = 5,
    }
}

codes! {
    /// Bytes of one depth pixel.
    enum DepthFormat: u32 {
        /// There is no depth plane.
        None = 0,
        /// Unsigned 16 bits, little endian, in units of `depth_unit_m`; 0 is unknown.
        Z16 = 1,
    }
}

codes! {
    /// The model that the five distortion coefficients belong to.
    enum Distortion: u32 {
        /// None: a rectified or synthetic picture.
        None = 0,
        /// Brown-Conrady (k1, k2, p1, p2, k3), as in OpenCV.
        BrownConrady = 1,
        /// Brown-Conrady from distorted to undistorted, as in the colour streams of RealSense.
        InverseBrownConrady = 2,
    }
}

wire! { "andon.Intrinsics", 40;
    /// The intrinsics of a camera. All zero means unknown.
    struct Intrinsics {
        /// Focal length in pixels, x.
        fx: f32,
        /// Focal length in pixels, y.
        fy: f32,
        /// Principal point in pixels, x.
        cx: f32,
        /// Principal point in pixels, y.
        cy: f32,
        /// Coefficients of the `model`.
        distortion: [f32; 5],
        /// A [`Distortion`].
        model: u32,
    }
}

wire! { "andon.Extrinsics", 48;
    /// A rigid motion: `p_to = rotation * p_from + translation_m`.
    struct Extrinsics {
        /// Rows of the rotation matrix.
        rotation: [[f32; 3]; 3],
        /// Translation in metres.
        translation_m: [f32; 3],
    }
}

wire! { "andon.FrameHeader", 224;
    /// The user header of the channel `frame`.
    struct FrameHeader {
        /// The stamp; its `frame_seq` equals its `seq`.
        stamp: Stamp,
        /// Source time in nanoseconds: of a recording the time since its first frame, of a camera CLOCK_MONOTONIC.
        source_ns: u64,
        /// Bits of [`crate::flag`]: `END_OF_STREAM`, `PACED`.
        flags: u32,
        /// Frames that the source itself lost just before this one.
        dropped: u32,
        /// Pixels per row of the colour plane; 0 when there is no picture.
        width: u32,
        /// Rows of the colour plane.
        height: u32,
        /// Bytes from one row of the colour plane to the next.
        stride: u32,
        /// A [`ColourFormat`].
        colour_format: u32,
        /// Pixels per row of the depth plane.
        depth_width: u32,
        /// Rows of the depth plane, which begins right after the colour plane.
        depth_height: u32,
        /// Bytes from one row of the depth plane to the next.
        depth_stride: u32,
        /// A [`DepthFormat`].
        depth_format: u32,
        /// The unit of depth in metres.
        depth_unit_m: f32,
        /// Intrinsics of the colour camera.
        colour: Intrinsics,
        /// Intrinsics of the depth camera.
        depth: Intrinsics,
        /// From the depth camera to the colour camera.
        colour_from_depth: Extrinsics,
        /// Bytes of the JPEG that the colour plane was decoded from, right after the depth plane; 0 when the source sends none.
        jpeg_bytes: u32,
    }
}
message!(FrameHeader);

impl FrameHeader {
    /// Bytes of the colour plane, or `None` when the product does not fit.
    pub fn colour_bytes(&self) -> Option<usize> {
        let rows = self.height as usize;
        let of_colours = if self.colour_format == ColourFormat::Nv12.code() { rows / 2 } else { 0 };
        rows.checked_add(of_colours)?.checked_mul(self.stride as usize)
    }

    /// Bytes of the depth plane, or `None` when the product does not fit.
    pub fn depth_bytes(&self) -> Option<usize> {
        (self.depth_height as usize).checked_mul(self.depth_stride as usize)
    }
}
