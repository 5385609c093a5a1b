//! From pixels to metres on the bench.
//!
//! A marker of known size gives its own scale, so that its height does not move it sideways: `x = (u - c_x) side / side_px`. A hand has no known
//! size. It takes the scale of the things next to it. Where it touches a thing, it is at the same height, and hand and thing are compared on one
//! scale.

mod calibration;
mod error;
mod misfit;
mod plane;
mod scale;

pub use calibration::{BenchMarker, Calibration, Examination, calibrate, examine};
pub use error::CalibrationError;
pub use misfit::MarkerResidual;

use crate::config::MarkerObject;
use crate::detections::{HANDS, LANDMARKS, OBJECTS};
use crate::error::PerceptionError;
use crate::finder::SeenObject;
use crate::points::{BenchPoint, PixelPoint};
use heapless::Vec;
use plane::{Plane, centre_of_corners};
use scale::Nearness;

/// A thing that was last seen longer ago than this may have been moved, and gives no scale to what is near it.
const STANDS_NS: u64 = 2_000_000_000;

/// The fingertips that touch: index, middle, ring.
const TIPS: [usize; 3] = [8, 12, 16];

/// Where an object is on the bench.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub(crate) position: BenchPoint,
    /// Turn about z in radians, counter-clockwise seen from the camera.
    pub(crate) yaw: f64,
}

#[derive(Clone, Copy, Debug)]
struct Known {
    id: u16,
    nearness: Nearness,
    centre: PixelPoint,
    seen_ns: u64,
}

/// The plane for pictures of one size.
#[derive(Debug)]
struct SizedPlane {
    width: usize,
    height: usize,
    plane: Plane,
}

/// Turns pixels into metres, frame by frame.
#[derive(Debug)]
pub(crate) struct Bench {
    calibration: Option<Calibration>,
    objects: std::vec::Vec<MarkerObject>,
    plane: Option<SizedPlane>,
    known: Vec<Known, OBJECTS>,
    /// Per hand, indexed by `Side`.
    hands: [Option<Nearness>; HANDS],
    now_ns: u64,
}

impl Bench {
    /// Without a calibration the sizes of the markers alone give the scale, and the image plane must be parallel to the bench
    /// (paper IV).
    pub(crate) fn new(calibration: Option<Calibration>, objects: &[MarkerObject]) -> Self {
        Self {
            calibration,
            objects: objects.to_vec(),
            plane: None,
            known: Vec::new(),
            hands: [None; HANDS],
            now_ns: 0,
        }
    }

    /// Takes in the objects of a frame. Those of known size give the scale.
    ///
    /// # Errors
    /// [`PerceptionError::CalibratedFor`].
    pub(crate) fn see(
        &mut self,
        [width, height]: [usize; 2],
        objects: &[SeenObject],
        now_ns: u64,
    ) -> Result<(), PerceptionError> {
        self.now_ns = now_ns;
        self.prepare_plane(width, height, objects)?;
        let Some(SizedPlane { plane, .. }) = self.plane else { return Ok(()) };
        for object in objects {
            let Some(side_m) = object.side_m else { continue };
            let measured = side_m / plane.square(&object.corners).side_m;
            let centre = centre_of_corners(&object.corners);
            match self.known.iter_mut().find(|known| known.id == object.id) {
                Some(known) => {
                    known.nearness.settle(measured);
                    (known.centre, known.seen_ns) = (centre, now_ns);
                }
                None => {
                    let nearness = Nearness::new(measured);
                    let known = Known { id: object.id, nearness, centre, seen_ns: now_ns };
                    // There is room: a frame has no more objects than fit.
                    let _ = self.known.push(known);
                }
            }
        }
        Ok(())
    }

    /// Prepares the plane for pictures of this size. Without a calibration its scale is that of the first markers and is kept. Nearness is relative
    /// to it, and it is the same for everything.
    fn prepare_plane(
        &mut self,
        width: usize,
        height: usize,
        objects: &[SeenObject],
    ) -> Result<(), PerceptionError> {
        if self.plane.as_ref().is_some_and(|plane| (plane.width, plane.height) == (width, height)) {
            return Ok(());
        }
        self.known.clear();
        self.hands = [None; HANDS];
        let plane = match &self.calibration {
            Some(calibration) => {
                if (calibration.width, calibration.height) != (width, height) {
                    let for_pictures = [calibration.width, calibration.height];
                    return Err(PerceptionError::CalibratedFor { for_pictures, width, height });
                }
                calibration.plane()
            }
            None => parallel_plane(width, height, objects),
        };
        self.plane = plane.map(|plane| SizedPlane { width, height, plane });
        Ok(())
    }

    /// Side in pixels of the smallest marker that may appear, if that is known.
    pub(crate) fn min_side_px(&self) -> Option<f64> {
        let SizedPlane { width, height, plane } = self.plane.as_ref()?;
        let (right, bottom) = (*width as f64, *height as f64);
        // Where the camera is tilted, a corner of the picture is the farthest from it.
        let corners = [(0.0, 0.0), (right, 0.0), (0.0, bottom), (right, bottom)];
        let metres_per_px = corners
            .map(|(x, y)| plane.at(PixelPoint::new(x, y)).distance(plane.at(PixelPoint::new(x + 1.0, y))))
            .into_iter()
            .fold(0.0, f64::max);
        let sides = self.objects.iter().map(|object| f64::from(object.side_m));
        Some(sides.min_by(f64::total_cmp)? / metres_per_px)
    }

    /// Where an object of this frame is; `None` until something has given the scale.
    pub(crate) fn place(&self, object: &SeenObject) -> Option<Placed> {
        let SizedPlane { plane, .. } = self.plane.as_ref()?;
        let position = match object.side_m {
            Some(_) => {
                let known = self.known.iter().find(|known| known.id == object.id)?;
                plane.raised(known.centre, known.nearness.value())
            }
            None => plane.at(centre_of_corners(&object.corners)),
        };
        Some(Placed { position, yaw: plane.square(&object.corners).yaw })
    }

    /// The landmarks of a hand in metres; `None` until a marker has given the scale. `hand` is its index by `Side`.
    pub(crate) fn hand(
        &mut self,
        hand: usize,
        landmarks_px: &[PixelPoint; LANDMARKS],
    ) -> Option<[BenchPoint; LANDMARKS]> {
        let SizedPlane { plane, .. } = self.plane.as_ref()?;
        let touch = PixelPoint::mean(TIPS.map(|tip| landmarks_px[tip]));
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
        Some(landmarks_px.map(|landmark| plane.raised(landmark, nearness.value())))
    }

    /// The nearness of the things around a pixel: the mean, weighted by the inverse square of their distance.
    fn nearness_at(&self, pixel: PixelPoint) -> Option<f64> {
        let (mut sum, mut weight) = (0.0, 0.0);
        for known in self.known.iter().filter(|known| self.now_ns.saturating_sub(known.seen_ns) <= STANDS_NS)
        {
            let [dx, dy] = [known.centre.x - pixel.x, known.centre.y - pixel.y];
            // The one pixel keeps the weight finite.
            let share = 1.0 / (dx * dx + dy * dy + 1.0);
            sum += share * known.nearness.value();
            weight += share;
        }
        (weight > 0.0).then(|| sum / weight)
    }
}

/// The parallel plane on which the object of known size that is farthest from the camera has its own size. That one is nearest to the bench.
fn parallel_plane(width: usize, height: usize, objects: &[SeenObject]) -> Option<Plane> {
    // On a plane of one metre per pixel a side in metres is the side in pixels.
    let unscaled = Plane::parallel(width, height, 1.0);
    let scales =
        objects.iter().filter_map(|object| Some(object.side_m? / unscaled.square(&object.corners).side_m));
    let metres_per_px = scales.max_by(f64::total_cmp)?;
    Some(Plane::parallel(width, height, metres_per_px))
}
