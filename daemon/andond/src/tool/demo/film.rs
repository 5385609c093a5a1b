//! The clip again, with what the running line saw and judged drawn on it.

use std::path::Path;

use andon_core::couple::Couple;
use andon_core::verdict::Verdict;

use super::watch::Heard;
use crate::config::Camera;
use crate::exit::Code;
use crate::picture::Annotator;
use crate::recording::View;
use crate::report::Names;
use crate::tool::Failure;
use crate::video::Film;
use crate::wire;

/// Writes the annotated clip into `folder`. The pictures are decoded once more; what is drawn came over the channels.
pub(super) fn write(clip: &Path, folder: &Path, heard: &Heard, names: &Names) -> Result<(), Failure> {
    let usage = |error: &dyn std::fmt::Display| Failure::new(Code::Usage, error);
    std::fs::create_dir_all(folder).map_err(|error| usage(&format!("{}: {error}", folder.display())))?;
    // The rate is for folders of pictures; a clip has its own.
    let mut film = Film::open(clip, Camera::default().rate_hz).map_err(|error| usage(&error))?;
    let out = folder.join(clip.file_name().unwrap_or_default());
    let format = film.format();
    let mut annotator = Annotator::create(&out, format, names.clone()).map_err(|error| usage(&error))?;
    let verdicts: Vec<(u64, Verdict)> = heard
        .verdicts
        .iter()
        .filter_map(|message| Some((message.stamp.frame_seq, wire::verdict::read(message)?)))
        .collect();
    let mut shown = 0;
    let mut newest = None;
    while film.advance().map_err(|error| usage(&error))?.is_some() {
        shown += 1;
        let Some(seen) = heard.detections.iter().find(|seen| seen.stamp.frame_seq == shown) else { continue };
        newest = Some(seen);
        let couples = heard.couples.iter().rev().find(|couples| couples.stamp.frame_seq <= shown);
        let couples: Vec<Couple> =
            couples.map(|couples| wire::couples::read(couples).hands.into()).unwrap_or_default();
        let now: Vec<Verdict> =
            verdicts.iter().filter(|(frame, _)| *frame == shown).map(|(_, verdict)| *verdict).collect();
        let view = View { format, picture: film.picture(), seen };
        annotator.draw(view, &couples, &now).map_err(|error| usage(&error))?;
    }
    if let Some(seen) = newest {
        let late: Vec<Verdict> =
            verdicts.iter().filter(|(frame, _)| *frame > shown).map(|(_, verdict)| *verdict).collect();
        let view = View { format, picture: film.picture(), seen };
        annotator.draw_end(view, &late).map_err(|error| usage(&error))?;
    }
    annotator.finish().map_err(|error| usage(&error))?;
    println!("written: {}", out.display());
    Ok(())
}
