//! Commands that set up a bench: what the camera sees, and where things lie.

use std::path::PathBuf;

use clap::Args;

use super::ConfigArgs;

/// `andond calibrate`
#[derive(Debug, Args)]
pub struct Calibrate {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// A picture that shows the four markers
    pub picture: PathBuf,
    /// A marker that lies on the bench: its id and the position of its centre, in metres; name four
    #[arg(long = "marker", value_name = "ID=X,Y", required = true)]
    pub markers: Vec<String>,
    /// Side of the markers' black square, in metres
    #[arg(long, value_name = "METRES")]
    pub side: f32,
    /// The calibration file to write
    #[arg(short, long)]
    pub out: PathBuf,
}

/// `andond record`
#[derive(Debug, Args)]
pub struct Record {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// The track file to write
    #[arg(short, long, value_name = "FILE.tracks.jsonl")]
    pub out: PathBuf,
    /// Replace an existing file
    #[arg(long)]
    pub force: bool,
}

/// `andond tracks`
#[derive(Debug, Args)]
pub struct Tracks {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// A film or a folder of pictures
    pub film: PathBuf,
    /// The track file to write
    #[arg(short, long, value_name = "FILE.tracks.jsonl")]
    pub out: PathBuf,
    /// Replace an existing file
    #[arg(long)]
    pub force: bool,
}
