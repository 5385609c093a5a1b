//! Vectors, rotations and the minimum distance between two sets of points.

use crate::capacity::INTERACTION_POINTS;
use crate::input::Point;

/// A unit quaternion (w, x, y, z).
pub(super) type Quaternion = [f32; 4];

pub(super) fn add(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn subtract(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn dot(a: Point, b: Point) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn norm(a: Point) -> f32 {
    libm::sqrtf(dot(a, a))
}

/// The distance of two points.
pub(crate) fn distance(one: Point, other: Point) -> f32 {
    norm(subtract(one, other))
}

/// The squared distance of two points.
pub(crate) fn squared_distance(one: Point, other: Point) -> f32 {
    let apart = subtract(one, other);
    dot(apart, apart)
}

/// The quaternion of a rotation about z by `yaw` radians.
pub(super) fn about_z(yaw: f32) -> Quaternion {
    [libm::cosf(yaw / 2.0), 0.0, 0.0, libm::sinf(yaw / 2.0)]
}

/// The rotation about z of a unit quaternion, in radians.
pub(super) fn yaw(q: Quaternion) -> f32 {
    let [w, x, y, z] = q;
    libm::atan2f(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
}

/// The quaternion scaled to unit length; `None` where its length is zero or not finite.
pub(super) fn unit(q: Quaternion) -> Option<Quaternion> {
    let length = libm::sqrtf(q.iter().map(|value| value * value).sum());
    (length.is_finite() && length > f32::EPSILON).then(|| q.map(|value| value / length))
}

/// The rotation by `b` and then by `a`.
pub(super) fn rotation_after(a: Quaternion, b: Quaternion) -> Quaternion {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// The inverse of a unit quaternion.
pub(super) fn inverse(q: Quaternion) -> Quaternion {
    [q[0], -q[1], -q[2], -q[3]]
}

/// The columns of the rotation matrix of a unit quaternion.
pub(super) fn columns(q: Quaternion) -> [Point; 3] {
    let [w, x, y, z] = q;
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)],
        [2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)],
        [2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// The vector rotated by a unit quaternion.
pub(super) fn rotated(v: Point, q: Quaternion) -> Point {
    let [a, b, c] = columns(q);
    [0, 1, 2].map(|i| a[i] * v[0] + b[i] * v[1] + c[i] * v[2])
}

/// Interaction points with one array per coordinate, so that the compiler makes vector instructions of [`Cloud::distance`].
/// Unused entries repeat the first point, which changes no minimum distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cloud {
    coordinates: [[f32; INTERACTION_POINTS]; 3],
    /// How many entries are in use.
    count: usize,
}

impl Cloud {
    /// `None` if there is no point. Points beyond the capacity are left out.
    pub(super) fn new(points: &[Point]) -> Option<Self> {
        let first = points.first()?;
        let coordinates =
            [0, 1, 2].map(|axis| core::array::from_fn(|index| points.get(index).unwrap_or(first)[axis]));
        Some(Self { coordinates, count: points.len().min(INTERACTION_POINTS) })
    }

    /// The points of an object that has this pose, in the bench frame.
    pub(super) fn at(&self, position: Point, orientation: Quaternion) -> Self {
        let [a, b, c] = columns(orientation);
        let [x, y, z] = &self.coordinates;
        let coordinates = [0, 1, 2].map(|axis| {
            core::array::from_fn(|index| {
                position[axis] + a[axis] * x[index] + b[axis] * y[index] + c[axis] * z[index]
            })
        });
        Self { coordinates, count: self.count }
    }

    /// Maximum distance of a point from the origin.
    pub(super) fn radius(&self) -> f32 {
        let [x, y, z] = &self.coordinates;
        let squares = (0..self.count).map(|i| x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
        libm::sqrtf(squares.fold(0.0, f32::max))
    }

    /// Whether a point of this cloud is within a distance of the given point.
    pub(super) fn comes_within(&self, distance: f32, of: Point) -> bool {
        let [x, y, z] = &self.coordinates;
        (0..self.count).any(|i| squared_distance([x[i], y[i], z[i]], of) <= distance * distance)
    }

    /// Minimum distance between a point of this cloud and a point of the other.
    pub(super) fn distance(&self, other: &Self) -> f32 {
        let [ox, oy, oz] = &other.coordinates;
        let mut min = [f32::INFINITY; INTERACTION_POINTS];
        for i in 0..self.count {
            let [x, y, z] = [self.coordinates[0][i], self.coordinates[1][i], self.coordinates[2][i]];
            for j in 0..INTERACTION_POINTS {
                let [dx, dy, dz] = [ox[j] - x, oy[j] - y, oz[j] - z];
                let square = dx * dx + dy * dy + dz * dz;
                min[j] = if square < min[j] { square } else { min[j] };
            }
        }
        libm::sqrtf(min.into_iter().fold(f32::INFINITY, f32::min))
    }
}
