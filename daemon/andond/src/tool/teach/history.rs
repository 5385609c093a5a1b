//! The runs that people have confirmed, out of the recordings of a station: each becomes a track file beside the job file.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use andon_host::atomic::{self, folder_of};
use andon_host::config::Config;
use andon_learn::digest::sha256_hex;
use andon_learn::job_file::JobFile;
use andon_record::store;
use shm_schemas::{MessageId, flag};

use crate::blackbox::{Frames, piece_of, station_of};
use crate::cli::Was;
use crate::recorder::{Recorder, header};
use crate::tool::clip::recordings;
use crate::tool::runs::file_name;
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
    found.runs = once_each(found.runs, &|name| sources.iter().any(|source| source.name == name));
    Ok(found)
}

/// A piece has several verdicts: confirmed more than once it is one run, under the name by which the job knows it already.
fn once_each(mut runs: Vec<PathBuf>, is_source: &dyn Fn(&str) -> bool) -> Vec<PathBuf> {
    runs.sort_by_key(|run| !is_source(&file_name(run)));
    let mut seen = HashSet::new();
    // One that cannot be read is named as such where it is taught.
    runs.retain(|run| std::fs::read(run).map_or(true, |bytes| seen.insert(sha256_hex(&bytes))));
    runs
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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_piece_of_which_two_verdicts_were_confirmed_is_one_run_and_keeps_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let runs = [(1, "one piece"), (2, "one piece"), (3, "another")].map(|(seq, frames)| {
            let run = folder.path().join(name_of(MessageId { epoch: 7, seq }));
            std::fs::write(&run, frames).unwrap();
            run
        });
        let [first, second, third] = runs.clone();
        assert_eq!(once_each(runs.to_vec(), &|_| false), [first.clone(), third.clone()]);
        let known = file_name(&second);
        assert_eq!(once_each(runs.to_vec(), &|name| name == known), [second, third]);
    }
}
