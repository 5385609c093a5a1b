//! What the [`Perceiver`](crate::Perceiver) is told before the first frame.

use crate::bench::Calibration;
use crate::detections::Side;
use crate::markers::Dictionary;
use std::path::PathBuf;

/// Everything the perceiver needs to know.
#[derive(Clone, Debug)]
pub struct PerceptionConfig {
    /// Folder of the hand models and `libonnxruntime.so`, filled by `models/provision.py`.
    pub runtime: PathBuf,
    /// How hands are found.
    pub hands: HandsConfig,
    /// How objects are found.
    pub markers: MarkersConfig,
    /// How pixels become metres.
    pub bench: BenchConfig,
}

impl PerceptionConfig {
    /// The right hand and these objects with the default settings.
    pub fn new(runtime: impl Into<PathBuf>, objects: Vec<MarkerObject>) -> Self {
        Self {
            runtime: runtime.into(),
            hands: HandsConfig::default(),
            markers: MarkersConfig { objects, ..MarkersConfig::default() },
            bench: BenchConfig::default(),
        }
    }
}

/// Which of the two sizes of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelSize {
    /// The larger and more accurate one.
    Full,
    /// The smaller and faster one.
    Lite,
}

/// How hands are found.
#[derive(Clone, Debug, PartialEq)]
pub struct HandsConfig {
    /// The hands that are wanted; empty finds none and loads no model.
    pub sides: Vec<Side>,
    /// Palm detection, which runs only while a hand is looked for.
    pub palm_model: ModelSize,
    /// Landmarks, which run on every frame for every hand.
    pub landmark_model: ModelSize,
    /// Least score of a palm, 0..1; MediaPipe's default is 0.5.
    pub least_palm_score: f32,
    /// Least score of a hand's landmarks, 0..1; under it the hand is lost. MediaPipe's default is 0.5.
    pub least_hand_score: f32,
    /// While one hand is followed and another is wanted, palm detection runs on every so many frames.
    pub search_every_frames: u32,
    /// A pause between two frames longer than this is a gap: hands are looked for anew, in milliseconds.
    pub gap_ms: u32,
}

impl Default for HandsConfig {
    fn default() -> Self {
        Self {
            sides: vec![Side::Right],
            palm_model: ModelSize::Full,
            landmark_model: ModelSize::Full,
            least_palm_score: 0.5,
            least_hand_score: 0.5,
            // A second hand is found within a third of a second at 30 fps, for a tenth of the cost.
            search_every_frames: 10,
            // Three frames at 30 fps: a hand at 1 m/s has moved by its own length.
            gap_ms: 100,
        }
    }
}

/// An object that carries a marker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkerObject {
    /// The marker's id in its dictionary, which is the object's.
    pub id: u16,
    /// Side of the black square in metres.
    pub side_m: f32,
}

/// How objects are found.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkersConfig {
    /// The markers' dictionary.
    pub dictionary: Dictionary,
    /// The objects; markers of other ids are ignored.
    pub objects: Vec<MarkerObject>,
    /// How much darker than its surroundings a pixel must be to count as black, in grey levels of 255.
    pub threshold_constant: f64,
}

impl Default for MarkersConfig {
    fn default() -> Self {
        Self {
            dictionary: Dictionary::default(),
            objects: Vec::new(),
            // OpenCV's own default is 7, which loses markers in dim light; 3 keeps them and stays above the noise of a camera.
            threshold_constant: 3.0,
        }
    }
}

/// How pixels become metres.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum BenchConfig {
    /// From the sizes of the markers alone; the image plane is parallel to the bench (paper IV).
    #[default]
    FromMarkers,
    /// From a calibration.
    Calibrated(Calibration),
}
