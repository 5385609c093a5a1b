//! Where the bench is: z up from it, x right and y up in the picture.

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use opencv::calib3d;

use super::depth::Sampler;
use super::error::MetricError;
use super::lens::Lens;
use super::pose;
use crate::error::PerceptionError;

/// Every so many pixels of the depth picture are enough: 4800 points of 640 x 480.
const STEP: usize = 8;

/// The bench must be this share of what the depth camera sees: a plane under less of it is not found for certain.
const LEAST_SHARE: f64 = 0.5;

/// A bench is flat to this, in metres: the noise of a D435i at 1 m.
const MOST_RMS_M: f64 = 0.006;

/// The bench is seen from above, not from the side: the camera looks down at it by 30 degrees at least.
const LEAST_COSINE: f64 = 0.5;

/// The bench frame of a camera that does not move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BenchFrame {
    /// From the colour camera's frame to the bench's.
    pub bench_from_camera: Isometry3<f64>,
    /// What it fits to: metres of the depth from the plane, or pixels of the markers from their places.
    pub residual: f64,
}

impl BenchFrame {
    /// The plane that most of the depth picture shows. Its origin is the foot of the colour camera.
    ///
    /// # Errors
    /// [`MetricError::NoBench`] when no plane covers enough of the picture.
    pub fn from_depth(depth: &Sampler<'_>) -> Result<Self, MetricError> {
        let points = depth.grid(STEP);
        let plane = super::plane::fit(&points)
            .ok_or(MetricError::NoBench { reason: "the depth picture is empty".into() })?;
        let share = plane.points as f64 / points.len() as f64;
        let refused = |reason| Err(MetricError::NoBench { reason });
        if share < LEAST_SHARE || plane.rms_m > MOST_RMS_M {
            return refused(format!(
                "a plane fits {:.0} % of the depth to {:.1} mm",
                100.0 * share,
                1000.0 * plane.rms_m
            ));
        }
        if -plane.normal.z < LEAST_COSINE {
            return refused("the largest plane is seen from the side".into());
        }
        let up = plane.normal;
        // The camera's x, laid into the plane; it is not along the normal, by the cosine above.
        let right = (Vector3::x() - up * up.x).normalize();
        let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_rows(&[
            right.transpose(),
            up.cross(&right).transpose(),
            up.transpose(),
        ]));
        let height = plane.distance(&Point3::origin());
        let bench_from_camera = Isometry3::from_parts(
            Translation3::new(0.0, 0.0, height),
            UnitQuaternion::from_rotation_matrix(&rotation),
        );
        Ok(Self { bench_from_camera, residual: plane.rms_m })
    }

    /// From points of the bench plane, in metres, and the pixels of the colour picture that see them; `None` where they
    /// give no plane. Needs no depth; four or more, no three in a line.
    ///
    /// # Errors
    /// [`PerceptionError::OpenCv`].
    pub fn from_points(
        places: &[[f64; 2]],
        pixels: &[[f64; 2]],
        lens: &Lens,
    ) -> Result<Option<Self>, PerceptionError> {
        let places: Vec<Point3<f64>> = places.iter().map(|&[x, y]| Point3::new(x, y, 0.0)).collect();
        let found = pose::solve(&places, pixels, lens, calib3d::SolvePnPMethod::SOLVEPNP_IPPE)?;
        let best = found.iter().min_by(|one, two| one.reprojection_px.total_cmp(&two.reprojection_px));
        Ok(best.map(|best| Self {
            bench_from_camera: best.camera_from_marker.inverse(),
            residual: best.reprojection_px,
        }))
    }
}
