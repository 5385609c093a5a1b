//! A plane through points, most of which lie on it.

use nalgebra::{Matrix3, Point3, SymmetricEigen, Vector3};

/// A plane that a patch of depth shows, in the colour camera's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Patch {
    /// Mean of its points.
    pub(super) centre: Point3<f64>,
    /// Unit normal, towards the camera.
    pub(super) normal: Vector3<f64>,
    /// Root mean square distance of its points from it, in metres.
    pub(super) rms_m: f64,
    /// Root mean square distance of its points from their mean, across its narrower side, in metres.
    pub(super) spread_m: f64,
    /// Number of points that it depends on.
    pub(super) points: usize,
}

/// Points farther from the plane than this many robust standard deviations do not count in the next round.
const OUTLIER: f64 = 2.5;

/// The median of normally distributed distances from the plane is this share of their standard deviation.
const MEDIAN_SHARE: f64 = 0.6745;

/// Depth comes in steps of a millimetre, so a shorter distance is no outlier, in metres.
const STEP_M: f64 = 0.001;

/// Number of planes through three points that are tried. Where half of the points lie on the plane, one triple in eight does,
/// and one of 48 does with a probability of 99.8 %.
const TRIPLES: usize = 48;

/// Rounds of least squares without the outliers: from a plane near the right one, the set of points settles in two.
const ROUNDS: usize = 4;

/// Fits the plane that more than half of the points lie on. It takes the least median of distances among planes through three points (Rousseeuw
/// 1984), then total least squares without the outliers. The same points give the same plane. `None` for fewer than three points, or points in a
/// line.
pub(super) fn fit(points: &[Point3<f64>]) -> Option<Patch> {
    let mut dice = Dice(1);
    let triples = (0..TRIPLES).filter_map(|_| {
        let patch = least_squares([(); 3].map(|()| &points[dice.below(points.len())]).into_iter())?;
        Some((median_distance(&patch, points), patch))
    });
    let (_, mut patch) =
        (points.len() >= 3).then(|| triples.min_by(|one, two| one.0.total_cmp(&two.0))).flatten()?;
    for _ in 0..ROUNDS {
        let limit = OUTLIER * (median_distance(&patch, points) / MEDIAN_SHARE).max(STEP_M);
        patch = least_squares(points.iter().filter(|point| patch.distance(point).abs() <= limit))?;
    }
    Some(patch)
}

fn median_distance(patch: &Patch, points: &[Point3<f64>]) -> f64 {
    let mut distances: Vec<f64> = points.iter().map(|point| patch.distance(point).abs()).collect();
    let middle = distances.len() / 2;
    *distances.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Picks the same points every time: Knuth's linear congruential generator, whose upper bits are random.
struct Dice(u64);

impl Dice {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % count
    }
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
    // For points in a line the middle one is as small as the smallest: there is no plane.
    if eigen.eigenvalues[order[1]] < 1e-12 {
        return None;
    }
    let normal: Vector3<f64> = eigen.eigenvectors.column(order[0]).into();
    let normal = if normal.dot(&centre.coords) > 0.0 { -normal } else { normal };
    let rms_m = eigen.eigenvalues[order[0]].max(0.0).sqrt();
    let spread_m = eigen.eigenvalues[order[1]].sqrt();
    Some(Patch { centre, normal, rms_m, spread_m, points: count })
}
