//! A recording of the role `record`, judged as it was: by the jobs that were in force, with the commands where they came.

use std::fmt::Display;
use std::path::Path;
use std::slice::from_ref;

use andon_core::couple::Couple;
use andon_core::verdict::Verdict;
use andon_host::video::pipe::PictureFormat;
use andon_ipc::UtcTime;
use andon_record::End;
use shm_schemas::{PartId, Verdict as Message};

use super::agreement::Agreement;
use super::printer::Printer;
use super::{ToolError, load_config_for, progress};
use crate::blackbox::again::{Outcome, Recorded, Step, judge};
use crate::blackbox::{Looked, Plan, Sight, first_picture};
use crate::cli::Replay;
use crate::made_with::{differences, hashes};
use crate::picture::Annotator;
use crate::recording::{RecordingError, View};
use crate::report::{Names, on_recording, verdict_sentence};
use crate::wire;
use crate::wire::verdict::{Sender, station_name};

/// Runs the command; the exit code is the verdict.
///
/// # Errors
/// What is missing or damaged.
pub(super) fn run(arguments: &Replay) -> Result<u8, ToolError> {
    let path = arguments.recording.as_path();
    let plan = Plan::read(path).map_err(RecordingError::from)?;
    let sight = arguments.from_frames.then(|| sight(arguments, &plan)).transpose()?;
    let mut printer = Printer::new(arguments.json);
    let mut judged = Vec::new();
    let mut drawing = Drawing::new(path, arguments.annotate.as_deref(), &plan)?;
    let bar = progress(None, path);
    let mut names = (0, Names::default());
    let paths = [path.to_path_buf()];
    let wants_pictures = arguments.annotate.is_some();
    let recorded =
        Recorded { paths: &paths, plan: &plan, instead: None, wants_pictures, sight: sight.as_ref() };
    let outcome = judge(recorded, &mut |step: Step<'_>| -> Result<(), ToolError> {
        let (job, hash) = step.job;
        if names.0 != hash {
            names = (hash, Names::of_job(job));
        }
        if !step.verdicts.is_empty() {
            bar.suspend(|| {
                step.verdicts.iter().try_for_each(|verdict| printer.print(verdict, job, &names.1))
            })
            .map_err(ToolError::Print)?;
            judged.extend_from_slice(step.verdicts);
        }
        drawing.draw(&step, &names.1)?;
        bar.inc(1);
        Ok(())
    })?;
    bar.finish_and_clear();
    drawing.finish()?;
    tell(path, &plan, &outcome, &judged, &names.1);
    if printer.is_silent() {
        eprintln!("nothing was judged: in {} no hand was seen to touch an object of the job", path.display());
    }
    Ok(printer.exit_code())
}

/// Says how the verdicts compare with those that were sent then.
fn tell(path: &Path, plan: &Plan, outcome: &Outcome, judged: &[Verdict], names: &Names) {
    let path = path.display();
    let sent: Vec<Verdict> = plan.verdicts.iter().filter_map(wire::verdict::read).collect();
    // As they would have been sent: what has no meaning at a level is not.
    let judged: Vec<Verdict> = judged.iter().filter_map(as_sent).collect();
    let judged = judged.as_slice();
    let Agreement { equal, begin, end } = Agreement::of(&sent, judged);
    eprintln!("as recorded: {equal} of {} verdicts are equal bit for bit", sent.len());
    if let Some(was) = sent.get(begin) {
        let words = |verdict: &Verdict| {
            format!("{} {}", on_recording(verdict.decided_ns), verdict_sentence(verdict, names))
        };
        let is = judged.get(begin).map_or("none".to_owned(), words);
        eprintln!("the first that differs was\n{}\nand is\n{is}", words(was));
        match sent.len().checked_sub(end).and_then(|from| sent.get(from)) {
            Some(from) => eprintln!("all {end} verdicts from {} on are equal", on_recording(from.decided_ns)),
            None => eprintln!("they differ up to the end"),
        }
    }
    if let End::Cut(why) = &plan.end {
        eprintln!("{path} is cut: {why}; what came before it is whole");
    }
    if !plan.is_from_start {
        eprintln!(
            "{path} begins in the middle: what encoder and judge had seen before is not in it, and verdicts may differ"
        );
    }
    match &outcome.looked {
        Some(looked) => tell_looked(&path, looked),
        None => {
            let others = differences(&plan.station.hashes, &hashes(&plan.station.config));
            if let Some(first) = others.first() {
                eprintln!(
                    "{path} was made with something else in {} respects ({first}): its detections are judged as they are, and detecting again \
                     (--from-frames) need not give the same bits",
                    others.len()
                );
            }
        }
    }
    for (channel, lost) in &plan.lost {
        eprintln!("{path}: {lost} messages of {channel} did not reach the recorder, and verdicts may differ");
    }
    if outcome.couples_differ > 0 {
        eprintln!(
            "{path}: {} of {} couples differ from those that were sent",
            outcome.couples_differ,
            outcome.couples + outcome.couples_differ
        );
    }
    if judged.len() > equal && equal == sent.len() {
        eprintln!(
            "{path}: {} more verdicts than were sent: a judge that was killed has not sent its last",
            judged.len() - equal
        );
    }
}

/// By what the pictures are looked at again. Says first in what that differs from what they were looked at with.
fn sight(arguments: &Replay, plan: &Plan) -> Result<Sight, ToolError> {
    let path = &arguments.recording;
    let recorded = &plan.station.config.perception.models;
    let models = match recorded.is_dir() {
        true => recorded.clone(),
        // Recorded on another machine: where they are here, the configuration that is here says.
        false => load_config_for(&arguments.config, from_ref(path))?.perception.models,
    };
    let sight = Sight::of(path, &plan.station, models).map_err(RecordingError::from)?;
    let path = path.display();
    let then = &plan.station.hashes;
    let others = differences(then, &hashes(sight.config()));
    if then.is_empty() {
        eprintln!("{path} does not say what it was made with: detections may differ");
    } else if others.is_empty() {
        eprintln!("program, models, libraries and processor features are those of the recording");
    } else {
        eprintln!("{path} was made with something else: detections may differ");
        others.iter().for_each(|other| eprintln!("  {other}"));
    }
    Ok(sight)
}

/// Says how what was detected again compares with what was detected then.
fn tell_looked(path: &impl Display, looked: &Looked) {
    let Looked { frames, equal, encoded, without_picture, lost, begins_in_the_middle } = *looked;
    eprintln!("as recorded: the detections of {equal} of {frames} frames are equal bit for bit");
    for (count, words) in [
        (
            encoded,
            "pictures are not those that the camera sent: the recorder has encoded them, with losses, and with black where masks lie",
        ),
        (without_picture, "frames have no picture: what was detected in them then is judged"),
        (lost, "frames were looked at, and the recording does not say what was detected in them"),
        (
            begins_in_the_middle,
            "starts of `perceive` lack their first frames: what was seen in those is not in it",
        ),
    ] {
        if count > 0 {
            eprintln!("{path}: {count} {words}");
        }
    }
    if !looked.is_all_that_was_seen() {
        eprintln!("{path}: so detections and verdicts may differ, whatever they are made with");
    }
}

/// A verdict as a reader of its channel has it.
fn as_sent(verdict: &Verdict) -> Option<Verdict> {
    let sender = Sender { job_id: 0, model_hash: 0, station: station_name(""), part: PartId::NONE };
    let mut message = Message::default();
    wire::verdict::write(verdict, &sender, UtcTime::default(), &mut message);
    wire::verdict::read(&message)
}

/// The film with what was seen and judged drawn on it, where one is wanted.
struct Drawing<'a> {
    file: Option<&'a Path>,
    format: PictureFormat,
    blind_ms: u32,
    annotator: Option<Annotator>,
}

impl<'a> Drawing<'a> {
    fn new(path: &Path, file: Option<&'a Path>, plan: &Plan) -> Result<Self, ToolError> {
        let method = &plan.station.config.method;
        let format = match file {
            None => PictureFormat { width: 0, height: 0, rate_hz: 0.0, count: 0 },
            Some(_) => {
                let first = first_picture(path).map_err(RecordingError::from)?;
                PictureFormat {
                    rate_hz: f64::from(method.rate_hz),
                    ..first.ok_or(ToolError::NothingToAnnotate)?
                }
            }
        };
        Ok(Self { file, format, blind_ms: method.blind_ms, annotator: None })
    }

    /// Draws a frame, where it has a picture of the size that the film has.
    fn draw(&mut self, step: &Step<'_>, names: &Names) -> Result<(), ToolError> {
        let (Some(file), Some((format, picture, seen))) = (self.file, step.view) else { return Ok(()) };
        if (format.width, format.height) != (self.format.width, self.format.height) {
            return Ok(());
        }
        let annotator = match &mut self.annotator {
            Some(annotator) => annotator,
            none => none.insert(Annotator::create(file, self.format, names.clone(), self.blind_ms)?),
        };
        let couples: &[Couple] = step.couples.map_or(&[], |couples| &couples.hands);
        Ok(annotator.draw(View { format: self.format, picture, seen }, couples, step.verdicts)?)
    }

    /// Ends the film. Where no picture belongs to what was detected, there is none.
    fn finish(self) -> Result<(), ToolError> {
        match self.annotator {
            Some(annotator) => Ok(annotator.finish()?),
            None if self.file.is_some() => Err(ToolError::NothingToAnnotate),
            None => Ok(()),
        }
    }
}
