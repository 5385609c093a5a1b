//! Measures metric mode: how far landmarks and markers are from the truth, in millimetres and degrees.
//!
//! `tests/realsense/synthetic_depth.py CLIP.truth.jsonl CLIP.depth` makes the depth pictures of a clip; the bench frame comes
//! from the first of them.

use crate::clip::{Change, Clip, Shown};
use crate::errors::Errors;
use crate::truth::{TrueFrame, TrueHand, TrueObject, number, numbers};
use crate::{Error, usual_perceiver};
use andon_perception::Detections;
use andon_perception::detections::{HandDetection, LANDMARKS, Side};
use andon_perception::metric::{
    BenchFrame, DepthImage, Distortion, Lens, Metric, MetricObject, MetricScene, Rig, Sampler, rigid,
};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The clip; its truth lies beside it.
    clip: PathBuf,
    /// Its depth pictures; their calibration lies beside them.
    depth: PathBuf,
    /// Take the landmarks' pixels from the truth: what remains is the error of depth.
    #[arg(long)]
    true_pixels: bool,
    /// Withhold the depth in every other half second, and measure just those.
    #[arg(long)]
    blind: bool,
}

/// Frames of half a second.
const HALF_SECOND: usize = 15;

/// Landmarks by how they are used.
const MEASURED_LANDMARKS: [(&str, &[usize]); 4] = [
    ("tips 8 12 16", &[8, 12, 16]),
    ("knuckle 9", &[9]),
    ("thumb 4", &[4]),
    ("all 21", &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20]),
];

pub(crate) fn run(arguments: &Arguments, runtime: &Path) -> Result<(), Error> {
    let mut clip = Clip::open(&arguments.clip, &Change::default())?;
    let mut pictures = DepthPictures::open(&arguments.depth)?;
    let rig = pictures.rig;
    let mut perceiver = usual_perceiver(runtime, &clip.truth)?;
    let objects = clip.truth.objects.clone();
    let mut metric: Option<Metric> = None;
    let mut score = Score::default();
    while let Some(Shown { index, captured_ns, image, truth, .. }) = clip.next()? {
        let depth = pictures.next()?;
        let mut detections = perceiver.perceive(image, captured_ns)?;
        if arguments.true_pixels {
            put_true_pixels(&mut detections, truth, [image.width(), image.height()]);
        }
        let metric = match &mut metric {
            Some(metric) => metric,
            none => none.insert(Metric::new(rig, bench_frame(depth, &rig)?, &objects)),
        };
        let is_withheld = arguments.blind && index / HALF_SECOND % 2 == 1;
        let scene = metric.place((!is_withheld).then_some(depth), &detections)?;
        if is_withheld == arguments.blind {
            score.frame(&scene, truth);
        }
    }
    score.print();
    Ok(())
}

fn bench_frame(depth: DepthImage<'_>, rig: &Rig) -> Result<BenchFrame, Error> {
    let bench = BenchFrame::from_depth(&Sampler::new(depth, rig))?;
    println!("the camera is {:.4} m above the bench", bench.bench_from_camera.translation.z);
    Ok(bench)
}

/// The depth pictures of a clip, one after the other.
struct DepthPictures {
    rig: Rig,
    unit_m: f64,
    size: [usize; 2],
    file: BufReader<File>,
    picture: Vec<u8>,
}

impl DepthPictures {
    fn open(path: &Path) -> Result<Self, Error> {
        let calibration: Value = serde_json::from_reader(File::open(path.with_extension("json"))?)?;
        let rotation =
            std::array::from_fn(|row| numbers::<3>(&calibration["rotation"][row]).map(|value| value as f32));
        let translation_m = numbers(&calibration["translation_m"]).map(|value| value as f32);
        let size = numbers(&calibration["depth"]["size"]).map(|value| value as usize);
        Ok(Self {
            rig: Rig {
                colour: lens(&calibration["colour"]),
                depth: lens(&calibration["depth"]),
                colour_from_depth: rigid(rotation, translation_m),
            },
            unit_m: number(&calibration["unit_m"]),
            size,
            file: BufReader::new(File::open(path)?),
            picture: vec![0; size[0] * size[1] * 2],
        })
    }

    fn next(&mut self) -> Result<DepthImage<'_>, Error> {
        self.file.read_exact(&mut self.picture)?;
        Ok(DepthImage::new(self.size, 2 * self.size[0], self.unit_m, &self.picture)?)
    }
}

fn lens(value: &Value) -> Lens {
    Lens {
        focal: numbers(&value["focal"]),
        centre: numbers(&value["centre"]),
        distortion: Distortion::None,
        coefficients: [0.0; 5],
    }
}

/// Puts the true landmarks in the place of those that were detected, where the whole hand is in the picture.
fn put_true_pixels(detections: &mut Detections, truth: &TrueFrame, [width, height]: [usize; 2]) {
    // The truth has no shape: it is that of the detected hand, if there is one.
    let shape_m = detections.hands.first().map_or([[0.0; 3]; LANDMARKS], |hand| hand.shape_m);
    detections.hands.clear();
    let Some(TrueHand { landmarks_px, .. }) = &truth.hand else { return };
    let is_inside = |[u, v]: &[f64; 2]| (0.0..width as f64).contains(u) && (0.0..height as f64).contains(v);
    if landmarks_px.iter().all(is_inside) {
        let hand = HandDetection {
            side: Side::Right,
            score: 1.0,
            landmarks_px: landmarks_px.map(|point| point.map(|value| value as f32)),
            shape_m,
            landmarks_m: [[0.0; 2]; LANDMARKS],
        };
        // There is room: it was cleared.
        let _ = detections.hands.push(hand);
    }
}

#[derive(Default)]
struct Score {
    /// By what they are of, and their unit.
    errors: BTreeMap<(&'static str, &'static str), Errors>,
    /// Landmarks and markers that were seen and could not be placed, by what they are.
    unplaced: BTreeMap<&'static str, usize>,
    ambiguous: usize,
}

impl Score {
    fn frame(&mut self, scene: &MetricScene, truth: &TrueFrame) {
        if let (Some(hand), Some(true_hand)) = (scene.hands.first(), &truth.hand) {
            for (name, landmarks) in MEASURED_LANDMARKS {
                for &landmark in landmarks {
                    self.position(name, hand.landmarks_m[landmark], true_hand.landmarks_m[landmark]);
                }
            }
        }
        for object in &scene.objects {
            if let Some(true_object) = truth.objects.iter().find(|each| each.id == object.id) {
                self.object(object, true_object);
            }
        }
    }

    fn position(&mut self, name: &'static str, found_m: [f32; 3], true_m: [f64; 3]) {
        let error_m = Vector3::from(found_m.map(f64::from)) - Vector3::from(true_m);
        if error_m.norm().is_nan() {
            *self.unplaced.entry(name).or_default() += 1;
        } else {
            self.add(name, "mm", 1e3 * error_m.norm());
            self.add(name, "mm, height", 1e3 * error_m.z.abs());
        }
    }

    fn object(&mut self, object: &MetricObject, truth: &TrueObject) {
        let name = if truth.is_carried { "marker, carried" } else { "marker, at rest" };
        self.position(name, object.position_m, truth.position_m);
        let turn = |[w, x, y, z]: [f64; 4]| UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        let (found, wanted) = (turn(object.orientation.map(f64::from)), turn(truth.orientation));
        let tilt = (found * Vector3::z()).angle(&(wanted * Vector3::z()));
        self.add(name, "degrees, tilt", tilt.to_degrees());
        self.add(name, "degrees", found.angle_to(&wanted).to_degrees());
        self.ambiguous += usize::from(!object.unambiguous);
    }

    fn add(&mut self, name: &'static str, unit: &'static str, error: f64) {
        self.errors.entry((name, unit)).or_default().push(error);
    }

    fn print(&self) {
        println!("{:34} {:>7} {:>8} {:>8} {:>8}", "error of", "count", "median", "95 %", "mean");
        for ((name, unit), errors) in &self.errors {
            println!(
                "{:34} {:7} {:8.2} {:8.2} {:8.2}",
                format!("{name}, {unit}"),
                errors.count(),
                errors.median(),
                errors.quantile(0.95),
                errors.mean()
            );
        }
        for (name, count) in &self.unplaced {
            println!("not placed: {name}, {count} times");
        }
        println!("ambiguous poses: {}", self.ambiguous);
    }
}
