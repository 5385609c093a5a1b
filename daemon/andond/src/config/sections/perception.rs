//! The section `[perception]`.

use crate::config::keys::Keys;
use crate::config::value::{Value as _, several, words};
use andon_core::capacity;
use andon_core::input::Side;
use std::path::PathBuf;

/// The weight of the hand landmark model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandModel {
    /// The more exact one.
    Full,
    /// Twice as fast.
    Lite,
}
words!(HandModel { HandModel::Full = "full", HandModel::Lite = "lite" });

words!(Side { Side::Right = "right", Side::Left = "left" });

/// `[perception]`: how hands and objects are found.
#[derive(Clone, Debug, PartialEq)]
pub struct Perception {
    /// Directory of the hand models and the ONNX Runtime library.
    pub models: PathBuf,
    /// The weight of the hand models.
    pub hand_model: HandModel,
    /// The hands that work here.
    pub hands: Vec<Side>,
    /// The ArUco dictionary of the markers.
    pub dictionary: Dictionary,
}

impl Default for Perception {
    fn default() -> Self {
        Self {
            models: "/usr/lib/andon/models".into(),
            hand_model: HandModel::Full,
            hands: vec![Side::Right, Side::Left],
            dictionary: Dictionary::Dict4x4_50,
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
            "The hand model: exact (full) or twice as fast (lite).",
        );
        k.key(
            "hands",
            &mut self.hands,
            several(1, capacity::HANDS, ()),
            "The hands that work here. A hand that is not listed is not looked for, which saves time.",
        );
        k.key("dictionary", &mut self.dictionary, (), "The ArUco dictionary of the markers.");
    }
}

/// A predefined ArUco dictionary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names are OpenCV's")]
pub enum Dictionary {
    Dict4x4_50,
    Dict4x4_100,
    Dict4x4_250,
    Dict4x4_1000,
    Dict5x5_50,
    Dict5x5_100,
    Dict5x5_250,
    Dict5x5_1000,
    Dict6x6_50,
    Dict6x6_100,
    Dict6x6_250,
    Dict6x6_1000,
}
words!(Dictionary {
    Dictionary::Dict4x4_50 = "DICT_4X4_50",
    Dictionary::Dict4x4_100 = "DICT_4X4_100",
    Dictionary::Dict4x4_250 = "DICT_4X4_250",
    Dictionary::Dict4x4_1000 = "DICT_4X4_1000",
    Dictionary::Dict5x5_50 = "DICT_5X5_50",
    Dictionary::Dict5x5_100 = "DICT_5X5_100",
    Dictionary::Dict5x5_250 = "DICT_5X5_250",
    Dictionary::Dict5x5_1000 = "DICT_5X5_1000",
    Dictionary::Dict6x6_50 = "DICT_6X6_50",
    Dictionary::Dict6x6_100 = "DICT_6X6_100",
    Dictionary::Dict6x6_250 = "DICT_6X6_250",
    Dictionary::Dict6x6_1000 = "DICT_6X6_1000",
});

impl Dictionary {
    /// OpenCV's name of it.
    #[must_use]
    pub fn name(self) -> String {
        self.write().trim_matches('"').to_owned()
    }

    /// How many markers it has: their ids are below this.
    #[must_use]
    pub fn markers(self) -> u16 {
        match self {
            Self::Dict4x4_50 | Self::Dict5x5_50 | Self::Dict6x6_50 => 50,
            Self::Dict4x4_100 | Self::Dict5x5_100 | Self::Dict6x6_100 => 100,
            Self::Dict4x4_250 | Self::Dict5x5_250 | Self::Dict6x6_250 => 250,
            Self::Dict4x4_1000 | Self::Dict5x5_1000 | Self::Dict6x6_1000 => 1000,
        }
    }
}
