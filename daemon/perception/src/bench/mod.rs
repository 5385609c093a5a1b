//! From pixels to metres on the bench.
//!
//! A marker of known size tells its own scale, so that its height does not move it sideways: `x = (u - c_x) side / side_px`.
//! A hand has no known size. It takes the scale of the things that it is next to: where it touches, it is at their height,
//! and hand and thing are compared on one scale.

mod calibration;
mod plane;
mod scale;

pub use calibration::{BenchMarker, Calibration, CalibrationError, calibrate};

use crate::config::{BenchConfig, MarkerObject};
use crate::detections::{LANDMARKS, OBJECTS};
use crate::error::PerceptionError;
use crate::markers::Marker;
use heapless::Vec;
use plane::{Plane, Point, centre_of_corners};
use scale::Nearness;

/// What has not been seen for longer than this has been moved: it does not tell the scale of what is near it any more.
const STANDS_NS: u64 = 2_000_000_000;

/// Fingertips that touch: index, middle, ring.
const TIPS: [usize; 3] = [8, 12, 16];

/// An object on the bench.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Placed {
    pub(crate) position: Point,
    pub(crate) yaw: f64,
}

#[derive(Clone, Copy, Debug)]
struct Known {
    id: u16,
    nearness: Nearness,
    centre_px: Point,
    seen_ns: u64,
}

/// Turns pixels into metres, frame by frame.
#[derive(Debug)]
pub(crate) struct Bench {
    config: BenchConfig,
    objects: std::vec::Vec<MarkerObject>,
    /// Width, height and the plane they are for.
    plane: Option<(usize, usize, Plane)>,
    known: Vec<Known, OBJECTS>,
    /// By hand, as in `Side`.
    hands: [Option<Nearness>; 2],
    now_ns: u64,
}

impl Bench {
    pub(crate) fn new(config: &BenchConfig, objects: &[MarkerObject]) -> Self {
        Self {
            config: config.clone(),
            objects: objects.to_vec(),
            plane: None,
            known: Vec::new(),
            hands: [None; 2],
            now_ns: 0,
        }
    }

    /// Takes in the markers of a frame.
    pub(crate) fn see(
        &mut self,
        [width, height]: [usize; 2],
        markers: &[Marker],
        now_ns: u64,
    ) -> Result<(), PerceptionError> {
        self.now_ns = now_ns;
        self.prepare_plane(width, height, markers)?;
        let Some((_, _, plane)) = &self.plane else { return Ok(()) };
        for marker in markers {
            let Some(side_m) = side_m(&self.objects, marker.id) else { continue };
            let measured = side_m / plane.square(&marker.corners).side;
            let centre_px = centre_of_corners(&marker.corners);
            match self.known.iter_mut().find(|known| known.id == marker.id) {
                Some(known) => {
                    known.nearness.settle(measured);
                    (known.centre_px, known.seen_ns) = (centre_px, now_ns);
                }
                None => {
                    let known = Known {
                        id: marker.id,
                        nearness: Nearness::new(measured),
                        centre_px,
                        seen_ns: now_ns,
                    };
                    // There is room: a frame has no more markers than there are objects, and `Perceiver::new` counts those.
                    let _ = self.known.push(known);
                }
            }
        }
        Ok(())
    }

    /// The plane for pictures of this size. Without a calibration its scale is that of the first markers, and is kept: it is
    /// only what nearness is counted from, and the same for everything.
    fn prepare_plane(
        &mut self,
        width: usize,
        height: usize,
        markers: &[Marker],
    ) -> Result<(), PerceptionError> {
        if matches!(self.plane, Some((w, h, _)) if (w, h) == (width, height)) {
            return Ok(());
        }
        self.known.clear();
        self.hands = [None; 2];
        self.plane = match &self.config {
            BenchConfig::Calibrated(calibration) => {
                if (calibration.width, calibration.height) != (width, height) {
                    let for_pictures = [calibration.width, calibration.height];
                    return Err(PerceptionError::CalibratedFor { for_pictures, width, height });
                }
                calibration.plane()
            }
            BenchConfig::FromMarkers => {
                let pixels = Plane::parallel(width, height, 1.0);
                let scales = markers.iter().filter_map(|marker| {
                    Some(side_m(&self.objects, marker.id)? / pixels.square(&marker.corners).side)
                });
                // The farthest marker lies nearest to the bench.
                scales
                    .max_by(f64::total_cmp)
                    .map(|metres_per_px| Plane::parallel(width, height, metres_per_px))
            }
        }
        .map(|plane| (width, height, plane));
        Ok(())
    }

    /// Side in pixels of the smallest marker that is to be expected, if anything is known of it.
    pub(crate) fn least_side_px(&self) -> Option<f64> {
        let (width, height, plane) = self.plane.as_ref()?;
        // The picture's corners are the farthest from the camera, where it is tilted.
        let step = |x: f64, y: f64| {
            let (a, b) = (plane.at([x, y]), plane.at([x + 1.0, y]));
            (a[0] - b[0]).hypot(a[1] - b[1])
        };
        let (right, bottom) = (*width as f64, *height as f64);
        let metres_per_px = [step(0.0, 0.0), step(right, 0.0), step(0.0, bottom), step(right, bottom)]
            .into_iter()
            .fold(0.0, f64::max);
        let least_side_m =
            self.objects.iter().map(|object| f64::from(object.side_m)).fold(f64::INFINITY, f64::min);
        Some(least_side_m / metres_per_px)
    }

    /// Where a marker of this frame is.
    pub(crate) fn place(&self, marker: &Marker) -> Option<Placed> {
        let (_, _, plane) = self.plane.as_ref()?;
        let known = self.known.iter().find(|known| known.id == marker.id)?;
        Some(Placed {
            position: plane.raised(known.centre_px, known.nearness.value()),
            yaw: plane.square(&marker.corners).yaw,
        })
    }

    /// The landmarks of a hand in metres; None while no marker has told the scale.
    pub(crate) fn hand(
        &mut self,
        hand: usize,
        landmarks: &[[f32; 2]; LANDMARKS],
    ) -> Option<[[f32; 2]; LANDMARKS]> {
        let (_, _, plane) = self.plane.as_ref()?;
        let points = landmarks.map(|point| point.map(f64::from));
        let touch =
            [0, 1].map(|axis| TIPS.iter().map(|&tip| points[tip][axis]).sum::<f64>() / TIPS.len() as f64);
        let nearness = match (self.nearness_at(touch), self.hands[hand]) {
            (Some(measured), Some(mut settled)) => {
                settled.settle(measured);
                settled
            }
            (Some(measured), None) => Nearness::new(measured),
            (None, Some(settled)) => settled,
            (None, None) => Nearness::new(1.0),
        };
        self.hands[hand] = Some(nearness);
        Some(points.map(|point| plane.raised(point, nearness.value()).map(|value| value as f32)))
    }

    /// The nearness of the things around a pixel: the mean, weighted by the inverse square of their distance.
    fn nearness_at(&self, [x, y]: Point) -> Option<f64> {
        let (mut sum, mut weight) = (0.0, 0.0);
        for known in self.known.iter().filter(|known| self.now_ns.saturating_sub(known.seen_ns) <= STANDS_NS)
        {
            let [dx, dy] = [known.centre_px[0] - x, known.centre_px[1] - y];
            // A pixel keeps the weight finite.
            let share = 1.0 / (dx * dx + dy * dy + 1.0);
            sum += share * known.nearness.value();
            weight += share;
        }
        (weight > 0.0).then(|| sum / weight)
    }
}

fn side_m(objects: &[MarkerObject], id: u16) -> Option<f64> {
    objects.iter().find(|object| object.id == id).map(|object| f64::from(object.side_m))
}
