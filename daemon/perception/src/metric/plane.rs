//! A plane through points, most of which lie on it.

use nalgebra::{Matrix3, Point3, SymmetricEigen, Vector3};

use super::depth::Patch;

/// Points farther from the plane than this many robust standard deviations do not count in the next round.
const OUTLIER: f64 = 2.5;

/// The median of the distances from the plane is this share of their standard deviation, where they are normal.
const MEDIAN_SHARE: f64 = 0.6745;

/// Depth comes in steps of a millimetre, so distances under this are no outliers, in metres.
const STEP_M: f64 = 0.001;

/// Rounds; on a bench with a third of it covered the set of points has settled after eight.
const ROUNDS: usize = 12;

/// Fits a plane by total least squares, and again without the outliers. `None` for fewer than three points, or points
/// in a line.
pub(super) fn fit(points: &[Point3<f64>]) -> Option<Patch> {
    let mut patch = least_squares(points.iter())?;
    for _ in 0..ROUNDS {
        let mut distances: Vec<f64> = points.iter().map(|point| patch.distance(point).abs()).collect();
        let middle = distances.len() / 2;
        let median = *distances.select_nth_unstable_by(middle, f64::total_cmp).1;
        let limit = OUTLIER * (median / MEDIAN_SHARE).max(STEP_M);
        patch = least_squares(points.iter().filter(|point| patch.distance(point).abs() <= limit))?;
    }
    Some(patch)
}

impl Patch {
    /// Signed distance of a point, positive on the camera's side.
    pub(super) fn distance(&self, point: &Point3<f64>) -> f64 {
        self.normal.dot(&(point - self.centre))
    }
}

fn least_squares<'a>(points: impl Iterator<Item = &'a Point3<f64>> + Clone) -> Option<Patch> {
    let count = points.clone().count();
    if count < 3 {
        return None;
    }
    let share = 1.0 / count as f64;
    let centre = Point3::from(points.clone().map(|point| point.coords).sum::<Vector3<f64>>() * share);
    let spread: Matrix3<f64> = points.map(|point| (point - centre) * (point - centre).transpose()).sum();
    let eigen = SymmetricEigen::new(spread * share);
    let mut order = [0, 1, 2];
    order.sort_unstable_by(|&one, &two| eigen.eigenvalues[one].total_cmp(&eigen.eigenvalues[two]));
    // In a line, the middle one is as small as the least: no plane.
    if eigen.eigenvalues[order[1]] < 1e-12 {
        return None;
    }
    let normal: Vector3<f64> = eigen.eigenvectors.column(order[0]).into();
    let normal = if normal.dot(&centre.coords) > 0.0 { -normal } else { normal };
    let rms_m = eigen.eigenvalues[order[0]].max(0.0).sqrt();
    let spread_m = eigen.eigenvalues[order[1]].sqrt();
    Some(Patch { centre, normal, rms_m, spread_m, points: count })
}
