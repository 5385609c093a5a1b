//! Metric mode: three dimensions from a colour and a depth picture (DESIGN 4, "Spaces").
//!
//! [`lens`] pixels and points → [`depth`] depth at the pixels that are needed → [`hand`] landmarks and [`pose`] markers in
//! the colour camera's frame → the frame of the [`bench`]. [`Metric`] puts them together, frame by frame.
//!
//! Nothing here knows where the pictures come from: optics are plain numbers, depth is a slice.

pub mod bench;
pub mod depth;
pub mod error;
pub mod hand;
pub mod lens;
mod plane;
pub mod pose;

pub use bench::BenchFrame;
pub use depth::{DepthImage, Sampler};
pub use error::MetricError;
pub use lens::{Distortion, Lens, Rig};

use crate::config::MarkerObject;
use crate::detections::{Detections, HANDS, HandDetection, LANDMARKS, OBJECTS, ObjectDetection, Side};
use crate::held::{Held, PlacedHand, PlacedObject};
use heapless::Vec;
use nalgebra::{Isometry3, Point3};

/// A hand in the bench frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetricHand {
    /// Which hand.
    pub side: Side,
    /// Landmarks in metres in the bench frame; NaN where the hand has had no depth for half a second.
    pub landmarks_m: [[f32; 3]; LANDMARKS],
    /// Share of the landmarks whose depth was measured at them, 0..1.
    pub measured: f32,
}

/// An object in the bench frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetricObject {
    /// The marker's id, which is the object's.
    pub id: u16,
    /// Centre of the marker in metres in the bench frame.
    pub position_m: [f32; 3],
    /// Unit quaternion (w, x, y, z), marker frame to bench frame.
    pub orientation: [f32; 4],
    /// False where two poses fit and neither depth nor time could tell which is right.
    pub unambiguous: bool,
}

/// What was seen in one frame, in the bench frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MetricScene {
    /// The hands of the detections, in their order.
    pub hands: Vec<MetricHand, HANDS>,
    /// The objects of the detections, in their order, but for those whose corners are no picture of a square.
    pub objects: Vec<MetricObject, OBJECTS>,
    /// Carried objects whose markers are hidden, placed by the motion of the hand.
    pub held: Vec<PlacedObject, OBJECTS>,
}

/// The last pose of an object.
#[derive(Clone, Copy, Debug)]
struct Remembered {
    id: u16,
    camera_from_marker: Isometry3<f64>,
    seen_ns: u64,
}

/// Turns detections in pixels into a scene in metres.
///
/// One of these follows one camera: it remembers poses from frame to frame.
#[derive(Clone, Debug)]
pub struct Metric {
    rig: Rig,
    bench: BenchFrame,
    objects: std::vec::Vec<MarkerObject>,
    remembered: Vec<Remembered, OBJECTS>,
    held: Held,
    /// By hand, as in [`Side`].
    palms: [hand::Memory; HANDS],
}

impl Metric {
    /// For a camera that stays where it is, over a bench that has been calibrated.
    pub fn new(rig: Rig, bench: BenchFrame, objects: &[MarkerObject]) -> Self {
        Self {
            rig,
            bench,
            objects: objects.to_vec(),
            remembered: Vec::new(),
            held: Held::default(),
            palms: Default::default(),
        }
    }

    /// Places what was detected in pixels. Without depth, objects are placed by their corners alone, and hands are as high as
    /// they were, for half a second.
    ///
    /// # Errors
    /// [`MetricError::Perception`] when OpenCV fails.
    pub fn place(
        &mut self,
        depth: Option<DepthImage<'_>>,
        seen: &Detections,
    ) -> Result<MetricScene, MetricError> {
        let mut scene = MetricScene::default();
        let rig = self.rig;
        let sampler = depth.map(|image| Sampler::new(image, &rig));
        for object in &seen.objects {
            if let Some(placed) = self.object(sampler.as_ref(), object, seen.captured_ns)? {
                // There is room: a frame's detections have room for no more.
                let _ = scene.objects.push(placed);
            }
        }
        // There is room, as above.
        scene.hands.extend(seen.hands.iter().map(|hand| self.hand(sampler.as_ref(), hand, seen.captured_ns)));
        let hand = |&MetricHand { side, landmarks_m, .. }: &MetricHand| PlacedHand { side, landmarks_m };
        let hands: Vec<_, HANDS> = scene.hands.iter().map(hand).collect();
        let object = |&MetricObject { id, position_m, orientation, .. }: &MetricObject| PlacedObject {
            id,
            position_m,
            orientation,
        };
        let objects: Vec<_, OBJECTS> = scene.objects.iter().map(object).collect();
        scene.held = self.held.step(seen.captured_ns, &hands, &objects);
        Ok(scene)
    }

    fn object(
        &mut self,
        depth: Option<&Sampler<'_>>,
        object: &ObjectDetection,
        now_ns: u64,
    ) -> Result<Option<MetricObject>, MetricError> {
        let Some(known) = self.objects.iter().find(|known| known.id == object.id) else { return Ok(None) };
        let corners = object.corners_px.map(|corner| corner.map(f64::from));
        let candidates = pose::candidates(&corners, f64::from(known.side_m), &self.rig.colour)?;
        let patch = depth.and_then(|depth| depth.patch(&corners));
        let at = self.remembered.iter().position(|remembered| remembered.id == object.id);
        let before = at.map(|at| {
            let Remembered { camera_from_marker, seen_ns, .. } = self.remembered[at];
            pose::Before { camera_from_marker, ago_ns: now_ns.saturating_sub(seen_ns) }
        });
        let Some(pose) = pose::choose(&candidates, patch.as_ref(), before.as_ref()) else { return Ok(None) };
        let now = Remembered { id: object.id, camera_from_marker: pose.camera_from_marker, seen_ns: now_ns };
        match at {
            Some(at) => self.remembered[at] = now,
            // There is room: as many as there are objects.
            None => drop(self.remembered.push(now)),
        }
        let Isometry3 { rotation, translation } = self.bench.bench_from_camera * pose.camera_from_marker;
        let [x, y, z, w] = rotation.coords.into();
        Ok(Some(MetricObject {
            id: object.id,
            position_m: translation.vector.map(|value| value as f32).into(),
            orientation: [w, x, y, z].map(|value: f64| value as f32),
            unambiguous: pose.unambiguous,
        }))
    }

    fn hand(&mut self, depth: Option<&Sampler<'_>>, hand: &HandDetection, now_ns: u64) -> MetricHand {
        let outline = hand::Outline::new(&hand.landmarks_px, &hand.shape_m);
        let memory = &mut self.palms[hand.side as usize];
        let Some(placed) = outline.place(depth, &self.rig.colour, now_ns, memory) else {
            return MetricHand { side: hand.side, landmarks_m: [[f32::NAN; 3]; LANDMARKS], measured: 0.0 };
        };
        let in_bench = |point: Point3<f64>| {
            (self.bench.bench_from_camera * point).coords.map(|value| value as f32).into()
        };
        let measured = placed.sources.iter().filter(|&&source| source == hand::DepthSource::Measured).count();
        MetricHand {
            side: hand.side,
            landmarks_m: placed.points.map(in_bench),
            measured: measured as f32 / LANDMARKS as f32,
        }
    }
}

#[cfg(test)]
mod tests;
