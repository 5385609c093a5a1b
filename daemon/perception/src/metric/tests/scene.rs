//! Scenes of rectangles in front of two cameras that are side by side, as in a D435i.

use crate::metric::depth::{DepthImage, Sampler};
use crate::metric::lens::{Distortion, Lens, Rig, rigid};
use crate::points::PixelPoint;
use nalgebra::{Isometry3, Point3, Vector3};

pub(super) const WIDTH: usize = 320;
pub(super) const HEIGHT: usize = 240;
const UNIT_M: f64 = 0.001;

pub(super) fn rig() -> Rig {
    let lens = |focal: f64, centre| Lens {
        focal: [focal; 2],
        centre,
        distortion: Distortion::None,
        coefficients: [0.0; 5],
    };
    // Half a degree about y, 15 mm to the side.
    let (sin, cos) = (0.5_f32.to_radians().sin(), 0.5_f32.to_radians().cos());
    let colour_from_depth = rigid([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]], [0.015, 0.0, 0.0]);
    Rig { colour: lens(615.0, [319.5, 239.5]), depth: lens(200.0, [159.5, 119.5]), colour_from_depth }
}

/// A rectangle: its frame's x and y run along its sides.
#[derive(Clone, Copy)]
pub(super) struct Rectangle {
    /// From its own frame to the colour camera's.
    pub(super) pose: Isometry3<f64>,
    pub(super) half: [f64; 2],
}

impl Rectangle {
    /// Face-on at this distance from the colour camera.
    pub(super) fn facing(centre: [f64; 3], half: [f64; 2]) -> Self {
        Self { pose: Isometry3::translation(centre[0], centre[1], centre[2]), half }
    }

    /// Where a ray from `origin` meets the rectangle, in lengths of `along`.
    fn meet(&self, origin: &Point3<f64>, along: &Vector3<f64>) -> Option<f64> {
        let start = self.pose.inverse_transform_point(origin);
        let way = self.pose.inverse_transform_vector(along);
        let share = -start.z / way.z;
        let at = start + way * share;
        (share > 0.0 && at.x.abs() <= self.half[0] && at.y.abs() <= self.half[1]).then_some(share)
    }
}

/// The bytes of the depth picture of a scene.
pub(super) fn depth(scene: &[Rectangle]) -> Vec<u8> {
    let rig = rig();
    let origin = Point3::from(rig.colour_from_depth.translation.vector);
    let mut bytes = Vec::with_capacity(WIDTH * HEIGHT * 2);
    for row in 0..HEIGHT {
        for column in 0..WIDTH {
            // At depth 1, so that lengths along the ray are depths.
            let ray = rig.depth.deproject(PixelPoint::new(column as f64, row as f64), 1.0).coords;
            let along = rig.colour_from_depth.rotation * ray;
            let nearest =
                scene.iter().filter_map(|part| part.meet(&origin, &along)).fold(f64::INFINITY, f64::min);
            let steps = if nearest.is_finite() { (nearest / UNIT_M).round() as u16 } else { 0 };
            bytes.extend(steps.to_le_bytes());
        }
    }
    bytes
}

/// Overwrites a depth pixel.
pub(super) fn put(bytes: &mut [u8], column: usize, row: usize, depth_m: f64) {
    let steps = (depth_m / UNIT_M).round() as u16;
    bytes[2 * (row * WIDTH + column)..][..2].copy_from_slice(&steps.to_le_bytes());
}

pub(super) fn image(bytes: &[u8]) -> DepthImage<'_> {
    DepthImage::new([WIDTH, HEIGHT], 2 * WIDTH, UNIT_M, bytes).unwrap()
}

/// Calls `ask` with a sampler of the picture.
pub(super) fn sampled<T>(bytes: &[u8], ask: impl FnOnce(&Sampler<'_>) -> T) -> T {
    ask(&Sampler::new(image(bytes), &rig()))
}
