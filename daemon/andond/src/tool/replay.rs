//! `andond replay`: a recording judged by a taught job.

use std::io::Write;
use std::path::Path;
use std::slice::from_ref;

use andon_core::anomaly::Judge;
use andon_core::couple::{Couple, Couples, Encoder};
use andon_core::dtw::OnlineDtw;
use andon_core::input::Frame;
use andon_core::job::Job;
use andon_core::verdict::{Level, Outcome, Verdict};
use andon_learn::distribution::{Distribution, LEGEND};
use andon_learn::job_file::JobFile;
use shm_schemas::PartId;

use super::{ToolError, job, load_config_for, progress};
use crate::cli::Replay;
use crate::compatibility;
use crate::picture::Annotator;
use crate::recording::Recording;
use crate::report::{Names, Teller, VerdictLine, on_recording};

/// Exit code: an anomaly was found.
const ANOMALY: u8 = 1;
/// Exit code: nothing wrong was found, and something could not be judged.
const NOT_JUDGED: u8 = 2;

/// Runs the command; the exit code is the verdict.
///
/// # Errors
/// What is missing or damaged.
pub fn run(arguments: &Replay) -> Result<u8, ToolError> {
    let file = job::load(&arguments.job)?;
    let config = load_config_for(&arguments.config, from_ref(&arguments.recording))?;
    // A track file is of no station, unless one is named.
    if !Recording::is_tracks(&arguments.recording) || arguments.config.is_named() {
        compatibility::station(&file, &config)
            .map_err(|misfit| ToolError::Misfit { path: arguments.job.clone(), misfit })?;
    }
    let mut recording = Recording::open(&arguments.recording, &config)?;
    job::check_recording((&arguments.job, &file), &arguments.recording, recording.header())?;
    let names = Names::of_job(&file);
    let mut printer = Printer {
        file: &file,
        names: &names,
        json: arguments.json,
        seq: 0,
        teller: Teller::default(),
        has_legend: false,
        anomaly: false,
        not_judged: false,
        judged: false,
        shows_parts: false,
    };
    replay(&mut recording, &file, arguments, &mut printer)?;
    let (path, rate_hz) = (arguments.recording.display(), recording.header().rate_hz);
    let needed_hz = file.min_rate_hz;
    if rate_hz < needed_hz {
        eprintln!(
            "{path} has {rate_hz:.1} frames per second, and the job needs {needed_hz:.1}: what fewer frames show is not judged"
        );
    } else if printer.seq == 0 && !printer.shows_parts && !Recording::is_tracks(&arguments.recording) {
        eprintln!(
            "nothing was judged: {path} shows no marker of the job's parts; `andond look {path}` says why, as where the picture is mirrored or a \
             negative"
        );
    } else if printer.seq == 0 {
        eprintln!("nothing was judged: in {path} no hand was seen to touch an object of the job");
    }
    Ok(printer.exit_code())
}

struct Printer<'a> {
    file: &'a JobFile,
    names: &'a Names,
    json: bool,
    seq: u64,
    teller: Teller,
    /// Whether the signs of a distribution have been explained.
    has_legend: bool,
    anomaly: bool,
    not_judged: bool,
    judged: bool,
    shows_parts: bool,
}

impl Printer<'_> {
    fn print(&mut self, verdict: &Verdict) -> std::io::Result<()> {
        self.seq += 1;
        self.anomaly |= verdict.outcome == Outcome::Anomaly;
        self.not_judged |= verdict.outcome == Outcome::NotJudged;
        self.judged |= verdict.level == Level::Job && verdict.outcome == Outcome::Ok;
        let mut out = anstream::stdout().lock();
        if self.json {
            let line = VerdictLine::new(self.seq, verdict, &PartId::NONE, self.names, Some(self.file));
            serde_json::to_writer(&mut out, &line)?;
            writeln!(out)
        } else {
            let mut line = self.teller.tell(&on_recording(verdict.decided_ns), verdict, self.names);
            line.text += &self.shown(verdict);
            line.write(&mut out)
        }
    }

    /// Where what is not right lies among the runs that were shown, beneath its verdict; the first time with what the signs mean.
    fn shown(&mut self, verdict: &Verdict) -> String {
        let Some(shown) = Distribution::of_verdict(self.file, verdict) else { return String::new() };
        let mut rows = vec![shown.to_string()];
        if !std::mem::replace(&mut self.has_legend, true) {
            rows.push(format!("({LEGEND})"));
        }
        let beneath = on_recording(0).len() + 2;
        rows.into_iter().map(|row| format!("\n{:beneath$}{row}", "")).collect()
    }

    fn exit_code(&self) -> u8 {
        match (self.anomaly, self.not_judged || !self.judged) {
            (true, _) => ANOMALY,
            (false, true) => NOT_JUDGED,
            (false, false) => 0,
        }
    }
}

fn replay(
    recording: &mut Recording,
    file: &JobFile,
    arguments: &Replay,
    printer: &mut Printer<'_>,
) -> Result<(), ToolError> {
    let mut encoder = Encoder::new(file.method, &file.shapes())?;
    let mut annotator =
        annotator(arguments.annotate.as_deref(), recording, printer.names, file.method.blind_ms)?;
    let bar = progress(recording.count(), &arguments.recording);
    file.with_job(|job: &Job<'_>| -> Result<(), ToolError> {
        let mut judge = Judge::<Vec<_>>::with_memory(job, file.method)?;
        let mut newest: Option<Couples> = None;
        loop {
            let frame = recording.next_frame()?;
            printer.shows_parts |= frame.as_ref().is_some_and(|frame| !frame.objects.is_empty());
            let verdicts = judge_next(frame.as_ref(), &mut encoder, &mut judge, &mut newest);
            if !verdicts.is_empty() {
                bar.suspend(|| verdicts.iter().try_for_each(|verdict| printer.print(verdict)))
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
    Ok(())
}

/// The verdicts that the next frame leads to, or the end of the recording; `newest` becomes the newest couples.
fn judge_next<'j>(
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
    let Some(view) = recording.view() else {
        return Err(ToolError::NothingToAnnotate);
    };
    Ok(Some(Annotator::create(file, view.format, names.clone(), blind_ms)?))
}
