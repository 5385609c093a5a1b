//! The bench plane as the camera sees it.

use crate::points::{BenchPoint, PixelPoint};

pub(crate) type Matrix = [[f64; 3]; 3];

/// A marker on the bench plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Square {
    /// Its side as it appears on the plane, in metres. A marker above the plane appears larger.
    pub(crate) side_m: f64,
    /// Its turn about z in radians, counter-clockwise seen from the camera.
    pub(crate) yaw: f64,
}

/// The bench plane: where a pixel's line of sight meets it, and where a thing above it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    bench_from_image: Matrix,
    /// The point of the plane straight below the camera.
    foot: BenchPoint,
}

impl Plane {
    /// The plane of a camera whose image plane is parallel to it; the origin is the centre of the picture.
    pub(crate) fn parallel(width: usize, height: usize, metres_per_px: f64) -> Self {
        let centre = centre_of_picture(width, height);
        let bench_from_image = [
            [metres_per_px, 0.0, -metres_per_px * centre.x],
            [0.0, -metres_per_px, metres_per_px * centre.y],
            [0.0, 0.0, 1.0],
        ];
        Self { bench_from_image, foot: BenchPoint::default() }
    }

    /// The plane of any homography; `None` where it is singular.
    pub(crate) fn seen_through(bench_from_image: Matrix, width: usize, height: usize) -> Option<Self> {
        let foot = apply(&bench_from_image, nadir(&bench_from_image, width, height)?);
        (foot.x.is_finite() && foot.y.is_finite()).then_some(Self { bench_from_image, foot })
    }

    /// As [`Plane::seen_through`], where nothing above the plane is asked for: its foot is not known.
    pub(crate) fn without_foot(bench_from_image: Matrix) -> Self {
        Self { bench_from_image, foot: BenchPoint::default() }
    }

    /// Homogeneous pixels to homogeneous metres.
    pub(crate) fn bench_from_image(&self) -> Matrix {
        self.bench_from_image
    }

    /// Where the line of sight of a pixel meets the plane.
    pub(crate) fn at(&self, pixel: PixelPoint) -> BenchPoint {
        apply(&self.bench_from_image, pixel)
    }

    /// Where a thing is that appears larger by 1 / `nearness` because of its height.
    ///
    /// A plane parallel to the bench and nearer to the camera is seen on the bench as itself, scaled about the camera's
    /// foot. This is true of any camera, tilted or not, and needs no height and no focal length.
    pub(crate) fn raised(&self, pixel: PixelPoint, nearness: f64) -> BenchPoint {
        let at = self.at(pixel);
        BenchPoint {
            x: self.foot.x + (at.x - self.foot.x) * nearness,
            y: self.foot.y + (at.y - self.foot.y) * nearness,
        }
    }

    /// The square that four corners (top left, top right, bottom right, bottom left) make on the plane.
    pub(crate) fn square(&self, corners: &[PixelPoint; 4]) -> Square {
        let [top_left, top_right, bottom_right, bottom_left] = corners.map(|corner| self.at(corner));
        let mean_step = |from_a: BenchPoint, to_a: BenchPoint, from_b: BenchPoint, to_b: BenchPoint| {
            [(to_a.x - from_a.x + to_b.x - from_b.x) / 2.0, (to_a.y - from_a.y + to_b.y - from_b.y) / 2.0]
        };
        let x = mean_step(top_left, top_right, bottom_left, bottom_right);
        let y = mean_step(bottom_left, top_left, bottom_right, top_right);
        // The turn that comes nearest to the pair of axes.
        let yaw = (x[1] - y[0]).atan2(x[0] + y[1]);
        Square { side_m: untilted_side_m(x, y), yaw }
    }
}

/// The pixel that shows a point of the bench; `None` where the homography is singular.
pub(crate) fn pixel_of(bench_from_image: &Matrix, point: BenchPoint) -> Option<PixelPoint> {
    let image_from_bench = inverse(bench_from_image)?;
    let BenchPoint { x, y } = apply(&image_from_bench, PixelPoint::new(point.x, point.y));
    (x.is_finite() && y.is_finite()).then_some(PixelPoint { x, y })
}

fn centre_of_picture(width: usize, height: usize) -> PixelPoint {
    PixelPoint::new((width as f64 - 1.0) / 2.0, (height as f64 - 1.0) / 2.0)
}

/// The sides of a marker differ by less than this share because of noise: corners to 0.2 px on a marker of 30 px.
const ASPECT_NOISE: f64 = 0.02;

/// The side of the square whose axes appear as `x` and `y`, in metres.
///
/// A marker that is tilted while it is held is foreshortened across its axis of tilt and keeps its length along it. So the
/// side is the longer extent where the two clearly differ, and otherwise their mean.
fn untilted_side_m(x: [f64; 2], y: [f64; 2]) -> f64 {
    // The singular values of the matrix with these columns.
    let half_sum = (x[0] * x[0] + x[1] * x[1] + y[0] * y[0] + y[1] * y[1]) / 2.0;
    let determinant = x[0] * y[1] - x[1] * y[0];
    let half_difference = (half_sum * half_sum - determinant * determinant).max(0.0).sqrt();
    let (longer, shorter) =
        ((half_sum + half_difference).sqrt(), (half_sum - half_difference).max(0.0).sqrt());
    let mean = (longer + shorter) / 2.0;
    let tilt = (1.0 - shorter / longer).powi(2);
    mean + (longer - mean) * tilt / (tilt + ASPECT_NOISE * ASPECT_NOISE)
}

/// Where the diagonals meet, which is the centre of the square under any perspective.
pub(crate) fn centre_of_corners(corners: &[PixelPoint; 4]) -> PixelPoint {
    let [a, b, c, d] = *corners;
    let (p, q) = ([c.x - a.x, c.y - a.y], [d.x - b.x, d.y - b.y]);
    let cross = p[0] * q[1] - p[1] * q[0];
    if cross == 0.0 {
        return PixelPoint::mean(*corners);
    }
    let along = ((b.x - a.x) * q[1] - (b.y - a.y) * q[0]) / cross;
    PixelPoint::new(a.x + along * p[0], a.y + along * p[1])
}

/// The point of the bench that a pixel sees.
pub(crate) fn apply(bench_from_image: &Matrix, pixel: PixelPoint) -> BenchPoint {
    let [u, v, w] = bench_from_image.map(|row| row[0] * pixel.x + row[1] * pixel.y + row[2]);
    BenchPoint::new(u / w, v / w)
}

/// The pixel straight below the camera, which is the vanishing point of the bench's vertical. The principal point is taken
/// to be the picture's centre, and pixels to be square.
fn nadir(bench_from_image: &Matrix, width: usize, height: usize) -> Option<PixelPoint> {
    let centre = centre_of_picture(width, height);
    // Pixels counted from the centre of the picture; columns of the inverse are the images of the bench's axes.
    let centred =
        bench_from_image.map(|row| [row[0], row[1], row[0] * centre.x + row[1] * centre.y + row[2]]);
    let [x_axis, y_axis, _] = transposed(inverse(&centred)?);
    let horizon = cross(x_axis, y_axis);
    let focal_squared = focal_squared(x_axis, y_axis, width);
    Some(PixelPoint {
        x: centre.x + focal_squared * horizon[0] / horizon[2],
        y: centre.y + focal_squared * horizon[1] / horizon[2],
    })
}

/// The squared focal length, in pixels, with which the images of the bench's axes are those of two perpendicular axes of one
/// length. A camera that looks straight down does not determine it. There the foot does not depend on it either, and a usual
/// lens is assumed.
fn focal_squared(x_axis: [f64; 3], y_axis: [f64; 3], width: usize) -> f64 {
    let square = |axis: [f64; 3]| axis[0] * axis[0] + axis[1] * axis[1];
    let equations = [
        (x_axis[0] * y_axis[0] + x_axis[1] * y_axis[1], x_axis[2] * y_axis[2]),
        (square(x_axis) - square(y_axis), x_axis[2] * x_axis[2] - y_axis[2] * y_axis[2]),
    ];
    let focal_squared = -equations.iter().map(|(a, _)| a * a).sum::<f64>()
        / equations.iter().map(|(a, b)| a * b).sum::<f64>();
    // Fields of view of 19 and 90 degrees; the usual one, 53 degrees.
    let (min, max, usual) = (width as f64 * 0.5, width as f64 * 3.0, width as f64);
    if focal_squared >= min * min && focal_squared <= max * max { focal_squared } else { usual * usual }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn transposed(m: Matrix) -> Matrix {
    std::array::from_fn(|row| std::array::from_fn(|column| m[column][row]))
}

fn inverse(m: &Matrix) -> Option<Matrix> {
    let columns = [cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])];
    let determinant = m[0][0] * columns[0][0] + m[0][1] * columns[0][1] + m[0][2] * columns[0][2];
    let inverse = transposed(columns).map(|row| row.map(|value| value / determinant));
    inverse.iter().flatten().all(|value| value.is_finite()).then_some(inverse)
}
