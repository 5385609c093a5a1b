//! The settings of a [`Perceiver`](crate::Perceiver).

use crate::detections::Side;
use crate::dictionary::Dictionary;
use std::path::PathBuf;

/// The settings of a [`Perceiver`](crate::Perceiver).
#[derive(Clone, Debug, PartialEq)]
pub struct PerceptionConfig {
    /// Folder of the hand models and `libonnxruntime.so`, filled by `models/provision.py`.
    pub runtime: PathBuf,
    /// How hands are found.
    pub hands: HandsConfig,
    /// How objects are found.
    pub markers: MarkersConfig,
    /// Who looks.
    pub threads: ThreadsConfig,
}

/// The threads that look at a picture side by side.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ThreadsConfig {
    /// Number of threads; with one, everything is done by the caller.
    pub count: usize,
}

impl Default for ThreadsConfig {
    fn default() -> Self {
        // Markers beside a hand, or one hand beside another: a third thread would have nothing to do.
        Self { count: 2 }
    }
}

/// The sizes of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelSize {
    /// The larger and more accurate one.
    Full,
    /// The larger one of landmarks, most of whose convolutions compute with bytes. Palms have only the larger one.
    Quantised,
    /// The smaller and faster one.
    Lite,
}

/// How hands are found.
#[derive(Clone, Debug, PartialEq)]
pub struct HandsConfig {
    /// The hands that are wanted. Where there are none, no hand is looked for and no model is loaded.
    pub sides: Vec<Side>,
    /// The model that detects palms. It runs only while a hand is looked for.
    pub palm_model: ModelSize,
    /// The model that finds landmarks. It runs on every frame for every hand.
    pub landmark_model: ModelSize,
    /// Minimum score of a palm, 0..1; MediaPipe's default is 0.5.
    pub min_palm_score: f32,
    /// Minimum score of a hand's landmarks, 0..1; below it the hand is lost. MediaPipe's default is 0.5.
    pub min_hand_score: f32,
    /// While one hand is followed and another is wanted, palm detection runs once per this number of frames.
    pub search_every_frames: u32,
    /// A longer pause between two frames, in milliseconds, is a gap, after which palm detection runs.
    pub gap_ms: u32,
}

impl Default for HandsConfig {
    fn default() -> Self {
        Self {
            sides: vec![Side::Right],
            palm_model: ModelSize::Full,
            // As exact as the full one in every measurement, in half the time.
            landmark_model: ModelSize::Quantised,
            min_palm_score: 0.5,
            min_hand_score: 0.5,
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
    /// The object's id.
    pub id: u16,
    /// The marker's id in its dictionary.
    pub marker: u16,
    /// Side of the black square in metres.
    pub side_m: f32,
}

/// Where markers are looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkerSearch {
    /// While all are seen, around the places where they were. As soon as one is missing there, and now and then, in the whole picture.
    Near,
    /// In the whole picture of every frame.
    Whole,
}

/// How objects are found.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkersConfig {
    /// The markers' dictionary.
    pub dictionary: Dictionary,
    /// The objects that carry a marker; other markers are ignored.
    pub objects: Vec<MarkerObject>,
    /// How much darker than its surroundings a pixel must be to count as black, in grey levels of 255.
    pub threshold_constant: f64,
    /// Where they are looked for.
    pub search: MarkerSearch,
}

impl Default for MarkersConfig {
    fn default() -> Self {
        Self {
            dictionary: Dictionary::default(),
            objects: Vec::new(),
            // OpenCV's own default of 7 loses markers in dim light; 3 keeps them and stays above the noise of a camera.
            threshold_constant: 3.0,
            // It finds the same markers.
            search: MarkerSearch::Near,
        }
    }
}
