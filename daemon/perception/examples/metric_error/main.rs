//! Measures metric mode against clips whose truth is known.
//!
//! `tests/realsense/synthetic_depth.py CLIP.truth.jsonl CLIP.depth` makes the depth pictures of a clip; the bench is
//! calibrated from the first of them. Prints, in millimetres and degrees, how far landmarks and markers are from the truth.

mod inputs;
mod score;

use andon_perception::config::MarkerObject;
use andon_perception::metric::{BenchFrame, DepthImage, Metric, Sampler};
use andon_perception::{ImageView, Perceiver, PerceptionConfig, PixelFormat};
use clap::Parser;
use inputs::Inputs;
use score::Score;
use std::path::PathBuf;

type Error = Box<dyn std::error::Error>;

#[derive(Parser)]
struct Arguments {
    /// The clip; its truth lies beside it.
    clip: PathBuf,
    /// Its depth pictures; their calibration lies beside them.
    depth: PathBuf,
    /// Folder of the models and ONNX Runtime.
    #[arg(long, env = "ANDON_RUNTIME", default_value = "target/runtime")]
    runtime: PathBuf,
    /// Take the landmarks' pixels from the truth: what remains is the error of depth.
    #[arg(long)]
    true_pixels: bool,
    /// Withhold the depth in every other half second, and measure just those.
    #[arg(long)]
    blind: bool,
}

fn main() -> Result<(), Error> {
    let arguments = Arguments::parse();
    let mut inputs = Inputs::open(&arguments.clip, &arguments.depth)?;
    let objects: Vec<_> = inputs.objects.iter().map(|&(id, side_m)| MarkerObject { id, side_m }).collect();
    let mut perceiver = Perceiver::new(&PerceptionConfig::new(&arguments.runtime, objects.clone()))?;
    let (rig, unit_m) = (inputs.rig, inputs.unit_m);
    let mut metric: Option<Metric> = None;
    let mut score = Score::default();
    let mut frame = 0;
    while let Some(pictures) = inputs.next()? {
        let image = ImageView::new(640, 480, 640 * 3, PixelFormat::Rgb8, pictures.colour)?;
        let depth = DepthImage::new([640, 480], 1280, unit_m, pictures.depth)?;
        let captured_ns = (frame as f64 / 30.0 * 1e9) as u64;
        let mut seen = perceiver.perceive(image, captured_ns, frame)?;
        if arguments.true_pixels {
            inputs::put_true_pixels(&mut seen, pictures.truth);
        }
        if metric.is_none() {
            let bench = BenchFrame::from_depth(&Sampler::new(depth, &rig))?;
            println!(
                "bench: height {:.4} m, rms {:.2} mm",
                bench.bench_from_camera.translation.z,
                bench.residual * 1e3
            );
            metric = Some(Metric::new(rig, bench, &objects));
        }
        if let Some(metric) = &mut metric {
            let is_withheld = arguments.blind && frame / 15 % 2 == 1;
            let scene = metric.place((!is_withheld).then_some(depth), &seen)?;
            if is_withheld == arguments.blind {
                score.frame(&scene, pictures.truth);
            }
        }
        frame += 1;
    }
    score.print();
    Ok(())
}
