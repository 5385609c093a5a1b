//! A clip, decoded by ffmpeg, and its truth.

use crate::Error;
use andon_perception::{ImageView, PixelFormat};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};

/// How the clip is changed before it is looked at.
pub(crate) struct Change {
    pub(crate) filter: Option<String>,
    pub(crate) scale: f64,
    pub(crate) mirror: bool,
    pub(crate) jpeg: Option<u8>,
}

/// Landmarks in MediaPipe's order.
pub(crate) type Landmarks = [[f64; 2]; 21];

/// What is true of a frame, in the changed picture.
pub(crate) struct TruthFrame {
    /// Landmarks in pixels and in metres.
    pub(crate) hand: Option<(Landmarks, Landmarks)>,
    pub(crate) objects: Vec<TruthObject>,
}

/// What is true of an object.
pub(crate) struct TruthObject {
    pub(crate) id: u16,
    pub(crate) visible: bool,
    pub(crate) centre_px: [f64; 2],
    pub(crate) position_m: [f64; 2],
    pub(crate) yaw: f64,
    pub(crate) held: bool,
}

/// What is true of a clip.
pub(crate) struct Truth {
    pub(crate) fps: f64,
    /// Id and side of the marker in metres.
    pub(crate) objects: Vec<(u16, f32)>,
    pub(crate) frames: Vec<TruthFrame>,
}

pub(crate) struct Clip {
    pub(crate) truth: Truth,
    pub(crate) width: usize,
    pub(crate) height: usize,
    frame: Vec<u8>,
    pipe: BufReader<ChildStdout>,
    children: Vec<Child>,
}

impl Clip {
    pub(crate) fn open(path: &Path, change: &Change) -> Result<Self, Error> {
        let (truth, width, height) = read_truth(&path.with_extension("truth.jsonl"), change)?;
        let mut filters = vec![format!("scale={width}:{height}:flags=bicubic")];
        filters.extend(change.filter.clone());
        filters.extend(change.mirror.then(|| "hflip".to_owned()));
        let filters = filters.join(",");

        let mut decoder = Command::new("ffmpeg");
        decoder.args(["-v", "error", "-i"]).arg(path).args(["-vf", &filters]);
        let mut children = Vec::new();
        let mut last = match change.jpeg {
            None => decoder,
            Some(quality) => {
                decoder.args(["-c:v", "mjpeg", "-q:v", &quality.to_string(), "-f", "matroska", "-"]);
                let mut first = decoder.stdin(Stdio::null()).stdout(Stdio::piped()).spawn()?;
                let mut second = Command::new("ffmpeg");
                second.args(["-v", "error", "-i", "-"]).stdin(first.stdout.take().ok_or("no pipe")?);
                children.push(first);
                second
            }
        };
        last.args(["-f", "rawvideo", "-pix_fmt", "bgr24", "-"]).stdout(Stdio::piped());
        let mut last = last.spawn().map_err(|error| format!("ffmpeg cannot be started: {error}"))?;
        let pipe = BufReader::new(last.stdout.take().ok_or("no pipe")?);
        children.push(last);
        Ok(Self { truth, width, height, frame: vec![0; width * height * 3], pipe, children })
    }

    /// Decodes the next frame; false at the end.
    pub(crate) fn advance(&mut self) -> Result<bool, Error> {
        match self.pipe.read_exact(&mut self.frame) {
            Ok(()) => Ok(true),
            Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => Ok(false),
            Err(error) => Err(error.into()),
        }
    }

    /// The frame, blue first.
    pub(crate) fn image(&self) -> Result<ImageView<'_>, Error> {
        Ok(ImageView::new(self.width, self.height, self.width * 3, PixelFormat::Bgr8, &self.frame)?)
    }
}

impl Drop for Clip {
    fn drop(&mut self) {
        for child in &mut self.children {
            // It may have ended by itself.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

fn read_truth(path: &Path, change: &Change) -> Result<(Truth, usize, usize), Error> {
    let file = std::fs::File::open(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let mut lines = BufReader::new(file).lines();
    let header: Value = serde_json::from_str(&lines.next().ok_or("the truth is empty")??)?;
    let size = |key: &str| (number(&header[key]) * change.scale).round() as usize;
    let (width, height) = (size("width"), size("height"));
    let places = Places { scale: change.scale, mirror: change.mirror, width };
    let objects = list(&header["objects"])
        .map(|object| (number(&object["id"]) as u16, number(&object["marker_side_m"]) as f32));
    let mut truth = Truth { fps: number(&header["fps"]), objects: objects.collect(), frames: Vec::new() };
    for line in lines {
        truth.frames.push(places.frame(&serde_json::from_str(&line?)?));
    }
    Ok((truth, width, height))
}

/// Brings the truth to the changed picture.
struct Places {
    scale: f64,
    mirror: bool,
    width: usize,
}

impl Places {
    fn px(&self, point: &Value) -> [f64; 2] {
        let [x, y] = [0, 1].map(|axis| (number(&point[axis]) + 0.5) * self.scale - 0.5);
        [if self.mirror { self.width as f64 - 1.0 - x } else { x }, y]
    }

    fn m(&self, point: &Value) -> [f64; 2] {
        let [x, y] = [0, 1].map(|axis| number(&point[axis]));
        [if self.mirror { -x } else { x }, y]
    }

    fn frame(&self, frame: &Value) -> TruthFrame {
        let hand = list(&frame["hands"]).next().map(|hand| {
            (
                std::array::from_fn(|landmark| self.px(&hand["px"][landmark])),
                std::array::from_fn(|landmark| self.m(&hand["m"][landmark])),
            )
        });
        let objects = list(&frame["objects"]).map(|object| {
            let corners: Vec<_> = list(&object["marker_px"]).map(|corner| self.px(corner)).collect();
            let mean = |axis: usize| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 4.0;
            TruthObject {
                id: number(&object["id"]) as u16,
                visible: object["marker_visible"].as_bool().unwrap_or_default() && !self.mirror,
                centre_px: [mean(0), mean(1)],
                position_m: self.m(&object["p"]),
                yaw: number(&object["yaw"]),
                held: frame["held"] == object["id"],
            }
        });
        TruthFrame { hand, objects: objects.collect() }
    }
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}
