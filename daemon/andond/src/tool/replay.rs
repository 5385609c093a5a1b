//! `andond replay`: a recording judged by a taught job.

use std::io::{Write, stdout};
use std::path::Path;

use andon_core::anomaly::Judge;
use andon_core::couple::{Couple, Couples, Encoder};
use andon_core::job::Job;
use andon_core::verdict::{Kind, Verdict};
use andon_learn::job_file::JobFile;

use super::{Failure, job, load_config, progress};
use crate::cli::Replay;
use crate::exit::Code;
use crate::fit;
use crate::picture::Annotator;
use crate::recording::Recording;
use crate::report::{Names, VerdictLine, is_anomaly, verdict_sentence};

/// Exit code: an anomaly was found.
const ANOMALY: u8 = 1;
/// Exit code: nothing wrong was found, and something could not be judged.
const NOT_JUDGED: u8 = 2;

/// Runs the command; the exit code is the verdict.
///
/// # Errors
/// What is missing or damaged.
pub fn run(arguments: &Replay) -> Result<u8, Failure> {
    let file = job::load(&arguments.job)?;
    let config = load_config(&arguments.config)?;
    let mut recording = Recording::open(&arguments.recording, &config)?;
    fit::recording(&file, recording.header()).map_err(|reason| {
        Failure::new(Code::Configuration, format!("job {}: {reason}", arguments.job.display()))
    })?;
    let names = Names::new(file.objects.iter().map(|object| (object.shape.id, object.name.clone())));
    let mut printer = Printer {
        names: &names,
        json: arguments.json,
        seq: 0,
        anomaly: false,
        not_judged: false,
        judged: false,
    };
    replay(&mut recording, &file, arguments, &mut printer)?;
    if printer.seq == 0 {
        eprintln!(
            "nothing was judged: in {} no hand touched an object of the job",
            arguments.recording.display()
        );
    }
    Ok(printer.exit_code())
}

struct Printer<'a> {
    names: &'a Names,
    json: bool,
    seq: u64,
    anomaly: bool,
    not_judged: bool,
    judged: bool,
}

impl Printer<'_> {
    fn print(&mut self, verdict: &Verdict) -> std::io::Result<()> {
        self.seq += 1;
        self.anomaly |= is_anomaly(verdict);
        self.not_judged |= verdict.kind == Kind::NotJudged;
        self.judged |= verdict.kind == Kind::JobOk;
        let mut out = stdout().lock();
        if self.json {
            serde_json::to_writer(&mut out, &VerdictLine::new(self.seq, verdict))?;
            writeln!(out)
        } else {
            writeln!(out, "{}", verdict_sentence(verdict, self.names))
        }
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
) -> Result<(), Failure> {
    let unusable = |error: &dyn std::fmt::Debug| {
        Failure::new(Code::Configuration, format!("job {}: {error:?}", arguments.job.display()))
    };
    let shapes: Vec<_> = file.objects.iter().map(|object| object.shape.clone()).collect();
    let mut encoder = Encoder::new(file.method, &shapes).map_err(|error| unusable(&error))?;
    let mut annotator = annotator(arguments.annotate.as_deref(), recording, printer.names)?;
    let bar = progress(recording.count(), &arguments.recording);
    file.with_job(|job: &Job<'_>| -> Result<(), Failure> {
        let mut judge = Judge::<Vec<_>>::with_memory(job, file.method).map_err(|error| unusable(&error))?;
        let mut verdicts: Vec<Verdict> = Vec::new();
        let mut newest: Option<Couples> = None;
        loop {
            let frame = recording.next_frame()?;
            let mut take = |couples: Couples| {
                judge.step(&couples, &mut |verdict| verdicts.push(verdict));
                newest = Some(couples);
            };
            match &frame {
                // Frames that come late are counted; a recording has none but where its clock was stepped.
                Some(frame) => drop(encoder.step(frame, &mut take)),
                None => encoder.flush(&mut take),
            }
            if frame.is_none() {
                judge.finish(&mut |verdict| verdicts.push(verdict));
            }
            bar.suspend(|| verdicts.iter().try_for_each(|verdict| printer.print(verdict)))
                .map_err(|error| Failure::new(Code::Fault, error))?;
            if let (Some(annotator), Some(view)) = (annotator.as_mut(), recording.view()) {
                let couples: &[Couple] = newest.as_ref().map_or(&[], |couples| &couples.hands);
                let drawn = match &frame {
                    Some(_) => annotator.draw(view, couples, &verdicts),
                    None => annotator.draw_end(view, &verdicts),
                };
                drawn.map_err(|error| Failure::new(Code::Usage, error))?;
            }
            verdicts.clear();
            if frame.is_none() {
                return Ok(());
            }
            bar.inc(1);
        }
    })?;
    bar.finish_and_clear();
    if let Some(annotator) = annotator {
        annotator.finish().map_err(|error| Failure::new(Code::Usage, error))?;
    }
    if let Some(warning) = recording.warning() {
        eprintln!("{warning}");
    }
    Ok(())
}

fn annotator(
    file: Option<&Path>,
    recording: &Recording,
    names: &Names,
) -> Result<Option<Annotator>, Failure> {
    let Some(file) = file else { return Ok(None) };
    let Some(view) = recording.view() else {
        return Err(Failure::new(Code::Usage, "--annotate needs a film: a track file has no pictures"));
    };
    Annotator::create(file, view.format, names.clone())
        .map(Some)
        .map_err(|error| Failure::new(Code::Usage, error))
}
