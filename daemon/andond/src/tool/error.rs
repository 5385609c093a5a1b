//! Why a command ended without a result: what it tells a person, and the exit code that says so to a program.

use std::io;
use std::path::PathBuf;
use std::process::ExitStatus;
use std::time::Duration;

use andon_core::config::MethodFault;
use andon_core::{anomaly, couple};
use andon_host::cli::{ConfigError, NoConfiguration};
use andon_host::config::Faults;
use andon_host::exit::Code;
use andon_host::unwritten::remedy;
use andon_journal::JournalError;
use andon_learn::job_file::JobFileError;
use andon_learn::run::RunError;
use andon_learn::teach::TeachError;
use andon_perception::PerceptionError;
use andon_perception::bench::CalibrationError;
use andon_record::picture::PictureError;
use andon_study::analysis::AnalysisError;
use andon_study::experiment::ExperimentError;
use andon_study::folder::{FolderError, PatternError};
use shm_schemas::RoleId;

use super::check::Unusable;
use super::markers::LayoutError;
use super::teach::SourceError;
use crate::backup::ArchiveError;
use crate::blackbox::BlackboxError;
use crate::compatibility::Misfit;
use crate::picture::AnnotateError;
use crate::recorder::Unwritten;
use crate::recording::RecordingError;
use crate::video::VideoError;

/// Why a command ended without a result. Each message names the place and the remedy.
#[derive(Debug, thiserror::Error)]
pub enum ToolError {
    /// There is no configuration, or it has faults.
    #[error(transparent)]
    Configuration(#[from] ConfigError),
    /// The value of an option cannot be understood.
    #[error("{option} {given:?}: {expected}")]
    Option {
        /// The option.
        option: &'static str,
        /// Its value.
        given: String,
        /// What it must be, with an example.
        expected: &'static str,
    },
    /// A marker of the bench cannot be understood.
    #[error("--marker {given:?}: {expected}")]
    Marker {
        /// What was given.
        given: String,
        /// What it must be.
        expected: String,
    },
    /// The judge did not take a part id.
    #[error("the part id was not taken: {0}")]
    PartRefused(&'static str),
    /// The judge does not answer a command.
    #[error("the judge does not answer: see `andond status`")]
    NoAnswer,
    /// The station shows nothing.
    #[error("no frame comes from the station: see `andond status`")]
    NoFrames,
    /// No job of the station has this name or number.
    #[error(
        "{wanted}: no job of this name or number is in {}; there {}",
        folder.display(), listed(names)
    )]
    UnknownJob {
        /// What was given.
        wanted: String,
        /// The station's jobs.
        folder: PathBuf,
        /// The numbers and names of those that are there.
        names: Vec<String>,
    },
    /// A station loads only the jobs of its folder.
    #[error("{}: the station loads jobs from {} only: copy it there", path.display(), folder.display())]
    ForeignJob {
        /// The job file.
        path: PathBuf,
        /// The station's jobs.
        folder: PathBuf,
    },
    /// Several jobs have this name or number.
    #[error("{wanted}: several jobs are called so: give the number, or one of the files {}", files.join(", "))]
    SeveralJobs {
        /// What was given.
        wanted: String,
        /// Their files.
        files: Vec<String>,
    },
    /// A recording that brings no job along was to be judged without one.
    #[error("{}: name the job with --job; only a recording of the role `record` (.mcap) brings its own along", .0.display())]
    NoJobNamed(PathBuf),
    /// What has no pictures was to be annotated.
    #[error("--annotate needs pictures: a track file has none, nor has a recording that has lost them")]
    NothingToAnnotate,
    /// A file or a folder that is needed cannot be read.
    #[error("{}: {source}; {remedy}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
        /// What to do.
        remedy: &'static str,
    },
    /// A result cannot be written.
    #[error("{}: it cannot be written: {source}; {}", path.display(), remedy(source))]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A result would replace an existing file.
    #[error("{}: it exists already; name another file, or replace it with --force", .0.display())]
    Exists(PathBuf),
    /// A station has this name already.
    #[error("{}: a station of this name is installed: change its file there, and restart its target", .0.display())]
    Installed(PathBuf),
    /// Only root may do it.
    #[error("only an administrator installs a station: run it with sudo")]
    NotRoot,
    /// A program of the system has not done its part.
    #[error("{command}: {what}")]
    System {
        /// Its command line.
        command: String,
        /// What became of it.
        what: String,
    },
    /// The job file that the command needs is not there.
    #[error("job {}: {source}; teach it with `andond teach`", path.display())]
    NoJob {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The job file is damaged or of another version.
    #[error(transparent)]
    JobFile(#[from] JobFileError),
    /// The job does not fit the recording.
    #[error("job {}: {misfit}", path.display())]
    Misfit {
        /// The job file.
        path: PathBuf,
        /// What does not fit.
        misfit: Misfit,
    },
    /// The encoder takes neither these constants nor these objects.
    #[error("the feature couples cannot be computed: {0}; correct [method] and [[objects]]")]
    Encoder(#[from] couple::Unusable),
    /// The segmentation does not take these constants.
    #[error("the recording cannot be segmented: {0}; correct [method]")]
    Method(#[from] MethodFault),
    /// The job asks for more than can be judged.
    #[error("the job cannot be judged: {0}; teach it again with `andond teach`")]
    Judge(#[from] anomaly::Unusable),
    /// A recording cannot be used.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A recording is not a run that a job can be learned from.
    #[error("{}: {source}", path.display())]
    Run {
        /// The recording.
        path: PathBuf,
        /// Why.
        source: RunError,
    },
    /// Recordings of two spaces were given together.
    #[error("{}: recordings in plane and in metric coordinates cannot be mixed; give those of one space", .0.display())]
    MixedSpaces(PathBuf),
    /// The recordings that a job was taught from cannot be used again.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// Nothing can be learned from the runs.
    #[error(transparent)]
    Teach(#[from] TeachError),
    /// Nothing can be learned from the runs, and parts of the station are in none of them.
    #[error("{unseen}. Nothing was learned: {nothing}")]
    NotShown {
        /// The parts, and what to do.
        unseen: String,
        /// What follows from it.
        nothing: TeachError,
    },
    /// The value of `--names` cannot be understood.
    #[error("--names: {0}")]
    Names(PatternError),
    /// A folder of recordings cannot be read.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// The recordings are not enough for the experiment.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// The recordings cannot be analysed.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// A film cannot be read or written.
    #[error(transparent)]
    Video(#[from] VideoError),
    /// A film cannot be drawn on.
    #[error(transparent)]
    Annotate(#[from] AnnotateError),
    /// The markers cannot be printed.
    #[error(transparent)]
    Sheets(#[from] LayoutError),
    /// A track file was to be looked at.
    #[error("{}: a track file has no pictures; give a film, a folder of pictures or a picture", .0.display())]
    NothingToShow(PathBuf),
    /// There is no file for a certificate.
    #[error(
        "the configuration names no files for it: set board.certificate and board.key, as \"/var/lib/andon/bench1.certificate.pem\" and \
             \"/var/lib/andon/bench1.key.pem\""
    )]
    NoCertificateNamed,
    /// A certificate cannot have a name.
    #[error("the certificate cannot be made: {reason}; correct board.hosts")]
    CertificateName {
        /// What is wrong with it.
        reason: String,
    },
    /// What makes a board safe cannot be used.
    #[error(transparent)]
    UnsafeBoard(#[from] crate::boards::UnsafeBoard),
    /// A login cannot be made.
    #[error(transparent)]
    Login(#[from] andon_board::LoginsError),
    /// There is no such login.
    #[error("{name}: there is no login and no kiosk of this name in {}; `andond board logins` lists them", path.display())]
    NoLogin {
        /// The name.
        name: String,
        /// The file of logins.
        path: PathBuf,
    },
    /// A password cannot be read.
    #[error("the password cannot be read: {0}; type it twice, or give it on the standard input")]
    Password(io::Error),
    /// The journal does not keep what a person has done.
    #[error("the journal has not taken it within 5 s: see `andond status`")]
    Unkept,
    /// The journal has no such row.
    #[error(
        "{0}: the journal has no verdict of this number, or not any more; `andond history` shows the numbers"
    )]
    NoRow(u64),
    /// Of a verdict nothing was recorded.
    #[error(
        "{row}: nothing was recorded of this verdict, or it was removed: {} has no recording of it; record.mode and record.on say what is \
         recorded",
        folder.display()
    )]
    NotRecorded {
        /// The row of the verdict.
        row: u64,
        /// The folder of the recordings.
        folder: PathBuf,
    },
    /// A recording cannot be removed.
    #[error("{}: it cannot be removed: {source}; run this as the user of the station's units", path.display())]
    Remove {
        /// The recording.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Nobody has confirmed a run that was recorded.
    #[error(
        "no run to learn from: no verdict with a recording was confirmed to be right; `andond history` shows which have one, and \
         `andond confirm ID right` confirms it"
    )]
    NothingConfirmed,
    /// Nothing was recorded in this time.
    #[error("{}: there is no recording of this time; record.mode says what is recorded", .0.display())]
    NoRecordings(PathBuf),
    /// No picture came.
    #[error(
        "{0}: no picture comes; see `andond check` for a camera, and `andond status` for a running station"
    )]
    NothingSeen(String),
    /// What may not be seen cannot be hidden, so that nothing is shown.
    #[error(
        "the picture is not shown, because what may not be seen in it cannot be hidden: {0}; see record.bench and record.masks"
    )]
    Unhidden(#[from] PictureError),
    /// The page cannot be served.
    #[error("{address}: the page cannot be shown there: {source}; name another port with --page PORT")]
    Page {
        /// Where it was to be shown.
        address: std::net::SocketAddr,
        /// What the system said.
        source: io::Error,
    },
    /// The recording to calibrate from has no picture.
    #[error("{}: there is no picture in it; give one that shows the four markers", .0.display())]
    NoPicture(PathBuf),
    /// The picture to calibrate from cannot be read as pixels.
    #[error("{}: {source}", picture.display())]
    Picture {
        /// The picture.
        picture: PathBuf,
        /// Why.
        source: PerceptionError,
    },
    /// The bench cannot be placed by the picture.
    #[error("{}: {source}", picture.display())]
    Calibration {
        /// The picture.
        picture: PathBuf,
        /// Why.
        source: CalibrationError,
    },
    /// The calibration cannot be saved.
    #[error(transparent)]
    SaveCalibration(CalibrationError),
    /// The configuration names no station that can be joined.
    #[error(transparent)]
    Station(andon_ipc::Error),
    /// The station's shared memory.
    #[error(transparent)]
    Ipc(#[from] andon_ipc::Error),
    /// The journal cannot be read.
    #[error(transparent)]
    Journal(JournalError),
    /// An archive cannot be used, or a station cannot be restored now.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
    /// What the configuration names cannot be used.
    #[error("{0}")]
    Unusable(Unusable),
    /// A code that does not exist, with what there is instead.
    #[error("{0}")]
    UnknownCode(String),
    /// Standard output is closed or full.
    #[error("standard output cannot be written: {0}; {remedy}", remedy = remedy(.0))]
    Print(#[source] io::Error),
    /// Frames did not reach the recorder.
    #[error("{0} frames were lost: the machine is too busy, and a replay may judge otherwise; record again")]
    Lost(u64),
    /// A file, a port or a process of the demo cannot be made.
    #[error("the demo cannot start: {what}: {source}")]
    Demo {
        /// What was tried.
        what: String,
        /// What the system said.
        source: io::Error,
    },
    /// Roles of the demo did not come up.
    #[error("these roles did not come up: {0:?}; look at the load of the machine, or name another --config")]
    NotUp(Vec<RoleId>),
    /// A role of the demo ended by itself.
    #[error("the role {role} has ended ({status}):\n{log}")]
    RoleEnded {
        /// The role.
        role: &'static str,
        /// How it ended.
        status: ExitStatus,
        /// The end of its log, which says what to do.
        log: String,
    },
    /// The line of the demo stands still.
    #[error("{}: nothing came for {silence:?}; look at the load of the machine", clip.display())]
    Silence {
        /// The clip that was played.
        clip: PathBuf,
        /// For how long nothing came.
        silence: Duration,
    },
}

impl ToolError {
    /// What the process ends with.
    pub fn code(&self) -> Code {
        match self {
            Self::Configuration(_)
            | Self::NoJob { .. }
            | Self::JobFile(_)
            | Self::Misfit { .. }
            | Self::Encoder(_)
            | Self::Method(_)
            | Self::Judge(_)
            | Self::Recording(RecordingError::Perception(_) | RecordingError::Setup(_))
            | Self::NoCertificateNamed
            | Self::UnsafeBoard(_)
            | Self::Station(_) => Code::Configuration,
            Self::Ipc(_)
            | Self::Journal(_)
            | Self::NothingSeen(_)
            | Self::Print(_)
            | Self::Lost(_)
            | Self::Demo { .. }
            | Self::NotUp(_)
            | Self::NoAnswer
            | Self::NotRoot
            | Self::System { .. }
            | Self::Unkept
            | Self::NoFrames
            | Self::PartRefused(_) => Code::Fault,
            Self::Unusable(unusable) => unusable.code(),
            Self::RoleEnded { status, .. } if status.code() == Some(Code::Configuration as i32) => {
                Code::Configuration
            }
            Self::RoleEnded { .. } => Code::Fault,
            Self::Silence { .. } => Code::NoProgress,
            Self::Archive(ArchiveError::Running(_)) => Code::Fault,
            Self::NotShown { .. } => Code::Declined,
            Self::Teach(error) if error.is_of_runs() => Code::Declined,
            Self::Option { .. }
            | Self::UnknownJob { .. }
            | Self::ForeignJob { .. }
            | Self::SeveralJobs { .. }
            | Self::UnknownCode(_)
            | Self::Archive(_)
            | Self::NoJobNamed(_)
            | Self::NoRow(_)
            | Self::NotRecorded { .. }
            | Self::Remove { .. }
            | Self::NothingConfirmed
            | Self::NoRecordings(_)
            | Self::NothingToAnnotate
            | Self::Read { .. }
            | Self::Write { .. }
            | Self::Exists(_)
            | Self::Installed(_)
            | Self::Recording(_)
            | Self::Run { .. }
            | Self::MixedSpaces(_)
            | Self::Source(_)
            | Self::Teach(_)
            | Self::Names(_)
            | Self::Folder(_)
            | Self::Experiment(_)
            | Self::Analysis(_)
            | Self::Video(_)
            | Self::Annotate(_)
            | Self::Sheets(_)
            | Self::NothingToShow(_)
            | Self::CertificateName { .. }
            | Self::Login(_)
            | Self::NoLogin { .. }
            | Self::Password(_)
            | Self::Page { .. }
            | Self::Unhidden(_)
            | Self::Marker { .. }
            | Self::NoPicture(_)
            | Self::Picture { .. }
            | Self::Calibration { .. }
            | Self::SaveCalibration(_) => Code::Usage,
        }
    }
}

impl From<Unwritten> for ToolError {
    fn from(Unwritten { path, source }: Unwritten) -> Self {
        Self::Write { path, source }
    }
}

impl From<BlackboxError> for ToolError {
    fn from(error: BlackboxError) -> Self {
        Self::Recording(error.into())
    }
}

impl From<Faults> for ToolError {
    fn from(faults: Faults) -> Self {
        Self::Configuration(faults.into())
    }
}

impl From<NoConfiguration> for ToolError {
    fn from(missing: NoConfiguration) -> Self {
        Self::Configuration(missing.into())
    }
}

impl From<JournalError> for ToolError {
    fn from(error: JournalError) -> Self {
        match error {
            // The rows went to standard output.
            JournalError::Export(error) => Self::Print(error),
            other => Self::Journal(other),
        }
    }
}

/// What there is instead, in words.
fn listed(names: &[String]) -> String {
    if names.is_empty() { "is none".to_owned() } else { format!("are {}", names.join(", ")) }
}
