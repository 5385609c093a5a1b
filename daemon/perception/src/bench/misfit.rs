//! Which of the markers is wrong where they do not fit their positions.
//!
//! Four centres fit any four positions exactly, so the centres alone say nothing. A marker is a square of known side, and its corners say how
//! the bench lies around it: three markers place the fourth. The one without which the others fit is the wrong one.

use super::calibration::{BenchMarker, MAX_CENTRE_ERROR_M, MAX_SIDE_ERROR, fit, side_error};
use super::error::CalibrationError;
use super::plane::{Matrix, Plane, centre_of_corners};
use crate::markers::Marker;
use crate::points::{BenchPoint, PixelPoint};

/// How often turns and plane are fitted to each other. From the second time on, a tilted camera's plane changes by less than a pixel.
const ROUNDS: usize = 8;
/// All sides are wrong alike where they agree to this, relative: twice the error that one marker may have.
pub(super) const ALIKE: f64 = 2.0 * MAX_SIDE_ERROR;

/// A marker as it is named, and as it was found.
pub(super) type Pair = (BenchMarker, Marker);

/// Where a marker is by the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkerResidual {
    /// Its id.
    pub id: u16,
    /// Its corners in pixels.
    pub corners_px: [[f32; 2]; 4],
    /// Where it is said to be.
    pub stated: BenchPoint,
    /// Where the other markers, with their sides, place it.
    pub measured: BenchPoint,
    /// Its side as the other markers measure it, in metres.
    pub side_m: f64,
}

impl MarkerResidual {
    /// From where it is said to be to where the others place it, in metres.
    pub fn distance_m(&self) -> f64 {
        self.measured.distance(self.stated)
    }
}

/// Every marker by the others, in the order of `pairs`.
pub(super) fn residuals(pairs: &[Pair]) -> Vec<MarkerResidual> {
    (0..pairs.len())
        .filter_map(|left_out| residual(&pairs[left_out], &plane_without(pairs, left_out)?))
        .collect()
}

/// Every marker by all but the one with this id, and their plane.
pub(super) fn without(pairs: &[Pair], id: u16) -> Option<(Vec<MarkerResidual>, Matrix)> {
    let wrong = pairs.iter().position(|(known, _)| known.id == id)?;
    let plane = plane_without(pairs, wrong)?;
    Some((pairs.iter().filter_map(|pair| residual(pair, &plane)).collect(), plane.bench_from_image()))
}

fn residual((known, found): &Pair, plane: &Plane) -> Option<MarkerResidual> {
    let measured = plane.at(centre_of_corners(&found.corners));
    let is_placed = measured.x.is_finite() && measured.y.is_finite();
    is_placed.then(|| MarkerResidual {
        id: known.id,
        corners_px: found.corners.map(Into::into),
        stated: known.centre,
        measured,
        side_m: plane.square(&found.corners).side_m,
    })
}

/// The plane by all markers but one.
fn plane_without(pairs: &[Pair], left_out: usize) -> Option<Plane> {
    let others: Vec<Pair> =
        pairs.iter().enumerate().filter(|(index, _)| *index != left_out).map(|(_, pair)| *pair).collect();
    plane_of_squares(&others)
}

/// The plane that fits the corners of these markers best, each turned as it seems to be.
fn plane_of_squares(pairs: &[Pair]) -> Option<Plane> {
    let mut plane = first_plane(pairs)?;
    for _ in 0..ROUNDS {
        let points: Vec<(PixelPoint, BenchPoint)> =
            pairs.iter().flat_map(|pair| corners_on_bench(pair, &plane)).collect();
        plane = as_plane(fit(&points).ok()?)?;
    }
    Some(plane)
}

/// A plane to begin with: the one in which the centres lie where they should, as if the camera looked straight down.
fn first_plane(pairs: &[Pair]) -> Option<Plane> {
    let [first, second, third, ..] = pairs else { return None };
    let ends = [first, second, third].map(|(known, found)| (centre_of_corners(&found.corners), known.centre));
    let [(a, to_a), (b, to_b), (c, to_c)] = ends;
    let area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    let row = |at_a: f64, at_b: f64, at_c: f64| {
        let x = ((at_b - at_a) * (c.y - a.y) - (at_c - at_a) * (b.y - a.y)) / area;
        let y = ((at_c - at_a) * (b.x - a.x) - (at_b - at_a) * (c.x - a.x)) / area;
        [x, y, at_a - x * a.x - y * a.y]
    };
    as_plane([row(to_a.x, to_b.x, to_c.x), row(to_a.y, to_b.y, to_c.y), [0.0, 0.0, 1.0]])
}

/// Only where pixels lie on the bench is asked of it, which no size of the picture changes.
fn as_plane(bench_from_image: Matrix) -> Option<Plane> {
    bench_from_image
        .iter()
        .flatten()
        .all(|value| value.is_finite())
        .then(|| Plane::without_foot(bench_from_image))
}

/// The corners of a marker and where they are on the bench, if it is turned as it seems to be.
fn corners_on_bench((known, found): &Pair, plane: &Plane) -> [(PixelPoint, BenchPoint); 4] {
    let (sin, cos) = plane.square(&found.corners).yaw.sin_cos();
    let half = known.side_m / 2.0;
    // As the corners run: top left, top right, bottom right, bottom left.
    let ends = [[-half, half], [half, half], [half, -half], [-half, -half]];
    std::array::from_fn(|corner| {
        let [x, y] = ends[corner];
        let at = BenchPoint::new(known.centre.x + cos * x - sin * y, known.centre.y + sin * x + cos * y);
        (found.corners[corner], at)
    })
}

/// What is wrong with markers that do not fit.
pub(super) fn explain(pairs: &[Pair], by_centres: &Plane) -> CalibrationError {
    sides_alike(pairs, by_centres)
        .or_else(|| one_wrong(pairs))
        .or_else(|| exchanged(pairs))
        .unwrap_or_else(|| CalibrationError::SeveralWrong(residuals(pairs)))
}

/// All sides are wrong by one factor: they were printed in another size, or measured wrongly.
fn sides_alike(pairs: &[Pair], by_centres: &Plane) -> Option<CalibrationError> {
    let shares: Vec<f64> =
        pairs.iter().map(|(known, found)| by_centres.square(&found.corners).side_m / known.side_m).collect();
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    // Sides and diagonals: squares stay squares.
    let is_alike = pairs
        .iter()
        .all(|(known, found)| side_error(by_centres, &found.corners, mean * known.side_m) <= ALIKE);
    let stated_m = pairs.first()?.0.side_m;
    (is_alike && (mean - 1.0).abs() > MAX_SIDE_ERROR)
        .then_some(CalibrationError::Sides { stated_m, measured_m: mean * stated_m })
}

/// One marker without which all others fit.
fn one_wrong(pairs: &[Pair]) -> Option<CalibrationError> {
    let without = |left_out: usize| {
        let plane = plane_without(pairs, left_out)?;
        let others = pairs.iter().enumerate().filter(|(index, _)| *index != left_out);
        let worst = others.map(|(_, pair)| misfit(pair, &plane)).fold(0.0, f64::max);
        Some((worst, left_out, plane))
    };
    let best = (0..pairs.len()).filter_map(without).min_by(|one, other| one.0.total_cmp(&other.0));
    let (worst, wrong, plane) = best?;
    if worst > 1.0 {
        return None;
    }
    let found = residual(&pairs[wrong], &plane)?;
    let (known, _) = pairs[wrong];
    if found.distance_m() > MAX_CENTRE_ERROR_M {
        return Some(CalibrationError::Elsewhere {
            id: known.id,
            stated: known.centre,
            measured: found.measured,
        });
    }
    Some(CalibrationError::Side { id: known.id, stated_m: known.side_m, measured_m: found.side_m })
}

/// How badly a marker fits: over 1 is too much.
fn misfit((known, found): &Pair, plane: &Plane) -> f64 {
    let distance_m = plane.at(centre_of_corners(&found.corners)).distance(known.centre);
    // A position or a size that is no number fits nothing.
    let worst =
        distance_m / MAX_CENTRE_ERROR_M + side_error(plane, &found.corners, known.side_m) / MAX_SIDE_ERROR;
    if worst.is_nan() { f64::INFINITY } else { worst }
}

/// Two markers that lie at each other's positions.
fn exchanged(pairs: &[Pair]) -> Option<CalibrationError> {
    for one in 0..pairs.len() {
        for other in one + 1..pairs.len() {
            let mut pairs = pairs.to_vec();
            (pairs[one].0.centre, pairs[other].0.centre) = (pairs[other].0.centre, pairs[one].0.centre);
            let plane = plane_of_squares(&pairs)?;
            if pairs.iter().all(|pair| misfit(pair, &plane) <= 1.0) {
                return Some(CalibrationError::Exchanged([pairs[one].0.id, pairs[other].0.id]));
            }
        }
    }
    None
}
