//! The turned square of the picture in which the model looks for a hand.

use crate::detections::LANDMARKS;
use std::f32::consts::{FRAC_PI_2, PI, TAU};

/// A turned square of the picture, in pixels. At rotation 0 the hand's fingers point up in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Region {
    pub(crate) centre: [f32; 2],
    pub(crate) side: f32,
    /// Radians, clockwise in the picture.
    pub(crate) rotation: f32,
}

/// Landmarks that do not move while fingers bend: wrist, thumb and the fingers without their ends.
const STEADY: [usize; 12] = [0, 1, 2, 3, 5, 6, 9, 10, 13, 14, 17, 18];

impl Region {
    /// The largest square around a whole picture.
    pub(crate) fn whole(width: usize, height: usize) -> Self {
        let centre = [width as f32 / 2.0, height as f32 / 2.0];
        Self { centre, side: width.max(height) as f32, rotation: 0.0 }
    }

    /// Where the hand is expected in the next frame (MediaPipe's `hand_landmark_landmarks_to_roi`).
    pub(crate) fn of_landmarks(landmarks_px: &[[f32; 2]; LANDMARKS]) -> Self {
        let [index, middle, ring] = [5, 9, 13].map(|knuckle: usize| landmarks_px[knuckle]);
        let between = |a: [f32; 2], b: [f32; 2]| [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
        let rotation = upright(landmarks_px[0], between(between(index, ring), middle));
        let (sin, cos) = rotation.sin_cos();

        let mut min = [f32::INFINITY; 2];
        let mut max = [f32::NEG_INFINITY; 2];
        for [x, y] in STEADY.map(|landmark| landmarks_px[landmark]) {
            for (axis, value) in [x * cos + y * sin, y * cos - x * sin].into_iter().enumerate() {
                min[axis] = min[axis].min(value);
                max[axis] = max[axis].max(value);
            }
        }
        let [x, y] = between(min, max);
        let centre = [x * cos - y * sin, x * sin + y * cos];
        Self::grown(centre, [max[0] - min[0], max[1] - min[1]], rotation, 2.0, 0.1)
    }

    /// The square around a turned box, moved towards the fingers by a share of the box's height, then scaled.
    pub(super) fn grown(
        centre: [f32; 2],
        [width, height]: [f32; 2],
        rotation: f32,
        scale: f32,
        towards_fingers: f32,
    ) -> Self {
        let (sin, cos) = rotation.sin_cos();
        let shift = towards_fingers * height;
        Self {
            centre: [centre[0] + shift * sin, centre[1] - shift * cos],
            side: width.max(height) * scale,
            rotation,
        }
    }

    /// The pixel of a point of the region, which is given as 0..1 on both axes.
    pub(crate) fn to_image(self, [x, y]: [f32; 2]) -> [f32; 2] {
        let (sin, cos) = self.rotation.sin_cos();
        let (x, y) = ((x - 0.5) * self.side, (y - 0.5) * self.side);
        [self.centre[0] + x * cos - y * sin, self.centre[1] + x * sin + y * cos]
    }

    /// Shared area over joint area, as if both regions were upright.
    pub(crate) fn overlap(&self, other: &Self) -> f32 {
        let shared = |axis: usize| {
            let end = |region: &Self, sign: f32| region.centre[axis] + sign * region.side / 2.0;
            (end(self, 1.0).min(end(other, 1.0)) - end(self, -1.0).max(end(other, -1.0))).max(0.0)
        };
        let shared = shared(0) * shared(1);
        shared / (self.side * self.side + other.side * other.side - shared)
    }
}

/// The rotation that turns the direction from `wrist` to `knuckle` upright, -π..π.
pub(super) fn upright(wrist: [f32; 2], knuckle: [f32; 2]) -> f32 {
    let angle = FRAC_PI_2 - (wrist[1] - knuckle[1]).atan2(knuckle[0] - wrist[0]);
    angle - TAU * ((angle + PI) / TAU).floor()
}
