//! The command line: one variant per command, one file per command in [`crate::tool`], one file per role in
//! [`crate::role`].

mod bench;
mod jobs;
mod station;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

pub use bench::{Calibrate, Record};
pub use jobs::{Analyze, Cost, Experiment, Replay, Segment, Teach, ThresholdRule};
pub use station::{
    Backup, Check, ConfigCommand, Demo, Explain, History, Idle, Level, Part, Restore, Role, Run, Speed,
    Status, Tail,
};

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
    /// Say what the code of a message means and what to do, or list all codes
    Explain(Explain),
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
