//! The two hand models on ONNX Runtime.

use super::crop::{Border, Cropper};
use super::light::brighten;
use super::palm::{self, PalmDecoder, Palms};
use super::region::Region;
use super::runtime;
use crate::config::{HandsConfig, ModelSize};
use crate::detections::{LANDMARKS, Side};
use crate::error::{PerceptionError, RuntimeFile};
use crate::image::ImageView;
use ort::session::{Session, SessionOutputs};
use ort::value::TensorRef;
use std::path::Path;

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

/// The models behind the tracker. Tests put scripted ones in their place.
pub(crate) trait HandModels {
    /// Palms anywhere in the picture, best first.
    fn palms(&mut self, image: &ImageView<'_>) -> Result<Palms, PerceptionError>;
    /// The hand in a region.
    fn landmarks(&mut self, image: &ImageView<'_>, region: Region) -> Result<Landmarks, PerceptionError>;
}

/// The MediaPipe models.
pub(crate) struct OnnxModels {
    palm: Session,
    landmark: Session,
    decoder: PalmDecoder,
    min_palm_score: f32,
    cropper: Cropper,
    palm_input: Vec<f32>,
    landmark_input: Vec<f32>,
}

impl OnnxModels {
    pub(crate) fn new(folder: &Path, config: &HandsConfig) -> Result<Self, PerceptionError> {
        let environment = runtime::environment(folder)?;
        let (palm, landmark) = (
            match config.palm_model {
                ModelSize::Full => "palm_detection_full.onnx",
                ModelSize::Lite => "palm_detection_lite.onnx",
            },
            match config.landmark_model {
                ModelSize::Full => "hand_landmark_full.onnx",
                ModelSize::Lite => "hand_landmark_lite.onnx",
            },
        );
        Ok(Self {
            palm: runtime::session(&environment, folder, palm, RuntimeFile::PalmModel)?,
            landmark: runtime::session(&environment, folder, landmark, RuntimeFile::LandmarkModel)?,
            decoder: PalmDecoder::new(),
            min_palm_score: config.min_palm_score,
            cropper: Cropper::default(),
            palm_input: vec![0.0; palm::INPUT * palm::INPUT * 3],
            landmark_input: vec![0.0; INPUT * INPUT * 3],
        })
    }
}

impl HandModels for OnnxModels {
    fn palms(&mut self, image: &ImageView<'_>) -> Result<Palms, PerceptionError> {
        let whole = Region::whole(image.width(), image.height());
        self.cropper.crop(image, whole, palm::INPUT, Border::Black, &mut self.palm_input)?;
        brighten(&mut self.palm_input);
        let outputs = run(&mut self.palm, RuntimeFile::PalmModel, palm::INPUT, &self.palm_input)?;
        let candidates = self.decoder.candidates();
        let boxes = output(&outputs, RuntimeFile::PalmModel, "Identity", 18 * candidates)?;
        let logits = output(&outputs, RuntimeFile::PalmModel, "Identity_1", candidates)?;
        Ok(self.decoder.decode(boxes, logits, self.min_palm_score, whole))
    }

    fn landmarks(&mut self, image: &ImageView<'_>, region: Region) -> Result<Landmarks, PerceptionError> {
        self.cropper.crop(image, region, INPUT, Border::Nearest, &mut self.landmark_input)?;
        brighten(&mut self.landmark_input);
        let outputs = run(&mut self.landmark, RuntimeFile::LandmarkModel, INPUT, &self.landmark_input)?;
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
