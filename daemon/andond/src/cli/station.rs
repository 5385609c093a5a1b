//! Commands that run a station, and those that look at one that runs or has run.

use std::path::PathBuf;

use andon_host::cli::ConfigArgs;
use clap::{Args, ValueEnum};

/// `andond demo`
#[derive(Debug, Args)]
pub struct Demo {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Folder with the clips [default: tests/footage in the current folder, or /usr/share/andon]
    #[arg(long, value_name = "FOLDER")]
    pub clips: Option<PathBuf>,
    /// Job to watch [default: config/jobs/polish-and-measure.toml in the current folder, or the same in /etc/andon/jobs]
    #[arg(long)]
    pub job: Option<PathBuf>,
    /// Play at the clips' own rate (file), or as fast as the line can (max)
    #[arg(long, value_enum, default_value_t = Speed::File)]
    pub speed: Speed,
    /// Write a copy of each clip into this folder, with what was seen and judged drawn on it
    #[arg(long, value_name = "FOLDER")]
    pub annotate: Option<PathBuf>,
    /// Show on a board what just ran, with clips of the faults, and play the first clip again and again, until Ctrl-C. Only this machine reaches it
    #[arg(long)]
    pub board: bool,
}

/// How fast a recording is played.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Speed {
    /// At its own rate.
    File,
    /// As fast as the readers can; nothing is dropped.
    Max,
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
    /// Print one JSON object per verdict, and one of the kind Sight or Outage where nobody watched. Numbers of activities and IUs count from 0
    #[arg(long)]
    pub json: bool,
    /// Show times of day in UTC instead of local time
    #[arg(long)]
    pub utc: bool,
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
    /// Show times of day in UTC instead of local time
    #[arg(long)]
    pub utc: bool,
}

/// `andond explain`
#[derive(Debug, Args)]
pub struct Explain {
    /// Codes, as AND-307, and-307 or 307; without any, all codes are listed
    #[arg(value_name = "CODE")]
    pub codes: Vec<String>,
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
    /// Show only the job with this name or number
    #[arg(long, value_name = "NAME|NUMBER")]
    pub job: Option<String>,
    /// Show only the part with this id; an empty one shows what was judged without an id
    #[arg(long, value_name = "ID")]
    pub part: Option<String>,
    /// Show only anomalies and what could not be judged
    #[arg(long)]
    pub nok: bool,
    /// Show who has changed what instead: commands, job loads, configuration, program
    #[arg(long, conflicts_with_all = ["job", "part", "nok"])]
    pub audit: bool,
    /// Show how many pieces were right, wrong and not judged instead, and by which fault
    #[arg(long, conflicts_with_all = ["audit", "nok", "csv"])]
    pub summary: bool,
    /// Draw the faults by their frequency and the wrong pieces over time into this file
    #[arg(long, value_name = "FILE.svg", conflicts_with_all = ["audit", "nok", "csv"])]
    pub plot: Option<PathBuf>,
    /// Print comma-separated values instead of a table; times are in UTC, and activities and IUs count from 0
    #[arg(long)]
    pub csv: bool,
    /// Print what this question finds instead, as comma-separated values. The tables are verdict, gap, not_watching and audit; the column clip of verdict
    /// is the recording that shows it, or NULL
    #[arg(long, value_name = "SELECT", conflicts_with_all = ["since", "job", "part", "nok", "audit", "summary", "plot", "csv", "utc"])]
    pub sql: Option<String>,
    /// Show times in UTC instead of local time
    #[arg(long)]
    pub utc: bool,
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

/// `andond clip`
#[derive(Debug, Args)]
pub struct Clip {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// The number of a verdict, as `andond history` shows it behind a row that has a clip
    #[arg(value_name = "ID")]
    pub row: u64,
    /// Write a film of it, with what was seen and judged drawn on it
    #[arg(long, value_name = "FILE.mp4")]
    pub annotate: Option<PathBuf>,
}

/// `andond confirm`
#[derive(Debug, Args)]
pub struct Confirm {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// The number of a verdict, as `andond history` shows it behind a row that has a clip
    #[arg(value_name = "ID")]
    pub row: u64,
    /// Whether the work was right, whatever the verdict says
    #[arg(value_enum)]
    pub was: Was,
}

/// What a person says of the work that a verdict is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Was {
    /// It was right.
    Right,
    /// It was wrong.
    Wrong,
}

impl From<Was> for andon_board::Was {
    fn from(was: Was) -> Self {
        match was {
            Was::Right => Self::Right,
            Was::Wrong => Self::Wrong,
        }
    }
}

/// `andond forget`
#[derive(Debug, Args)]
pub struct Forget {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Remove the recordings that ended before this time (RFC 3339) or this span before now (`8h`, `30d`), the pictures of the steps of jobs that
    /// were taught before it, and the pictures of the bench that an engineer took before it
    #[arg(long, value_name = "DATE", required_unless_present = "part")]
    pub before: Option<String>,
    /// Remove the recordings that show work on the part with this id, and the pictures of the bench that an engineer took: each may show it
    #[arg(long, value_name = "ID", conflicts_with = "before")]
    pub part: Option<String>,
}
