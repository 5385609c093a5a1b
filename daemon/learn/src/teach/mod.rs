//! Teaching: from a few correct runs of a whole job, without labels, to a job file (paper III-C, III-D, IV-B).
//!
//! Contexts give the nominal activities ([`Disagreement`] says where a run differs), DBA the reference of each IU, a
//! [`ThresholdRule`] its threshold, and a [`BoundsRule`](crate::rule::BoundsRule) the bounds of duration and of the other measures.
//! The same runs give the same job, byte for byte. What speaks against learning from the runs is found in [`trust`] and said in the report.

mod bounds;
mod iu_report;
mod kind;
mod leave_one_out;
mod measures;
mod meetings;
mod noticed;
mod options;
mod order;
mod page;
mod pairs;
mod people;
mod reach;
mod relation;
mod report;
mod sampling;
mod sequence;
mod start;
mod statement;
mod strength;
mod threshold;
mod trust;
mod widened;

pub use iu_report::IuReport;
pub use meetings::Unsure;
pub use options::{TeachError, TeachOptions};
pub use order::OrderReport;
pub use page::page;
pub use report::TeachReport;
pub use sequence::Disagreement;
pub use statement::Statement;
pub use trust::{Blind, Doubt, Measure, Outlier};

use crate::barycentre::Barycentres;
use crate::job_file::{JobFile, Provenance, ShownValues, Source, TaughtActivity, TaughtIu, context_words};
use crate::recording::{NamedObject, object_name};
use crate::rule::ThresholdRule;
use crate::run::{Iu, Run};
use crate::warp::Warp;
use andon_core::bounds::Bounds;
use andon_core::capacity::{ACTIVITIES, ACTIVITY_IUS, OBJECTS};
use andon_core::couple::{Context, Motion};
use andon_core::dtw::Refused;
use andon_core::job::MeasureBounds;
use andon_core::object::Meeting;
use andon_core::segment::Measures;
use andon_core::verdict;
use bounds::UNBOUNDED;
use kind::{is_repeated, is_taking, way_of};
use measures::{Rates, what_was_shown};
use people::People;
use report::Found;
use sampling::needed_rate_hz;
use sequence::{Agreement, Sequence, agree};
use std::borrow::Cow;
use strength::{Rule, StepKey, Strength, Strengths};
pub use threshold::Memory;
use threshold::compared;
use trust::{Odd, odd_runs, too_few_frames, without_copies};

/// Teaches a job from correct runs of it: the stages, one after the other.
///
/// # Errors
/// If there is no run, if the runs have nothing in common, if the job exceeds a capacity, or if an option is out of its range.
pub fn teach(runs: &[Run], options: &TeachOptions) -> Result<(JobFile, TeachReport), TeachError> {
    options.check()?;
    if runs.is_empty() {
        return Err(TeachError::NoRun);
    }
    let (runs, twice) = if options.examine_runs { without_copies(runs) } else { (Cow::Borrowed(runs), None) };
    let slow = if options.examine_runs { too_few_frames(&runs, &options.method) } else { None };
    let doubts: Vec<Doubt> = twice.into_iter().chain(slow).collect();
    let sentences: Vec<String> = doubts.iter().map(|doubt| doubt_words(doubt, &runs)).collect();
    teach_different(&runs, options, doubts).map_err(|nothing| match nothing {
        nothing if sentences.is_empty() || !nothing.is_of_runs() => nothing,
        nothing => TeachError::Doubtful { doubts: sentences, nothing: Box::new(nothing) },
    })
}

/// Teaches runs that are different. `doubts` is what speaks against them so far.
fn teach_different(
    runs: &[Run],
    options: &TeachOptions,
    mut doubts: Vec<Doubt>,
) -> Result<(JobFile, TeachReport), TeachError> {
    let mut shown = Demonstrations::of(runs.to_vec(), options)?;
    let left_out = options.leave_one_out.then(|| leave_one_out::tried(&shown.used(runs), options)).flatten();
    let strengths = left_out.as_ref().map(|left_out| left_out.strengths.clone()).unwrap_or_default();
    shown.agree_with(&strengths);
    let Learnt { mut job, ius, blind, people } = learn(&shown, options, &strengths, &mut Memory::default())?;
    if options.measure_rate {
        job.min_rate_hz = needed_rate_hz(&shown.agreement.used_runs(&shown.runs), &job);
    }
    let mut odd = Odd::default();
    if options.examine_runs {
        // The lengths were checked when the IUs were learnt.
        odd = odd_runs(&shown.runs, &shown.agreement, options).unwrap_or_default();
        doubts.append(&mut odd.doubts);
    }
    let found = Found {
        disagreements: shown.agreement.disagreements,
        doubts,
        pauses: odd.pauses,
        questions: odd.questions,
        blind,
        left_out,
        one_person: people.one_person,
        unsure: shown.unsure,
    };
    let report = TeachReport::new(runs.len(), options, &job, found, ius);
    Ok((job, report))
}

/// Runs, with where hands and objects meet as these runs show it, and what they then have in common.
struct Demonstrations {
    runs: Vec<Run>,
    agreement: Agreement,
    unsure: Vec<Unsure>,
}

impl Demonstrations {
    /// Finds where hands and objects meet, which pairs of objects count, and what the runs have in common.
    ///
    /// # Errors
    /// If the objects cannot be used.
    fn of(runs: Vec<Run>, options: &TeachOptions) -> Result<Self, TeachError> {
        if !options.find_meetings {
            let agreement = agree(&runs, &Strengths::default());
            return Ok(Self { runs, agreement, unsure: Vec::new() });
        }
        let (objects, mut unsure) = meetings::learn(&runs, &options.method);
        let (objects, met) = pairs::choose(objects, &|objects| encoded_with(objects, &runs))?;
        unsure.extend(Unsure::incidental(&objects));
        let (runs, agreement) = reach::widened(met, options)?;
        Ok(Self { runs, agreement, unsure })
    }

    /// Finds what the runs have in common where rules are as strong as this. Whether it is anything else than before.
    fn agree_with(&mut self, strengths: &Strengths) -> bool {
        let agreement = agree(&self.runs, strengths);
        let is_other = agreement.sequences != self.agreement.sequences;
        self.agreement = agreement;
        is_other
    }

    /// Those of the runs as they were given that are used.
    fn used<'a>(&self, given: &'a [Run]) -> Vec<&'a Run> {
        self.agreement.used_runs(given)
    }
}

/// The runs as they are where hands and objects meet so.
fn encoded_with(objects: &[NamedObject], runs: &[Run]) -> Result<Vec<Run>, TeachError> {
    // The points and distances that are learnt are finite, so it is only their number that may be refused.
    let too_many = |_| TeachError::Full { what: "objects", needed: objects.len(), max: OBJECTS };
    let met = runs.iter().map(|run| run.encoded_with_objects(objects)).collect::<Result<_, _>>();
    met.map_err(too_many)
}

/// The runs as they are where hands and objects meet as these runs show it.
///
/// # Errors
/// If the objects cannot be used.
pub fn as_shown_to_meet(runs: &[Run], options: &TeachOptions) -> Result<Vec<Run>, TeachError> {
    Ok(Demonstrations::of(runs.to_vec(), options)?.runs)
}

/// Teaches runs as they are, where hands and parts meet as these say, with what was learned from the same runs before.
///
/// # Errors
/// As for [`teach`].
pub fn teach_again(runs: &[Run], options: &TeachOptions, memory: &mut Memory) -> Result<JobFile, TeachError> {
    options.check()?;
    let strengths = Strengths::default();
    let shown =
        Demonstrations { runs: runs.to_vec(), agreement: agree(runs, &strengths), unsure: Vec::new() };
    let Learnt { mut job, .. } = learn(&shown, options, &strengths, memory)?;
    if options.measure_rate {
        job.min_rate_hz = needed_rate_hz(&shown.agreement.used_runs(&shown.runs), &job);
    }
    Ok(job)
}

/// What is learnt from demonstrations.
struct Learnt {
    job: JobFile,
    ius: Vec<IuReport>,
    blind: Vec<Blind>,
    people: People,
}

/// Learns the IUs of all steps and their order, with rules as strong as this.
fn learn(
    shown: &Demonstrations,
    options: &TeachOptions,
    strengths: &Strengths,
    memory: &mut Memory,
) -> Result<Learnt, TeachError> {
    let Demonstrations { runs, agreement, .. } = shown;
    if agreement.sequences.is_empty() {
        return Err(nothing_agrees(runs, agreement));
    }
    check_capacities(agreement)?;
    let people = People::of(runs, agreement, options.method.rate_hz);
    memory.prepare(options.cost, options.has_free_ends);
    let mut teacher = Teacher {
        runs,
        options,
        strengths,
        warp: Warp::new(options.cost),
        tables: Barycentres::new(options.cost, options.method.bins),
        rates: rates(runs, agreement, options.bounds.false_alarms, people),
        people,
        memory,
        ius: Vec::new(),
        blind: Vec::new(),
    };
    let keys = step_keys(agreement);
    let activities = agreement
        .sequences
        .iter()
        .enumerate()
        .map(|(number, sequence)| teacher.activity(number, sequence, keys[usize::from(sequence.activity)]))
        .collect::<Result<_, _>>()?;
    let (ius, blind) = (teacher.ius, teacher.blind);
    let job = job_file(runs, options, agreement, strengths, activities);
    Ok(Learnt { job, ius, blind, people })
}

/// The steps by their numbers, whatever these are.
fn step_keys(agreement: &Agreement) -> Vec<StepKey> {
    let mut keys: Vec<StepKey> = Vec::new();
    for sequence in &agreement.sequences {
        if usize::from(sequence.activity) == keys.len() {
            let Context([hand, object, ..]) = sequence.contexts[0];
            let opening = [hand, object];
            keys.push(StepKey { opening, nth: keys.iter().filter(|key| key.opening == opening).count() });
        }
    }
    keys
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
    strengths: &Strengths,
    activities: Vec<TaughtActivity>,
) -> JobFile {
    let mut steps = relation::steps(runs, agreement, options, strengths);
    let mut job = JobFile {
        id: options.id,
        name: options.name.clone(),
        passive_contacts: agreement.passive_contacts.clone(),
        cost: options.cost,
        max_slowdown: options.max_slowdown,
        has_free_ends: options.has_free_ends,
        min_rate_hz: 0.0,
        method: options.method,
        objects: start::found(runs, agreement, options.method.space, &mut steps),
        steps,
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
    strengths: &'a Strengths,
    warp: Warp,
    tables: Barycentres,
    rates: Rates,
    people: People,
    memory: &'a mut Memory,
    ius: Vec<IuReport>,
    blind: Vec<Blind>,
}

impl Teacher<'_> {
    fn activity(
        &mut self,
        number: usize,
        sequence: &Sequence,
        step: StepKey,
    ) -> Result<TaughtActivity, TeachError> {
        let ius = (0..sequence.contexts.len())
            .map(|index| self.iu(number, sequence, index, step))
            .collect::<Result<_, _>>()?;
        Ok(TaughtActivity { activity: sequence.activity, ius })
    }

    fn iu(
        &mut self,
        number: usize,
        sequence: &Sequence,
        index: usize,
        step: StepKey,
    ) -> Result<TaughtIu, TeachError> {
        self.blind.extend(sequence.blind(self.runs, index));
        let demonstrations: Vec<(usize, &Iu)> = sequence.well_shown(self.runs, index).collect();
        if demonstrations.is_empty() {
            return Err(self.never_seen(sequence, index));
        }
        self.check_lengths(sequence, index, &demonstrations)?;
        let demonstrations: Vec<&Iu> = demonstrations.into_iter().map(|(_, iu)| iu).collect();
        let TeachOptions { rule, max_slowdown, method, .. } = self.options;
        let leave_out = !matches!(rule, ThresholdRule::Paper { .. });
        let learned = self
            .memory
            .recall((number, index), || {
                let motions: Vec<_> = demonstrations.iter().map(|iu| compared(iu, self.options)).collect();
                let motions: Vec<&[Motion]> = motions.iter().map(AsRef::as_ref).collect();
                threshold::learn(&mut self.warp, &self.tables, &motions)
            })
            .map_err(|refused| iu_error("all", usize::from(sequence.activity), index, refused))?
            .slowed(*max_slowdown, leave_out);
        let context = sequence.contexts[index];
        // A hand that rests has only a time.
        let of = |rule, is_way: bool| match sequence.is_steadied && is_way {
            true => Strength::None,
            false => self.strengths.of(rule),
        };
        let strength =
            |measure| of(Rule::Measure(step, context, measure), measure != verdict::Measure::Duration);
        let of_motion = of(Rule::Motion(step, context), true);
        let frames: Vec<u32> = demonstrations.iter().map(|iu| iu.worked_frames()).collect();
        let measured = measures_of(self.runs, sequence, index);
        let way = self.way(sequence, index);
        let met_within_m = self.met_within_m(context);
        let (reversals, measures) =
            self.rates.bounds(context, &measured, way.as_deref(), met_within_m, &strength);
        let way = way.as_deref().unwrap_or(&measured);
        let shown = context
            .is_touch()
            .then(|| what_was_shown(&measured, way, &frames, learned.distances(), &measures));
        let measures = MeasureBounds { shown: shown.as_ref().map(ShownValues::ranges), ..measures };
        let taught = TaughtIu {
            context,
            threshold: learned.threshold(*rule, f64::from(method.rate_hz), &self.people, of_motion) as f32,
            frames: self.frames(
                &sequence.contexts,
                index,
                (&measured, &frames),
                strength(verdict::Measure::Duration),
            ),
            reversals,
            measures,
            reference: learned.reference.clone(),
            demonstrations: demonstrations.len() as u32,
            shown,
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
        strength: Strength,
    ) -> Bounds {
        let TeachOptions { bounds, method, .. } = self.options;
        let context = contexts[index];
        if strength == Strength::None {
            return UNBOUNDED;
        }
        let likely = self.rates.frames(context, measured, frames, method.rate_hz, strength);
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
