//! `andond clip`: the recording of a verdict.

use std::path::Path;

use andon_host::config::Config;
use andon_host::exit::Code;
use andon_journal::History;
use andon_record::index::still_of;
use andon_record::store::{self, Recording};
use shm_schemas::Verdict;

use super::{ToolError, replay, running_config};
use crate::cli::{Clip, Replay};

/// Runs the command.
///
/// # Errors
/// A row that the journal does not have, or of which nothing was recorded.
pub fn run(arguments: &Clip) -> Result<Code, ToolError> {
    let config = running_config(&arguments.config)?.config;
    let verdict = verdict(&config, arguments.row)?;
    let recording = recording(&config, arguments.row, &verdict)?;
    println!("{}", recording.path.display());
    let still = still_of(&recording.path, verdict.stamp.id());
    if still.exists() {
        println!("{}", still.display());
    }
    if let Some(film) = &arguments.annotate {
        draw(arguments, &recording.path, film)?;
        println!("{}", film.display());
    }
    Ok(Code::Stopped)
}

/// The verdict of a row of the journal.
///
/// # Errors
/// That there is none.
pub(super) fn verdict(config: &Config, row: u64) -> Result<Verdict, ToolError> {
    let found = History::open(&config.journal_path())?.verdict(row)?;
    found.ok_or(ToolError::NoRow(row))
}

/// The recording that shows a verdict.
///
/// # Errors
/// That there is none.
pub(super) fn recording(config: &Config, row: u64, verdict: &Verdict) -> Result<Recording, ToolError> {
    let recordings = recordings(config)?;
    let found = store::by_verdict(&recordings).get(&verdict.stamp.id()).copied().cloned();
    found.ok_or_else(|| ToolError::NotRecorded { row, folder: config.recordings() })
}

/// The recordings of a station.
///
/// # Errors
/// That their folder cannot be read.
pub(super) fn recordings(config: &Config) -> Result<Vec<Recording>, ToolError> {
    let folder = config.recordings();
    store::recordings(&folder).map_err(|source| ToolError::Read {
        path: folder,
        source,
        remedy: "run this as the user of the station's units, or correct record.path",
    })
}

/// Judges the clip again, which prints its verdicts, and draws them into a film.
fn draw(arguments: &Clip, recording: &Path, film: &Path) -> Result<(), ToolError> {
    let arguments = Replay {
        config: arguments.config.clone(),
        job: None,
        from_frames: false,
        recording: recording.into(),
        json: false,
        annotate: Some(film.into()),
    };
    replay::run(&arguments).map(drop)
}
