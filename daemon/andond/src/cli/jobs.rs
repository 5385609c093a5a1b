//! Commands that learn a job, judge recordings by it, and look into both.

use std::path::PathBuf;

use andon_core::job::LocalCost;
use andon_host::cli::ConfigArgs;
use clap::{Args, ValueEnum};

/// `andond teach`
#[derive(Debug, Args)]
pub struct Teach {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Correct runs of the whole job: films, folders of pictures, track files and recordings (.mcap), also mixed. With --add and --without: those of the
    /// existing job, unless they are beside the job file or in the current folder
    #[arg(required_unless_present_any = ["add", "without", "live", "from_history"])]
    pub recordings: Vec<PathBuf>,
    /// The job file to write; with --add and --without the one to change
    #[arg(short, long, value_name = "JOB.toml")]
    pub out: PathBuf,
    /// Show the job at the bench instead, through the running station or else its camera. It says what to do, and writes each run that
    /// is kept to a track file beside the job file
    #[arg(long, conflicts_with_all = ["add", "without"])]
    pub live: bool,
    /// How many runs to show with --live
    #[arg(long, value_name = "NUMBER", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    pub count: u16,
    /// Also the runs in the recordings of the station that a person has confirmed to be right (`andond confirm ID right`). They are written to track
    /// files beside the job file; an existing job is taught again with them
    #[arg(long, conflicts_with = "live")]
    pub from_history: bool,
    /// One more correct run for an existing job; can be repeated
    #[arg(long, value_name = "RECORDING")]
    pub add: Vec<PathBuf>,
    /// The name of a recording that the existing job should no longer be taught from; can be repeated
    #[arg(long, value_name = "NAME")]
    pub without: Vec<String>,
    /// How strict the job is, 1 to 5. Its measures accuse one right job in 133, 67, 33, 17 or 8. The stricter it is, the less evidence makes the
    /// order of two steps a law. Up to 3 a rule gives way to one run that contradicts it, at 4 to two, at 5 to none. [default: 3, or that of the job]
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u8).range(1..=5))]
    pub strictness: Option<u8>,
    /// Write the report as a page, with pictures of the steps, of their order, and of runs that stand out among the others
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,
    /// Draw the steps of the job and their order into this file
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Keep one small picture of each step beside the job file, out of the films that it is taught from. None comes out of a recording of the station.
    /// The worker's page of the board shows it. What record.bench and record.masks hide is black
    #[arg(long)]
    pub pictures: bool,
    /// The number by which a PLC selects the job. [default: its own if it is taught again, else the smallest that no job of the station or beside it
    /// has]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    pub id: Option<u32>,
    /// Name of the job [default: that of the job if it is taught again, else the name of the job file]
    #[arg(long)]
    pub name: Option<String>,
    /// Rule for the thresholds [default: leave-one-out, or that of the job]
    #[arg(long, value_enum)]
    pub rule: Option<ThresholdRule>,
    /// How motions are compared [default: circular, or that of the job]
    #[arg(long, value_enum)]
    pub cost: Option<Cost>,
    /// Whether the steps must come in the order that most runs have, or may come in any. [default: what all runs show is law, with enough evidence]
    #[arg(long, value_name = "true|false")]
    pub order: Option<bool>,
    /// Write the job even if the report says that the runs cannot be trusted, and replace existing files
    #[arg(long)]
    pub force: bool,
}

/// How thresholds are taught.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ThresholdRule {
    /// The paper's: mean + 2 sigma of the runs' distances to their barycentre.
    Paper,
    /// The distance of each run to the barycentre of the others.
    LeaveOneOut,
    /// Leave-one-out distances, at a stated rate of false alarms.
    Conformal,
}

/// How motions are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Cost {
    /// The paper's: features are numbers, each divided by the length of its range.
    Normalised,
    /// Features are numbers, each in its own unit.
    Ordinal,
    /// Directions are points on a circle.
    Circular,
}

impl Cost {
    /// The cost with this number of direction bins.
    pub fn local(self, bins: u8) -> LocalCost {
        match self {
            Self::Normalised => LocalCost::Normalised { bins },
            Self::Ordinal => LocalCost::Ordinal,
            Self::Circular => LocalCost::Circular { bins },
        }
    }
}

/// `andond replay`
#[derive(Debug, Args)]
pub struct Replay {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// The taught job [default: those that were in force, of a recording of the role `record`]
    #[arg(short, long)]
    pub job: Option<PathBuf>,
    /// A film, a folder of pictures, a track file, or a recording of the role `record` (.mcap)
    pub recording: PathBuf,
    /// Look at the pictures of a recording of the role `record` again, instead of judging what was detected then. It says first which libraries and
    /// processor features differ from those of the recording, and then how many detections are equal
    #[arg(long, conflicts_with = "job")]
    pub from_frames: bool,
    /// Print one JSON object per verdict; `distribution` in it is where an IU that is not right lies among the runs that were shown
    #[arg(long)]
    pub json: bool,
    /// Write a copy of the film, with what was seen and judged drawn on it
    #[arg(long, value_name = "FILE.mp4")]
    pub annotate: Option<PathBuf>,
}

/// `andond segment`
#[derive(Debug, Args)]
pub struct Segment {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// A film, a folder of pictures or a track file
    pub recording: PathBuf,
    /// The job whose runs show where hands and parts meet [default: where the station says it]
    #[arg(long, value_name = "FILE")]
    pub job: Option<PathBuf>,
    /// Print one JSON object per event
    #[arg(long)]
    pub json: bool,
    /// Draw the features and contexts over time, one lane each, with the IUs and activities as bands
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
}

/// Who did what in each recording of a folder.
#[derive(Debug, Default, Args)]
pub struct Names {
    /// How the names of the recordings say who did what, without their endings: {person}, {what} and {run}, and * for anything
    /// [default: p<person>_<what>_r<n>]
    #[arg(long, value_name = "PATTERN", conflicts_with = "runs")]
    pub names: Option<String>,
    /// A table that says it instead: the columns file, person and what, as .csv or as .toml with [[runs]]
    #[arg(long, value_name = "FILE.csv|FILE.toml")]
    pub runs: Option<PathBuf>,
}

/// `andond analyze`
#[derive(Debug, Args)]
pub struct Analyze {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Folder of recordings: track files and films; films need a station
    pub recordings: PathBuf,
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub names: Names,
    /// Folder to write the report into
    #[arg(short, long, value_name = "FOLDER")]
    pub out: PathBuf,
}

/// `andond experiment`
#[derive(Debug, Args)]
pub struct Experiment {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Which experiment of the paper: 1 or 2
    #[arg(value_parser = clap::value_parser!(u8).range(1..=2))]
    pub number: u8,
    /// Folder of recordings: track files and films; several with --ladder
    #[arg(required = true)]
    pub recordings: Vec<PathBuf>,
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub names: Names,
    /// How motions are compared [default: circular in experiment 1, each rule's own in experiment 2]
    #[arg(long, value_enum)]
    pub cost: Option<Cost>,
    /// What each rule gains in experiment 2, all folders side by side in one table
    #[arg(long)]
    pub ladder: bool,
}

/// `andond jobs`
#[derive(Debug, Args)]
pub struct Jobs {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Folder of job files [default: the jobs of the station]
    pub folder: Option<PathBuf>,
    /// Print one JSON object per job
    #[arg(long)]
    pub json: bool,
}

/// `andond use`
#[derive(Debug, Args)]
pub struct Use {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// The job: its name, its number or its file, as `andond jobs` lists them
    #[arg(value_name = "NAME|NUMBER|FILE")]
    pub job: String,
    /// Wait until no job is running, for so many seconds at most
    #[arg(long, value_name = "SECONDS")]
    pub when_idle: Option<u32>,
    /// A file that is removed, also from the disk, once the job is in force and before that is said. The role executor notes there what is to be put back
    #[arg(long, value_name = "FILE", hide = true)]
    pub forget: Option<PathBuf>,
}

/// `andond name`
#[derive(Debug, Args)]
pub struct Name {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// The job: its name, its number or its file, as `andond jobs` lists them
    #[arg(value_name = "NAME|NUMBER|FILE")]
    pub job: String,
    /// A name for each step, in the order of the steps
    #[arg(required = true, value_name = "STEP")]
    pub steps: Vec<String>,
}

/// `andond whatif`
#[derive(Debug, Args)]
pub struct Whatif {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// The job that might be used
    #[arg(short, long)]
    pub job: PathBuf,
    /// Look only at what was recorded after this time (RFC 3339) or within this span before now (`90m`, `8h`, `7d`)
    #[arg(long)]
    pub since: Option<String>,
}
