//! Measures how well hands and markers are detected in plane mode, and how long it takes.

use crate::clip::{Change, Clip, Shown, pixel_format};
use crate::errors::{Errors, distance};
use crate::truth::TrueFrame;
use crate::{Error, perceiver};
use andon_perception::config::{HandsConfig, MarkerSearch, ModelSize, ThreadsConfig};
use andon_perception::detections::{HandDetection, ObjectDetection, Side};
use andon_perception::{Detections, PixelFormat};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Clips with their truth beside them.
    #[arg(required = true)]
    clips: Vec<PathBuf>,
    /// The landmark model: full, quantised or lite.
    #[arg(long, default_value = "quantised", value_parser = model_size)]
    landmarks: ModelSize,
    /// Use the small palm model.
    #[arg(long)]
    lite_palm: bool,
    /// Look for both hands.
    #[arg(long)]
    both: bool,
    /// Threads that look at a frame side by side.
    #[arg(long, default_value_t = 2)]
    threads: usize,
    /// An ffmpeg filter that changes pixels and moves none, such as `noise=alls=20:allf=t`.
    #[arg(long)]
    filter: Option<String>,
    /// Encode every frame as JPEG of this ffmpeg quality first, 2 (best) to 31 (worst).
    #[arg(long)]
    jpeg: Option<u8>,
    /// The format of a frame: bgr, yuyv or nv12.
    #[arg(long, default_value = "bgr", value_parser = pixel_format)]
    pixels: PixelFormat,
    /// Look for markers in the whole picture of every frame.
    #[arg(long)]
    whole: bool,
    /// Width and height of the picture in relation to the clip's.
    #[arg(long, default_value_t = 1.0)]
    scale: f64,
    /// Mirror the picture: right hands become left ones, and markers cannot be read.
    #[arg(long)]
    mirror: bool,
    /// Look only at every n-th frame.
    #[arg(long, default_value_t = 1, value_name = "N")]
    every: usize,
}

impl Arguments {
    fn change(&self) -> Change {
        Change {
            filter: self.filter.clone(),
            scale: self.scale,
            mirror: self.mirror,
            jpeg: self.jpeg,
            pixels: self.pixels,
        }
    }

    /// The side of the hand that the clips show.
    fn side(&self) -> Side {
        if self.mirror { Side::Left } else { Side::Right }
    }

    fn hands(&self) -> HandsConfig {
        HandsConfig {
            sides: if self.both { vec![Side::Right, Side::Left] } else { vec![self.side()] },
            landmark_model: self.landmarks,
            palm_model: if self.lite_palm { ModelSize::Lite } else { ModelSize::Full },
            ..HandsConfig::default()
        }
    }
}

pub(crate) fn model_size(name: &str) -> Result<ModelSize, String> {
    match name {
        "full" => Ok(ModelSize::Full),
        "quantised" => Ok(ModelSize::Quantised),
        "lite" => Ok(ModelSize::Lite),
        _ => Err("full, quantised or lite".into()),
    }
}

pub(crate) fn run(arguments: &Arguments, runtime: &Path) -> Result<(), Error> {
    let mut total = Score::default();
    println!("{}", row(COLUMNS.map(|(title, _)| title.into())));
    for path in &arguments.clips {
        let mut score = Score::default();
        measure(arguments, runtime, path, &mut [&mut score, &mut total])?;
        println!("{}", score.row(&path.file_stem().unwrap_or_default().to_string_lossy()));
    }
    println!("{}", total.row("all"));
    Ok(())
}

/// Counts the frames of a clip in every one of the scores.
fn measure(
    arguments: &Arguments,
    runtime: &Path,
    path: &Path,
    scores: &mut [&mut Score],
) -> Result<(), Error> {
    let mut clip = Clip::open(path, &arguments.change())?;
    let threads = ThreadsConfig { count: arguments.threads };
    let search = if arguments.whole { MarkerSearch::Whole } else { MarkerSearch::Near };
    let mut perceiver = perceiver(runtime, &clip.truth, arguments.hands(), search, threads)?;
    scores.iter_mut().for_each(|score| score.previous.clear());
    while let Some(Shown { index, captured_ns, image, truth, .. }) = clip.next()? {
        if index % arguments.every == 0 {
            let began = Instant::now();
            let detections = perceiver.perceive(image, captured_ns)?;
            let took = began.elapsed();
            let size = [image.width(), image.height()].map(|side| side as f64);
            for score in scores.iter_mut() {
                score.times(&detections, took);
                score.hand(truth, &detections, arguments.side(), size);
                score.objects(truth, &detections);
            }
        }
    }
    Ok(())
}

/// A hand whose landmarks are off by more than this in the median is on something else, or has its fingers in another order. It is a share of the
/// picture's width.
const ELSEWHERE: f64 = 0.06;
/// The fingertips that touch.
const TIPS: [usize; 3] = [8, 12, 16];

#[derive(Default)]
struct Score {
    frames: usize,
    hands: usize,
    hands_found: usize,
    hands_elsewhere: usize,
    hands_of_the_other_side: usize,
    palm_detections: usize,
    landmarks_px: Errors,
    tips_px: Errors,
    tips_mm: Errors,
    markers: usize,
    markers_found: usize,
    hidden_markers_found: usize,
    centre_px: Errors,
    centre_mm: Errors,
    carried_mm: Errors,
    yaw_degrees: Errors,
    /// How an object's error changes from frame to frame, which the method takes for motion.
    step_mm: Errors,
    /// Ids and errors of the last frame's objects, in metres.
    previous: Vec<(u16, [f64; 2])>,
    frame_ms: Errors,
    palm_ms: Errors,
    landmarks_ms: Errors,
    markers_ms: Errors,
}

impl Score {
    fn times(&mut self, detections: &Detections, took: Duration) {
        self.frames += 1;
        self.frame_ms.push(1e3 * took.as_secs_f64());
        let ms = |ns: u64| ns as f64 / 1e6;
        self.markers_ms.push(ms(detections.timings.markers_ns));
        if detections.timings.landmarks_ns > 0 {
            self.landmarks_ms.push(ms(detections.timings.landmarks_ns));
        }
        if detections.timings.palm_ns > 0 {
            self.palm_detections += 1;
            self.palm_ms.push(ms(detections.timings.palm_ns));
        }
    }

    fn hand(&mut self, truth: &TrueFrame, detections: &Detections, side: Side, [width, height]: [f64; 2]) {
        let of_side = |hand: &&HandDetection| hand.side == side;
        self.hands_of_the_other_side += detections.hands.iter().filter(|hand| !of_side(hand)).count();
        let is_inside = |[x, y]: &[f64; 2]| (0.0..width).contains(x) && (0.0..height).contains(y);
        // A hand is to be found when most of it is in the picture.
        let is_in_view = truth.hand.as_ref().is_some_and(|hand| {
            hand.landmarks_px.iter().filter(|point| is_inside(point)).count() > hand.landmarks_px.len() / 2
        });
        self.hands += usize::from(is_in_view);
        let Some(found) = detections.hands.iter().find(of_side) else { return };
        let Some(hand) = &truth.hand else {
            self.hands_elsewhere += 1;
            return;
        };
        let error_px = |index: usize| distance(hand.landmarks_px[index], xy(found.landmarks_px[index]));
        let mut errors_px = Errors::default();
        errors_px.extend((0..hand.landmarks_px.len()).map(error_px));
        if errors_px.median() > ELSEWHERE * width {
            self.hands_elsewhere += 1;
        } else if is_in_view {
            self.hands_found += 1;
            self.landmarks_px.extend((0..hand.landmarks_px.len()).map(error_px));
            self.tips_px.extend(TIPS.map(error_px));
            let [x, y] = [0, 1];
            let true_m = |tip: usize| [hand.landmarks_m[tip][x], hand.landmarks_m[tip][y]];
            self.tips_mm.extend(TIPS.map(|tip| 1e3 * distance(true_m(tip), xy(found.landmarks_m[tip]))));
        }
    }

    fn objects(&mut self, truth: &TrueFrame, detections: &Detections) {
        let mut errors = Vec::new();
        for object in &truth.objects {
            self.markers += usize::from(object.is_visible);
            let Some(found) = detections.objects.iter().find(|found| found.id == object.id) else { continue };
            self.markers_found += usize::from(object.is_visible);
            self.hidden_markers_found += usize::from(!object.is_visible);
            self.centre_px.push(distance(centre_px(found), object.centre_px));
            let error_m = [0, 1].map(|axis| f64::from(found.position_m[axis]) - object.position_m[axis]);
            self.centre_mm.push(1e3 * distance(error_m, [0.0; 2]));
            if object.is_carried {
                self.carried_mm.push(1e3 * distance(error_m, [0.0; 2]));
            }
            let turn =
                2.0 * f64::from(found.orientation[3]).atan2(f64::from(found.orientation[0])) - object.yaw;
            self.yaw_degrees.push(turn.sin().atan2(turn.cos()).abs().to_degrees());
            if let Some((_, before)) = self.previous.iter().find(|(id, _)| *id == object.id) {
                self.step_mm.push(1e3 * distance(error_m, *before));
            }
            errors.push((object.id, error_m));
        }
        self.previous = errors;
    }

    /// The cells of [`COLUMNS`].
    fn row(&self, name: &str) -> String {
        let share = |part: usize, whole: usize| format!("{:.1}%", 100.0 * part as f64 / whole.max(1) as f64);
        let median = |errors: &Errors, digits: usize| format!("{:.digits$}", errors.median());
        let both = |errors: &Errors| format!("{:.2} {:.2}", errors.median(), errors.quantile(0.95));
        row([
            name.into(),
            self.frames.to_string(),
            share(self.hands_found, self.hands),
            self.hands_elsewhere.to_string(),
            self.hands_of_the_other_side.to_string(),
            self.palm_detections.to_string(),
            median(&self.landmarks_px, 2),
            median(&self.tips_px, 2),
            both(&self.tips_mm),
            share(self.markers_found, self.markers),
            self.hidden_markers_found.to_string(),
            both(&self.centre_px),
            both(&self.centre_mm),
            both(&self.carried_mm),
            both(&self.yaw_degrees),
            both(&self.step_mm),
            median(&self.palm_ms, 1),
            median(&self.landmarks_ms, 1),
            median(&self.markers_ms, 1),
            median(&self.frame_ms, 1),
            format!("{:.1}", self.frame_ms.quantile(0.99)),
        ])
    }
}

/// Titles and widths: the hand (`else` is one that was found on something else), the markers, the times in milliseconds. Errors are medians; `95`
/// stands before the 95 % quantile.
const COLUMNS: [(&str, usize); 21] = [
    ("clip", 20),
    ("frames", 6),
    ("hand", 6),
    ("else", 4),
    ("side", 4),
    ("palms", 5),
    ("px", 6),
    ("tip px", 6),
    ("tip mm 95", 12),
    ("marker", 6),
    ("hidden", 6),
    ("px 95", 9),
    ("mm 95", 11),
    ("carried 95", 11),
    ("yaw 95", 9),
    ("step 95", 9),
    ("palm", 5),
    ("lands", 5),
    ("marks", 5),
    ("frame", 5),
    ("99 %", 5),
];

fn row(cells: [String; COLUMNS.len()]) -> String {
    let padded = cells.iter().zip(COLUMNS).map(|(cell, (_, width))| format!("{cell:>width$}"));
    padded.collect::<Vec<_>>().join(" ")
}

fn centre_px(object: &ObjectDetection) -> [f64; 2] {
    [0, 1].map(|axis| object.corners_px.iter().map(|corner| f64::from(corner[axis])).sum::<f64>() / 4.0)
}

fn xy(point: [f32; 2]) -> [f64; 2] {
    point.map(f64::from)
}
