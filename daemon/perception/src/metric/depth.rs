//! Depth at a pixel of the colour picture, without aligning the pictures: only the pixels that are needed are read.
//!
//! The two cameras are side by side, so what a colour pixel sees lies on a short line in the depth picture. The line runs from where it would be if
//! it were near to where it would be if it were far. On that line the sampler looks for the pixel that sees the same. The pixels around it vote on
//! the depth, because a stereo camera has holes, fattened edges, and points that fly between near and far.

use nalgebra::Point3;

use super::error::MetricError;
use super::lens::Rig;
use super::plane::{self, Patch};
use crate::points::PixelPoint;

/// The minimum and maximum depth that is looked for, in metres. A D400 sees from 0.28 m at its best resolution, and a camera over a bench hangs no
/// higher than 1.5 m.
const RANGE_M: [f64; 2] = [0.25, 1.6];

/// Depths that differ by less than this, in metres, belong to one surface. The noise of a D435i at 1 m is 2 to 4 mm. A finger falls away by 4 mm over
/// half its width.
const SURFACE_M: f64 = 0.012;

/// A surface needs this share of the pixels with depth: a fingertip fills a third of its window, and flying points are fewer.
const MIN_SHARE: f64 = 0.25;

/// A surface needs this many pixels: three that agree are no accident.
const MIN_PIXELS: usize = 3;

/// Maximum width, height and bytes per row: far beyond any camera, and no product of them overflows.
const MAX_SIDE_PX: usize = 16_384;
const MAX_STRIDE: usize = 65_536;

/// A depth picture that belongs to someone else: 16 bits per pixel, little endian, 0 where there is no depth.
#[derive(Clone, Copy)]
pub struct DepthImage<'a> {
    width: usize,
    height: usize,
    stride: usize,
    unit_m: f64,
    data: &'a [u8],
}

impl<'a> DepthImage<'a> {
    /// `stride` is the number of bytes from one row to the next, and `unit_m` one step of depth in metres.
    ///
    /// # Errors
    /// [`MetricError::Depth`] when the sizes contradict one another.
    pub fn new(
        [width, height]: [usize; 2],
        stride: usize,
        unit_m: f64,
        data: &'a [u8],
    ) -> Result<Self, MetricError> {
        let fits =
            width <= MAX_SIDE_PX && height <= MAX_SIDE_PX && stride <= MAX_STRIDE && stride >= 2 * width;
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

/// Finds depth by the pixels of the colour picture.
#[derive(Clone, Copy)]
pub struct Sampler<'a> {
    image: DepthImage<'a>,
    rig: &'a Rig,
}

impl<'a> Sampler<'a> {
    /// A sampler of one depth picture.
    pub fn new(image: DepthImage<'a>, rig: &'a Rig) -> Self {
        Self { image, rig }
    }

    /// The nearest surface that a colour pixel sees, as a point of the colour camera's frame. The window that votes reaches `reach_m` metres each
    /// way. `None` where too few pixels have depth.
    pub(super) fn surface(&self, pixel: PixelPoint, reach_m: f64) -> Option<Point3<f64>> {
        let [column, row] = self.counterpart(pixel)?;
        let z = self.image.at(column, row).unwrap_or(RANGE_M[1]);
        let reach = (reach_m * self.rig.depth.focal[0] / z).round().max(1.0) as i64;
        let mut depths: Vec<f64> = window([column, row], reach)
            .filter_map(|[column, row]| Some(self.point(column, row)?.z))
            .collect();
        Some(self.rig.colour.deproject(pixel, nearest_surface(&mut depths)?))
    }

    /// The plane inside a quadrilateral of the colour picture. `None` where less than half of it has depth.
    pub(super) fn patch(&self, quadrilateral: &[PixelPoint; 4]) -> Option<Patch> {
        let middle = PixelPoint::mean(*quadrilateral);
        let [column, row] = self.counterpart(middle)?;
        let scale = self.rig.depth.focal[0] / self.rig.colour.focal[0];
        let radius = quadrilateral.iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
        let reach = (radius * scale).ceil() as i64;
        let is_inside = |point: &Point3<f64>| {
            self.rig.colour.project(point).is_some_and(|pixel| contains(quadrilateral, pixel))
        };
        let points: Vec<Point3<f64>> = window([column, row], reach)
            .filter_map(|[column, row]| self.point(column, row).filter(is_inside))
            .collect();
        let wanted = area(quadrilateral) * scale * scale;
        if points.len() < MIN_PIXELS || (points.len() as f64) < 0.5 * wanted {
            return None;
        }
        plane::fit(&points)
    }

    /// The points of every `step`-th pixel per row and column, in the colour camera's frame.
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
        Some(
            self.rig.colour_from_depth
                * self.rig.depth.deproject(PixelPoint::new(column as f64, row as f64), z),
        )
    }

    /// Column and row of the depth pixel that sees what a colour pixel sees. Of several it is the nearest to the camera, which
    /// hides the others. Where none has depth, it is the one where something in the middle of the range would be.
    fn counterpart(&self, pixel: PixelPoint) -> Option<[i64; 2]> {
        let seen_at = |z: f64| {
            let point =
                self.rig.colour_from_depth.inverse_transform_point(&self.rig.colour.deproject(pixel, z));
            self.rig.depth.project(&point)
        };
        let (near, far) = (seen_at(RANGE_M[0])?, seen_at(RANGE_M[1])?);
        let steps = (near.x - far.x).abs().max((near.y - far.y).abs()).ceil().max(1.0);
        // One depth pixel in colour pixels: a pixel within half of that sees any point of the surface.
        let tolerance = (self.rig.colour.focal[0] / self.rig.depth.focal[0]).max(1.0);
        let on_line = |step: f64| {
            let share = |far: f64, near: f64| (far + (near - far) * step / steps).round() as i64;
            [share(far.x, near.x), share(far.y, near.y)]
        };
        let matches = (0..=steps as i64).map(|step| on_line(step as f64)).filter_map(|[column, row]| {
            let point = self.point(column, row)?;
            let back = self.rig.colour.project(&point)?;
            (back.distance(pixel) <= tolerance).then_some(([column, row], point.z))
        });
        let nearest = matches.min_by(|one, two| one.1.total_cmp(&two.1)).map(|(at, _)| at);
        // A hole: the inverse of depth is linear along the line.
        let middle = || {
            seen_at(2.0 / (1.0 / RANGE_M[0] + 1.0 / RANGE_M[1]))
                .map(|at| [at.x, at.y].map(|value| value.round() as i64))
        };
        nearest.or_else(middle)
    }
}

/// Depth of the nearest surface among these; sorts them.
fn nearest_surface(depths: &mut [f64]) -> Option<f64> {
    depths.sort_unstable_by(f64::total_cmp);
    let min = MIN_PIXELS.max((MIN_SHARE * depths.len() as f64).ceil() as usize);
    let members = |first: usize| depths[first..].partition_point(|&depth| depth <= depths[first] + SURFACE_M);
    let nearest = (0..depths.len()).find(|&first| members(first) >= min)?;
    // The first that qualifies is the front of the surface; the best one begins a little behind it.
    let front = depths[nearest];
    let starts = (nearest..depths.len()).take_while(|&first| depths[first] <= front + SURFACE_M);
    let best = starts.max_by_key(|&first| members(first))?;
    Some(depths[best + members(best) / 2])
}

fn window([column, row]: [i64; 2], reach: i64) -> impl Iterator<Item = [i64; 2]> {
    (row - reach..=row + reach)
        .flat_map(move |row| (column - reach..=column + reach).map(move |column| [column, row]))
}

/// Twice the signed area of a triangle.
fn turn(a: PixelPoint, b: PixelPoint, c: PixelPoint) -> f64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

fn area(corners: &[PixelPoint; 4]) -> f64 {
    0.5 * (turn(corners[0], corners[1], corners[2]) + turn(corners[0], corners[2], corners[3])).abs()
}

/// Whether a convex quadrilateral contains a pixel, whichever way its corners run.
fn contains(corners: &[PixelPoint; 4], pixel: PixelPoint) -> bool {
    let sides: [f64; 4] = std::array::from_fn(|k| turn(corners[k], corners[(k + 1) % 4], pixel));
    sides.iter().all(|&side| side >= 0.0) || sides.iter().all(|&side| side <= 0.0)
}
