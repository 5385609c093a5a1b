//! What is true of a clip.

use crate::Error;
use crate::clip::Change;
use andon_perception::config::MarkerObject;
use andon_perception::detections::LANDMARKS;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// What is true of a clip, in its changed pictures. World: metres, as in `tests/footage/README.md`.
pub(crate) struct Truth {
    pub(crate) rate_hz: f64,
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) objects: Vec<MarkerObject>,
    pub(crate) frames: Vec<TrueFrame>,
}

/// What is true of a frame.
pub(crate) struct TrueFrame {
    /// The clips show one hand at most.
    pub(crate) hand: Option<TrueHand>,
    pub(crate) objects: Vec<TrueObject>,
}

/// Landmarks in MediaPipe's order.
pub(crate) struct TrueHand {
    pub(crate) landmarks_px: [[f64; 2]; LANDMARKS],
    pub(crate) landmarks_m: [[f64; 3]; LANDMARKS],
}

pub(crate) struct TrueObject {
    pub(crate) id: u16,
    pub(crate) is_visible: bool,
    pub(crate) is_carried: bool,
    /// The mean of the marker's corners.
    pub(crate) centre_px: [f64; 2],
    pub(crate) position_m: [f64; 3],
    /// Turn about z in radians.
    pub(crate) yaw: f64,
    /// Quaternion (w, x, y, z), marker frame to world.
    pub(crate) orientation: [f64; 4],
}

impl Truth {
    /// Reads the truth that lies beside a clip.
    pub(crate) fn beside(clip: &Path, change: &Change) -> Result<Self, Error> {
        let path = clip.with_extension("truth.jsonl");
        let file = std::fs::File::open(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let mut lines = BufReader::new(file).lines();
        let header: Value = serde_json::from_str(&lines.next().ok_or("the truth is empty")??)?;
        let size = |key: &str| (number(&header[key]) * change.scale).round() as usize;
        let objects = list(&header["objects"]).map(|object| MarkerObject {
            id: number(&object["id"]) as u16,
            marker: number(&object["id"]) as u16,
            side_m: number(&object["marker_side_m"]) as f32,
        });
        let mut truth = Self {
            rate_hz: number(&header["fps"]),
            width: size("width"),
            height: size("height"),
            objects: objects.collect(),
            frames: Vec::new(),
        };
        let changed = Changed { scale: change.scale, mirror: change.mirror, width: truth.width };
        for line in lines {
            truth.frames.push(changed.frame(&serde_json::from_str(&line?)?));
        }
        Ok(truth)
    }
}

/// Brings the truth to the changed picture.
struct Changed {
    scale: f64,
    mirror: bool,
    width: usize,
}

impl Changed {
    fn px(&self, point: &Value) -> [f64; 2] {
        let [x, y] = numbers(point).map(|value| (value + 0.5) * self.scale - 0.5);
        [if self.mirror { self.width as f64 - 1.0 - x } else { x }, y]
    }

    fn m(&self, point: &Value) -> [f64; 3] {
        let [x, y, z] = numbers(point);
        [if self.mirror { -x } else { x }, y, z]
    }

    fn frame(&self, frame: &Value) -> TrueFrame {
        TrueFrame {
            hand: list(&frame["hands"]).next().map(|hand| TrueHand {
                landmarks_px: std::array::from_fn(|landmark| self.px(&hand["px"][landmark])),
                landmarks_m: std::array::from_fn(|landmark| self.m(&hand["m"][landmark])),
            }),
            objects: list(&frame["objects"]).map(|object| self.object(object, &frame["held"])).collect(),
        }
    }

    fn object(&self, object: &Value, held: &Value) -> TrueObject {
        let corners: Vec<_> = list(&object["marker_px"]).map(|corner| self.px(corner)).collect();
        TrueObject {
            id: number(&object["id"]) as u16,
            // A mirrored marker cannot be read.
            is_visible: object["marker_visible"].as_bool().unwrap_or_default() && !self.mirror,
            is_carried: *held == object["id"],
            centre_px: [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 4.0),
            position_m: self.m(&object["p"]),
            yaw: number(&object["yaw"]),
            orientation: numbers(&object["q"]),
        }
    }
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

/// NaN if it is not a number.
pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

pub(crate) fn numbers<const COUNT: usize>(value: &Value) -> [f64; COUNT] {
    std::array::from_fn(|index| number(&value[index]))
}
