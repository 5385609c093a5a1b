//! Puts markers, hands and the bench together.

use crate::bench::Bench;
use crate::config::{HandsConfig, PerceptionConfig};
use crate::detections::{Detections, Flags, HANDS, HandDetection, OBJECTS, ObjectDetection, Side, Spent};
use crate::error::PerceptionError;
use crate::hands::{OnnxModels, Tracker};
use crate::held::{Held, PlacedHand, PlacedObject};
use crate::image::ImageView;
use crate::markers::{Marker, Markers};
use std::time::Instant;

/// Frames in, detections out.
///
/// One perceiver follows one camera: it remembers hands and scale from frame to frame.
pub struct Perceiver {
    config: PerceptionConfig,
    markers: Markers,
    /// None where no hand is wanted.
    hands: Option<Tracker<OnnxModels>>,
    bench: Bench,
    held: Held,
}

impl Perceiver {
    /// Checks the configuration, then loads the models.
    ///
    /// # Errors
    /// [`PerceptionError::Setting`]; [`PerceptionError::Missing`], [`PerceptionError::Unreadable`],
    /// [`PerceptionError::Corrupt`] and [`PerceptionError::Refused`] for a model or ONNX Runtime.
    pub fn new(config: &PerceptionConfig) -> Result<Self, PerceptionError> {
        check(config)?;
        let hands = match config.hands.sides.is_empty() {
            true => None,
            false => {
                Some(Tracker::new(OnnxModels::new(&config.runtime, &config.hands)?, config.hands.clone()))
            }
        };
        Ok(Self {
            config: config.clone(),
            markers: Markers::new(&config.markers)?,
            hands,
            bench: Bench::new(&config.bench, &config.markers.objects),
            held: Held::default(),
        })
    }

    /// What is to be seen in a frame. Frames come in order of their time; `image` is read in place.
    ///
    /// # Errors
    /// [`PerceptionError::OpenCv`], [`PerceptionError::Inference`]; [`PerceptionError::CalibratedFor`] when the calibration
    /// is for pictures of another size. The perceiver stays usable.
    pub fn perceive(
        &mut self,
        image: ImageView<'_>,
        captured_ns: u64,
        frame_seq: u64,
    ) -> Result<Detections, PerceptionError> {
        let mut detections = Detections { frame_seq, captured_ns, ..Detections::default() };
        self.perceive_objects(&image, &mut detections)?;
        self.perceive_hands(&image, &mut detections)?;
        self.follow_what_is_held(&mut detections);
        Ok(detections)
    }

    fn follow_what_is_held(&mut self, detections: &mut Detections) {
        let hand = |hand: &HandDetection| PlacedHand {
            side: hand.side,
            landmarks_m: hand.landmarks_m.map(|[x, y]| [x, y, 0.0]),
        };
        let object = |object: &ObjectDetection| PlacedObject {
            id: object.id,
            position_m: object.position_m,
            orientation: object.orientation,
        };
        let hands: heapless::Vec<_, HANDS> = detections.hands.iter().map(hand).collect();
        let objects: heapless::Vec<_, OBJECTS> = detections.objects.iter().map(object).collect();
        detections.held = self.held.step(detections.captured_ns, &hands, &objects);
    }

    fn perceive_objects(
        &mut self,
        image: &ImageView<'_>,
        detections: &mut Detections,
    ) -> Result<(), PerceptionError> {
        let begin = Instant::now();
        let objects = &self.config.markers.objects;
        let wanted = |id: u16| objects.iter().any(|object| object.id == id);
        let seen = self.markers.find(image, self.bench.least_side_px(), wanted)?;
        self.bench.see([image.width(), image.height()], &seen, detections.captured_ns)?;
        detections.objects = seen.iter().filter_map(|marker| placed(&self.bench, marker)).collect();
        detections.spent.markers_ns = begin.elapsed().as_nanos() as u64;
        Ok(())
    }

    fn perceive_hands(
        &mut self,
        image: &ImageView<'_>,
        detections: &mut Detections,
    ) -> Result<(), PerceptionError> {
        let Some(tracker) = &mut self.hands else { return Ok(()) };
        let mut spent = Spent::default();
        let tracked = tracker.step(image, detections.captured_ns, &mut spent)?;
        detections.spent.palm_ns = spent.palm_ns;
        detections.spent.landmarks_ns = spent.landmarks_ns;
        let Flags { palm_detection_ran, after_gap, no_scale } = &mut detections.flags;
        (*palm_detection_ran, *after_gap) = (tracked.palm_detection_ran, tracked.after_gap);
        for found in &tracked.hands {
            let landmarks_m = self.bench.hand(found.side as usize, &found.landmarks);
            *no_scale |= landmarks_m.is_none();
            let hand = HandDetection {
                side: found.side,
                score: found.score,
                landmarks_px: found.landmarks,
                shape_m: found.shape,
                landmarks_m: landmarks_m.unwrap_or([[f32::NAN; 2]; _]),
            };
            // There is room: the tracker follows no more hands than fit.
            let _ = detections.hands.push(hand);
        }
        Ok(())
    }
}

fn placed(bench: &Bench, marker: &Marker) -> Option<ObjectDetection> {
    let placed = bench.place(marker)?;
    let (sin, cos) = (placed.yaw / 2.0).sin_cos();
    Some(ObjectDetection {
        id: marker.id,
        corners_px: marker.corners.map(|corner| corner.map(|value| value as f32)),
        position_m: [placed.position[0] as f32, placed.position[1] as f32, 0.0],
        orientation: [cos as f32, 0.0, 0.0, sin as f32],
        quality: marker.quality as f32,
    })
}

fn check(config: &PerceptionConfig) -> Result<(), PerceptionError> {
    let setting = |key, value: String, range| Err(PerceptionError::Setting { key, value, range });
    let HandsConfig { sides, least_palm_score, least_hand_score, search_every_frames, .. } = &config.hands;
    if sides.len() > 2 || matches!(sides.as_slice(), [Side::Left, Side::Left] | [Side::Right, Side::Right]) {
        return setting("sides", format!("{sides:?}"), "each hand at most once");
    }
    for (key, score) in [("least_palm_score", least_palm_score), ("least_hand_score", least_hand_score)] {
        if !(0.0..=1.0).contains(score) {
            return setting(key, score.to_string(), "0 to 1");
        }
    }
    if *search_every_frames == 0 {
        return setting("search_every_frames", "0".into(), "1 or more");
    }
    let markers = &config.markers;
    if markers.objects.len() > OBJECTS {
        return setting("objects", format!("a list of {}", markers.objects.len()), "at most 32");
    }
    for (place, object) in markers.objects.iter().enumerate() {
        if markers.objects[..place].iter().any(|other| other.id == object.id) {
            return setting("id", object.id.to_string(), "each object's id is its own");
        }
        // Also refuses NaN.
        if !(object.side_m > 0.0 && object.side_m.is_finite()) {
            return setting("side_m", object.side_m.to_string(), "over 0 m");
        }
        if usize::from(object.id) >= markers.dictionary.markers() {
            return setting("id", object.id.to_string(), "an id of the marker dictionary");
        }
    }
    if !(0.0..=100.0).contains(&markers.threshold_constant) {
        return setting("threshold_constant", markers.threshold_constant.to_string(), "0 to 100");
    }
    Ok(())
}
