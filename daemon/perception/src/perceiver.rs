//! Puts markers, hands and the bench together.

use crate::bench::{Bench, Calibration};
use crate::carried::{CarriedObjects, PlacedHand};
use crate::config::{HandsConfig, MarkersConfig, PerceptionConfig};
use crate::detections::{Detections, HANDS, HandDetection, OBJECTS, ObjectDetection, PlacedObject, Side};
use crate::error::PerceptionError;
use crate::hands::{OnnxModels, Tracker};
use crate::image::ImageView;
use crate::markers::{Marker, Markers};
use crate::picture::Picture;
use crate::points::PixelPoint;
use std::time::Instant;

/// Frames in, detections out.
///
/// One perceiver follows one camera: it remembers hands and scale from frame to frame.
pub struct Perceiver {
    markers: Markers,
    /// None where no hand is wanted.
    hands: Option<Tracker<OnnxModels>>,
    bench: Bench,
    carried: CarriedObjects,
}

impl Perceiver {
    /// Checks the configuration, then loads the models. Without a calibration the sizes of the markers alone give the scale,
    /// and the image plane must be parallel to the bench (paper IV).
    ///
    /// # Errors
    /// [`PerceptionError::Setting`]; [`PerceptionError::Missing`], [`PerceptionError::Unreadable`],
    /// [`PerceptionError::Corrupt`] and [`PerceptionError::Refused`] for a model or ONNX Runtime.
    pub fn new(config: &PerceptionConfig, calibration: Option<Calibration>) -> Result<Self, PerceptionError> {
        let PerceptionConfig { runtime, hands, markers } = config;
        check_hands(hands)?;
        check_markers(markers)?;
        let models = match hands.sides.is_empty() {
            true => None,
            false => Some(OnnxModels::new(runtime, hands)?),
        };
        Ok(Self {
            markers: Markers::new(markers)?,
            hands: models.map(|models| Tracker::new(models, hands.clone())),
            bench: Bench::new(calibration, &markers.objects),
            carried: CarriedObjects::default(),
        })
    }

    /// The detections of a frame. Frames come in order of their time; `image` is read in place.
    ///
    /// # Errors
    /// [`PerceptionError::OpenCv`], [`PerceptionError::Inference`]; [`PerceptionError::CalibratedFor`] when the calibration
    /// is for pictures of another size. The perceiver stays usable.
    pub fn perceive(
        &mut self,
        image: ImageView<'_>,
        captured_ns: u64,
    ) -> Result<Detections, PerceptionError> {
        let mut detections = Detections { captured_ns, ..Detections::default() };
        self.perceive_objects(&image, &mut detections)?;
        self.perceive_hands(&image, &mut detections)?;
        self.follow_carried(&mut detections);
        Ok(detections)
    }

    fn perceive_objects(
        &mut self,
        image: &ImageView<'_>,
        detections: &mut Detections,
    ) -> Result<(), PerceptionError> {
        let began = Instant::now();
        let found =
            self.markers.find(image, self.bench.min_side_px(), |id| self.bench.side_m(id).is_some())?;
        self.bench.see([image.width(), image.height()], &found, detections.captured_ns)?;
        detections.foreign_markers = self.markers.foreign();
        detections.picture = Picture::of(image, &self.markers.gray(image)?);
        detections.objects = found.iter().filter_map(|marker| placed(&self.bench, marker)).collect();
        detections.spent.markers_ns = began.elapsed().as_nanos() as u64;
        Ok(())
    }

    fn perceive_hands(
        &mut self,
        image: &ImageView<'_>,
        detections: &mut Detections,
    ) -> Result<(), PerceptionError> {
        let Some(tracker) = &mut self.hands else { return Ok(()) };
        for found in tracker.step(image, detections.captured_ns, &mut detections.spent)? {
            let landmarks_m = self.bench.hand(found.side as usize, &found.landmarks_px.map(PixelPoint::from));
            let hand = HandDetection {
                side: found.side,
                score: found.score,
                landmarks_px: found.landmarks_px,
                shape_m: found.shape_m,
                landmarks_m: landmarks_m.map_or([[f32::NAN; 2]; _], |points| points.map(Into::into)),
            };
            // There is room: the tracker follows no more hands than fit.
            let _ = detections.hands.push(hand);
        }
        detections.hands_in_view = tracker.followed();
        Ok(())
    }

    fn follow_carried(&mut self, detections: &mut Detections) {
        let hands: heapless::Vec<_, HANDS> = detections.hands.iter().map(PlacedHand::from).collect();
        let objects: heapless::Vec<_, OBJECTS> = detections.objects.iter().map(PlacedObject::from).collect();
        detections.carried = self.carried.step(detections.captured_ns, &hands, &objects);
    }
}

fn placed(bench: &Bench, marker: &Marker) -> Option<ObjectDetection> {
    let placed = bench.place(marker)?;
    let (sin, cos) = (placed.yaw / 2.0).sin_cos();
    Some(ObjectDetection {
        id: marker.id,
        corners_px: marker.corners.map(Into::into),
        position_m: [placed.position.x as f32, placed.position.y as f32, 0.0],
        orientation: [cos as f32, 0.0, 0.0, sin as f32],
        quality: marker.quality as f32,
    })
}

fn refused(key: &'static str, value: impl ToString, range: &'static str) -> Result<(), PerceptionError> {
    Err(PerceptionError::Setting { key, value: value.to_string(), range })
}

fn check_hands(config: &HandsConfig) -> Result<(), PerceptionError> {
    let HandsConfig { sides, min_palm_score, min_hand_score, search_every_frames, .. } = config;
    if sides.len() > 2 || matches!(sides.as_slice(), [Side::Left, Side::Left] | [Side::Right, Side::Right]) {
        return refused("sides", format!("{sides:?}"), "each hand at most once");
    }
    for (key, score) in [("min_palm_score", min_palm_score), ("min_hand_score", min_hand_score)] {
        if !(0.0..=1.0).contains(score) {
            return refused(key, score, "0 to 1");
        }
    }
    if *search_every_frames == 0 {
        return refused("search_every_frames", 0, "1 or more");
    }
    Ok(())
}

fn check_markers(config: &MarkersConfig) -> Result<(), PerceptionError> {
    let MarkersConfig { dictionary, objects, threshold_constant } = config;
    if objects.len() > OBJECTS {
        return refused("objects", format!("a list of {}", objects.len()), "at most 32");
    }
    for (index, object) in objects.iter().enumerate() {
        if objects[..index].iter().any(|other| other.id == object.id) {
            return refused("id", object.id, "each object's id is its own");
        }
        // Also refuses NaN.
        if !(object.side_m > 0.0 && object.side_m.is_finite()) {
            return refused("side_m", object.side_m, "over 0 m");
        }
        if usize::from(object.id) >= dictionary.markers() {
            return refused("id", object.id, "an id of the marker dictionary");
        }
    }
    if !(0.0..=100.0).contains(threshold_constant) {
        return refused("threshold_constant", threshold_constant, "0 to 100");
    }
    Ok(())
}
