//! The command line: one variant per command, one file per command in [`crate::tool`], one file per role in
//! [`crate::role`].

mod bench;
pub mod board;
mod help;
mod jobs;
pub mod metres;
mod station;
#[cfg(test)]
mod written;

use std::path::PathBuf;

use andon_host::cli::Run;
use clap::{Args, Parser, Subcommand};

pub use help::command;
pub(crate) use help::{examples, exit_codes, exit_table};

pub use bench::{Calibrate, Hands, Install, Look, Markers, New, Paper, Record, Tracks};
pub use jobs::{
    Analyze, Cost, Experiment, Jobs, Name, Names, Replay, Segment, Teach, ThresholdRule, Use, Whatif,
};
pub use station::{
    Backup, Check, Clip, ConfigCommand, Confirm, Demo, Explain, Forget, History, Idle, Level, Part, Restore,
    Speed, Status, Tail, Was,
};

/// An andon cord that pulls itself: learns a manual job from a few demonstrations, then checks every step.
#[derive(Debug, Parser)]
#[command(name = "andond", version, propagate_version = true, max_term_width = 100)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Start every role, play the shipped clips and print what a technician would read
    Demo(Demo),
    /// Write the file of a new station: its parts, their markers, its camera
    New(New),
    /// Install a station that was written: its file, an engineer's login, and its start
    Install(Install),
    /// Print the markers of a station in true size, as PDF and SVG
    Markers(Markers),
    /// Show what the camera sees and say what to improve: light, sharpness, sizes of markers, hands
    Look(Look),
    /// Learn a job from recordings of correct runs, or from runs at the bench
    Teach(Teach),
    /// Judge a recording against a taught job; the exit code is the verdict
    Replay(Replay),
    /// Print the contacts (ERUs, IUs), the activities and the job of a recording
    Segment(Segment),
    /// Find the bench in a picture of four markers at known positions
    Calibrate(Calibrate),
    /// Write what a running station sees to a track file
    Record(Record),
    /// Write what a film shows to a track file
    Tracks(Tracks),
    /// List the jobs of a station, with the one in force
    Jobs(Jobs),
    /// Load a job into a running station
    Use(Use),
    /// Name the steps of a job: what people read of them
    Name(Name),
    /// Run one role of a station in this process
    Run(Run),
    /// Read the configuration and report every fault in it
    Check(Check),
    /// Print the annotated reference configuration, or the one in force
    Config(ConfigCommand),
    /// Follow the verdicts of a running station
    Tail(Tail),
    /// Show how every role of a running station is doing; the exit code says whether all are healthy
    Status(Status),
    /// Say what the code of a message means and what to do, or list all codes
    Explain(Explain),
    /// Query the journal
    History(History),
    /// Find the recording of a verdict
    Clip(Clip),
    /// Say whether a verdict was right: the journal keeps it, and `andond teach --from-history` learns from it
    Confirm(Confirm),
    /// Say what another job would have said of what was recorded; the exit code is as that of replay
    Whatif(Whatif),
    /// Remove recordings and pictures before their time; the journal keeps who has done it
    Forget(Forget),
    /// Write jobs, configuration, journal and what was made for an engineer to one file, also while the station runs
    Backup(Backup),
    /// Put back what `andond backup` wrote; the station must not run
    Restore(Restore),
    /// Wait until no job is running; the exit code says whether one still is
    Idle(Idle),
    /// Set the part id of the next part: it goes with every verdict of the job that begins next
    Part(Part),
    /// Make the board safe on a network: its certificate, its logins, its kiosks
    Board(board::Board),
    /// Compare and cluster the IUs of a folder of recordings; write a report
    Analyze(Analyze),
    /// Repeat an experiment of the paper on a folder of recordings
    Experiment(Experiment),
    /// Print what a shell needs to complete command lines
    Completions(Completions),
    /// Say what the exit code of each command means
    #[command(hide = true)]
    ExitCodes,
    /// Write the man pages into a folder
    #[command(hide = true)]
    Man(ManPages),
}

/// `andond completions`
#[derive(Debug, Args)]
pub struct Completions {
    /// The shell
    #[arg(value_enum)]
    pub shell: clap_complete::Shell,
}

/// `andond man`
#[derive(Debug, Args)]
pub struct ManPages {
    /// The folder to write into
    pub folder: PathBuf,
}
