//! `andond teach --pictures`: what each step looks like, out of the films that the job was taught from.

use std::path::PathBuf;

use andon_core::anomaly::Judge;
use andon_core::couple::Encoder;
use andon_core::job::Job;
use andon_core::verdict::{Level, Outcome, Verdict};
use andon_host::config::Config;
use andon_learn::job_file::JobFile;
use andon_record::picture::{Decoded, encode};

use crate::blackbox;
use crate::picture::Veil;
use crate::recording::{Recording, View};
use crate::tool::ToolError;
use crate::tool::replay::judge_next;

/// As wide as the worker's page shows them from afar.
const WIDTH: u32 = 480;
const QUALITY: u8 = 80;

/// The pictures of the steps, each from the first film that shows its step done right: at the end of the first contact of its part with another one, or
/// else at the end of the step. What `record.bench` and `record.masks` hide is black. A recording of the station gives none: who works there has not
/// shown it to others, and `andond forget` must find all of it.
///
/// # Errors
/// A recording that cannot be read again, and a picture of which nobody can hide what may not be seen.
pub(super) fn of_steps(
    job: &JobFile,
    recordings: &[PathBuf],
    config: &Config,
) -> Result<Vec<Option<Vec<u8>>>, ToolError> {
    let mut pictures: Vec<Option<Vec<u8>>> = vec![None; job.steps.len()];
    let mut veil = Veil::new(&config.record);
    for path in recordings.iter().filter(|path| !blackbox::is_recording(path)) {
        if pictures.iter().all(Option::is_some) {
            break;
        }
        let mut recording = Recording::open(path, config)?;
        if recording.format().is_some() {
            look_for(job, &mut recording, veil.as_mut(), &mut pictures)?;
        }
    }
    Ok(pictures)
}

fn look_for(
    file: &JobFile,
    recording: &mut Recording,
    mut veil: Option<&mut Veil>,
    pictures: &mut [Option<Vec<u8>>],
) -> Result<(), ToolError> {
    let mut encoder = Encoder::new(file.method, &file.shapes())?;
    file.with_job(|job: &Job<'_>| -> Result<(), ToolError> {
        let mut judge = Judge::<Vec<_>>::with_memory(job, file.method)?;
        let mut newest = None;
        while let Some(frame) = recording.next_frame()? {
            for verdict in judge_next(Some(&frame), &mut encoder, &mut judge, &mut newest) {
                let step = step_shown(&verdict).and_then(|step| pictures.get_mut(usize::from(step)));
                if let (Some(picture), Some(view)) = (step.filter(|known| known.is_none()), recording.view())
                {
                    *picture = small(view, veil.as_deref_mut())?;
                }
            }
        }
        Ok(())
    })
}

/// The step whose picture this moment is.
fn step_shown(verdict: &Verdict) -> Option<u16> {
    let is_at_other = verdict.context.0[1] != 0 && verdict.context.0[3] != 0;
    let shows = match verdict.level {
        Level::Iu => is_at_other,
        Level::Activity => true,
        Level::Job => false,
    };
    verdict.nearest.filter(|_| shows && verdict.outcome == Outcome::Ok)
}

/// A picture as a small JPEG: each of its pixels is the mean of a square. None of one that cannot be encoded.
fn small(view: View<'_>, veil: Option<&mut Veil>) -> Result<Option<Vec<u8>>, ToolError> {
    let mut pixels = view.picture.to_vec();
    if let Some(veil) = veil {
        veil.hide(view.format, &mut pixels)?;
    }
    Ok(encode(&shrunk(view.format.width, view.format.height, pixels), QUALITY).ok())
}

fn shrunk(width: u32, height: u32, pixels: Vec<u8>) -> Decoded {
    let side = width.div_ceil(WIDTH).max(1);
    let (columns, rows) = ((width / side).max(1), (height / side).max(1));
    if side == 1 {
        return Decoded { width, height, pixels };
    }
    let at = |x: u32, y: u32, colour: u32| u32::from(pixels[(3 * (y * width + x) + colour) as usize]);
    let mut small = Vec::with_capacity((3 * columns * rows) as usize);
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        for colour in 0..3 {
            let square =
                (0..side * side).map(|of| at(column * side + of % side, row * side + of / side, colour));
            small.push((square.sum::<u32>() / (side * side)) as u8);
        }
    }
    Decoded { width: columns, height: rows, pixels: small }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::path::Path;

    #[test]
    fn a_recording_of_the_station_is_not_even_opened_for_a_picture() {
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config/jobs/polish-and-measure.toml");
        let job = crate::role::read_job(&shipped).unwrap();
        let pictures = |name: &str| of_steps(&job, &[name.into()], &Config::default());
        assert_eq!(pictures("missing.mcap").unwrap(), [None, None]);
        assert!(pictures("missing.mp4").is_err());
    }

    #[test]
    fn a_small_picture_has_the_mean_of_each_square() {
        let pixels =
            (0..960 * 4).flat_map(|at: u32| [if at.is_multiple_of(2) { 10 } else { 30 }, 7, 200]).collect();
        let small = shrunk(960, 4, pixels);
        assert_eq!((small.width, small.height, small.pixels.len()), (480, 2, 3 * 480 * 2));
        assert!(small.pixels.chunks_exact(3).all(|pixel| pixel == [20, 7, 200]));
        let whole = shrunk(2, 1, vec![1, 2, 3, 4, 5, 6]);
        assert_eq!((whole.width, whole.height, whole.pixels), (2, 1, vec![1, 2, 3, 4, 5, 6]));
    }
}
