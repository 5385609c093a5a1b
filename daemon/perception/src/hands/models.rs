//! The two hand models on ONNX Runtime.
//!
//! The quantised landmark model computes in bytes, but for its first six convolutions and the last one. It takes half the time. On 118
//! hands of photographs its points are 0.25 % of the region's side away from those of the published model.

use super::crop::{Border, Cropper};
use super::light::brighten;
use super::palm::{self, PalmDecoder, Palms};
use super::region::Region;
use super::runtime;
use crate::config::{HandsConfig, ModelSize};
use crate::detections::{LANDMARKS, Side};
use crate::error::{PerceptionError, RuntimeFile};
use crate::image::ImageView;
use crate::workers;
use ort::session::{Session, SessionOutputs};
use ort::value::TensorRef;
use rayon::ThreadPool;
use std::path::Path;
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::Instant;
use tracing::trace_span;

/// Side of the landmark model's input in pixels.
const INPUT: usize = 224;

/// What the landmark model finds in a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Landmarks {
    /// As [`HandDetection::landmarks_px`](crate::detections::HandDetection::landmarks_px).
    pub(crate) points_px: [[f32; 2]; LANDMARKS],
    /// As [`HandDetection::shape_m`](crate::detections::HandDetection::shape_m).
    pub(crate) shape_m: [[f32; 3]; LANDMARKS],
    /// Probability that there is a hand, 0..1.
    pub(crate) presence: f32,
    /// Probability that it is a right hand, 0..1.
    pub(crate) right: f32,
}

impl Landmarks {
    /// Probability that it is a hand of this side, 0..1.
    pub(super) fn is_of(&self, side: Side) -> f32 {
        match side {
            Side::Right => self.right,
            Side::Left => 1.0 - self.right,
        }
    }
}

/// Finds the landmarks of a hand. Tests put a scripted one in its place.
pub(crate) trait LandmarkModel: Send {
    /// The hand in a region.
    fn landmarks(&mut self, image: &ImageView<'_>, region: Region) -> Result<Landmarks, PerceptionError>;
}

/// Finds palms. Tests put a scripted one in its place.
pub(crate) trait PalmModel {
    /// Palms anywhere in the picture, best first. What a search that has begun would find is forgotten.
    fn palms(&mut self, image: &ImageView<'_>) -> Result<Palms, PerceptionError>;
    /// Begins to search the picture, beside what its caller goes on with.
    fn begin(&mut self, image: &ImageView<'_>) -> Result<(), PerceptionError>;
    /// What the search that has begun finds, and how many nanoseconds it took.
    fn finish(&mut self) -> Result<(Palms, u64), PerceptionError>;
}

/// MediaPipe's landmark model.
pub(crate) struct OnnxLandmarks {
    session: Session,
    cropper: Cropper,
    input: Vec<f32>,
}

impl OnnxLandmarks {
    /// # Errors
    /// A file of the runtime folder that is missing, damaged or refused.
    pub(crate) fn new(folder: &Path, size: ModelSize) -> Result<Self, PerceptionError> {
        let file = match size {
            ModelSize::Full => "hand_landmark_full.onnx",
            ModelSize::Quantised => "hand_landmark_quantised.onnx",
            ModelSize::Lite => "hand_landmark_lite.onnx",
        };
        Ok(Self {
            session: runtime::session(folder, file, RuntimeFile::LandmarkModel)?,
            cropper: Cropper::default(),
            input: vec![0.0; INPUT * INPUT * 3],
        })
    }
}

impl LandmarkModel for OnnxLandmarks {
    fn landmarks(&mut self, image: &ImageView<'_>, region: Region) -> Result<Landmarks, PerceptionError> {
        trace_span!("crop").in_scope(|| {
            self.cropper.crop(image, region, INPUT, Border::Nearest, &mut self.input)?;
            brighten(&mut self.input);
            Ok::<_, PerceptionError>(())
        })?;
        let _span = trace_span!("landmark model").entered();
        let outputs = run(&mut self.session, RuntimeFile::LandmarkModel, INPUT, &self.input)?;
        let points = output(&outputs, RuntimeFile::LandmarkModel, "Identity", 3 * LANDMARKS)?;
        let presence = output(&outputs, RuntimeFile::LandmarkModel, "Identity_1", 1)?[0];
        let right = output(&outputs, RuntimeFile::LandmarkModel, "Identity_2", 1)?[0];
        let point = |index: usize| [points[3 * index] / INPUT as f32, points[3 * index + 1] / INPUT as f32];
        let shape = output(&outputs, RuntimeFile::LandmarkModel, "Identity_3", 3 * LANDMARKS)?;
        // The model sees the hand upright: its shape is turned back.
        let (sin, cos) = region.rotation.sin_cos();
        let turned = |index: usize| {
            let [x, y, z] = [0, 1, 2].map(|axis| shape[3 * index + axis]);
            [cos * x - sin * y, sin * x + cos * y, z]
        };
        Ok(Landmarks {
            points_px: std::array::from_fn(|index| region.to_image(point(index))),
            shape_m: std::array::from_fn(turned),
            presence,
            right,
        })
    }
}

/// MediaPipe's palm model, with a thread for searches that others do not wait for.
pub(crate) struct OnnxPalms {
    /// None while it runs in the thread.
    search: Option<Search>,
    running: Option<Receiver<(Search, Outcome)>>,
    thread: ThreadPool,
    cropper: Cropper,
}

/// What was found, or why nothing could be, and after how many nanoseconds.
type Outcome = Result<(Palms, u64), PerceptionError>;

impl OnnxPalms {
    /// # Errors
    /// A file of the runtime folder that is missing, damaged or refused; [`PerceptionError::Threads`].
    pub(crate) fn new(folder: &Path, config: &HandsConfig) -> Result<Self, PerceptionError> {
        let file = match config.palm_model {
            ModelSize::Full | ModelSize::Quantised => "palm_detection_full.onnx",
            ModelSize::Lite => "palm_detection_lite.onnx",
        };
        let search = Search {
            session: runtime::session(folder, file, RuntimeFile::PalmModel)?,
            decoder: PalmDecoder::new(),
            min_score: config.min_palm_score,
            input: vec![0.0; palm::INPUT * palm::INPUT * 3],
            whole: Region::whole(0, 0),
        };
        let thread = workers::aside()?;
        Ok(Self { search: Some(search), running: None, thread, cropper: Cropper::default() })
    }

    /// The search with the whole picture as its input. One that runs is waited for.
    fn loaded(&mut self, image: &ImageView<'_>) -> Result<Search, PerceptionError> {
        if let Some(running) = self.running.take() {
            self.search = running.recv().ok().map(|(search, _)| search);
        }
        let mut search = self.search.take().ok_or_else(lost)?;
        search.whole = Region::whole(image.width(), image.height());
        let _span = trace_span!("shrink").entered();
        self.cropper.crop(image, search.whole, palm::INPUT, Border::Black, &mut search.input)?;
        Ok(search)
    }
}

/// The thread has ended with the model: only a panic in it does that.
fn lost() -> PerceptionError {
    PerceptionError::Inference { what: RuntimeFile::PalmModel, reason: "its thread has ended".into() }
}

impl PalmModel for OnnxPalms {
    fn palms(&mut self, image: &ImageView<'_>) -> Result<Palms, PerceptionError> {
        let search = self.loaded(image)?;
        let search = self.search.insert(search);
        search.run()
    }

    fn begin(&mut self, image: &ImageView<'_>) -> Result<(), PerceptionError> {
        let mut search = self.loaded(image)?;
        let (give_back, running) = sync_channel(1);
        self.running = Some(running);
        self.thread.spawn(move || {
            let began = Instant::now();
            let found = search.run();
            let outcome = found.map(|palms| (palms, began.elapsed().as_nanos() as u64));
            // Nobody waits where the perceiver has ended meanwhile.
            let _ = give_back.send((search, outcome));
        });
        Ok(())
    }

    fn finish(&mut self) -> Result<(Palms, u64), PerceptionError> {
        let (search, outcome) =
            self.running.take().and_then(|running| running.recv().ok()).ok_or_else(lost)?;
        self.search = Some(search);
        outcome
    }
}

/// The palm model and what it reads.
struct Search {
    session: Session,
    decoder: PalmDecoder,
    min_score: f32,
    input: Vec<f32>,
    /// The square that the input shows.
    whole: Region,
}

impl Search {
    fn run(&mut self) -> Result<Palms, PerceptionError> {
        let _span = trace_span!("palm model").entered();
        brighten(&mut self.input);
        let outputs = run(&mut self.session, RuntimeFile::PalmModel, palm::INPUT, &self.input)?;
        let candidates = self.decoder.candidates();
        let boxes = output(&outputs, RuntimeFile::PalmModel, "Identity", 18 * candidates)?;
        let logits = output(&outputs, RuntimeFile::PalmModel, "Identity_1", candidates)?;
        Ok(self.decoder.decode(boxes, logits, self.min_score, self.whole))
    }
}

fn run<'s>(
    session: &'s mut Session,
    what: RuntimeFile,
    size: usize,
    input: &[f32],
) -> Result<SessionOutputs<'s>, PerceptionError> {
    let failed = |error: ort::Error| PerceptionError::Inference { what, reason: error.to_string() };
    let input = TensorRef::from_array_view(([1, size, size, 3], input)).map_err(failed)?;
    session.run(ort::inputs![input]).map_err(failed)
}

/// An output of the model by its name, with a known length.
fn output<'o>(
    outputs: &'o SessionOutputs<'_>,
    what: RuntimeFile,
    name: &str,
    length: usize,
) -> Result<&'o [f32], PerceptionError> {
    let failed = |reason: String| PerceptionError::Inference { what, reason };
    let value = outputs.get(name).ok_or_else(|| failed(format!("it has no output {name}")))?;
    let (_, data) = value.try_extract_tensor::<f32>().map_err(|error| failed(error.to_string()))?;
    if data.len() != length {
        return Err(failed(format!("its output {name} has {} numbers, not {length}", data.len())));
    }
    Ok(data)
}
