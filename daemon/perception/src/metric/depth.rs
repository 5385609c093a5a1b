//! Depth at a pixel of the colour picture, without aligning the pictures: only the pixels that are needed are looked at.
//!
//! The two cameras are side by side, so what a colour pixel sees lies on a short line in the depth picture, from where
//! it would be if it were near to where it would be if it were far. On that line the pixel is sought that sees the same;
//! around it, the depth is voted on: a stereo camera has holes, fattened edges, and points that fly between near and far.

use nalgebra::{Point3, Vector3};

use super::error::MetricError;
use super::lens::Rig;

/// The nearest and the farthest depth that is looked for, in metres: a D400 sees from 0.28 m on at its best resolution,
/// and a camera over a bench hangs no higher than 1.5 m.
const RANGE_M: [f64; 2] = [0.25, 1.6];

/// Depths that differ by less belong to one surface, in metres: the noise of a D435i at 1 m is 2 to 4 mm, and a finger
/// falls away by 4 mm over half its width.
const SURFACE_M: f64 = 0.012;

/// A surface needs this share of the pixels with depth: a finger tip fills a third of its window, points that fly are
/// fewer.
const LEAST_SHARE: f64 = 0.25;

/// And this many pixels: three that agree are no accident.
const LEAST_PIXELS: usize = 3;

/// A depth picture that belongs to someone else: 16 bits a pixel, little endian, 0 where there is no depth.
#[derive(Clone, Copy)]
pub struct DepthImage<'a> {
    width: usize,
    height: usize,
    stride: usize,
    unit_m: f64,
    data: &'a [u8],
}

impl<'a> DepthImage<'a> {
    /// `stride` is the bytes from one row to the next; `unit_m` the metres of one step of depth.
    ///
    /// # Errors
    /// [`MetricError::Depth`] when the sizes do not fit one another.
    pub fn new(
        [width, height]: [usize; 2],
        stride: usize,
        unit_m: f64,
        data: &'a [u8],
    ) -> Result<Self, MetricError> {
        // 16384: far beyond any camera, and no product below can overflow.
        let fits = width <= 16384 && height <= 16384 && stride <= 65536 && stride >= 2 * width;
        if !fits || data.len() < stride * height || !(unit_m > 0.0 && unit_m.is_finite()) {
            return Err(MetricError::Depth { width, height, stride, unit_m, bytes: data.len() });
        }
        Ok(Self { width, height, stride, unit_m, data })
    }

    /// Width and height in pixels.
    pub(super) fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// Depth in metres; `None` outside the picture and where there is none.
    pub(super) fn at(&self, column: i64, row: i64) -> Option<f64> {
        let (column, row) = (usize::try_from(column).ok()?, usize::try_from(row).ok()?);
        if column >= self.width || row >= self.height {
            return None;
        }
        let byte = row * self.stride + 2 * column;
        let steps = u16::from_le_bytes([self.data[byte], self.data[byte + 1]]);
        (steps > 0).then(|| f64::from(steps) * self.unit_m)
    }
}

/// A plane that a patch of depth shows, in the colour camera's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Mean of its points.
    pub centre: Point3<f64>,
    /// Unit normal, towards the camera.
    pub normal: Vector3<f64>,
    /// Root mean square distance of its points from it, in metres.
    pub rms_m: f64,
    /// Root mean square distance of its points from their mean, across its narrower side, in metres.
    pub spread_m: f64,
    /// How many points it rests on.
    pub points: usize,
}

/// Answers questions about depth in terms of the colour picture.
#[derive(Clone, Copy)]
pub struct Sampler<'a> {
    image: DepthImage<'a>,
    rig: &'a Rig,
}

impl<'a> Sampler<'a> {
    /// For one depth picture.
    pub fn new(image: DepthImage<'a>, rig: &'a Rig) -> Self {
        Self { image, rig }
    }

    /// The nearest surface that a colour pixel sees, as a point of the colour camera's frame; the window that votes
    /// reaches `reach_m` metres each way. `None` where too few pixels have depth.
    pub fn surface(&self, pixel: [f64; 2], reach_m: f64) -> Option<Point3<f64>> {
        let [column, row] = self.counterpart(pixel)?;
        let z = self.image.at(column, row).unwrap_or(RANGE_M[1]);
        let reach = (reach_m * self.rig.depth.focal[0] / z).round().max(1.0) as i64;
        let mut depths: Vec<f64> = window([column, row], reach)
            .filter_map(|[column, row]| Some(self.point(column, row)?.z))
            .collect();
        Some(self.rig.colour.deproject(pixel, nearest_surface(&mut depths)?))
    }

    /// The plane inside a quadrilateral of the colour picture. `None` where less than half of it has depth.
    pub fn patch(&self, quadrilateral: &[[f64; 2]; 4]) -> Option<Patch> {
        let middle = [0, 1].map(|axis| quadrilateral.iter().map(|corner| corner[axis]).sum::<f64>() / 4.0);
        let [column, row] = self.counterpart(middle)?;
        let scale = self.rig.depth.focal[0] / self.rig.colour.focal[0];
        let radius = quadrilateral.iter().map(|corner| distance(*corner, middle)).fold(0.0, f64::max);
        let reach = (radius * scale).ceil() as i64;
        let is_inside = |point: &Point3<f64>| {
            self.rig.colour.project(point).is_some_and(|pixel| contains(quadrilateral, pixel))
        };
        let points: Vec<Point3<f64>> = window([column, row], reach)
            .filter_map(|[column, row]| self.point(column, row).filter(is_inside))
            .collect();
        let wanted = area(quadrilateral) * scale * scale;
        if points.len() < LEAST_PIXELS || (points.len() as f64) < 0.5 * wanted {
            return None;
        }
        super::plane::fit(&points)
    }

    /// Every `step`th pixel's point, in the colour camera's frame.
    pub(super) fn grid(&self, step: usize) -> Vec<Point3<f64>> {
        let [width, height] = self.image.size();
        let rows = (0..height).step_by(step);
        rows.flat_map(|row| (0..width).step_by(step).map(move |column| (column as i64, row as i64)))
            .filter_map(|(column, row)| self.point(column, row))
            .collect()
    }

    /// What a depth pixel sees, in the colour camera's frame.
    fn point(&self, column: i64, row: i64) -> Option<Point3<f64>> {
        let z = self.image.at(column, row)?;
        Some(self.rig.colour_from_depth * self.rig.depth.deproject([column as f64, row as f64], z))
    }

    /// The depth pixel that sees what a colour pixel sees; of several the nearest to the camera, which hides the others.
    /// Where none has depth, the one where something in the middle of the range would be.
    fn counterpart(&self, pixel: [f64; 2]) -> Option<[i64; 2]> {
        let seen_at = |z: f64| {
            let point =
                self.rig.colour_from_depth.inverse_transform_point(&self.rig.colour.deproject(pixel, z));
            self.rig.depth.project(&point)
        };
        let (near, far) = (seen_at(RANGE_M[0])?, seen_at(RANGE_M[1])?);
        let steps = (near[0] - far[0]).abs().max((near[1] - far[1]).abs()).ceil().max(1.0);
        // One depth pixel, in colour pixels: any point of the surface is seen by a pixel within half of that.
        let tolerance = (self.rig.colour.focal[0] / self.rig.depth.focal[0]).max(1.0);
        let on_line = |step: f64| {
            [0, 1].map(|axis| (far[axis] + (near[axis] - far[axis]) * step / steps).round() as i64)
        };
        let matches = (0..=steps as i64).map(|step| on_line(step as f64)).filter_map(|[column, row]| {
            let point = self.point(column, row)?;
            let back = self.rig.colour.project(&point)?;
            (distance(back, pixel) <= tolerance).then_some(([column, row], point.z))
        });
        let nearest = matches.min_by(|one, two| one.1.total_cmp(&two.1)).map(|(at, _)| at);
        // A hole: the inverse of depth is what runs evenly along the line.
        let middle = || {
            seen_at(2.0 / (1.0 / RANGE_M[0] + 1.0 / RANGE_M[1]))
                .map(|at| at.map(|value| value.round() as i64))
        };
        nearest.or_else(middle)
    }
}

/// Depth of the nearest surface among these; sorts them.
fn nearest_surface(depths: &mut [f64]) -> Option<f64> {
    depths.sort_unstable_by(f64::total_cmp);
    let least = LEAST_PIXELS.max((LEAST_SHARE * depths.len() as f64).ceil() as usize);
    let members = |first: usize| depths[first..].partition_point(|&depth| depth <= depths[first] + SURFACE_M);
    let nearest = (0..depths.len()).find(|&first| members(first) >= least)?;
    // The first that qualifies is the front of the surface: the best one begins a little behind it.
    let front = depths[nearest];
    let starts = (nearest..depths.len()).take_while(|&first| depths[first] <= front + SURFACE_M);
    let best = starts.max_by_key(|&first| members(first))?;
    Some(depths[best + members(best) / 2])
}

fn window([column, row]: [i64; 2], reach: i64) -> impl Iterator<Item = [i64; 2]> {
    (row - reach..=row + reach)
        .flat_map(move |row| (column - reach..=column + reach).map(move |column| [column, row]))
}

fn distance(one: [f64; 2], two: [f64; 2]) -> f64 {
    (one[0] - two[0]).hypot(one[1] - two[1])
}

/// Twice the signed area of a triangle.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn area(corners: &[[f64; 2]; 4]) -> f64 {
    0.5 * (turn(corners[0], corners[1], corners[2]) + turn(corners[0], corners[2], corners[3])).abs()
}

/// Whether a convex quadrilateral contains a pixel, whichever way it turns.
fn contains(corners: &[[f64; 2]; 4], pixel: [f64; 2]) -> bool {
    let sides: [f64; 4] = std::array::from_fn(|k| turn(corners[k], corners[(k + 1) % 4], pixel));
    sides.iter().all(|&side| side >= 0.0) || sides.iter().all(|&side| side <= 0.0)
}
