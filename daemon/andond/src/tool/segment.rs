//! `andond segment`: the ERUs, IUs, activities and the job of a recording (paper III-B).

use std::io::{Write, stdout};
use std::slice::from_ref;

use andon_core::config::Method;
use andon_core::couple::{Couple, Encoder, Unseen};
use andon_core::input::Side;
use andon_core::segment::{Event, HandEvent, JobSegmenter};
use andon_host::atomic;
use andon_host::config::Config;
use andon_host::exit::Code;
use andon_learn::job_file::JobFile;
use andon_learn::recording::incidental_pairs;

use super::{ToolError, cannot_write, check_writable, each_frame, job, load_config_for};
use crate::cli::Segment;
use crate::recording::Recording;
use crate::report::plot::{self, Band, RecordedVisibility, Timeline};
use crate::report::{EventLine, Names};

/// Runs the command.
///
/// # Errors
/// What is missing or damaged.
pub fn run(arguments: &Segment) -> Result<Code, ToolError> {
    let config = load_config_for(&arguments.config, from_ref(&arguments.recording))?;
    if let Some(file) = &arguments.plot {
        check_writable(file)?;
    }
    let job = arguments.job.as_ref().map(|path| job::load(path)).transpose()?;
    let mut recording = Recording::open(&arguments.recording, &config)?;
    if let (Some(job), Some(path)) = (&job, &arguments.job) {
        job::check_recording((path, job), &arguments.recording, recording.header())?;
    }
    let names = Names::of_objects(job.as_ref().map_or(&recording.header().objects, |job| &job.objects));
    let segmented = segment(&mut recording, &config, job.as_ref(), arguments)?;
    if segmented.lines.is_empty() {
        eprintln!("{}: {}", arguments.recording.display(), nothing(&segmented, job.as_ref()));
    }
    for [one, other] in job.iter().flat_map(|job| incidental_pairs(&job.objects)) {
        eprintln!("not counted: {one} and {other} come near each other by chance only, as the job says");
    }
    let printed =
        if arguments.json { print_json(&segmented.lines) } else { print_text(&segmented.lines, &names) };
    printed.map_err(ToolError::Print)?;
    if let Some(file) = &arguments.plot {
        let picture = plot::draw(&segmented.seen, &segmented.timelines(&names), &names, config.method.bins);
        atomic::write(file, picture.as_bytes()).map_err(cannot_write(file))?;
    }
    Ok(Code::Stopped)
}

#[derive(Default)]
struct Segmented {
    seen: RecordedVisibility,
    couples: Vec<Couple>,
    lines: Vec<EventLine>,
    /// The rate of the grid, in Hz, how many frames it has, and how many of them came.
    grid_hz: f32,
    frames: u32,
    captured: u32,
}

impl Segmented {
    /// How many frames per second came, as far as the method takes them.
    fn rate_hz(&self) -> f32 {
        self.grid_hz * self.captured as f32 / self.frames.max(1) as f32
    }
}

/// Why there is nothing to print, and what to do.
fn nothing(segmented: &Segmented, job: Option<&JobFile>) -> String {
    let (rate_hz, needed_hz) = (segmented.rate_hz(), job.map_or(0.0, |job| job.min_rate_hz));
    if rate_hz < needed_hz {
        format!(
            "too few frames to see what a hand does: {rate_hz:.1} per second, and the job needs {needed_hz:.1}"
        )
    } else if job.is_some() {
        "no hand touched a part of the job; see with `andond look` whether hands and parts are seen"
            .to_owned()
    } else {
        "no hand touched a part where the station says that it is touched; name a job that was taught from such recordings with --job, \
         because the runs show where"
            .to_owned()
    }
}

/// Where a job is given, with its constants and where its runs show that hands and parts meet, as the judge does it.
fn segment(
    recording: &mut Recording,
    config: &Config,
    job: Option<&JobFile>,
    arguments: &Segment,
) -> Result<Segmented, ToolError> {
    let own = Method { space: recording.header().space, ..config.method() };
    let method = job.map_or(own, |job| job.method);
    let shapes = job.map_or_else(|| recording.header().shapes(), JobFile::shapes);
    let mut encoder = Encoder::new(method, &shapes)?;
    let mut segmenter = JobSegmenter::new(&method)?;
    let parts = shapes.iter().map(|shape| shape.id);
    let blind_ns = u64::from(method.blind_ms) * 1_000_000;
    let mut seen = RecordedVisibility::new(&recording.header().hands, parts, method.period_ns(), blind_ns);
    let mut segmented = Segmented { grid_hz: method.rate_hz, ..Segmented::default() };
    let mut handless = Vec::new();
    let mut take = |couples: andon_core::couple::Couples| {
        if couples.lacks(Unseen::MOVER | Unseen::CARRIER) {
            handless.push(couples.captured_ns);
        }
        segmented.frames += 1;
        segmented.captured += u32::from(!couples.lacks(Unseen::FRAME));
        segmented.couples.extend(couples.hands);
        segmenter.step(&couples, &mut |event| segmented.lines.extend(line(event)));
    };
    each_frame(recording, &arguments.recording, |frame| {
        seen.take(&frame);
        // A recording has no late frames, except where its clock was stepped; they are ignored.
        let _ = encoder.step(&frame, &mut take);
        Ok(())
    })?;
    encoder.flush(&mut take);
    handless.into_iter().for_each(|at_ns| seen.take_handless(at_ns));
    segmented.seen = seen;
    segmenter.finish(&mut |event| segmented.lines.extend(line(event)));
    segmented.lines.sort_by(|a, b| a.began_s.total_cmp(&b.began_s));
    Ok(segmented)
}

fn line(event: Event) -> Option<EventLine> {
    Some(match event {
        Event::Hand(side, HandEvent::Eru { context, began_ns, ended_ns, .. }) => {
            EventLine::new("eru", side, context.0, began_ns, ended_ns)
        }
        Event::Hand(side, HandEvent::IuEnded(iu)) => EventLine {
            measured: Some(f64::from(iu.measured) / f64::from(iu.frames.max(1))),
            seen: Some(f64::from(iu.seen) / f64::from(iu.frames.max(1))),
            ..EventLine::new("iu", side, iu.context.0, iu.began_ns, iu.ended_ns)
        },
        Event::Hand(side, HandEvent::ActivityEnded { context, began_ns, ended_ns }) => {
            EventLine::new("activity", side, context.0, began_ns, ended_ns)
        }
        Event::JobEnded { began_ns, ended_ns } => EventLine::job(began_ns, ended_ns),
        Event::JobBegan { .. } | Event::Hand(..) => return None,
    })
}

fn print_json(lines: &[EventLine]) -> std::io::Result<()> {
    let mut out = stdout().lock();
    for line in lines {
        serde_json::to_writer(&mut out, line)?;
        writeln!(out)?;
    }
    Ok(())
}

fn print_text(lines: &[EventLine], names: &Names) -> std::io::Result<()> {
    let mut out = stdout().lock();
    // ERUs come by the dozen: they are for programs.
    for line in lines.iter().filter(|line| line.level != "eru") {
        let indent = match line.level {
            "job" => "",
            "activity" => "  ",
            _ => "    ",
        };
        let what = line
            .context
            .map(|context| names.context(andon_core::couple::Context(context)))
            .unwrap_or_default();
        let hand = line.hand.unwrap_or("");
        let share = |what: &str, share: Option<f64>| match share {
            Some(share) if share < 1.0 => format!(" ({what} in {:.0} % of it)", 100.0 * share),
            _ => String::new(),
        };
        let known = share("all seen", line.seen) + &share("motion measured", line.measured);
        writeln!(
            out,
            "{:8.2} .. {:8.2} s  {hand:5}  {indent}{} {what}{known}",
            line.began_s, line.ended_s, line.level
        )?;
    }
    Ok(())
}

impl Segmented {
    /// One timeline for each hand that touches anything.
    fn timelines(&self, names: &Names) -> Vec<Timeline> {
        let timeline = |side: Side| Timeline {
            title: format!("{} hand", side.name()),
            couples: self.couples.iter().filter(|couple| couple.side == side).copied().collect(),
            ius: self.bands("iu", side, names),
            activities: self.bands("activity", side, names),
        };
        Side::ALL.map(timeline).into_iter().filter(|timeline| !timeline.ius.is_empty()).collect()
    }

    fn bands(&self, level: &str, side: Side, names: &Names) -> Vec<Band> {
        let nanoseconds = |seconds: f64| (seconds * 1e9).round() as u64;
        let of = self.lines.iter().filter(|line| line.level == level && line.hand == Some(side.name()));
        of.map(|line| Band {
            label: line
                .context
                .map(|context| names.context(andon_core::couple::Context(context)))
                .unwrap_or_default(),
            began_ns: nanoseconds(line.began_s),
            ended_ns: nanoseconds(line.ended_s),
        })
        .collect()
    }
}
