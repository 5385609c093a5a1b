//! Measures perception against clips whose truth is known.
//!
//! Every clip `NAME.mp4` has its truth beside it in `NAME.truth.jsonl` (see `tests/footage/README.md`). `ffmpeg` decodes the
//! clips.

mod clip;
mod detected;
mod errors;
mod metric;
mod profile;
mod sight;
mod speed;
mod truth;

use andon_perception::config::{HandsConfig, MarkerSearch, MarkersConfig, ThreadsConfig};
use andon_perception::{Perceiver, PerceptionConfig};
use clap::{Parser, Subcommand};
use std::path::{Path, PathBuf};
use truth::Truth;

type Error = Box<dyn std::error::Error + Send + Sync>;

#[derive(Parser)]
struct Arguments {
    #[command(subcommand)]
    measurement: Measurement,
    /// Folder of the models and ONNX Runtime.
    #[arg(long, global = true, env = "ANDON_RUNTIME", default_value = "target/runtime")]
    runtime: PathBuf,
}

#[derive(Subcommand)]
enum Measurement {
    /// How well hands and markers are detected, and how long it takes: one row per clip.
    Detected(detected::Arguments),
    /// What is said of a picture that something is done to, and after how long: one row per clip and change.
    Sight(sight::Arguments),
    /// How far landmarks and markers are from the truth in three dimensions.
    Metric(metric::Arguments),
    /// How fast frames are looked at, as one line of JSON.
    Speed(speed::Arguments),
    /// Draws which thread does what when while a frame is looked at.
    Profile(profile::Arguments),
}

fn main() -> Result<(), Error> {
    let Arguments { measurement, runtime } = Arguments::parse();
    match measurement {
        Measurement::Detected(arguments) => detected::run(&arguments, &runtime),
        Measurement::Sight(arguments) => sight::run(&arguments, &runtime),
        Measurement::Metric(arguments) => metric::run(&arguments, &runtime),
        Measurement::Speed(arguments) => speed::run(&arguments, &runtime),
        Measurement::Profile(arguments) => profile::run(&arguments, &runtime),
    }
}

/// A perceiver for the objects of a clip, as it is where nothing is configured.
fn usual_perceiver(runtime: &Path, truth: &Truth) -> Result<Perceiver, Error> {
    perceiver(runtime, truth, HandsConfig::default(), MarkerSearch::Near, ThreadsConfig::default())
}

/// A perceiver for the objects of a clip.
fn perceiver(
    runtime: &Path,
    truth: &Truth,
    hands: HandsConfig,
    search: MarkerSearch,
    threads: ThreadsConfig,
) -> Result<Perceiver, Error> {
    let markers = MarkersConfig { objects: truth.objects.clone(), search, ..MarkersConfig::default() };
    Ok(Perceiver::new(&PerceptionConfig { runtime: runtime.into(), hands, markers, threads }, None)?)
}
