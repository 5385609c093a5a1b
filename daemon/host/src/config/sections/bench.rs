//! The sections `[bench]` and `[[objects]]`: what is in front of the camera.

use crate::config::keys::Keys;
use crate::config::value::{Text, counted_within, several, within, words};
use andon_core::capacity;
use andon_core::input::Space;
use std::path::PathBuf;

words!(Space, Space::ALL, Space::name);

/// `[bench]`: the frame of reference.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bench {
    /// What `andond calibrate` wrote; where it is `None`, the sizes of the markers give the scale.
    pub calibration: Option<PathBuf>,
}

impl Bench {
    /// Readers of the file find `space` here; the program has it in the method.
    pub(in crate::config) fn keys(&mut self, space: &mut Space, k: &mut impl Keys) {
        k.key(
            "space",
            space,
            (),
            "The coordinates: the plane of the bench without elevation (plane), or with depth and elevation (metric).",
        );
        k.optional(
            "calibration",
            &mut self.calibration,
            (),
            r#""bench1.calibration.toml""#,
            "The file that `andond calibrate` wrote. Without it the sizes of the objects' markers give the scale.",
        );
    }
}

/// `[[objects]]`: a part or a tool. The frame of one that carries a marker is the marker's. Its origin is the marker's centre, x points right and y
/// up in the marker's own picture, z out of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Object {
    /// Identity: what jobs, verdicts and registers call it.
    pub id: u16,
    /// What people call it.
    pub name: String,
    /// The id of its marker, where that is another one.
    pub marker: Option<u16>,
    /// Side of the marker's black square, m; `None` for an object without a marker.
    pub marker_side_m: Option<f32>,
    /// Where it can be touched, m, object's frame; where it is `None`, the runs of a job show it.
    pub interaction_points: Option<Vec<[f32; 3]>>,
}

impl Object {
    /// The id of its marker, if it carries one.
    #[must_use]
    pub fn marker_id(&self) -> Option<u16> {
        self.marker_side_m.map(|_| self.marker.unwrap_or(self.id))
    }

    pub(in crate::config) fn keys(&mut self, k: &mut impl Keys) {
        k.required(
            "id",
            &mut self.id,
            counted_within(1, 65_535, "0 stands for no object in verdicts and registers"),
            "5",
            "The number of the object in jobs, verdicts and registers; and the id of its marker, unless `marker` says another.",
        );
        k.required("name", &mut self.name, Text::Line, r#""polisher""#, "What people call it.");
        k.optional(
            "marker",
            &mut self.marker,
            within(0, 65_535, "(a marker's id)"),
            "17",
            "The id of the object's marker, where that is not `id`.",
        );
        k.optional(
            "marker_side_m",
            &mut self.marker_side_m,
            within(0.005, 0.5, "m"),
            "0.036",
            "Side of the marker's black square, as measured on the print. Only a station whose camera.source is \"tracks\" may leave it \
             out: an object in pictures is found by its marker.",
        );
        k.optional(
            "interaction_points",
            &mut self.interaction_points,
            several(1, capacity::INTERACTION_POINTS, within(-2.0, 2.0, "m")),
            "[[0.0, 0.0, -0.022], [0.104, 0.016, -0.011]]",
            "Where the object is gripped and where it touches other objects, in the object's frame. Its origin is the marker's centre, x points right and y up in the marker's own picture, z out of it. Without them the runs of a job show it.",
        );
    }
}
