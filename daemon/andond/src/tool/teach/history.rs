//! The runs that people have confirmed, out of the recordings of a station: each becomes a track file beside the job file.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use andon_board::Was;
use andon_host::atomic::{self, folder_of};
use andon_host::config::Config;
use andon_journal::History;
use andon_learn::digest::sha256_hex;
use andon_learn::job_file::JobFile;
use andon_record::store;
use shm_schemas::{MessageId, flag};

use crate::blackbox::{Frames, Piece, piece_of, station_of};
use crate::confirmed;
use crate::recorder::{Recorder, header};
use crate::tool::clip::recordings;
use crate::tool::runs::file_name;
use crate::tool::{ToolError, cannot_write};
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
    let is_source = |name: &str| sources.iter().any(|source| source.name == name);
    let said = confirmed::since(&History::open(&config.journal_path())?, None)?;
    let all: Vec<confirmed::Confirmed> = said.into_values().map(|(confirmed, _who)| confirmed).collect();
    let recording = |id: MessageId| by_verdict.get(&id).map(|recording| recording.path.as_path());
    let piece = |id: MessageId| recording(id).and_then(|path| piece_of(path, id).ok());
    let is_wrong = |was: Was| was == Was::Wrong;
    let wrong: Vec<Piece> =
        all.iter().filter(|said| is_wrong(said.was)).filter_map(|said| piece(said.id)).collect();
    let mut found = Confirmed::default();
    for said in &all {
        let name = name_of(said.id);
        let run = folder_of(out).join(&name);
        // Who calls one result of a piece wrong means the piece: it teaches nothing, whatever was said of its other results.
        let is_of_wrong = || !wrong.is_empty() && piece(said.id).is_some_and(|piece| wrong.contains(&piece));
        if is_wrong(said.was) || is_of_wrong() {
            found.withdrawn.extend(Some(name).filter(|name| is_source(name)));
        } else if run.exists() || recording(said.id).map_or(Ok(false), |path| write(path, said.id, &run))? {
            // What was taken out of a recording once is there for longer than the recording is.
            found.runs.push(run);
        }
    }
    if found.runs.is_empty() && found.withdrawn.is_empty() {
        return Err(ToolError::NothingConfirmed);
    }
    found.runs = once_each(found.runs, &is_source);
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
fn name_of(verdict: MessageId) -> String {
    format!("confirmed-{verdict}.tracks.jsonl")
}

/// Writes the piece that a verdict is on. False where the recording has not all of it or cannot be read, which is said. Half a run teaches what is
/// wrong, and the others teach without it.
fn write(recording: &Path, verdict: MessageId, run: &Path) -> Result<bool, ToolError> {
    let piece = match piece_of(recording, verdict) {
        Ok(piece) => piece,
        Err(error) => {
            eprintln!("note: not taught: {error}");
            return Ok(false);
        }
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
