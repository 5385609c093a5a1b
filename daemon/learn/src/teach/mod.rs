//! Teaching: from a few correct runs of a whole job, without labels, to a job file (paper III-C, III-D, IV-B).
//!
//! Contexts give the nominal activities ([`Disagreement`] says where a run differs), DBA the reference of each IU, a
//! [`ThresholdRule`] its threshold, and a [`BoundsRule`](crate::rule::BoundsRule) the bounds of duration and of reversals.
//! The same runs give the same job, byte for byte.

mod bounds;
mod left_out;
mod options;
mod order;
mod relation;
mod report;
mod sampling;
mod sequence;
mod threshold;

pub use options::{TeachError, TeachOptions};
pub use order::OrderReport;
pub use report::{IuReport, Outlier, TeachReport};
pub use sequence::Disagreement;

use crate::barycentre::Barycentres;
use crate::job_file::{JobFile, Provenance, Source, TaughtActivity, TaughtIu};
use crate::rule::ThresholdRule;
use crate::run::{Iu, Run};
use crate::warp::Warp;
use andon_core::capacity::{ACTIVITIES, ACTIVITY_IUS};
use andon_core::couple::Motion;
use andon_core::dtw::Refused;
use sampling::needed_rate_hz;
use sequence::{Agreement, Sequence, agree};
use threshold::learn;

/// Teaches a job from correct runs of it.
///
/// # Errors
/// If there is no run, if the runs have nothing in common, if the job exceeds a capacity, or if an option is out of its range.
pub fn teach(runs: &[Run], options: &TeachOptions) -> Result<(JobFile, TeachReport), TeachError> {
    options.check()?;
    if runs.is_empty() {
        return Err(TeachError::NoRun);
    }
    let agreement = agree(runs);
    if agreement.sequences.is_empty() {
        return Err(TeachError::NothingInCommon(runs.len()));
    }
    check_capacities(&agreement)?;
    let mut teacher = Teacher {
        runs,
        options,
        warp: Warp::new(options.cost),
        tables: Barycentres::new(options.cost, options.method.bins),
        ius: Vec::new(),
    };
    let activities =
        agreement.sequences.iter().map(|sequence| teacher.activity(sequence)).collect::<Result<_, _>>()?;
    let mut job = job_file(runs, options, &agreement, activities);
    if options.measure_rate {
        job.min_rate_hz = needed_rate_hz(agreement.used.iter().map(|index| &runs[*index]), &job);
    }
    let used: Vec<&Run> = agreement.used.iter().map(|index| &runs[*index]).collect();
    let rejected = (options.try_runs && used.len() > 1).then(|| left_out::rejected(&used, options));
    let report = TeachReport::new(runs.len(), options, &job, agreement.disagreements, rejected, teacher.ius);
    Ok((job, report))
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
    JobFile {
        id: options.id,
        name: options.name.clone(),
        rests: agreement.rests.clone(),
        steps: relation::steps(runs, agreement, options.order_matters),
        cost: options.cost,
        max_slowdown: options.max_slowdown,
        min_rate_hz: 0.0,
        method: options.method,
        objects: runs[0].objects.clone(),
        activities,
        provenance: Provenance {
            program: options.program.clone(),
            date: options.date.clone(),
            rule: options.rule,
            bounds: options.bounds,
            sources: sources(runs, agreement),
        },
    }
}

fn sources(runs: &[Run], agreement: &Agreement) -> Vec<Source> {
    let is_left_out = |index| agreement.disagreements.iter().any(|found| found.run == index);
    let source = |(index, run): (usize, &Run)| Source {
        name: run.name.clone(),
        sha256: run.sha256.clone(),
        left_out: is_left_out(index),
    };
    runs.iter().enumerate().map(source).collect()
}

/// Teaches one nominal sequence after the other, and collects what it found.
struct Teacher<'a> {
    runs: &'a [Run],
    options: &'a TeachOptions,
    warp: Warp,
    tables: Barycentres,
    ius: Vec<IuReport>,
}

impl Teacher<'_> {
    fn activity(&mut self, sequence: &Sequence) -> Result<TaughtActivity, TeachError> {
        let ius =
            (0..sequence.contexts.len()).map(|index| self.iu(sequence, index)).collect::<Result<_, _>>()?;
        Ok(TaughtActivity { activity: sequence.activity, ius })
    }

    fn iu(&mut self, sequence: &Sequence, index: usize) -> Result<TaughtIu, TeachError> {
        let shown: Vec<&Iu> = sequence
            .shown
            .iter()
            .map(|&(run, activity)| &self.runs[run].activities[activity].ius[index])
            .collect();
        let motions: Vec<&[Motion]> = shown.iter().map(|iu| iu.motion.as_slice()).collect();
        self.check_lengths(sequence, index, &motions)?;
        let TeachOptions { rule, bounds, max_slowdown, method, .. } = self.options;
        let leave_out = !matches!(rule, ThresholdRule::Paper { .. });
        let learned = learn(&mut self.warp, &self.tables, &motions, leave_out, *max_slowdown)
            .map_err(|refused| iu_error("all", usize::from(sequence.activity), index, refused))?;
        let context = sequence.contexts[index];
        let frames: Vec<u32> = shown.iter().map(|iu| iu.frames).collect();
        let reversals: Vec<u32> = shown.iter().map(|iu| iu.reversals).collect();
        let taught = TaughtIu {
            context,
            threshold: learned.threshold(*rule, f64::from(method.rate_hz)) as f32,
            frames: bounds.frames(context, method.rate_hz, &frames),
            reversals: bounds.reversals(context, &reversals),
            reference: learned.reference.clone(),
            demonstrations: shown.len() as u32,
        };
        let names = sequence.shown.iter().map(|&(run, _)| self.runs[run].name.clone()).collect();
        self.ius.push(IuReport::new(sequence.activity, index, names, &learned, &taught));
        Ok(taught)
    }

    /// Compares each demonstration with its own first frame, so that one that cannot be compared is reported with its run.
    fn check_lengths(
        &mut self,
        sequence: &Sequence,
        index: usize,
        motions: &[&[Motion]],
    ) -> Result<(), TeachError> {
        for (motion, &(run, activity)) in motions.iter().zip(&sequence.shown) {
            self.warp
                .distance(motion, &motion[..1.min(motion.len())])
                .map_err(|refused| iu_error(&self.runs[run].name, activity, index, refused))?;
        }
        Ok(())
    }
}

/// An IU that cannot be compared; activity and IU by their indices from 0.
fn iu_error(run: &str, activity: usize, iu: usize, refused: Refused) -> TeachError {
    TeachError::Iu { run: run.to_owned(), activity: activity + 1, iu: iu + 1, refused }
}
