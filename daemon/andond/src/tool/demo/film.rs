//! Writes a clip again, with what the running line saw and judged drawn on it.

use std::path::Path;

use andon_core::couple::Couple;
use andon_core::verdict::Verdict;
use andon_host::config::Camera;

use super::channels::Received;
use crate::picture::Annotator;
use crate::recording::View;
use crate::report::Names;
use crate::tool::{ToolError, cannot_write};
use crate::video::Film;
use crate::wire;

/// Writes the annotated clip into `folder`. The pictures are decoded once more; what is drawn on them came over the channels.
pub(super) fn write(
    clip: &Path,
    folder: &Path,
    received: &Received,
    names: &Names,
    blind_ms: u32,
) -> Result<(), ToolError> {
    std::fs::create_dir_all(folder).map_err(cannot_write(folder))?;
    // The rate is for folders of pictures; a clip has its own.
    let mut film = Film::open(clip, Camera::default().rate_hz)?;
    let out = folder.join(clip.file_name().unwrap_or_default());
    let format = film.format();
    let mut annotator = Annotator::create(&out, format, names.clone(), blind_ms)?;
    let verdicts: Vec<(u64, Verdict)> = received
        .verdicts
        .iter()
        .filter_map(|message| Some((message.stamp.frame_seq, wire::verdict::read(message)?)))
        .collect();
    let mut shown = 0;
    let mut newest = None;
    while film.advance()?.is_some() {
        shown += 1;
        let Some(seen) = received.detections.iter().find(|seen| seen.stamp.frame_seq == shown) else {
            continue;
        };
        newest = Some(seen);
        let couples = received.couples.iter().rev().find(|couples| couples.stamp.frame_seq <= shown);
        let couples: Vec<Couple> =
            couples.map(|couples| wire::couples::read(couples).hands.into()).unwrap_or_default();
        let now: Vec<Verdict> =
            verdicts.iter().filter(|(frame, _)| *frame == shown).map(|(_, verdict)| *verdict).collect();
        let view = View { format, picture: film.picture(), seen };
        annotator.draw(view, &couples, &now)?;
    }
    if let Some(seen) = newest {
        let late: Vec<Verdict> =
            verdicts.iter().filter(|(frame, _)| *frame > shown).map(|(_, verdict)| *verdict).collect();
        let view = View { format, picture: film.picture(), seen };
        annotator.draw_end(view, &late)?;
    }
    annotator.finish()?;
    println!("written: {}", out.display());
    Ok(())
}
