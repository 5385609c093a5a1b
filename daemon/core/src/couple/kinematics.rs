//! Place, velocity and tangential acceleration, and their quantisation (paper III-A.2, III-A.3).

use super::geometry::{Quaternion, dot, inverse, norm, rotated};
use crate::config::Method;
use crate::input::{Point, Space};
use core::f32::consts::{FRAC_PI_2, PI, TAU};

/// How a hand or an object moves in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Kinematics {
    /// Where it is by the parabola through the positions around the frame, in the bench frame, and the root mean square of their residuals. Both are
    /// in metres.
    pub(super) position: Point,
    pub(super) residual_m: f32,
    /// Velocity in m/s, in the bench frame.
    pub(super) velocity: Point,
    /// Acceleration along the velocity, in m/s².
    pub(super) tangential: f32,
}

/// How many times the error with all frames of the window may be exceeded. By default every second frame multiplies that of an acceleration by up to
/// 1.96, and every third by 4.0. So every second is enough, and every third is not.
const MAX_ERROR: f64 = 2.5;

/// The maximum variances of a velocity and an acceleration that count as measured, as multiples of the variance of a position. In 1/s² and 1/s⁴. Few
/// positions, or positions mostly on one side of the frame, multiply the noise of each.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Precision {
    velocity: f64,
    acceleration: f64,
}

impl Precision {
    /// The variances with all positions of the window, `persist_frames` before and after the frame, and what is allowed beyond.
    pub(super) fn new(method: &Method) -> Self {
        let (half, rate) = (f64::from(method.persist_frames), f64::from(method.rate_hz));
        let count = 2.0 * half + 1.0;
        // The sums of the second and fourth powers of -half..=half.
        let s2 = half * (half + 1.0) * count / 3.0;
        let s4 = s2 * (3.0 * half * half + 3.0 * half - 1.0) / 5.0;
        let rate_squared = rate * rate;
        let max = MAX_ERROR * MAX_ERROR;
        Self {
            velocity: max * rate_squared / s2,
            acceleration: max * 4.0 * rate_squared * rate_squared / (s4 - s2 * s2 / count),
        }
    }
}

/// A time in seconds from the frame that is asked for, and the position then.
pub(super) type Sample = (f64, Point);

/// Fits a parabola to the positions around a frame and takes its value and its derivatives in that frame. It is a Savitzky-Golay filter that uses the
/// time stamps as they are and skips frames without a position. `None` if the positions are too few or too unevenly spread for the precision, or all
/// lie on one side of the frame.
pub(super) fn kinematics(
    samples: impl Iterator<Item = Sample> + Clone,
    precision: &Precision,
) -> Option<Kinematics> {
    // Times are scaled to the window, so that the sums of their powers have similar magnitudes.
    let scale = samples.clone().map(|(t, _)| t.abs()).reduce(f64::max).filter(|scale| *scale > 0.0)?;
    let mut powers = [0.0; 5];
    let mut moments = [[0.0; 3]; 3];
    let mut squares = 0.0;
    let (mut before, mut after) = (false, false);
    for (t, position) in samples {
        before |= t <= 0.0;
        after |= t >= 0.0;
        squares += position.iter().map(|value| f64::from(*value) * f64::from(*value)).sum::<f64>();
        let t = t / scale;
        let mut power = 1.0;
        for (k, sum) in powers.iter_mut().enumerate() {
            *sum += power;
            if let Some(moment) = moments.get_mut(k) {
                for (sum, value) in moment.iter_mut().zip(position) {
                    *sum += power * f64::from(value);
                }
            }
            power *= t;
        }
    }
    let curve = Parabola::fit(powers)?;
    if !(before && after && curve.is_precise(scale, precision)) {
        return None;
    }
    let rows: [[f64; 3]; 3] =
        [0, 1, 2].map(|row| [0, 1, 2].map(|axis| curve.coefficient(row, moments.map(|moment| moment[axis]))));
    let [position, velocity, acceleration]: [Point; 3] = [(0, 1.0), (1, scale), (2, scale * scale / 2.0)]
        .map(|(row, unit)| rows[row].map(|value| (value / unit) as f32));
    let explained: f64 = rows.iter().flatten().zip(moments.iter().flatten()).map(|(a, b)| a * b).sum();
    let residual_m = libm::sqrt((squares - explained).max(0.0) / powers[0]) as f32;
    let speed = norm(velocity);
    let tangential = if speed > 0.0 { dot(acceleration, velocity) / speed } else { 0.0 };
    Some(Kinematics { position, residual_m, velocity, tangential })
}

/// The inverse of the normal equations of a parabola.
struct Parabola([[f64; 3]; 3]);

impl Parabola {
    /// From the sums of the powers 0 to 4 of the times; `None` where these are fewer than three different times.
    fn fit(powers: [f64; 5]) -> Option<Self> {
        let [s0, s1, s2, s3, s4] = powers;
        let cofactors = [
            [s2 * s4 - s3 * s3, s2 * s3 - s1 * s4, s1 * s3 - s2 * s2],
            [s2 * s3 - s1 * s4, s0 * s4 - s2 * s2, s1 * s2 - s0 * s3],
            [s1 * s3 - s2 * s2, s1 * s2 - s0 * s3, s0 * s2 - s1 * s1],
        ];
        let determinant = s0 * cofactors[0][0] + s1 * cofactors[0][1] + s2 * cofactors[0][2];
        // Times are scaled to at most 1: three times one frame apart give far more than rounding does.
        (determinant > 1e-9).then(|| Self(cofactors.map(|row| row.map(|value| value / determinant))))
    }

    /// Whether the first and second derivatives at time 0 are precise enough, with times in units of `scale` seconds.
    fn is_precise(&self, scale: f64, precision: &Precision) -> bool {
        let scale_squared = scale * scale;
        self.0[1][1] <= precision.velocity * scale_squared
            && 4.0 * self.0[2][2] <= precision.acceleration * scale_squared * scale_squared
    }

    fn coefficient(&self, row: usize, moments: [f64; 3]) -> f64 {
        self.0[row].iter().zip(moments).map(|(factor, moment)| factor * moment).sum()
    }
}

/// Turns kinematics into the integers of `x_m`.
impl Method {
    /// Whether this is no motion.
    pub(super) fn is_at_rest(&self, motion: &Kinematics) -> bool {
        norm(motion.velocity) < self.rest_speed_m_s
    }

    /// The sign of the tangential acceleration: -1, 0 or 1. At rest there is no tangent and the sign is 0.
    pub(super) fn sign(&self, motion: &Kinematics) -> i8 {
        if self.is_at_rest(motion) || motion.tangential.abs() < self.dead_band_m_s2 {
            0
        } else if motion.tangential > 0.0 {
            1
        } else {
            -1
        }
    }

    /// Joint motion: 1 if the signs of both accelerations agree, else 0 (paper III-A.2). Two zeros agree, because an object
    /// that is carried at constant speed, or held still, is in the hand too.
    pub(super) fn joint_motion(&self, one: &Kinematics, other: &Kinematics) -> i8 {
        i8::from(self.sign(one) == self.sign(other))
    }

    /// `[θ, φ]`: the direction of the velocity of `v_i`, projected onto the axes of `v_j` (paper III-A.2), as bins of `2π/N`.
    ///
    /// Azimuth bin 1 is centred on the x axis of `v_j`, and bins are counted towards its y axis. Elevation has bins of the same width: bin 1 is
    /// centred on straight down, bin `N/2 + 1` on straight up. It is 0 in plane mode. Both are 0 at rest.
    pub(super) fn direction(&self, motion: &Kinematics, frame: Quaternion) -> [i8; 2] {
        if self.is_at_rest(motion) {
            return [0; 2];
        }
        let [x, y, z] = rotated(motion.velocity, inverse(frame));
        let width = TAU / f32::from(self.bins);
        let azimuth = libm::atan2f(y, x);
        let around = libm::floorf((azimuth + PI * 2.0) / width + 0.5) as i32 % i32::from(self.bins);
        let elevation = match self.space {
            Space::Plane => 0,
            Space::Metric => {
                let angle = libm::atan2f(z, libm::sqrtf(x * x + y * y)) + FRAC_PI_2;
                1 + libm::floorf(angle / width + 0.5) as i8
            }
        };
        // Less than N, which is at most 120.
        [elevation, around as i8 + 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::couple::geometry::about_z;

    /// The motion at time 0 of something that is at these places on the y axis at these times.
    fn measured(times: impl IntoIterator<Item = f64>, place: impl Fn(f64) -> f64) -> Option<Kinematics> {
        let samples: std::vec::Vec<Sample> =
            times.into_iter().map(|t| (t, [0.0, place(t) as f32, 1.0])).collect();
        kinematics(samples.into_iter(), &Precision::new(&Method::default()))
    }

    fn moving(velocity: Point) -> Kinematics {
        Kinematics { velocity, ..Kinematics::default() }
    }

    #[test]
    fn a_parabola_is_differentiated_exactly_at_uneven_times_with_frames_missing() {
        // At 0 the velocity is -0.5 and, as it slows down, the tangential acceleration -4.
        let times = [-0.17, -0.09, -0.06, 0.011, 0.04, 0.13];
        let motion = measured(times, |t| 3.0 - 0.5 * t + 2.0 * t * t).unwrap_or_default();
        assert!((motion.position[1] - 3.0).abs() < 1e-4 && motion.residual_m < 1e-4, "{motion:?}");
        assert!((motion.velocity[1] + 0.5).abs() < 1e-4, "{motion:?}");
        assert!((motion.tangential + 4.0).abs() < 1e-3, "{motion:?}");
        assert!(motion.velocity[2].abs() < 1e-6, "{motion:?}");
    }

    #[test]
    fn positions_on_one_side_only_and_too_few_positions_are_no_measurement() {
        // In frames of the grid, of which the window has 5 before and 5 after.
        for (frames, is_measured, what) in [
            (&[-5, -4, -3, -2, -1, 0, 1, 2, 3, 4, 5][..], true, "all"),
            (&[-4, -2, 0, 2, 4], true, "every second frame"),
            (&[-5, -3, -1, 1, 3, 5], true, "the other frames"),
            (&[-1, 0, 1], false, "three positions near the frame"),
            (&[-5, -4, -3, -2, -1], false, "all before the frame"),
            (&[-5, -4, -3, -2, -1, 0], false, "the frame is the last one"),
        ] {
            let times = frames.iter().map(|frame| f64::from(*frame) / 30.0);
            assert_eq!(measured(times, |t| t).is_some(), is_measured, "{what}");
        }
    }

    #[test]
    fn directions_are_counted_around_the_circle_from_the_x_axis_of_the_other() {
        let method = Method::default();
        for bin in 0..8u8 {
            for inside in [-0.49, 0.0, 0.49] {
                let angle = (f32::from(bin) + inside) * TAU / 8.0;
                let motion = moving([libm::cosf(angle), libm::sinf(angle), 0.0]);
                assert_eq!(method.direction(&motion, about_z(0.0)), [0, bin as i8 + 1]);
                // The other frame is rotated by a quarter: two bins less.
                assert_eq!(method.direction(&motion, about_z(FRAC_PI_2)), [0, ((bin + 6) % 8) as i8 + 1]);
            }
        }
    }

    #[test]
    fn elevation_runs_from_straight_down_to_straight_up() {
        let method = Method { space: Space::Metric, ..Method::default() };
        let [down, level, up] = [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
            .map(|velocity| method.direction(&moving(velocity), about_z(0.3))[0]);
        assert_eq!([down, level, up], [1, 3, 5]);
    }

    #[test]
    fn at_rest_there_is_neither_direction_nor_sign_and_opposite_signs_are_no_joint_motion() {
        let method = Method { space: Space::Metric, ..Method::default() };
        let slow = Kinematics { tangential: 9.0, ..moving([0.02, 0.0, 0.0]) };
        assert_eq!((method.direction(&slow, about_z(0.0)), method.sign(&slow)), ([0, 0], 0));
        let [slower, steady, faster] =
            [-1.0, 0.0, 1.0].map(|tangential| Kinematics { tangential, ..moving([1.0, 0.0, 0.0]) });
        let joint = [faster, slower, steady].map(|other| method.joint_motion(&faster, &other));
        assert_eq!(joint, [1, 0, 0]);
    }
}
