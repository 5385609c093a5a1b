//! Recordings of the role `record`, judged again: from the detections on with the same result, bit for bit, on any machine. From the pictures on
//! ([`Sight`]) the result is the same under two conditions. They are those that the camera sent, and libraries and processor are the same.
//!
//! A recording is read twice. The first time [`Plan`] finds out what the roles did. It notes the first frame of each encoder, the first couples of
//! each judge, and the couples after which each command was obeyed. The second time [`again`] does the same to the detections.

pub mod again;
mod look;
mod piece;
mod plan;
mod source;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use andon_host::config::{Config, Faults};
use andon_learn::job_file::{JobFile, JobFileError};
use andon_record::picture::PictureError;
use andon_record::{End, Item, ReadError, RecordingReader, Topic};
use shm_schemas::{Layout, from_bytes};

pub use look::{Looked, Sight};
pub use piece::{Piece, only_piece, piece_of};
pub use plan::{Chain, Plan, chains};
pub use source::{Frames, Run, first_picture};

use crate::perception::SetupError;
use crate::role::{CALIBRATION, CONFIGURATION, HASHES};

/// Why a recording cannot be judged again.
#[derive(Debug, thiserror::Error)]
pub enum BlackboxError {
    /// It cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// It carries no configuration.
    #[error("{}: it was cut before its configuration was written: nothing can be judged by it", path.display())]
    NoConfiguration {
        /// The recording.
        path: PathBuf,
    },
    /// The configuration in it cannot be used by this program.
    #[error("{}: the configuration in it cannot be used: {faults}", path.display())]
    Configuration {
        /// The recording.
        path: PathBuf,
        /// Every fault in it.
        faults: Faults,
    },
    /// The configuration in it cannot be put where it is read.
    #[error("a temporary file cannot be written: {0}; make room in /tmp, or name another folder by TMPDIR")]
    Temporary(std::io::Error),
    /// A job in it cannot be used by this program.
    #[error(transparent)]
    Job(#[from] JobFileError),
    /// It does not carry a job that was in force.
    #[error("{}: it does not carry the job of hash {model_hash:016x} that was in force; name a job with --job", path.display())]
    NoJob {
        /// The recording.
        path: PathBuf,
        /// The hash of the job.
        model_hash: u64,
    },
    /// It begins after the piece had begun.
    #[error(
        "{}: it begins in the middle of the piece, and teaches nothing: show the work again, or give a recording that has all of it",
        path.display()
    )]
    NoBegin {
        /// The recording.
        path: PathBuf,
    },
    /// It has no verdict on the whole piece.
    #[error(
        "{}: it ends before the piece does, and teaches nothing: show the work again, or give a recording that has all of it",
        path.display()
    )]
    NoEnd {
        /// The recording.
        path: PathBuf,
    },
    /// It has more than one piece.
    #[error(
        "{}: {count} pieces are in it, and a run is one: say by `andond confirm ID right` which are right, and learn from them by \
         `andond teach --from-history`",
        path.display()
    )]
    SeveralPieces {
        /// The recording.
        path: PathBuf,
        /// How many.
        count: usize,
    },
    /// A picture in it would take more memory than any picture of a recorder.
    #[error("{}: a picture in it is refused: {source}; give the recording as its recorder wrote it", path.display())]
    Picture {
        /// The recording.
        path: PathBuf,
        /// Why.
        source: PictureError,
    },
    /// It has nothing to be looked at again.
    #[error("{}: {why}: leave out --from-frames, and it is judged by what was detected then", path.display())]
    NotFromFrames {
        /// The recording.
        path: PathBuf,
        /// Why.
        why: &'static str,
    },
    /// Its pictures cannot be looked at.
    #[error("{}: its pictures cannot be looked at again: {source}", path.display())]
    Look {
        /// The recording.
        path: PathBuf,
        /// Why.
        source: SetupError,
    },
    /// The method refuses its constants or the objects.
    #[error("{}: the method cannot work with what is in it: {why}", path.display())]
    Method {
        /// The recording.
        path: PathBuf,
        /// Why.
        why: String,
    },
}

/// Whether this is the name of a recording of the role `record`.
pub fn is_recording(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mcap"))
}

/// What a recording says of its station, and how it ended.
pub struct Station {
    /// The configuration in force.
    pub config: Config,
    /// The jobs that were in force, by their hashes.
    pub jobs: HashMap<u64, JobFile>,
    /// What the pictures were looked at with.
    pub hashes: String,
    /// The calibration of the bench, as a file.
    pub calibration: Option<Vec<u8>>,
}

impl Station {
    /// From the files that a recording carries.
    ///
    /// # Errors
    /// What is missing, or cannot be used by this program.
    fn of(path: &Path, attached: &HashMap<String, Vec<u8>>) -> Result<Self, BlackboxError> {
        let Some(text) = attached.get(CONFIGURATION) else {
            return Err(BlackboxError::NoConfiguration { path: path.into() });
        };
        let mut jobs = HashMap::new();
        for (name, bytes) in attached.iter().filter(|(name, _)| name.starts_with("job-")) {
            let job = JobFile::parse(&format!("{}: {name}", path.display()), bytes)?;
            jobs.insert(job.model_hash(), job);
        }
        let hashes = attached.get(HASHES).map(|bytes| String::from_utf8_lossy(bytes).into_owned());
        let calibration = attached.get(CALIBRATION).cloned();
        Ok(Self { config: configuration(path, text)?, jobs, hashes: hashes.unwrap_or_default(), calibration })
    }
}

/// A configuration is read from files. What it names need not be there.
fn configuration(path: &Path, text: &[u8]) -> Result<Config, BlackboxError> {
    use std::io::Write as _;
    let mut file = tempfile::Builder::new().suffix(".toml").tempfile().map_err(BlackboxError::Temporary)?;
    file.write_all(text).map_err(BlackboxError::Temporary)?;
    Config::load_to_learn(&[file.path()])
        .map_err(|faults| BlackboxError::Configuration { path: path.into(), faults })
}

/// A message of a channel; `None` where it is one of another topic.
fn message<T: Layout>(topic: Topic, of: Topic, data: &[u8]) -> Option<T> {
    if topic == of { from_bytes(data) } else { None }
}

/// Reads the files that a recording carries, and how it ended, without its messages.
///
/// # Errors
/// Why it cannot be used.
pub fn station_of(path: &Path) -> Result<(Station, End), BlackboxError> {
    let mut attached = HashMap::new();
    let mut reader = RecordingReader::open(path)?;
    while let Some(item) = reader.next_item()? {
        if let Item::Attachment(file) = item {
            attached.insert(file.name, file.data.to_vec());
        }
    }
    Ok((Station::of(path, &attached)?, reader.end()))
}
