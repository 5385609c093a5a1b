//! Commands that set up a bench: what the camera sees, and where things lie.

use std::path::PathBuf;

use andon_host::cli::ConfigArgs;
use clap::{Args, ValueEnum};

use super::metres::{Named, named, side};

/// `andond new`
#[derive(Debug, Args)]
pub struct New {
    /// Name of the station: 1 to 16 of the characters a-z, 0-9 and '-'
    pub name: String,
    /// A part or a tool that carries a marker, and the side of the marker's black square, as in brick=0.033; can be repeated. Without a side
    /// of its own it has that of --side. Without any --part, a terminal is asked
    #[arg(long = "part", value_name = "NAME[=METRES]", value_parser = named)]
    pub parts: Vec<Named>,
    /// Side of the markers' black square, in metres [default: 0.04]
    #[arg(long, value_name = "METRES", value_parser = side)]
    pub side: Option<f64>,
    /// Where the frames come from: a device such as /dev/video0, the word realsense, a film, a .bag file or a folder of pictures
    /// [default: /dev/video0]
    #[arg(long, value_name = "SOURCE")]
    pub camera: Option<String>,
    /// The hands that work here [default: both]
    #[arg(long, value_enum)]
    pub hands: Option<Hands>,
    /// Give it a board on this port of the machine, on which an engineer teaches jobs; a station beside it needs another port
    #[arg(long, value_name = "PORT", num_args = 0..=1, require_equals = true, default_missing_value = "9465", value_parser = clap::value_parser!(u16).range(1..))]
    pub board: Option<u16>,
    /// The language of that board
    #[arg(long, value_name = "CODE", requires = "board", default_value = "en", value_parser = ["de", "en", "es", "fr", "zh"])]
    pub language: String,
    /// The station file to write [default: NAME.toml]
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Replace an existing file
    #[arg(long)]
    pub force: bool,
}

/// `andond install`
#[derive(Debug, Args)]
pub struct Install {
    /// The file of the station, as `andond new --board` or an engineer on the board of another station has written it
    pub file: PathBuf,
    /// An engineer who may log in to its board. The password is asked for, or read from the standard input
    #[arg(long, value_name = "NAME")]
    pub engineer: Option<String>,
}

/// The hands that are looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Hands {
    /// The right one.
    Right,
    /// The left one.
    Left,
    /// The right and the left one.
    Both,
}

/// `andond markers`
#[derive(Debug, Args)]
pub struct Markers {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Folder for NAME-markers.pdf and one SVG for each of its sheets
    #[arg(short, long, default_value = ".", value_name = "FOLDER")]
    pub out: PathBuf,
    /// The paper in the printer
    #[arg(long, value_enum, default_value_t = Paper::A4)]
    pub paper: Paper,
    /// How often the marker of each part is printed
    #[arg(long, default_value_t = 1, value_name = "NUMBER", value_parser = clap::value_parser!(u16).range(1..=50))]
    pub copies: u16,
    /// How many markers more are printed, with ids that no part has yet
    #[arg(long, default_value_t = 2, value_name = "NUMBER", value_parser = clap::value_parser!(u16).range(0..=50))]
    pub spare: u16,
    /// Where the four markers for `andond calibrate` lie: the corners of a rectangle of this width and depth, in metres
    #[arg(long, default_value = "0.5x0.3", value_name = "WIDTHxDEPTH")]
    pub bench: String,
    /// Replace existing files
    #[arg(long)]
    pub force: bool,
}

/// A size of paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Paper {
    /// 210 x 297 mm.
    A4,
    /// 8.5 x 11 inches.
    Letter,
}

/// `andond look`
#[derive(Debug, Args)]
pub struct Look {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// A film, a folder of pictures or a picture [default: the running station, or else its camera]
    pub source: Option<PathBuf>,
    /// Write the picture as the camera gives it, for `andond calibrate`
    #[arg(long, value_name = "FILE.png|FILE.jpg")]
    pub save: Option<PathBuf>,
    /// Write the picture with what is seen in it
    #[arg(long, value_name = "FILE.png|FILE.jpg")]
    pub annotated: Option<PathBuf>,
    /// Show it live in a page on this machine, until Ctrl-C, at this port
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = "8010")]
    pub page: Option<u16>,
    /// How long a camera is looked at, in seconds; of a recording all of it is
    #[arg(long, default_value_t = 3.0, value_name = "SECONDS")]
    pub seconds: f32,
}

/// `andond calibrate`
#[derive(Debug, Args)]
pub struct Calibrate {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// A picture that shows the four markers, as `andond look --save` writes it
    pub picture: PathBuf,
    /// A marker that lies on the bench: its id and where its centre is, in metres. X is to the right and Y away from the worker. Name four
    /// or more
    #[arg(long = "marker", value_name = "ID=X,Y", required = true)]
    pub markers: Vec<String>,
    /// Side of the markers' black square, in metres, as measured on the print
    #[arg(long, value_name = "METRES", value_parser = side)]
    pub side: f64,
    /// Draw into this picture where each marker lies and where the others place it
    #[arg(long, value_name = "FILE.png|FILE.jpg")]
    pub plot: Option<PathBuf>,
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
