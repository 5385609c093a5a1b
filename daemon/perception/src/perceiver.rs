//! Puts markers, hands and the bench together.

use crate::bench::{Bench, Calibration};
use crate::config::{HandsConfig, MarkersConfig, PerceptionConfig, ThreadsConfig};
use crate::detections::{Detections, HANDS, HandDetection, OBJECTS, ObjectDetection, Side, Timings};
use crate::error::PerceptionError;
use crate::finder::{FoundObjects, ObjectFinder, SeenObject};
use crate::hands::{Found, OnnxLandmarks, OnnxPalms, Tracker};
use crate::image::ImageView;
use crate::markers::MarkedObjects;
use crate::picture::Picture;
use crate::points::PixelPoint;
use crate::workers::Workers;
use std::path::Path;
use std::time::Instant;
use tracing::trace_span;

/// More threads than a picture has parts to look at are of no use.
const MAX_THREADS: usize = 8;

/// Frames in, detections out.
///
/// One perceiver follows one camera: it remembers hands and scale from frame to frame.
pub struct Perceiver {
    marked: MarkedObjects,
    /// What finds the objects that carry no marker.
    finders: Vec<Box<dyn ObjectFinder>>,
    /// None where no hand is wanted.
    hands: Option<Tracker<OnnxPalms, OnnxLandmarks>>,
    workers: Workers,
    bench: Bench,
}

impl Perceiver {
    /// Checks the configuration, then loads the models. Without a calibration the sizes of the markers alone give the scale,
    /// and the image plane must be parallel to the bench (paper IV).
    ///
    /// # Errors
    /// [`PerceptionError::Setting`]; [`PerceptionError::Missing`], [`PerceptionError::Unreadable`],
    /// [`PerceptionError::Corrupt`] and [`PerceptionError::Refused`] for a model or ONNX Runtime.
    pub fn new(config: &PerceptionConfig, calibration: Option<Calibration>) -> Result<Self, PerceptionError> {
        let PerceptionConfig { runtime, hands, markers, threads } = config;
        check_hands(hands)?;
        check_markers(markers)?;
        check_threads(threads)?;
        Ok(Self {
            marked: MarkedObjects::new(markers)?,
            finders: Vec::new(),
            hands: if hands.sides.is_empty() { None } else { Some(tracker(runtime, hands)?) },
            workers: Workers::new(threads)?,
            bench: Bench::new(calibration, &markers.objects),
        })
    }

    /// Also looks for what this finds. Of an object that several find, the first counts.
    #[must_use]
    pub fn with_finder(mut self, finder: Box<dyn ObjectFinder>) -> Self {
        self.finders.push(finder);
        self
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
        let _span = trace_span!("frame").entered();
        let mut detections = Detections { captured_ns, ..Detections::default() };
        let Self { marked, finders, hands, workers, bench, .. } = self;
        // Both look at the same picture, and neither needs what the other finds.
        let (seen, objects) = workers.join(
            || see_hands(hands, workers, &image, captured_ns),
            || see_objects(marked, finders, bench, &image, captured_ns),
        );
        let _span = trace_span!("place").entered();
        objects?.enter(&mut detections);
        self.enter_hands(&seen?, &mut detections);
        Ok(detections)
    }

    /// Places the hands on the bench, whose scale depends on the markers of the same picture.
    fn enter_hands(&mut self, seen: &SeenHands, detections: &mut Detections) {
        for found in &seen.hands {
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
        detections.hands_in_view = seen.in_view;
        detections.timings.palm_ns = seen.timings.palm_ns;
        detections.timings.landmarks_ns = seen.timings.landmarks_ns;
    }
}

fn tracker(
    runtime: &Path,
    config: &HandsConfig,
) -> Result<Tracker<OnnxPalms, OnnxLandmarks>, PerceptionError> {
    let palms = OnnxPalms::new(runtime, config)?;
    // A second hand that is followed only until it is known whose it is takes its turn with the first one's model.
    let landmarks = config.sides.iter().map(|_| OnnxLandmarks::new(runtime, config.landmark_model));
    let landmarks = landmarks.collect::<Result<_, _>>()?;
    Ok(Tracker::new(palms, landmarks, config.clone()))
}

/// The hands of a picture, in pixels.
#[derive(Default)]
struct SeenHands {
    hands: heapless::Vec<Found, HANDS>,
    in_view: usize,
    timings: Timings,
}

fn see_hands(
    tracker: &mut Option<Tracker<OnnxPalms, OnnxLandmarks>>,
    workers: &Workers,
    image: &ImageView<'_>,
    captured_ns: u64,
) -> Result<SeenHands, PerceptionError> {
    let _span = trace_span!("hands").entered();
    let mut seen = SeenHands::default();
    if let Some(tracker) = tracker {
        seen.hands = tracker.step(image, captured_ns, workers, &mut seen.timings)?;
        seen.in_view = tracker.followed();
    }
    Ok(seen)
}

/// The objects of a picture on the bench, and its measures.
struct SeenObjects {
    objects: heapless::Vec<ObjectDetection, OBJECTS>,
    twice: heapless::Vec<u16, OBJECTS>,
    foreign_markers: usize,
    picture: Picture,
    markers_ns: u64,
}

impl SeenObjects {
    fn enter(self, detections: &mut Detections) {
        detections.objects = self.objects;
        detections.twice = self.twice;
        detections.foreign_markers = self.foreign_markers;
        detections.picture = self.picture;
        detections.timings.markers_ns = self.markers_ns;
    }
}

fn see_objects(
    marked: &mut MarkedObjects,
    finders: &mut [Box<dyn ObjectFinder>],
    bench: &mut Bench,
    image: &ImageView<'_>,
    captured_ns: u64,
) -> Result<SeenObjects, PerceptionError> {
    let _span = trace_span!("markers").entered();
    let began = Instant::now();
    let found = find_all(marked, finders, image, bench.min_side_px())?;
    bench.see([image.width(), image.height()], &found.objects, captured_ns)?;
    let gray = marked.markers().gray(image)?;
    let picture = trace_span!("measures").in_scope(|| Picture::of(image, &gray));
    Ok(SeenObjects {
        objects: found.objects.iter().filter_map(|object| placed(bench, object)).collect(),
        twice: found.twice,
        foreign_markers: marked.markers().foreign(),
        picture,
        markers_ns: began.elapsed().as_nanos() as u64,
    })
}

/// What all finders have found, in the order of the ids.
fn find_all(
    marked: &mut MarkedObjects,
    finders: &mut [Box<dyn ObjectFinder>],
    image: &ImageView<'_>,
    min_side_px: Option<f64>,
) -> Result<FoundObjects, PerceptionError> {
    let mut found = marked.find(image, min_side_px)?;
    for finder in finders {
        found.add(finder.find(image, min_side_px)?);
    }
    found.objects.sort_unstable_by_key(|object| object.id);
    Ok(found)
}

fn placed(bench: &Bench, object: &SeenObject) -> Option<ObjectDetection> {
    let placed = bench.place(object)?;
    let (sin, cos) = (placed.yaw / 2.0).sin_cos();
    Some(ObjectDetection {
        id: object.id,
        corners_px: object.corners.map(Into::into),
        position_m: [placed.position.x as f32, placed.position.y as f32, 0.0],
        orientation: [cos as f32, 0.0, 0.0, sin as f32],
        quality: object.quality as f32,
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

fn check_threads(config: &ThreadsConfig) -> Result<(), PerceptionError> {
    if !(1..=MAX_THREADS).contains(&config.count) {
        return refused("threads", config.count, "1 to 8");
    }
    Ok(())
}

fn check_markers(config: &MarkersConfig) -> Result<(), PerceptionError> {
    let MarkersConfig { dictionary, objects, threshold_constant, .. } = config;
    if objects.len() > OBJECTS {
        return refused("objects", format!("a list of {}", objects.len()), "at most 32");
    }
    for (index, object) in objects.iter().enumerate() {
        if objects[..index].iter().any(|other| other.id == object.id) {
            return refused("id", object.id, "each object's id is its own");
        }
        if objects[..index].iter().any(|other| other.marker == object.marker) {
            return refused("marker", object.marker, "each object's marker is its own");
        }
        // Also refuses NaN.
        if !(object.side_m > 0.0 && object.side_m.is_finite()) {
            return refused("side_m", object.side_m, "over 0 m");
        }
        if usize::from(object.marker) >= dictionary.markers() {
            return refused("marker", object.marker, "an id of the marker dictionary");
        }
    }
    if !(0.0..=100.0).contains(threshold_constant) {
        return refused("threshold_constant", threshold_constant, "0 to 100");
    }
    Ok(())
}
