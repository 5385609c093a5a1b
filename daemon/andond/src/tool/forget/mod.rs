//! `andond forget`: removes recordings before their time, pictures of steps, and pictures of the bench that were taken for an engineer. The journal
//! keeps who has done it, and of what.

mod part;
mod pictures;

use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use andon_host::atomic;
use andon_host::config::Config;
use andon_host::exit::Code;
use andon_record::store::{self, Recording, Removed};
use jiff::Timestamp;
use shm_schemas::AuditKind;

use super::clip::recordings;
use super::part::part_id;
use super::since::since_ns;
use super::{ToolError, audit, running_config};
use crate::cli::Forget;
use crate::made::Made;
use crate::step_pictures::StepPicture;

/// Runs the command. What is being written stays: its recorder would go on writing into a file that nobody sees any more.
///
/// # Errors
/// What cannot be removed, and a journal that does not answer.
pub fn run(arguments: &Forget) -> Result<Code, ToolError> {
    let config = running_config(&arguments.config)?.config;
    let meant = Meant::of(arguments)?;
    let found = meant.among(recordings(&config)?);
    let pictures = meant.pictures(&config);
    let looks = meant.looks(&config);
    if found.is_empty() {
        println!("no recording is {}", meant.words());
    }
    if !(found.is_empty() && pictures.is_empty() && looks.is_empty()) {
        // First it is said, then it is done: nothing is removed unsaid.
        let said = meant.said(found.len(), pictures.len(), looks.len());
        audit::keep(&config, AuditKind::Recording, &said)?;
    }
    let written = remove_all(&config, &found)?;
    for path in pictures.iter().map(|picture| &picture.path).chain(&looks) {
        atomic::remove_file(path).map_err(|source| ToolError::Remove { path: path.clone(), source })?;
        println!("removed: {}", path.display());
    }
    for path in &written {
        println!(
            "NOT removed: {} is being written; run this again when it is complete, at the latest after the role `record` was stopped or restarted",
            path.display()
        );
    }
    Ok(if written.is_empty() { Code::Stopped } else { Code::Declined })
}

/// Returns those that a recorder writes, which stay. One that cannot be removed keeps no other one.
fn remove_all(config: &Config, found: &[Recording]) -> Result<Vec<PathBuf>, ToolError> {
    let failed = |path: &Path| {
        let path = path.to_path_buf();
        move |source| ToolError::Remove { path, source }
    };
    let (mut written, mut error) = (Vec::new(), None);
    for Recording { path, .. } in found {
        match store::remove(path).map_err(failed(path)) {
            Ok(Removed::Gone) => println!("removed: {}", path.display()),
            Ok(Removed::InUse) => written.push(path.clone()),
            Err(kept) => error = error.or(Some(kept)),
        }
    }
    // A recorder does it when it begins. Where none runs, nobody else would.
    if !config.ipc_station().map_err(ToolError::Station)?.is_in_use() {
        store::sweep(&config.recordings());
    }
    // A folder that is not there has none.
    for path in store::orphans(&config.recordings()).unwrap_or_default() {
        atomic::remove_file(&path).map_err(failed(&path))?;
        println!("removed, it belonged to no recording: {}", path.display());
    }
    error.map_or(Ok(written), Err)
}

/// When a file was written, nanoseconds since 1970 UTC; `None` where there is none.
fn modified_utc_ns(path: &Path) -> Option<u64> {
    let modified = path.metadata().and_then(|meta| meta.modified()).ok()?;
    u64::try_from(modified.duration_since(UNIX_EPOCH).ok()?.as_nanos()).ok()
}

/// Which recordings are meant.
enum Meant {
    /// Those that ended before this time, nanoseconds since 1970 UTC.
    Before(u64, String),
    /// Those that show work on this part.
    Part(String),
}

impl Meant {
    fn of(arguments: &Forget) -> Result<Self, ToolError> {
        if let Some(part) = &arguments.part {
            return Ok(Self::Part(part_id("--part", part)?.text().to_owned()));
        }
        // One of the two is given.
        let before = arguments.before.clone().unwrap_or_default();
        Ok(Self::Before(since_ns("--before", &before, Timestamp::now())?, before))
    }

    fn among(&self, recordings: Vec<Recording>) -> Vec<Recording> {
        match self {
            Self::Before(utc_ns, _) => {
                recordings.into_iter().filter(|recording| recording.index.ended_utc_ns < *utc_ns).collect()
            }
            Self::Part(part) => part::showing(recordings, part),
        }
    }

    /// The pictures of steps that are meant. They come from demonstrations and never from a recording, so that none shows work on a part.
    fn pictures(&self, config: &Config) -> Vec<StepPicture> {
        match self {
            Self::Before(utc_ns, _) => pictures::from_before(config, *utc_ns),
            Self::Part(_) => Vec::new(),
        }
    }

    /// The pictures of the bench that were taken for an engineer, and are meant. Which part lay there nobody knows, so each may show it.
    fn looks(&self, config: &Config) -> Vec<PathBuf> {
        let is_meant = |path: &PathBuf| match self {
            Self::Before(utc_ns, _) => modified_utc_ns(path).is_some_and(|taken_ns| taken_ns < *utc_ns),
            Self::Part(_) => path.exists(),
        };
        Made::new(config).pictures().into_iter().filter(is_meant).collect()
    }

    /// What the journal keeps.
    fn said(&self, recordings: usize, pictures: usize, looks: usize) -> String {
        let more = [(pictures, "pictures of steps"), (looks, "pictures of the bench")];
        let more = more.into_iter().filter(|(count, _)| *count > 0);
        let more: String = more.map(|(count, what)| format!(" and {count} {what}")).collect();
        format!("{recordings} recordings{more} to be removed: {}", self.words())
    }

    fn words(&self) -> String {
        match self {
            Self::Before(_, before) => format!("from before {before}"),
            Self::Part(part) => format!("of part {part:?}"),
        }
    }
}
