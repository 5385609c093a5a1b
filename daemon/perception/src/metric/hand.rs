//! The landmarks of a hand in three dimensions.
//!
//! A landmark lies inside the hand; depth shows the skin above it, or whatever hides it. Seen from above, the tips of a hand that grips lie some 4 cm
//! under its knuckles. So the shape that the hand model guesses is laid upon the measured palm, and gives the expected depth of the other landmarks.
//! A landmark whose measured depth is in front of that is hidden and takes the expected depth. Any other has its skin in view and keeps the measured
//! depth.
//!
//! Seen from above, depth shows the back of the hand over the tips. With the measured depth alone the tips were 33 mm off, with the shape
//! 17 mm.

use nalgebra::{Matrix3, Point3, Vector3};

use super::depth::Sampler;
use super::lens::Lens;
use crate::detections::LANDMARKS;
use crate::points::PixelPoint;

/// Half the width of the window that votes on a landmark's depth, in metres: a finger is 15 to 18 mm wide.
const REACH_M: f64 = 0.006;

/// Half the thickness of a hand at each landmark, in metres, means of adults. Wrist 20 mm, knuckles 13, middle joints 9, last joints 8, tips 7. The
/// thumb's joints are a little thicker.
const HALF_THICKNESS_M: [f64; LANDMARKS] = [
    0.020, 0.016, 0.013, 0.010, 0.009, // wrist and thumb
    0.013, 0.009, 0.008, 0.007, // index
    0.013, 0.009, 0.008, 0.007, // middle
    0.013, 0.009, 0.008, 0.007, // ring
    0.013, 0.009, 0.008, 0.007, // little finger
];

const WRIST: usize = 0;

/// The landmarks where the fingers begin.
const KNUCKLES: [usize; 4] = [5, 9, 13, 17];

/// Fewer knuckles than this, with the wrist, do not determine how the palm lies.
const MIN_KNUCKLES: usize = 2;

/// A measured depth this far in front of the expected one, in metres, belongs to something else. It is half the thickness of a finger, between 0 (the
/// landmark's own skin) and the whole thickness (a finger that lies over it).
const HIDDEN_M: f64 = 0.0075;

/// Without depth a hand stays at its last height for this long, in nanoseconds. It is half a reach, in which it rises or sinks by a few centimetres.
/// Its size in the picture would say no more, because its tilt is only guessed.
const REMEMBERED_NS: u64 = 500_000_000;

/// Where a landmark's depth comes from. Only tests read it: the depth alone does not show which rule gave it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DepthSource {
    /// It was measured at the landmark.
    Measured,
    /// It is that of the hand model's shape, laid upon the palm.
    Shape,
}

/// A hand in the colour camera's frame, in metres.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hand3 {
    /// The landmarks.
    pub(super) points: [Point3<f64>; LANDMARKS],
    /// Where each one's depth comes from.
    pub(super) sources: [DepthSource; LANDMARKS],
}

/// What the colour picture shows of a hand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outline {
    pixels: [PixelPoint; LANDMARKS],
    /// The hand model's shape, as [`HandDetection::shape_m`](crate::detections::HandDetection::shape_m).
    shape_m: [Vector3<f64>; LANDMARKS],
}

/// The palm when it was last measured.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Palm {
    depth_m: f64,
    /// The size of the hand over that of the shape.
    scale: f64,
    measured_ns: u64,
}

/// What is remembered of a hand from frame to frame, so that it can be placed without depth for a while.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Memory(Option<Palm>);

impl Outline {
    /// From the numbers of a [`HandDetection`](crate::detections::HandDetection).
    pub(super) fn new(landmarks_px: &[[f32; 2]; LANDMARKS], shape_m: &[[f32; 3]; LANDMARKS]) -> Self {
        Self {
            pixels: landmarks_px.map(PixelPoint::from),
            shape_m: shape_m.map(|point| Vector3::from(point.map(f64::from))),
        }
    }

    /// Places the landmarks by depth or, where the palm has none, at the height that the hand had a moment ago. `None` where
    /// that is unknown, too.
    pub(super) fn place(
        &self,
        depth: Option<&Sampler<'_>>,
        lens: &Lens,
        now_ns: u64,
        memory: &mut Memory,
    ) -> Option<Hand3> {
        let measured: [Option<f64>; LANDMARKS] = std::array::from_fn(|k| {
            depth?.surface(self.pixels[k], REACH_M).map(|point| point.z + HALF_THICKNESS_M[k])
        });
        let (expected, measured) = match self.on_palm(&measured, lens) {
            Some((expected, scale)) => {
                let palm = Palm { depth_m: middle(&expected), scale, measured_ns: now_ns };
                // A shape of nothing has no scale.
                memory.0 = palm.scale.is_finite().then_some(palm);
                (expected, measured)
            }
            // Too little is measured to know whether the depth is that of the hand.
            None => (self.at(memory.recall(now_ns)?), [None; LANDMARKS]),
        };
        let mut hand = Hand3 {
            points: std::array::from_fn(|k| lens.deproject(self.pixels[k], expected[k])),
            sources: [DepthSource::Shape; LANDMARKS],
        };
        for k in 0..LANDMARKS {
            if let Some(z) = measured[k].filter(|z| *z > expected[k] - HIDDEN_M) {
                (hand.points[k], hand.sources[k]) =
                    (lens.deproject(self.pixels[k], z), DepthSource::Measured);
            }
        }
        hand.points.iter().all(|point| point.coords.iter().all(|value| value.is_finite())).then_some(hand)
    }

    /// Depths of the shape, scaled, turned and moved so that its palm lies on the measured one, and the scale.
    fn on_palm(&self, measured: &[Option<f64>; LANDMARKS], lens: &Lens) -> Option<([f64; LANDMARKS], f64)> {
        let point = |k: usize| Some(lens.deproject(self.pixels[k], measured[k]?).coords);
        let wrist = point(WRIST)?;
        let knuckles: Vec<_> = KNUCKLES.iter().filter_map(|&k| Some((self.shape_m[k], point(k)?))).collect();
        if knuckles.len() < MIN_KNUCKLES {
            return None;
        }
        let lengths = knuckles
            .iter()
            .map(|(shape, point)| (point - wrist).norm() / (shape - self.shape_m[WRIST]).norm());
        let scale = median(lengths.collect())?;
        let pairs: Vec<_> = knuckles
            .iter()
            .copied()
            .chain([(self.shape_m[WRIST], wrist)])
            .map(|(shape, point)| (shape * scale, point))
            .collect();
        let (turn, from, to) = alignment(&pairs)?;
        Some((self.shape_m.map(|point| (to + turn * (point * scale - from)).z), scale))
    }

    /// Depths of the shape with its palm at the height that it had.
    fn at(&self, palm: Palm) -> [f64; LANDMARKS] {
        let own = middle(&self.shape_m.map(|point| point.z));
        self.shape_m.map(|point| palm.depth_m + palm.scale * (point.z - own))
    }
}

impl Memory {
    fn recall(&self, now_ns: u64) -> Option<Palm> {
        self.0.filter(|palm| now_ns.saturating_sub(palm.measured_ns) <= REMEMBERED_NS)
    }
}

/// Mean depth of the palm.
fn middle(depths: &[f64; LANDMARKS]) -> f64 {
    let knuckles = KNUCKLES.iter().map(|&k| depths[k]).sum::<f64>() / KNUCKLES.len() as f64;
    (depths[WRIST] + knuckles) / 2.0
}

/// The turn that takes the first of each pair nearest to the second (Kabsch 1976), and the means of both.
fn alignment(pairs: &[(Vector3<f64>, Vector3<f64>)]) -> Option<(Matrix3<f64>, Vector3<f64>, Vector3<f64>)> {
    let share = 1.0 / pairs.len() as f64;
    let from = pairs.iter().map(|(from, _)| from).sum::<Vector3<f64>>() * share;
    let to = pairs.iter().map(|(_, to)| to).sum::<Vector3<f64>>() * share;
    let covariance: Matrix3<f64> = pairs.iter().map(|(a, b)| (b - to) * (a - from).transpose()).sum();
    if !covariance.iter().all(|value| value.is_finite()) {
        return None;
    }
    let svd = covariance.svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    // A reflection fits as well as a turn where all points lie in a plane, as those of a palm do.
    let sign = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, (u * v_t).determinant().signum()));
    Some((u * sign * v_t, from, to))
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let middle = values.len() / 2;
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}
