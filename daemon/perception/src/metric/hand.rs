//! The landmarks of a hand in three dimensions.
//!
//! A landmark lies inside the hand; depth shows the skin above it, or whatever hides the landmark. What is measured is
//! therefore held against the shape of the hand: MediaPipe's relative depth where it is given, else the lengths of bones.
//! What does not fit is filled in from what does.

use nalgebra::Point3;

use super::depth::Sampler;
use super::lens::Lens;
use crate::detections::LANDMARKS;

/// Half of what votes on a landmark's depth, in metres: a finger is 15 to 18 mm wide.
const REACH_M: f64 = 0.006;

/// Half the thickness of a hand at each landmark, in metres, means of adults: wrist 20 mm, knuckles 13, middle joints 9,
/// last joints 8, tips 7; the thumb's joints are a little thicker.
const HALF_THICKNESS_M: [f64; LANDMARKS] = [
    0.020, 0.016, 0.013, 0.010, 0.009, // wrist and thumb
    0.013, 0.009, 0.008, 0.007, // index
    0.013, 0.009, 0.008, 0.007, // middle
    0.013, 0.009, 0.008, 0.007, // ring
    0.013, 0.009, 0.008, 0.007, // little finger
];

/// The landmark that each one hangs on, towards the wrist.
const PARENT: [usize; LANDMARKS] = [0, 0, 1, 2, 3, 0, 5, 6, 7, 0, 9, 10, 11, 0, 13, 14, 15, 0, 17, 18, 19];

/// The longest bone from each landmark to its parent, in metres: the 95th percentile of men, and 1 cm for noise.
const LONGEST_BONE_M: [f64; LANDMARKS] = [
    0.0, 0.065, 0.060, 0.050, 0.045, 0.120, 0.060, 0.042, 0.040, 0.120, 0.064, 0.045, 0.042, 0.115, 0.060,
    0.043, 0.042, 0.110, 0.052, 0.036, 0.038,
];

/// Landmarks of the palm, which hide each other least.
const PALM: [usize; 6] = [0, 1, 5, 9, 13, 17];

/// Measured depth this far from what the relative depth says belongs to something else, in metres: the relative depth is
/// good to 1 or 2 cm.
const MISFIT_M: f64 = 0.030;

/// Where a landmark's depth comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthSource {
    /// It was measured at the landmark.
    Measured,
    /// MediaPipe's relative depth, at the distance that the measured ones tell.
    Relative,
    /// The next measured landmark towards the wrist.
    Neighbour,
}

/// A hand in the colour camera's frame, in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Hand3 {
    /// The landmarks.
    pub points: [Point3<f64>; LANDMARKS],
    /// Where each one's depth comes from.
    pub sources: [DepthSource; LANDMARKS],
}

/// Places the landmarks of a hand.
///
/// `pixels` are the landmarks in the colour picture; `relative` is MediaPipe's third coordinate of each, in pixels of the
/// same picture, smaller is nearer, where it is known. `None` where not even the palm has depth.
pub fn place(
    pixels: &[[f32; 2]; LANDMARKS],
    relative: Option<&[f32; LANDMARKS]>,
    depth: &Sampler<'_>,
    lens: &Lens,
) -> Option<Hand3> {
    let pixels = pixels.map(|pixel| pixel.map(f64::from));
    let measured: [Option<f64>; LANDMARKS] =
        std::array::from_fn(|k| depth.surface(pixels[k], REACH_M).map(|point| point.z + HALF_THICKNESS_M[k]));
    let (depths, sources) = match relative {
        Some(relative) => by_relative(&measured, relative, lens)?,
        None => by_bones(&measured, &pixels, lens)?,
    };
    let points = std::array::from_fn(|k| lens.deproject(pixels[k], depths[k]));
    Some(Hand3 { points, sources })
}

type Placed = ([f64; LANDMARKS], [DepthSource; LANDMARKS]);

/// The relative depths, moved to where most of the measured ones are; a measured one that fits is kept.
fn by_relative(
    measured: &[Option<f64>; LANDMARKS],
    relative: &[f32; LANDMARKS],
    lens: &Lens,
) -> Option<Placed> {
    let of = |chosen: &[usize]| median(chosen.iter().filter_map(|&k| measured[k]).collect());
    // A pixel is this many metres at the hand.
    let scale = of(&PALM)? / lens.focal[0];
    let shape = relative.map(|z| f64::from(z) * scale);
    let offset = median((0..LANDMARKS).filter_map(|k| Some(measured[k]? - shape[k])).collect())?;
    let mut placed = ([0.0; LANDMARKS], [DepthSource::Measured; LANDMARKS]);
    for k in 0..LANDMARKS {
        let expected = shape[k] + offset;
        (placed.0[k], placed.1[k]) = match measured[k].filter(|z| (z - expected).abs() <= MISFIT_M) {
            Some(z) => (z, DepthSource::Measured),
            None => (expected, DepthSource::Relative),
        };
    }
    Some(placed)
}

/// From the palm outwards, each landmark no farther from its parent than a bone is long.
fn by_bones(
    measured: &[Option<f64>; LANDMARKS],
    pixels: &[[f64; 2]; LANDMARKS],
    lens: &Lens,
) -> Option<Placed> {
    let palm = median(PALM.iter().filter_map(|&k| measured[k]).collect())?;
    let mut placed = ([palm; LANDMARKS], [DepthSource::Neighbour; LANDMARKS]);
    for k in 0..LANDMARKS {
        let parent = if k == 0 { palm } else { placed.0[PARENT[k]] };
        let longest = if k == 0 { LONGEST_BONE_M[9] } else { LONGEST_BONE_M[k] };
        let along_picture = if k == 0 {
            0.0
        } else {
            (lens.deproject(pixels[k], parent) - lens.deproject(pixels[PARENT[k]], parent)).norm()
        };
        let room = (longest * longest - along_picture * along_picture).max(0.0).sqrt();
        match measured[k].filter(|z| (z - parent).abs() <= room.max(SLACK_M)) {
            Some(z) => (placed.0[k], placed.1[k]) = (z, DepthSource::Measured),
            None => placed.0[k] = parent,
        }
    }
    Some(placed)
}

/// A bone that lies in the picture at its full length may still be this much askew: noise of depth and of landmarks.
const SLACK_M: f64 = 0.015;

fn median(mut values: Vec<f64>) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let middle = values.len() / 2;
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}
