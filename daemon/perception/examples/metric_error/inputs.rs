//! A clip, its depth pictures and its truth, frame by frame.

use crate::Error;
use andon_perception::Detections;
use andon_perception::detections::{HandDetection, LANDMARKS, Side};
use andon_perception::metric::lens::rigid;
use andon_perception::metric::{Distortion, Lens, Rig};
use serde_json::Value;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{ChildStdout, Command, Stdio};

pub(crate) struct Inputs {
    pub(crate) rig: Rig,
    pub(crate) unit_m: f64,
    /// Id and marker side in metres.
    pub(crate) objects: Vec<(u16, f32)>,
    truth: std::vec::IntoIter<Value>,
    colour: BufReader<ChildStdout>,
    depth: BufReader<File>,
    buffers: (Vec<u8>, Vec<u8>, Value),
}

pub(crate) struct Pictures<'a> {
    pub(crate) colour: &'a [u8],
    pub(crate) depth: &'a [u8],
    pub(crate) truth: &'a Value,
}

impl Inputs {
    pub(crate) fn open(clip: &Path, depth: &Path) -> Result<Self, Error> {
        let lines = BufReader::new(File::open(clip.with_extension("truth.jsonl"))?).lines();
        let mut truth = lines
            .map(|line| Ok(serde_json::from_str(&line?)?))
            .collect::<Result<Vec<Value>, Error>>()?
            .into_iter();
        let header = truth.next().ok_or("the truth is empty")?;
        let objects = header["objects"].as_array().into_iter().flatten();
        let objects =
            objects.map(|each| (number(&each["id"]) as u16, number(&each["marker_side_m"]) as f32)).collect();
        let calibration: Value = serde_json::from_reader(File::open(depth.with_extension("json"))?)?;
        let translation = [0, 1, 2].map(|axis| number(&calibration["translation_m"][axis]) as f32);
        let rotation =
            [0, 1, 2].map(|row| [0, 1, 2].map(|column| number(&calibration["rotation"][row][column]) as f32));
        let mut ffmpeg = Command::new("ffmpeg")
            .args(["-v", "error", "-i"])
            .arg(clip)
            .args(["-f", "rawvideo", "-pix_fmt", "rgb24", "-"])
            .stdout(Stdio::piped())
            .spawn()?;
        Ok(Self {
            rig: Rig {
                colour: lens(&calibration["colour"]),
                depth: lens(&calibration["depth"]),
                colour_from_depth: rigid(rotation, translation),
            },
            unit_m: number(&calibration["unit_m"]),
            objects,
            truth,
            colour: BufReader::new(ffmpeg.stdout.take().ok_or("ffmpeg has no output")?),
            depth: BufReader::new(File::open(depth)?),
            buffers: (vec![0; 640 * 480 * 3], vec![0; 640 * 480 * 2], Value::Null),
        })
    }

    pub(crate) fn next(&mut self) -> Result<Option<Pictures<'_>>, Error> {
        let Some(truth) = self.truth.next() else { return Ok(None) };
        let (colour, depth, line) = &mut self.buffers;
        *line = truth;
        self.colour.read_exact(colour)?;
        self.depth.read_exact(depth)?;
        Ok(Some(Pictures { colour, depth, truth: line }))
    }
}

/// Puts the truth's landmarks in the place of those that were detected.
pub(crate) fn put_true_pixels(seen: &mut Detections, truth: &Value) {
    let detected = seen.hands.first().map(|hand| hand.shape_m);
    seen.hands.clear();
    for hand in truth["hands"].as_array().into_iter().flatten() {
        let landmarks_px: [[f32; 2]; LANDMARKS] =
            std::array::from_fn(|k| [0, 1].map(|axis| number(&hand["px"][k][axis]) as f32));
        let is_inside =
            landmarks_px.iter().all(|&[u, v]| (0.0..640.0).contains(&u) && (0.0..480.0).contains(&v));
        if is_inside {
            // Of the detected hand, if there was one: the truth has no such thing.
            let shape_m = detected.unwrap_or([[0.0; 3]; LANDMARKS]);
            let hand = HandDetection {
                side: Side::Right,
                score: 1.0,
                landmarks_px,
                shape_m,
                landmarks_m: [[0.0; 2]; LANDMARKS],
            };
            // There is room: it was cleared, and the clips have one hand.
            let _ = seen.hands.push(hand);
        }
    }
}

fn lens(value: &Value) -> Lens {
    let pair = |key: &str| [0, 1].map(|axis| number(&value[key][axis]));
    Lens {
        focal: pair("focal"),
        centre: pair("centre"),
        distortion: Distortion::None,
        coefficients: [0.0; 5],
    }
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}
