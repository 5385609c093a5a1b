//! The command line: one variant per command, one file per command in [`crate::tool`], one file per role in
//! [`crate::role`].

use std::path::PathBuf;

use andon_core::job::LocalCost;
use clap::{Args, Parser, Subcommand, ValueEnum};

/// An andon cord that pulls itself: learns a manual job from a few demonstrations, then checks every step.
#[derive(Debug, Parser)]
#[command(name = "andond", version, propagate_version = true, max_term_width = 100)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The configuration that most commands read.
#[derive(Clone, Debug, Default, Args)]
pub struct ConfigArgs {
    /// Configuration files; a later one overrides an earlier one [default: $ANDON_CONFIG, config/stations/demo.toml in
    /// the current folder, or /etc/andon/andon.toml]
    #[arg(short = 'c', long = "config", value_name = "FILE")]
    pub files: Vec<PathBuf>,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Start every role, play the shipped clips and print what a technician would read
    Demo(Demo),
    /// Learn a job from recordings of correct runs; exit 0: written, 1: the runs cannot be trusted and nothing was written
    Teach(Teach),
    /// Judge a recording against a taught job; exit 0: all correct, 1: an anomaly, 2: something could not be judged
    Replay(Replay),
    /// Print the ERUs, IUs, activities and the job of a recording
    Segment(Segment),
    /// Find the bench in a picture of four markers at known positions
    Calibrate(Calibrate),
    /// Write what a running station sees, or a film shows, to a track file
    Record(Record),
    /// Run one role of a station in this process
    Run(Run),
    /// Read the configuration and report every fault in it
    Check(Check),
    /// Print the annotated reference configuration, or the one in force
    Config(ConfigCommand),
    /// Follow the verdicts of a running station
    Tail(Tail),
    /// Show how every role of a running station is doing; exit 0: all are healthy, 1: some are not
    Status(Status),
    /// Query the journal
    History(History),
    /// Write jobs, configuration and journal of a station to one file, also while it runs
    Backup(Backup),
    /// Put back what `andond backup` wrote; the station must not run
    Restore(Restore),
    /// Wait until no job is running; exit 0: none is, 1: one still is
    Idle(Idle),
    /// Say which part comes next: its id goes with every verdict of the job that begins next
    Part(Part),
    /// Compare and cluster the IUs of a folder of recordings; write a report
    Analyze(Analyze),
    /// Repeat an experiment of the paper on a folder of recordings
    Experiment(Experiment),
}

/// `andond demo`
#[derive(Debug, Args)]
pub struct Demo {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Folder with the clips
    #[arg(long, default_value = "tests/footage")]
    pub clips: PathBuf,
    /// Job to watch
    #[arg(long, default_value = "config/jobs/polish-and-measure.toml")]
    pub job: PathBuf,
    /// Play at the clips' own rate (file), or as fast as the line can (max)
    #[arg(long, value_enum, default_value_t = Speed::File)]
    pub speed: Speed,
    /// Write a copy of each clip into this folder, with what was seen and judged drawn on it
    #[arg(long, value_name = "FOLDER")]
    pub annotate: Option<PathBuf>,
}

/// How fast a recording is played.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Speed {
    /// At its own rate.
    File,
    /// As fast as the readers can; nothing is dropped.
    Max,
}

/// `andond teach`
#[derive(Debug, Args)]
pub struct Teach {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Correct runs of the whole job: films, folders of pictures or track files; with --add and --without those that the job was taught
    /// from and that are neither beside the job file nor in the current folder
    #[arg(required_unless_present_any = ["add", "without"])]
    pub recordings: Vec<PathBuf>,
    /// The job file to write; with --add and --without the one to change
    #[arg(short, long)]
    pub out: PathBuf,
    /// One more correct run for an existing job; can be repeated
    #[arg(long, value_name = "RECORDING")]
    pub add: Vec<PathBuf>,
    /// The name of a recording that the existing job should no longer be taught from; can be repeated
    #[arg(long, value_name = "NAME")]
    pub without: Vec<String>,
    /// How strict the job is, 1 to 5: at 1 its measures accuse one right job in 133, then one in 67, 33 and 17, at 5 one in 8, and less
    /// evidence makes the order of two steps a law [default: 3]
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u8).range(1..=5))]
    pub strictness: Option<u8>,
    /// Draw the steps of the job and their order into this file
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// The number by which a PLC selects the job [default: 1]
    #[arg(long)]
    pub id: Option<u32>,
    /// Name of the job [default: the name of the job file]
    #[arg(long)]
    pub name: Option<String>,
    /// Rule for the thresholds [default: leave-one-out]
    #[arg(long, value_enum)]
    pub rule: Option<ThresholdRule>,
    /// How motions are compared [default: circular]
    #[arg(long, value_enum)]
    pub cost: Option<Cost>,
    /// Whether the steps must come in the order in which most runs have them, or may come in any [default: what all runs show is law where
    /// the evidence is enough]
    #[arg(long)]
    pub order: Option<bool>,
    /// Write the job even if the report says that the runs cannot be trusted, and even over an existing file
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
    /// The taught job
    #[arg(short, long)]
    pub job: PathBuf,
    /// A film, a folder of pictures or a track file
    pub recording: PathBuf,
    /// Print one JSON object per verdict
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
    /// Print one JSON object per event
    #[arg(long)]
    pub json: bool,
    /// Draw the features and contexts over time, one lane each, with the IUs and activities as bands
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
}

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
    /// A film or a folder of pictures, so that it need not be processed again for what is done with it later [default: the running station]
    pub recording: Option<PathBuf>,
    /// The track file to write
    #[arg(short, long)]
    pub out: PathBuf,
}

/// `andond run`
#[derive(Debug, Args)]
pub struct Run {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Use the files as they are, even if the running line uses others
    #[arg(long)]
    pub as_given: bool,
    /// The role
    #[arg(value_enum)]
    pub role: Role,
}

/// A role of the line, one process each, in the order of the data path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Role {
    /// Owns every channel and removes what dead processes leave behind
    Steward,
    /// Takes frames from the camera or the recording
    Capture,
    /// Turns frames into detections
    Perceive,
    /// Turns detections into feature couples
    Encode,
    /// Turns feature couples into verdicts
    Judge,
    /// Writes verdicts to the database
    Journal,
    /// Passes verdicts to the PLC, and its commands to the judge
    Plc,
    /// Counts what the line does, for a monitoring system
    Metrics,
}

/// `andond check`
#[derive(Debug, Args)]
pub struct Check {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
}

/// `andond config`
#[derive(Debug, Args)]
pub struct ConfigCommand {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Print the annotated reference: every key with its meaning, unit, range and default
    #[arg(long)]
    pub default: bool,
}

/// `andond tail`
#[derive(Debug, Args)]
pub struct Tail {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Print one JSON object per verdict
    #[arg(long)]
    pub json: bool,
    /// Show only anomalies and what could not be judged
    #[arg(long)]
    pub nok: bool,
    /// Show only this level
    #[arg(long, value_enum)]
    pub level: Option<Level>,
}

/// The level of a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Level {
    /// Interaction Units.
    Iu,
    /// Activities.
    Activity,
    /// Jobs.
    Job,
}

/// `andond status`
#[derive(Debug, Args)]
pub struct Status {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// `andond history`
#[derive(Debug, Args)]
pub struct History {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Show only what was decided after this time (RFC 3339) or within this span before now (`90m`, `8h`, `7d`)
    #[arg(long)]
    pub since: Option<String>,
    /// Show only the job with this number
    #[arg(long)]
    pub job: Option<u32>,
    /// Show only the part with this id; an empty one shows what was judged without an id
    #[arg(long, value_name = "ID")]
    pub part: Option<String>,
    /// Show only anomalies and what could not be judged
    #[arg(long)]
    pub nok: bool,
    /// Show who has changed what instead: commands, job loads, configuration, program
    #[arg(long, conflicts_with_all = ["job", "part", "nok"])]
    pub audit: bool,
    /// Print comma-separated values instead of a table
    #[arg(long)]
    pub csv: bool,
}

/// `andond backup`
#[derive(Debug, Args)]
pub struct Backup {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// The archive to write (tar)
    pub archive: PathBuf,
}

/// `andond restore`
#[derive(Debug, Args)]
pub struct Restore {
    /// The archive that `andond backup` wrote
    pub archive: PathBuf,
    /// Only show what is in it, and check it
    #[arg(long)]
    pub list: bool,
    /// Replace existing files that differ
    #[arg(long)]
    pub replace: bool,
    /// Put the files under this folder instead of where they were
    #[arg(long, value_name = "FOLDER")]
    pub into: Option<PathBuf>,
}

/// `andond idle`
#[derive(Debug, Args)]
pub struct Idle {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// How long to wait, in seconds
    #[arg(long, default_value_t = 300)]
    pub timeout: u32,
}

/// `andond part`
#[derive(Debug, Args)]
pub struct Part {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// The part or serial id, printable ASCII, at most 32 characters; "" for none
    pub id: String,
}

/// `andond analyze`
#[derive(Debug, Args)]
pub struct Analyze {
    /// Folder of recordings (track files)
    pub recordings: PathBuf,
    /// Folder to write the report into
    #[arg(short, long)]
    pub out: PathBuf,
}

/// `andond experiment`
#[derive(Debug, Args)]
pub struct Experiment {
    /// Which experiment of the paper: 1 or 2
    #[arg(value_parser = clap::value_parser!(u8).range(1..=2))]
    pub number: u8,
    /// Folder of recordings (track files); several with --ladder
    #[arg(required = true)]
    pub recordings: Vec<PathBuf>,
    /// How motions are compared [default: circular in experiment 1, each rule's own in experiment 2]
    #[arg(long, value_enum)]
    pub cost: Option<Cost>,
    /// What each rule gains in experiment 2, all folders side by side in one table
    #[arg(long)]
    pub ladder: bool,
}
