//! The runs that people have confirmed, out of the recordings of a station: each becomes a track file beside the job file.

use std::path::{Path, PathBuf};

use andon_host::atomic::{self, folder_of};
use andon_host::config::Config;
use andon_learn::job_file::JobFile;
use andon_record::store;
use shm_schemas::{MessageId, flag};

use crate::blackbox::{Frames, piece_of, station_of};
use crate::cli::Was;
use crate::recorder::{Recorder, header};
use crate::tool::clip::recordings;
use crate::tool::{ToolError, cannot_write, confirm};
use crate::wire;

/// What people have said of runs.
#[derive(Debug, Default)]
pub(super) struct Confirmed {
    /// The right ones, as track files.
    pub(super) runs: Vec<PathBuf>,
    /// The names of those that the job was taught from and that somebody calls wrong by now.
    pub(super) withdrawn: Vec<String>,
}

/// Writes the confirmed runs to track files beside `out`. `before` is the job that is taught again.
///
/// # Errors
/// That there is nothing to learn from them, and what cannot be read or written.
pub(super) fn of(config: &Config, out: &Path, before: Option<&JobFile>) -> Result<Confirmed, ToolError> {
    let recordings = recordings(config)?;
    let by_verdict = store::by_verdict(&recordings);
    let sources = before.map(|job| job.provenance.sources.as_slice()).unwrap_or_default();
    let mut found = Confirmed::default();
    for confirmed in confirm::confirmed(config)?.into_values() {
        let name = name_of(confirmed.id);
        let run = folder_of(out).join(&name);
        match (confirmed.was, by_verdict.get(&confirmed.id)) {
            (Was::Wrong, _) if sources.iter().any(|source| source.name == name) => found.withdrawn.push(name),
            (Was::Wrong, _) => (),
            // What was taken out of a recording once is there for longer than the recording is.
            (Was::Right, _) if run.exists() => found.runs.push(run),
            (Was::Right, Some(recording)) if write(&recording.path, confirmed.id, &run)? => {
                found.runs.push(run)
            }
            (Was::Right, _) => (),
        }
    }
    if found.runs.is_empty() && found.withdrawn.is_empty() {
        return Err(ToolError::NothingConfirmed);
    }
    Ok(found)
}

/// The name of a run: of all verdicts that there ever are, this one has it.
fn name_of(MessageId { epoch, seq }: MessageId) -> String {
    format!("confirmed-{epoch}-{seq}.tracks.jsonl")
}

/// Writes the piece that a verdict is on. False where the recording has not all of it, which is said: half a run teaches what is wrong.
fn write(recording: &Path, verdict: MessageId, run: &Path) -> Result<bool, ToolError> {
    let piece = match piece_of(recording, verdict) {
        Err(error) if error.is_incomplete() => {
            eprintln!("note: not taught: {error}");
            return Ok(false);
        }
        piece => piece?,
    };
    let (station, _) = station_of(recording)?;
    let failed = cannot_write(run);
    let part = atomic::beside(run).map_err(&failed)?;
    let mut recorder = Recorder::new(part.reopen().map_err(&failed)?, run, header(&station.config))?;
    let mut frames = Frames::open(recording)?;
    while let Some(detections) = frames.next_detections()? {
        let is_frame = detections.flags & flag::END_OF_STREAM == 0;
        if is_frame && piece.contains(&detections.stamp.captured_ns) {
            recorder.write(wire::detections::to_core(detections))?;
        }
    }
    recorder.finish()?;
    atomic::put(part.into_temp_path(), run).map_err(failed)?;
    Ok(true)
}
