//! Perception as the configuration describes it.

use andon_core::input::Side;
use andon_host::config::{Config, HandModel};
use andon_perception::bench::{Calibration, CalibrationError};
use andon_perception::config::{HandsConfig, MarkerObject, MarkersConfig, ModelSize, ThreadsConfig};
use andon_perception::detections;
use andon_perception::{Perceiver, PerceptionConfig, PerceptionError};

/// Why there is no perceiver.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// A model or the library that runs them.
    #[error(transparent)]
    Perception(#[from] PerceptionError),
    /// The calibration of the bench.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
}

/// A perceiver for one stream of frames.
///
/// # Errors
/// The model, the library or the calibration that is missing or damaged, and what to run.
pub fn perceiver(config: &Config) -> Result<Perceiver, SetupError> {
    let settings = PerceptionConfig {
        runtime: config.perception.models.clone(),
        hands: hands(config),
        markers: markers(config),
        threads: ThreadsConfig::default(),
    };
    Ok(Perceiver::new(&settings, calibration(config)?)?)
}

/// The calibration that the configuration names, if it names one.
///
/// # Errors
/// A calibration that cannot be read.
pub fn calibration(config: &Config) -> Result<Option<Calibration>, CalibrationError> {
    config.bench.calibration.as_deref().map(Calibration::load).transpose()
}

fn hands(config: &Config) -> HandsConfig {
    let size = match config.perception.hand_model {
        HandModel::Full => ModelSize::Full,
        HandModel::Quantised => ModelSize::Quantised,
        HandModel::Lite => ModelSize::Lite,
    };
    let side = |side: &Side| match side {
        Side::Right => detections::Side::Right,
        Side::Left => detections::Side::Left,
    };
    HandsConfig {
        sides: config.perception.hands.iter().map(side).collect(),
        palm_model: size,
        landmark_model: size,
        ..HandsConfig::default()
    }
}

/// The objects that are looked for by their markers.
pub fn marker_objects(config: &Config) -> Vec<MarkerObject> {
    let object = |object: &andon_host::config::Object| {
        let (marker, side_m) = (object.marker_id()?, object.marker_side_m?);
        Some(MarkerObject { id: object.id, marker, side_m })
    };
    config.objects.iter().filter_map(object).collect()
}

fn markers(config: &Config) -> MarkersConfig {
    MarkersConfig {
        dictionary: config.perception.dictionary,
        objects: marker_objects(config),
        search: config.perception.marker_search,
        ..MarkersConfig::default()
    }
}
