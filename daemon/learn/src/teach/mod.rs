//! Teaching: from a few correct runs of a whole job, without labels, to a job file (paper III-C, III-D, IV-B).
//!
//! Contexts give the nominal activities ([`Disagreement`] says where a run differs), DBA the reference of each IU, a
//! [`ThresholdRule`] its threshold, and a [`BoundsRule`](crate::rule::BoundsRule) the bounds of duration and of the other measures.
//! The same runs give the same job, byte for byte. What speaks against learning from the runs is found in [`trust`] and said in the report.

mod bounds;
mod iu_report;
mod kind;
mod left_out;
mod measures;
mod meetings;
mod noticed;
mod options;
mod order;
mod page;
mod people;
mod reach;
mod relation;
mod report;
mod sampling;
mod sequence;
mod start;
mod threshold;
mod trust;

pub use iu_report::IuReport;
pub use meetings::Unsure;
pub(crate) use meetings::is_given;
pub use options::{TeachError, TeachOptions};
pub use order::OrderReport;
pub use page::page;
pub use report::TeachReport;
pub use sequence::Disagreement;
pub use trust::{Blind, Doubt, Measure, Outlier};

use crate::barycentre::Barycentres;
use crate::job_file::{JobFile, Provenance, Source, TaughtActivity, TaughtIu, context_words};
use crate::recording::{NamedObject, object_name};
use crate::rule::ThresholdRule;
use crate::run::{Iu, Run};
use crate::warp::Warp;
use andon_core::bounds::Bounds;
use andon_core::capacity::{ACTIVITIES, ACTIVITY_IUS, OBJECTS};
use andon_core::couple::{Context, Motion};
use andon_core::dtw::Refused;
use andon_core::object::Meeting;
use andon_core::segment::Measures;
use kind::{is_repeated, is_taking, way_of};
use measures::Rates;
use people::People;
use report::Found;
use sampling::needed_rate_hz;
use sequence::{Agreement, Sequence, agree};
use std::borrow::Cow;
pub(crate) use threshold::Memory;
use threshold::{compared, learn};
use trust::{doubts_of, too_few_frames, without_copies};

/// Teaches a job from correct runs of it.
///
/// # Errors
/// If there is no run, if the runs have nothing in common, if the job exceeds a capacity, or if an option is out of its range.
pub fn teach(runs: &[Run], options: &TeachOptions) -> Result<(JobFile, TeachReport), TeachError> {
    options.check()?;
    if runs.is_empty() {
        return Err(TeachError::NoRun);
    }
    let (runs, twice) = if options.examine_runs { without_copies(runs) } else { (Cow::Borrowed(runs), None) };
    if !options.find_meetings {
        return teach_examined(&runs, agree(&runs), options, twice);
    }
    let (met, agreement, unsure) = meet(&runs, options)?;
    let (job, mut report) = teach_examined(&met, agreement, options, twice)?;
    report.unsure = unsure;
    Ok((job, report))
}

/// The runs as they are where hands and objects meet as these runs show it, what they then have in common, and what is not sure of it.
fn meet(runs: &[Run], options: &TeachOptions) -> Result<(Vec<Run>, Agreement, Vec<Unsure>), TeachError> {
    let (objects, unsure) = meetings::learn(runs, &options.method);
    let (met, agreement) = reach::widened(encoded_with(&objects, runs)?, options)?;
    Ok((met, agreement, unsure))
}

/// The runs as they are where hands and objects meet so.
fn encoded_with(objects: &[NamedObject], runs: &[Run]) -> Result<Vec<Run>, TeachError> {
    // The points and distances that are learnt are finite, so it is only their number that may be refused.
    let too_many = |_| TeachError::Full { what: "objects", needed: objects.len(), max: OBJECTS };
    let met = runs.iter().map(|run| run.encoded_with_objects(objects)).collect::<Result<_, _>>();
    met.map_err(too_many)
}

/// Teaches a job from runs that are different. `twice` is what speaks against those that were given.
fn teach_examined(
    runs: &[Run],
    agreement: Agreement,
    options: &TeachOptions,
    twice: Option<Doubt>,
) -> Result<(JobFile, TeachReport), TeachError> {
    if !options.examine_runs {
        return teach_different(runs, agreement, options, Vec::new(), &mut Memory::default());
    }
    let doubts: Vec<Doubt> = twice.into_iter().chain(too_few_frames(runs, &options.method)).collect();
    let sentences: Vec<String> = doubts.iter().map(|doubt| doubt_words(doubt, runs)).collect();
    teach_different(runs, agreement, options, doubts, &mut Memory::default()).map_err(|nothing| match nothing
    {
        nothing if sentences.is_empty() || !nothing.is_of_runs() => nothing,
        nothing => TeachError::Doubtful { doubts: sentences, nothing: Box::new(nothing) },
    })
}

/// The runs as they are where hands and objects meet as these runs show it.
///
/// # Errors
/// If the objects cannot be used.
pub(crate) fn as_shown_to_meet(runs: &[Run], options: &TeachOptions) -> Result<Vec<Run>, TeachError> {
    Ok(meet(runs, options)?.0)
}

/// Teaches runs as they are, where hands and parts meet as these say, with what was learned from the same runs before.
///
/// # Errors
/// As for [`teach`].
pub(crate) fn teach_again(
    runs: &[Run],
    options: &TeachOptions,
    memory: &mut Memory,
) -> Result<JobFile, TeachError> {
    options.check()?;
    Ok(teach_different(runs, agree(runs), options, Vec::new(), memory)?.0)
}

/// `agreement` is what these runs have in common, `doubts` what speaks against them so far.
fn teach_different(
    runs: &[Run],
    agreement: Agreement,
    options: &TeachOptions,
    mut doubts: Vec<Doubt>,
    memory: &mut Memory,
) -> Result<(JobFile, TeachReport), TeachError> {
    if agreement.sequences.is_empty() {
        return Err(nothing_agrees(runs, &agreement));
    }
    check_capacities(&agreement)?;
    let people = People::of(runs, &agreement, options.method.rate_hz);
    memory.prepare(options.cost, options.has_free_ends);
    let mut teacher = Teacher {
        runs,
        options,
        warp: Warp::new(options.cost),
        tables: Barycentres::new(options.cost, options.method.bins),
        rates: rates(runs, &agreement, options.bounds.false_alarms, people),
        people,
        memory,
        ius: Vec::new(),
        blind: Vec::new(),
    };
    let activities = agreement
        .sequences
        .iter()
        .enumerate()
        .map(|(number, sequence)| teacher.activity(number, sequence))
        .collect::<Result<_, _>>()?;
    let (ius, blind) = (teacher.ius, teacher.blind);
    let mut job = job_file(runs, options, &agreement, activities);
    let used = agreement.used_runs(runs);
    if options.measure_rate {
        job.min_rate_hz = needed_rate_hz(&used, &job);
    }
    let mut pauses = Vec::new();
    if options.examine_runs {
        // The lengths were checked when the IUs were learnt.
        let (found, only_pauses) = doubts_of(runs, &agreement, options).unwrap_or_default();
        doubts.extend(found);
        pauses = only_pauses;
    }
    let rejected = (options.try_runs && used.len() > 1).then(|| left_out::rejected(&used, options, &job));
    let found = Found {
        disagreements: agreement.disagreements,
        doubts,
        pauses,
        blind,
        rejected,
        one_person: people.one_person,
    };
    let report = TeachReport::new(runs.len(), options, &job, found, ius);
    Ok((job, report))
}

fn rates(runs: &[Run], agreement: &Agreement, false_alarms: f64, people: People) -> Rates {
    let sequences = agreement.sequences.iter();
    let ius: Vec<_> = sequences
        .flat_map(|sequence| {
            let contexts = sequence.contexts.iter().enumerate();
            contexts.map(move |(index, context)| (*context, measures_of(runs, sequence, index)))
        })
        .collect();
    Rates::new(false_alarms, people, ius.iter().map(|(context, shown)| (*context, shown.as_slice())))
}

/// The measures of the demonstrations of an IU that were seen well.
fn measures_of(runs: &[Run], sequence: &Sequence, index: usize) -> Vec<Measures> {
    sequence.well_shown(runs, index).map(|(_, iu)| iu.measures).collect()
}

/// Why there is nothing that all steps of a run agree on.
fn nothing_agrees(runs: &[Run], agreement: &Agreement) -> TeachError {
    // Where no step is common to most runs, there is nothing that a run could have had instead.
    let has_common =
        agreement.disagreements.iter().any(|found| found.others.is_some() || found.had.is_none());
    if !has_common {
        return TeachError::NothingInCommon(runs.len());
    }
    let words = |context| context_words(context, |id| object_name(&runs[0].objects, id));
    let differences = agreement.disagreements.iter().map(|found| found.sentence(&words)).collect();
    TeachError::NoneAgrees { runs: runs.len(), differences }
}

fn doubt_words(doubt: &Doubt, runs: &[Run]) -> String {
    let words = |context| context_words(context, |id| object_name(&runs[0].objects, id));
    format!("{}: {}", doubt.sentence(&words), doubt.remedy())
}

fn check_capacities(agreement: &Agreement) -> Result<(), TeachError> {
    let longest =
        agreement.sequences.iter().map(|sequence| sequence.contexts.len()).max().unwrap_or_default();
    for (what, needed, max) in [
        ("nominal activities", agreement.sequences.len(), ACTIVITIES),
        ("IUs in one activity", longest, ACTIVITY_IUS),
    ] {
        if needed > max {
            return Err(TeachError::Full { what, needed, max });
        }
    }
    Ok(())
}

fn job_file(
    runs: &[Run],
    options: &TeachOptions,
    agreement: &Agreement,
    activities: Vec<TaughtActivity>,
) -> JobFile {
    let mut job = JobFile {
        id: options.id,
        name: options.name.clone(),
        rests: agreement.rests.clone(),
        steps: relation::steps(runs, agreement, options),
        cost: options.cost,
        max_slowdown: options.max_slowdown,
        has_free_ends: options.has_free_ends,
        min_rate_hz: 0.0,
        method: options.method,
        objects: start::found(runs, agreement, options.method.space),
        activities,
        provenance: Provenance {
            program: options.program.clone(),
            date: options.date.clone(),
            rule: options.rule,
            bounds: options.bounds,
            strictness: Some(options.strictness),
            order: options.order_matters,
            sources: sources(runs, agreement),
        },
        step_names: Vec::new(),
    };
    job.name_steps(&options.step_names);
    job
}

fn sources(runs: &[Run], agreement: &Agreement) -> Vec<Source> {
    let source = |(index, run): (usize, &Run)| Source {
        name: run.name.clone(),
        sha256: run.sha256.clone(),
        left_out: !agreement.used.contains(&index),
    };
    runs.iter().enumerate().map(source).collect()
}

/// Teaches one nominal sequence after the other, and collects what it found.
struct Teacher<'a> {
    runs: &'a [Run],
    options: &'a TeachOptions,
    warp: Warp,
    tables: Barycentres,
    rates: Rates,
    people: People,
    memory: &'a mut Memory,
    ius: Vec<IuReport>,
    blind: Vec<Blind>,
}

impl Teacher<'_> {
    fn activity(&mut self, number: usize, sequence: &Sequence) -> Result<TaughtActivity, TeachError> {
        let ius = (0..sequence.contexts.len())
            .map(|index| self.iu(number, sequence, index))
            .collect::<Result<_, _>>()?;
        Ok(TaughtActivity { activity: sequence.activity, ius })
    }

    fn iu(&mut self, number: usize, sequence: &Sequence, index: usize) -> Result<TaughtIu, TeachError> {
        self.blind.extend(sequence.blind(self.runs, index));
        let shown: Vec<(usize, &Iu)> = sequence.well_shown(self.runs, index).collect();
        if shown.is_empty() {
            return Err(self.never_seen(sequence, index));
        }
        self.check_lengths(sequence, index, &shown)?;
        let shown: Vec<&Iu> = shown.into_iter().map(|(_, iu)| iu).collect();
        let TeachOptions { rule, max_slowdown, method, .. } = self.options;
        let leave_out = !matches!(rule, ThresholdRule::Paper { .. });
        let learned = self
            .memory
            .recall((number, index), || {
                let motions: Vec<_> = shown.iter().map(|iu| compared(iu, self.options)).collect();
                let motions: Vec<&[Motion]> = motions.iter().map(AsRef::as_ref).collect();
                learn(&mut self.warp, &self.tables, &motions)
            })
            .map_err(|refused| iu_error("all", usize::from(sequence.activity), index, refused))?
            .slowed(*max_slowdown, leave_out);
        let context = sequence.contexts[index];
        let frames: Vec<u32> = shown.iter().map(|iu| iu.worked_frames()).collect();
        let measured = measures_of(self.runs, sequence, index);
        let way = self.way(sequence, index);
        let (reversals, measures) =
            self.rates.bounds(context, &measured, &frames, way.as_deref(), self.met_within_m(context));
        let taught = TaughtIu {
            context,
            threshold: learned.threshold(*rule, f64::from(method.rate_hz), &self.people) as f32,
            frames: self.frames(&sequence.contexts, index, (&measured, &frames)),
            reversals,
            measures,
            reference: learned.reference.clone(),
            demonstrations: shown.len() as u32,
        };
        self.ius.push(IuReport::new(sequence.activity, index, &learned, &measured, &taught));
        Ok(taught)
    }

    /// What the demonstrations measured of a way at its end, where the IU is a part of one; it ends with the time at the part that it leads to,
    /// unless strokes are made there.
    fn way(&self, sequence: &Sequence, index: usize) -> Option<Vec<Measures>> {
        let way = way_of(&sequence.contexts, index)?;
        let [begin, end] = [*way.start(), *way.end()].map(|iu| measures_of(self.runs, sequence, iu));
        match (is_repeated(&end), index == *way.start()) {
            (false, _) => Some(end),
            (true, true) => Some(begin),
            (true, false) => None,
        }
    }

    /// How near the runs show the two parts of an IU to come, in metres; 0 where the station says it.
    fn met_within_m(&self, Context([_, _, j, l]): Context) -> f32 {
        let place = |at: u16, with: u16| {
            let mut at = self.runs[0].objects.iter().filter(move |object| object.shape.id == at);
            let meetings = &at.next()?.shape.meetings;
            let met = meetings.iter().find(|met| met.with == with && !met.points.is_empty())?;
            (with != Meeting::HAND).then_some(met.contact.off_m)
        };
        place(l, j).or_else(|| place(j, l)).unwrap_or_default()
    }

    /// The bounds of the duration of one of these IUs, from that of the demonstrations, in frames.
    fn frames(
        &self,
        contexts: &[Context],
        index: usize,
        (measured, frames): (&[Measures], &[u32]),
    ) -> Bounds {
        let TeachOptions { bounds, method, .. } = self.options;
        let context = contexts[index];
        let likely = self.rates.frames(context, measured, frames, method.rate_hz);
        let (min, max) = likely.unwrap_or_default();
        let max = bounds.max_frames(context, method.rate_hz, (frames, self.people.variety), max);
        let is_taking = is_taking(contexts, index) && !is_repeated(measured);
        Bounds { min: if is_taking { 0 } else { min }, max }
    }

    fn never_seen(&self, sequence: &Sequence, index: usize) -> TeachError {
        let name = |id| object_name(&self.runs[0].objects, id);
        TeachError::NeverSeen {
            activity: usize::from(sequence.activity) + 1,
            iu: index + 1,
            what: context_words(sequence.contexts[index], name),
        }
    }

    /// Compares each demonstration with its own first frame, so that one that cannot be compared is reported with its run.
    fn check_lengths(
        &mut self,
        sequence: &Sequence,
        index: usize,
        shown: &[(usize, &Iu)],
    ) -> Result<(), TeachError> {
        for &(run, iu) in shown {
            let motion = compared(iu, self.options);
            let activity = sequence.shown.iter().find(|(other, _)| *other == run).map_or(0, |found| found.1);
            self.warp
                .distance(&motion, &motion[..1.min(motion.len())])
                .map_err(|refused| iu_error(&self.runs[run].name, activity, index, refused))?;
        }
        Ok(())
    }
}

/// An IU that cannot be compared; activity and IU by their indices from 0.
fn iu_error(run: &str, activity: usize, iu: usize, refused: Refused) -> TeachError {
    TeachError::Iu { run: run.to_owned(), activity: activity + 1, iu: iu + 1, refused }
}
