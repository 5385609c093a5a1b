//! The section `[perception]`.

use crate::config::keys::Keys;
use crate::config::value::{several, words};
use andon_core::capacity;
use andon_core::input::Side;
use andon_perception::Dictionary;
use andon_perception::config::MarkerSearch;
use std::path::PathBuf;

/// The weight of the hand models.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandModel {
    /// The larger ones.
    Full,
    /// The larger ones; that of landmarks computes most of its convolutions with bytes.
    Quantised,
    /// The smaller ones, which are less exact.
    Lite,
}
words!(HandModel {
    HandModel::Full = "full",
    HandModel::Quantised = "quantised",
    HandModel::Lite = "lite",
});

words!(MarkerSearch { MarkerSearch::Near = "near", MarkerSearch::Whole = "whole" });
words!(Side, Side::ALL, Side::name);
words!(Dictionary, Dictionary::all(), Dictionary::name);

/// `[perception]`: how hands and objects are found.
#[derive(Clone, Debug, PartialEq)]
pub struct Perception {
    /// Directory of the hand models and the ONNX Runtime library.
    pub models: PathBuf,
    /// The weight of the hand models.
    pub hand_model: HandModel,
    /// The hands that work here.
    pub hands: Vec<Side>,
    /// The dictionary of the markers.
    pub dictionary: Dictionary,
    /// Where markers are looked for.
    pub marker_search: MarkerSearch,
}

impl Default for Perception {
    fn default() -> Self {
        Self {
            models: "/usr/lib/andon/models".into(),
            hand_model: HandModel::Quantised,
            hands: vec![Side::Right, Side::Left],
            dictionary: Dictionary::default(),
            marker_search: MarkerSearch::Near,
        }
    }
}

impl Perception {
    pub(in crate::config) fn keys(&mut self, k: &mut impl Keys) {
        k.key("models", &mut self.models, (), "Directory of the hand models and of libonnxruntime.so.");
        k.key(
            "hand_model",
            &mut self.hand_model,
            (),
            "The hand models. They are the larger ones with landmarks computed in bytes (quantised), or the same as they were published, which take twice as long (full). The smaller ones are less exact (lite).",
        );
        k.key(
            "hands",
            &mut self.hands,
            several(1, capacity::HANDS, ()),
            "The hands that work here. A hand that is not listed is not looked for, which saves time.",
        );
        k.key(
            "dictionary",
            &mut self.dictionary,
            (),
            "The dictionary of the markers, by the name that OpenCV gives it.",
        );
        k.key(
            "marker_search",
            &mut self.marker_search,
            (),
            "Where markers are looked for. With near it is around the places where they were, and in the whole picture as soon as one is missing. With whole it is in the whole picture of every frame. Both find the same markers in the same frames; near takes half \
             the time, and in a noisy picture a seventh.",
        );
    }
}
