//! Six degrees of freedom from four corners.
//!
//! A square that is seen nearly face-on has two poses that fit its corners about equally well, with opposite tilts. Depth on
//! the marker decides between them; where there is no depth, the pose of a moment ago does.

use nalgebra::{Isometry3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use opencv::calib3d;
use opencv::core::{Mat, Point2d, Point3d, Vec3d, Vector, no_array};
use opencv::prelude::*;

use super::lens::Lens;
use super::plane::Patch;
use crate::error::{PerceptionError, while_doing};
use crate::points::PixelPoint;

/// Standard deviation of a corner along each axis of the picture, in pixels. 0.02 where the picture is sharp, and more in motion and in noise.
const CORNER_PX: f64 = 0.1;

/// Standard deviation of the tilt that the corners of a marker of 30 px give, in radians. It is 4 degrees, from `CORNER_PX` and the perspective of
/// its sides.
const CORNERS_TILT: f64 = 0.07;

/// Maximum rate at which a held part turns, in radians per second: the quick turn of a wrist.
const MAX_TURN_RATE: f64 = 4.0;

/// An older pose says nothing about the present one, in nanoseconds.
const REMEMBERED_NS: u64 = 500_000_000;

/// If the costs of the two poses differ by no more than this, it is unknown which pose is right. The cost is -2 ln of a likelihood, and this is 2 ln
/// 99, odds of 99 to 1.
const CLEAR: f64 = 9.2;

/// A pose that fits the corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    /// From the marker's frame (x right, y up, z out of its picture) to the colour camera's.
    pub(super) camera_from_marker: Isometry3<f64>,
    /// Root mean square distance of the corners, in pixels.
    pub(super) reprojection_px: f64,
}

/// A marker's pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pose {
    /// From the marker's frame to the colour camera's.
    pub(super) camera_from_marker: Isometry3<f64>,
    /// Whether depth, time or the corners themselves decided between the two poses.
    pub(super) unambiguous: bool,
}

/// The pose of a moment ago.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PreviousPose {
    /// The pose.
    pub(super) camera_from_marker: Isometry3<f64>,
    /// How long ago it was, in nanoseconds.
    pub(super) ago_ns: u64,
}

/// Both poses of a marker of side `side_m`, from its corners: top left, top right, bottom right, bottom left of its own
/// picture. There are none where the corners are no picture of a square.
///
/// # Errors
/// [`PerceptionError::OpenCv`].
pub(super) fn candidates(
    corners: &[PixelPoint; 4],
    side_m: f64,
    lens: &Lens,
) -> Result<Vec<Candidate>, PerceptionError> {
    let half = side_m / 2.0;
    let square =
        [[-half, half], [half, half], [half, -half], [-half, -half]].map(|[x, y]| Point3::new(x, y, 0.0));
    solve(&square, corners, lens, calib3d::SolvePnPMethod::SOLVEPNP_IPPE_SQUARE)
}

/// The right one of the candidates, its tilt improved by the depth on the marker. `None` without candidates.
pub(super) fn choose(
    candidates: &[Candidate],
    patch: Option<&Patch>,
    before: Option<&PreviousPose>,
) -> Option<Pose> {
    let before = before.filter(|before| before.ago_ns <= REMEMBERED_NS);
    let mut ranked: Vec<(f64, &Candidate)> =
        candidates.iter().map(|candidate| (cost(candidate, patch, before), candidate)).collect();
    ranked.sort_by(|one, two| one.0.total_cmp(&two.0));
    let (min, best) = *ranked.first()?;
    let unambiguous = ranked.get(1).is_none_or(|(cost, _)| cost - min > CLEAR);
    let camera_from_marker = match patch {
        Some(patch) => leaned(&best.camera_from_marker, patch),
        None => best.camera_from_marker,
    };
    Some(Pose { camera_from_marker, unambiguous })
}

/// Squared deviations in units of their standard deviations.
fn cost(candidate: &Candidate, patch: Option<&Patch>, before: Option<&PreviousPose>) -> f64 {
    let corners = 4.0 * (candidate.reprojection_px / CORNER_PX).powi(2);
    let normal = candidate.camera_from_marker.rotation * Vector3::z();
    let depth =
        patch.map_or(0.0, |patch| (normal.angle(&patch.normal) / tilt_of(patch).hypot(CORNERS_TILT)).powi(2));
    let time = before.map_or(0.0, |before| {
        let turned = candidate.camera_from_marker.rotation.angle_to(&before.camera_from_marker.rotation);
        // Both poses are measured. Every turn up to the maximum is equally likely: its deviation is the maximum over the root of 3.
        let measured = CORNERS_TILT * f64::sqrt(2.0);
        let turn = MAX_TURN_RATE * before.ago_ns as f64 * 1e-9 / f64::sqrt(3.0);
        (turned / measured.hypot(turn)).powi(2)
    });
    corners + depth + time
}

/// Standard deviation of the tilt of a patch, in radians.
fn tilt_of(patch: &Patch) -> f64 {
    // Neighbouring pixels share a matching window of some 9 pixels. The points are `reach` from the middle on average.
    let independent = (patch.points as f64 / 9.0).max(1.0);
    let reach = patch.spread_m.max(1e-3);
    (patch.rms_m / (reach * independent.sqrt())).max(0.01)
}

/// The pose with the mean of its own tilt and that of the patch, weighted by how well they are known. Its distance is that of the patch.
fn leaned(pose: &Isometry3<f64>, patch: &Patch) -> Isometry3<f64> {
    let normal = pose.rotation * Vector3::z();
    let (corners, depth) = (CORNERS_TILT.powi(-2), tilt_of(patch).powi(-2));
    let towards = (normal * corners + patch.normal * depth).normalize();
    let lean = UnitQuaternion::rotation_between(&normal, &towards).unwrap_or_default();
    // Along the ray of its centre, to the plane of the patch.
    let centre = pose.translation.vector;
    let along = patch.normal.dot(&centre);
    let share = if along.abs() > f64::EPSILON { patch.normal.dot(&patch.centre.coords) / along } else { 1.0 };
    Isometry3::from_parts(Translation3::from(centre * share), lean * pose.rotation)
}

/// All poses that OpenCV finds for points and their pixels.
pub(super) fn solve(
    points: &[Point3<f64>],
    pixels: &[PixelPoint],
    lens: &Lens,
    method: calib3d::SolvePnPMethod,
) -> Result<Vec<Candidate>, PerceptionError> {
    let objects: Vector<Point3d> =
        points.iter().map(|point| Point3d::new(point.x, point.y, point.z)).collect();
    // Rays without distortion: OpenCV sees a camera of focal length 1.
    let rays: Vector<Point2d> =
        pixels.iter().map(|&pixel| lens.ray(pixel)).map(|[x, y]| Point2d::new(x, y)).collect();
    let (mut turns, mut shifts) = (Vector::<Mat>::new(), Vector::<Mat>::new());
    let found = (|| -> opencv::Result<Vec<Isometry3<f64>>> {
        let eye = Mat::eye(3, 3, opencv::core::CV_64F)?.to_mat()?;
        calib3d::solve_pnp_generic(
            &objects,
            &rays,
            &eye,
            &no_array(),
            &mut turns,
            &mut shifts,
            false,
            method,
            &no_array(),
            &no_array(),
            &mut no_array(),
        )?;
        turns
            .iter()
            .zip(shifts.iter())
            .map(|(turn, shift)| Ok(isometry(vector(&turn)?, vector(&shift)?)))
            .collect()
    })()
    .map_err(while_doing("solving a pose"))?;
    let judged = |pose: Isometry3<f64>| {
        let squares = points.iter().zip(pixels).map(|(point, pixel)| {
            let seen = lens.project(&(pose * point))?;
            Some((seen.x - pixel.x).powi(2) + (seen.y - pixel.y).powi(2))
        });
        let sum = squares.sum::<Option<f64>>()?;
        sum.is_finite().then(|| Candidate {
            camera_from_marker: pose,
            reprojection_px: (sum / points.len() as f64).sqrt(),
        })
    };
    Ok(found.into_iter().filter_map(judged).collect())
}

fn isometry(turn: Vector3<f64>, shift: Vector3<f64>) -> Isometry3<f64> {
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::new(turn));
    Isometry3::from_parts(Translation3::from(shift), rotation)
}

fn vector(mat: &Mat) -> opencv::Result<Vector3<f64>> {
    let values = mat.reshape(3, 1)?;
    let at = values.at_2d::<Vec3d>(0, 0)?;
    Ok(Vector3::new(at[0], at[1], at[2]))
}
