//! Where the bench is: z up from it, x right and y up in the picture.

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use opencv::calib3d;

use super::depth::Sampler;
use super::error::MetricError;
use super::lens::Lens;
use super::{plane, pose};
use crate::error::PerceptionError;
use crate::points::{BenchPoint, PixelPoint};

/// One pixel per this number of rows and columns of the depth picture is enough: 4800 points of 640 x 480.
const STEP: usize = 8;

/// Minimum share of the depth picture that shows the bench: a plane under less of it is not found for certain.
const MIN_SHARE: f64 = 0.5;

/// Maximum root mean square distance of the depth from the bench, in metres: the noise of a D435i at 1 m.
const MAX_RMS_M: f64 = 0.006;

/// Minimum cosine between the bench's vertical and the camera's axis: the camera looks down at 30 degrees or more.
const MIN_COSINE: f64 = 0.5;

/// The bench frame of a camera that does not move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BenchFrame {
    /// From the colour camera's frame to the bench's.
    pub bench_from_camera: Isometry3<f64>,
}

impl BenchFrame {
    /// The frame of the plane that most of the depth picture shows. Its origin is the foot of the colour camera.
    ///
    /// # Errors
    /// [`MetricError::NoBench`] when no plane covers enough of the picture.
    pub fn from_depth(depth: &Sampler<'_>) -> Result<Self, MetricError> {
        let points = depth.grid(STEP);
        let plane = plane::fit(&points)
            .ok_or(MetricError::NoBench { reason: "the depth picture is empty".into() })?;
        let share = plane.points as f64 / points.len() as f64;
        let refused = |reason| Err(MetricError::NoBench { reason });
        if share < MIN_SHARE || plane.rms_m > MAX_RMS_M {
            return refused(format!(
                "a plane fits {:.0} % of the depth to {:.1} mm",
                100.0 * share,
                1000.0 * plane.rms_m
            ));
        }
        if -plane.normal.z < MIN_COSINE {
            return refused("the largest plane is seen from the side".into());
        }
        let up = plane.normal;
        // The camera's x, projected into the plane. By the cosine above it is not along the normal.
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
        Ok(Self { bench_from_camera })
    }

    /// The frame of these points of the bench plane, seen by these pixels of the colour picture. It also gives the root mean square distance of the
    /// pixels from where the points would be seen, in pixels. `None` where the points give no plane. Needs no depth, and four or more points, no
    /// three in a line.
    ///
    /// # Errors
    /// [`PerceptionError::OpenCv`].
    pub(crate) fn from_points(
        points: &[BenchPoint],
        pixels: &[PixelPoint],
        lens: &Lens,
    ) -> Result<Option<(Self, f64)>, PerceptionError> {
        let points: Vec<Point3<f64>> =
            points.iter().map(|point| Point3::new(point.x, point.y, 0.0)).collect();
        let found = pose::solve(&points, pixels, lens, calib3d::SolvePnPMethod::SOLVEPNP_IPPE)?;
        let best = found.iter().min_by(|one, two| one.reprojection_px.total_cmp(&two.reprojection_px));
        Ok(best.map(|best| {
            (Self { bench_from_camera: best.camera_from_marker.inverse() }, best.reprojection_px)
        }))
    }
}
