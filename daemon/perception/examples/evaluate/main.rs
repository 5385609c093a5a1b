//! Measures the perceiver against clips whose truth is known.
//!
//! Every clip `NAME.mp4` has its truth beside it in `NAME.truth.jsonl`. `ffmpeg` decodes the clip; its filters make the
//! same clip darker, noisier or larger. Prints a line a clip.

mod clip;
mod score;

use andon_perception::config::{MarkerObject, ModelSize};
use andon_perception::detections::Side;
use andon_perception::{Perceiver, PerceptionConfig};
use clap::Parser;
use clip::{Change, Clip};
use score::Score;
use std::path::PathBuf;

type Error = Box<dyn std::error::Error>;

#[derive(Parser)]
struct Arguments {
    /// Clips with their truth beside them.
    #[arg(required = true)]
    clips: Vec<PathBuf>,
    /// Folder of the models and ONNX Runtime.
    #[arg(long, env = "ANDON_RUNTIME", default_value = "target/runtime")]
    runtime: PathBuf,
    /// Use the small landmark model.
    #[arg(long)]
    lite_landmarks: bool,
    /// Use the small palm model.
    #[arg(long)]
    lite_palm: bool,
    /// Want both hands.
    #[arg(long)]
    both: bool,
    /// An ffmpeg filter that changes pixels, not places, such as `noise=alls=20:allf=t`.
    #[arg(long)]
    filter: Option<String>,
    /// Encode every frame as JPEG of this ffmpeg quality (2 best, 31 worst) first.
    #[arg(long)]
    jpeg: Option<u8>,
    /// Width and height of the picture in relation to the clip's.
    #[arg(long, default_value_t = 1.0)]
    scale: f64,
    /// Mirror the picture: right hands become left ones. Markers are not to be read then.
    #[arg(long)]
    mirror: bool,
    /// Keep only every so many frames.
    #[arg(long, default_value_t = 1)]
    every: usize,
    /// Write what was detected, a JSON object a frame.
    #[arg(long)]
    dump: Option<PathBuf>,
}

fn main() -> Result<(), Error> {
    let arguments = Arguments::parse();
    let mut total = Score::default();
    println!("{}", Score::header());
    for path in &arguments.clips {
        let score = evaluate(&arguments, path)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        println!("{}", score.line(&name));
        total.add(score);
    }
    println!("{}", total.line("all"));
    Ok(())
}

fn evaluate(arguments: &Arguments, path: &std::path::Path) -> Result<Score, Error> {
    let change = Change {
        filter: arguments.filter.clone(),
        scale: arguments.scale,
        mirror: arguments.mirror,
        jpeg: arguments.jpeg,
    };
    let mut clip = Clip::open(path, &change)?;
    let objects = clip.truth.objects.iter().map(|&(id, side_m)| MarkerObject { id, side_m }).collect();
    let mut config = PerceptionConfig::new(&arguments.runtime, objects);
    let size = |lite| if lite { ModelSize::Lite } else { ModelSize::Full };
    config.hands.landmark_model = size(arguments.lite_landmarks);
    config.hands.palm_model = size(arguments.lite_palm);
    let side = if arguments.mirror { Side::Left } else { Side::Right };
    config.hands.sides = if arguments.both { vec![Side::Right, Side::Left] } else { vec![side] };

    let mut perceiver = Perceiver::new(&config)?;
    let mut score = Score::default();
    let mut dump = arguments.dump.as_ref().map(std::fs::File::create).transpose()?;
    let mut number = 0;
    while clip.advance()? {
        let truth = clip.truth.frames.get(number).ok_or("the clip is longer than its truth")?;
        if number % arguments.every == 0 {
            let captured_ns = (number as f64 / clip.truth.fps * 1e9) as u64;
            let begin = std::time::Instant::now();
            let detections = perceiver.perceive(clip.image()?, captured_ns, number as u64)?;
            score.frame(truth, &detections, side, [clip.width, clip.height], begin.elapsed());
            if let Some(file) = &mut dump {
                score::dump(file, &detections)?;
            }
        }
        number += 1;
    }
    Ok(score)
}
