//! Pixels and points of one camera, by the SDK's formulas.

use crate::points::PixelPoint;
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion};

/// How a lens bends the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distortion {
    /// Not at all.
    None,
    /// Brown-Conrady as in OpenCV: the tangential part of the undistorted point.
    BrownConrady,
    /// Brown-Conrady with the tangential part of the radially distorted point. This is what librealsense computes for the model that it calls
    /// inverse, which D400 colour streams have, and for the modified one.
    InverseBrownConrady,
}

/// Iterations that undo a distortion: librealsense's own number, which is enough for 1e-6 px with the coefficients of real
/// lenses.
const ITERATIONS: usize = 10;

/// Intrinsics of a camera. Camera frame: metres, x right, y down, z forward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Focal length in pixels, x and y.
    pub focal: [f64; 2],
    /// Principal point in pixels, x and y.
    pub centre: [f64; 2],
    /// The model of `coefficients`.
    pub distortion: Distortion,
    /// k1, k2, p1, p2, k3.
    pub coefficients: [f64; 5],
}

impl Lens {
    /// The pixel that sees a point; `None` for one that is not in front of the camera.
    pub(crate) fn project(&self, point: &Point3<f64>) -> Option<PixelPoint> {
        if point.z <= 0.0 {
            return None;
        }
        let [x, y] = self.distort([point.x / point.z, point.y / point.z]);
        Some(PixelPoint::new(x * self.focal[0] + self.centre[0], y * self.focal[1] + self.centre[1]))
    }

    /// The point at depth `z_m`, in metres, that a pixel sees.
    pub(crate) fn deproject(&self, pixel: PixelPoint, z_m: f64) -> Point3<f64> {
        let [x, y] = self.ray(pixel);
        Point3::new(x * z_m, y * z_m, z_m)
    }

    /// The pixel's ray, as its point at depth 1.
    pub(crate) fn ray(&self, pixel: PixelPoint) -> [f64; 2] {
        let wanted = [(pixel.x - self.centre[0]) / self.focal[0], (pixel.y - self.centre[1]) / self.focal[1]];
        if self.distortion == Distortion::None {
            return wanted;
        }
        // A fixed point: the undistorted point is the distorted one without what the distortion adds.
        let mut at = wanted;
        for _ in 0..ITERATIONS {
            let radial = self.radial(at);
            let base = self.tangential_base(at, radial);
            let tangential = self.tangential(base, at);
            at = [0, 1].map(|axis| (wanted[axis] - tangential[axis]) / radial);
        }
        at
    }

    fn distort(&self, at: [f64; 2]) -> [f64; 2] {
        if self.distortion == Distortion::None {
            return at;
        }
        let radial = self.radial(at);
        let tangential = self.tangential(self.tangential_base(at, radial), at);
        [0, 1].map(|axis| at[axis] * radial + tangential[axis])
    }

    fn radial(&self, [x, y]: [f64; 2]) -> f64 {
        let [k1, k2, _, _, k3] = self.coefficients;
        let r2 = x * x + y * y;
        1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    }

    /// The point that the tangential distortion is computed from.
    fn tangential_base(&self, at: [f64; 2], radial: f64) -> [f64; 2] {
        match self.distortion {
            Distortion::None | Distortion::BrownConrady => at,
            Distortion::InverseBrownConrady => at.map(|value| value * radial),
        }
    }

    /// `at` gives the radius, which every model takes from the undistorted point.
    fn tangential(&self, [x, y]: [f64; 2], at: [f64; 2]) -> [f64; 2] {
        let [_, _, p1, p2, _] = self.coefficients;
        let r2 = at[0] * at[0] + at[1] * at[1];
        [2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x), 2.0 * p2 * x * y + p1 * (r2 + 2.0 * y * y)]
    }
}

/// The colour and the depth camera of one device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rig {
    /// The colour camera. Points are given in its frame.
    pub colour: Lens,
    /// The depth camera.
    pub depth: Lens,
    /// From the depth camera's frame to the colour camera's.
    pub colour_from_depth: Isometry3<f64>,
}

/// A rigid motion from the rows of a rotation matrix and a translation in metres.
pub fn rigid(rotation: [[f32; 3]; 3], translation_m: [f32; 3]) -> Isometry3<f64> {
    let matrix = Matrix3::from_fn(|row, column| f64::from(rotation[row][column]));
    // The nearest rotation: in f32 a matrix is a rotation to seven digits only.
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix(&matrix));
    let [x, y, z] = translation_m.map(f64::from);
    Isometry3::from_parts(Translation3::new(x, y, z), rotation)
}
