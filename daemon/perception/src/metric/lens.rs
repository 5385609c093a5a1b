//! Pixels and points of one camera, by the SDK's formulas.

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion};

/// How a lens bends the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distortion {
    /// Not at all.
    None,
    /// Brown-Conrady, as OpenCV: the tangential part of the undistorted point.
    BrownConrady,
    /// Brown-Conrady with the tangential part of the radially distorted point: what librealsense computes for the model
    /// that it calls inverse, which is that of D400 colour streams, and for the one that it calls modified.
    InverseBrownConrady,
}

/// Iterations that undo a distortion: librealsense's own number, enough for 1e-6 px with the coefficients of real lenses.
const ITERATIONS: usize = 10;

/// Intrinsics of a camera. Pixel centres lie at whole numbers. Camera frame: metres, x right, y down, z forward.
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
    pub fn project(&self, point: &Point3<f64>) -> Option<[f64; 2]> {
        if point.z <= 0.0 {
            return None;
        }
        let [x, y] = self.distort([point.x / point.z, point.y / point.z]);
        Some([x * self.focal[0] + self.centre[0], y * self.focal[1] + self.centre[1]])
    }

    /// The point at depth `z` that a pixel sees.
    pub fn deproject(&self, pixel: [f64; 2], z: f64) -> Point3<f64> {
        let [x, y] = self.ray(pixel);
        Point3::new(x * z, y * z, z)
    }

    /// The pixel's ray, as its point at depth 1.
    pub fn ray(&self, pixel: [f64; 2]) -> [f64; 2] {
        let wanted = [0, 1].map(|axis| (pixel[axis] - self.centre[axis]) / self.focal[axis]);
        if self.distortion == Distortion::None {
            return wanted;
        }
        // Fixed point: the undistorted point is the distorted one less what the distortion adds.
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

    /// The point whose tangential distortion counts.
    fn tangential_base(&self, at: [f64; 2], radial: f64) -> [f64; 2] {
        match self.distortion {
            Distortion::None | Distortion::BrownConrady => at,
            Distortion::InverseBrownConrady => at.map(|value| value * radial),
        }
    }

    /// `at` gives the radius, which all models take from the undistorted point.
    fn tangential(&self, [x, y]: [f64; 2], at: [f64; 2]) -> [f64; 2] {
        let [_, _, p1, p2, _] = self.coefficients;
        let r2 = at[0] * at[0] + at[1] * at[1];
        [2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x), 2.0 * p2 * x * y + p1 * (r2 + 2.0 * y * y)]
    }
}

/// The colour and the depth camera of one device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rig {
    /// The colour camera. Its frame is the one that points are given in.
    pub colour: Lens,
    /// The depth camera.
    pub depth: Lens,
    /// From the depth camera's frame to the colour camera's.
    pub colour_from_depth: Isometry3<f64>,
}

/// A rigid motion from the rows of a rotation matrix and a translation in metres.
pub fn rigid(rotation: [[f32; 3]; 3], translation_m: [f32; 3]) -> Isometry3<f64> {
    let matrix = Matrix3::from_fn(|row, column| f64::from(rotation[row][column]));
    // The nearest rotation: a matrix in f32 is one only to seven digits.
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix(&matrix));
    let [x, y, z] = translation_m.map(f64::from);
    Isometry3::from_parts(Translation3::new(x, y, z), rotation)
}
