//! `andond replay`: a recording judged by a taught job.

mod again;
mod agreement;
mod printer;

use std::path::Path;
use std::slice::from_ref;

use andon_core::anomaly::Judge;
use andon_core::couple::{Couple, Couples, Encoder};
use andon_core::dtw::OnlineDtw;
use andon_core::input::Frame;
use andon_core::job::Job;
use andon_core::verdict::Verdict;
use andon_learn::job_file::JobFile;

use super::{ToolError, job, load_config_for, progress};
use crate::blackbox;
use crate::cli::Replay;
use crate::compatibility;
use crate::picture::Annotator;
use crate::recording::Recording;
use crate::report::Names;
use printer::Printer;

/// Runs the command; the exit code is the verdict.
///
/// # Errors
/// What is missing or damaged.
pub fn run(arguments: &Replay) -> Result<u8, ToolError> {
    match &arguments.job {
        Some(job) => by_job(arguments, job),
        None if blackbox::is_recording(&arguments.recording) => again::run(arguments),
        None => Err(ToolError::NoJobNamed(arguments.recording.clone())),
    }
}

/// Judges a recording by a job, whatever was in force when it was made.
fn by_job(arguments: &Replay, job: &Path) -> Result<u8, ToolError> {
    let file = job::load(job)?;
    let config = load_config_for(&arguments.config, from_ref(&arguments.recording))?;
    let misfit = |misfit| ToolError::Misfit { path: job.into(), misfit };
    // A track file is of no station, unless one is named.
    if !Recording::knows_its_station(&arguments.recording) || arguments.config.is_named() {
        compatibility::station(&file, &config).map_err(misfit)?;
    }
    let mut recording = Recording::open(&arguments.recording, &config)?;
    job::check_recording((job, &file), &arguments.recording, recording.header())?;
    let names = Names::of_job(&file);
    let mut printer = Printer::new(arguments.json);
    let shows_parts = replay(&mut recording, &file, &names, arguments, &mut printer)?;
    let (path, rate_hz) = (arguments.recording.display(), recording.header().rate_hz);
    let needed_hz = file.min_rate_hz;
    if rate_hz < needed_hz {
        eprintln!(
            "{path} has {rate_hz:.1} frames per second, and the job needs {needed_hz:.1}: what fewer frames show is not judged"
        );
    } else if printer.is_silent() && !shows_parts && !Recording::knows_its_station(&arguments.recording) {
        eprintln!(
            "nothing was judged: {path} shows no marker of the job's parts; `andond look {path}` says why, as where the picture is mirrored or a \
             negative"
        );
    } else if printer.is_silent() {
        eprintln!("nothing was judged: in {path} no hand was seen to touch an object of the job");
    }
    Ok(printer.exit_code())
}

/// Whether any part was seen.
fn replay(
    recording: &mut Recording,
    file: &JobFile,
    names: &Names,
    arguments: &Replay,
    printer: &mut Printer,
) -> Result<bool, ToolError> {
    let mut encoder = Encoder::new(file.method, &file.shapes())?;
    let mut annotator = annotator(arguments.annotate.as_deref(), recording, names, file.method.blind_ms)?;
    let mut shows_parts = false;
    let bar = progress(recording.count(), &arguments.recording);
    file.with_job(|job: &Job<'_>| -> Result<(), ToolError> {
        let mut judge = Judge::<Vec<_>>::with_memory(job, file.method)?;
        let mut newest: Option<Couples> = None;
        loop {
            let frame = recording.next_frame()?;
            shows_parts |= frame.as_ref().is_some_and(|frame| !frame.objects.is_empty());
            let verdicts = judge_next(frame.as_ref(), &mut encoder, &mut judge, &mut newest);
            if !verdicts.is_empty() {
                bar.suspend(|| verdicts.iter().try_for_each(|verdict| printer.print(verdict, file, names)))
                    .map_err(ToolError::Print)?;
            }
            if let (Some(annotator), Some(view)) = (annotator.as_mut(), recording.view()) {
                let couples: &[Couple] = newest.as_ref().map_or(&[], |couples| &couples.hands);
                match &frame {
                    Some(_) => annotator.draw(view, couples, &verdicts)?,
                    None => annotator.draw_end(view, &verdicts)?,
                }
            }
            if frame.is_none() {
                return Ok(());
            }
            bar.inc(1);
        }
    })?;
    bar.finish_and_clear();
    recording.warnings(&arguments.recording).iter().for_each(|warning| eprintln!("{warning}"));
    if let Some(annotator) = annotator {
        annotator.finish()?;
    }
    Ok(shows_parts)
}

/// The verdicts that the next frame leads to, or the end of the recording; `newest` becomes the newest couples.
pub(super) fn judge_next<'j>(
    frame: Option<&Frame>,
    encoder: &mut Encoder,
    judge: &mut Judge<'j, Vec<OnlineDtw<'j>>>,
    newest: &mut Option<Couples>,
) -> Vec<Verdict> {
    let mut verdicts = Vec::new();
    let mut take = |couples: Couples| {
        judge.step(&couples, &mut |event| verdicts.extend(event.verdict()));
        *newest = Some(couples);
    };
    match frame {
        // A recording has no late frames, except where its clock was stepped; they are ignored.
        Some(frame) => drop(encoder.step(frame, &mut take)),
        None => {
            encoder.flush(&mut take);
            judge.finish(&mut |event| verdicts.extend(event.verdict()));
        }
    }
    verdicts
}

fn annotator(
    file: Option<&Path>,
    recording: &Recording,
    names: &Names,
    blind_ms: u32,
) -> Result<Option<Annotator>, ToolError> {
    let Some(file) = file else { return Ok(None) };
    let Some(format) = recording.format() else {
        return Err(ToolError::NothingToAnnotate);
    };
    Ok(Some(Annotator::create(file, format, names.clone(), blind_ms)?))
}
