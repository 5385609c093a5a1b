//! A plane of the bench as the camera sees it.

/// A point in pixels or in metres.
pub(crate) type Point = [f64; 2];
pub(crate) type Matrix = [[f64; 3]; 3];

/// A marker on the bench plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Square {
    /// Where its diagonals meet, in metres.
    pub(crate) centre: Point,
    /// Its side as it appears on the plane, in metres. What stands higher appears larger.
    pub(crate) side: f64,
    /// Its turn about z, counter-clockwise seen from the camera, in radians.
    pub(crate) yaw: f64,
}

/// The bench plane: where a pixel's line of sight meets it, and how what stands above it is brought back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plane {
    bench_from_image: Matrix,
    /// The point of the plane straight below the camera, in metres.
    foot: Point,
}

impl Plane {
    /// The image plane is parallel to the bench; the origin is the centre of the picture.
    pub(crate) fn parallel(width: usize, height: usize, metres_per_px: f64) -> Self {
        let [x, y] = centre_of(width, height);
        let bench_from_image = [
            [metres_per_px, 0.0, -metres_per_px * x],
            [0.0, -metres_per_px, metres_per_px * y],
            [0.0, 0.0, 1.0],
        ];
        Self { bench_from_image, foot: [0.0; 2] }
    }

    /// Any homography. None where it is singular.
    pub(crate) fn seen_through(bench_from_image: Matrix, width: usize, height: usize) -> Option<Self> {
        let foot = apply(&bench_from_image, nadir(&bench_from_image, width, height)?);
        foot.iter().all(|value| value.is_finite()).then_some(Self { bench_from_image, foot })
    }

    /// Where the line of sight of a pixel meets the plane, in metres.
    pub(crate) fn at(&self, pixel: Point) -> Point {
        apply(&self.bench_from_image, pixel)
    }

    /// Where a thing is whose height makes it appear larger by 1 / `nearness`, in metres.
    ///
    /// A plane parallel to the bench and nearer to the camera is seen on the bench as itself, scaled about the camera's
    /// foot. This is so for any camera, tilted or not; no height and no focal length enters.
    pub(crate) fn raised(&self, pixel: Point, nearness: f64) -> Point {
        let at = self.at(pixel);
        [0, 1].map(|axis| self.foot[axis] + (at[axis] - self.foot[axis]) * nearness)
    }

    /// The square that four corners (top left, top right, bottom right, bottom left) in pixels make on the plane.
    pub(crate) fn square(&self, corners: &[Point; 4]) -> Square {
        let [top_left, top_right, bottom_right, bottom_left] = corners.map(|corner| self.at(corner));
        let mean_step = |from_a: Point, to_a: Point, from_b: Point, to_b: Point| {
            [0, 1].map(|axis| (to_a[axis] - from_a[axis] + to_b[axis] - from_b[axis]) / 2.0)
        };
        let x = mean_step(top_left, top_right, bottom_left, bottom_right);
        let y = mean_step(bottom_left, top_left, bottom_right, top_right);
        // The turn that comes nearest to the pair of axes.
        let yaw = (x[1] - y[0]).atan2(x[0] + y[1]);
        Square { centre: self.at(centre_of_corners(corners)), side: untilted_side(x, y), yaw }
    }
}

/// The centre of a picture in pixels.
fn centre_of(width: usize, height: usize) -> Point {
    [(width as f64 - 1.0) / 2.0, (height as f64 - 1.0) / 2.0]
}

/// Sides of a marker that differ by less than this share differ by noise: corners to 0.2 px on a marker of 30 px.
const ASPECT_NOISE: f64 = 0.02;

/// The side of the square whose axes appear as `x` and `y`: a marker that is tilted while held is foreshortened across its
/// axis of tilt and keeps its length along it. So it is the longer extent where they clearly differ, else their mean.
fn untilted_side(x: Point, y: Point) -> f64 {
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

/// Where the diagonals meet: the centre of the square under any perspective.
pub(crate) fn centre_of_corners(corners: &[Point; 4]) -> Point {
    let [a, b, c, d] = *corners;
    let (p, q) = ([c[0] - a[0], c[1] - a[1]], [d[0] - b[0], d[1] - b[1]]);
    let cross = p[0] * q[1] - p[1] * q[0];
    if cross == 0.0 {
        return [0, 1].map(|axis| (a[axis] + b[axis] + c[axis] + d[axis]) / 4.0);
    }
    let along = ((b[0] - a[0]) * q[1] - (b[1] - a[1]) * q[0]) / cross;
    [a[0] + along * p[0], a[1] + along * p[1]]
}

pub(crate) fn apply(matrix: &Matrix, [x, y]: Point) -> Point {
    let [u, v, w] = matrix.map(|row| row[0] * x + row[1] * y + row[2]);
    [u / w, v / w]
}

/// The pixel straight below the camera: the vanishing point of the bench's vertical. The principal point is taken to be the
/// picture's centre and pixels to be square.
fn nadir(bench_from_image: &Matrix, width: usize, height: usize) -> Option<Point> {
    let [x, y] = centre_of(width, height);
    // Pixels counted from the centre of the picture; columns of the inverse are the images of the bench's axes.
    let centred = bench_from_image.map(|row| [row[0], row[1], row[0] * x + row[1] * y + row[2]]);
    let [x_axis, y_axis, _] = transposed(inverse(&centred)?);
    let horizon = cross(x_axis, y_axis);
    let focal_squared = focal_squared(x_axis, y_axis, width);
    Some([x + focal_squared * horizon[0] / horizon[2], y + focal_squared * horizon[1] / horizon[2]])
}

/// The focal length squared, in pixels, that makes the images of the bench's axes those of two perpendicular axes of one
/// length. A camera that looks straight down does not tell; there the foot does not depend on it, and a usual lens is taken.
fn focal_squared(x_axis: [f64; 3], y_axis: [f64; 3], width: usize) -> f64 {
    let square = |axis: [f64; 3]| axis[0] * axis[0] + axis[1] * axis[1];
    let equations = [
        (x_axis[0] * y_axis[0] + x_axis[1] * y_axis[1], x_axis[2] * y_axis[2]),
        (square(x_axis) - square(y_axis), x_axis[2] * x_axis[2] - y_axis[2] * y_axis[2]),
    ];
    let focal_squared = -equations.iter().map(|(a, _)| a * a).sum::<f64>()
        / equations.iter().map(|(a, b)| a * b).sum::<f64>();
    // Fields of view of 19 and 90 degrees; the usual one, 53 degrees.
    let (least, most, usual) = (width as f64 * 0.5, width as f64 * 3.0, width as f64);
    if focal_squared >= least * least && focal_squared <= most * most { focal_squared } else { usual * usual }
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
