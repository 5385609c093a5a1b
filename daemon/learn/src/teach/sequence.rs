//! What the runs have in common: the nominal activities, found from the contexts alone.
//!
//! A *step* is an opening (the hand and the first object of an activity) together with the number of earlier activities of the run that have
//! the same opening. The steps that more than half of the runs have make up the job. Within a step the most common sequence of contexts is
//! nominal, and another sequence that enough runs have is a variant. A run that has anything else is left out.

use crate::run::Run;
use andon_core::couple::Context;
use std::collections::BTreeMap;

/// A variant needs at least this many runs: two could share the same slip.
const MIN_VARIANT_RUNS: usize = 3;

/// A variant also needs at least this share of the runs: among many runs, three could share the same slip.
const MIN_VARIANT_SHARE: f64 = 0.2;

/// A step of the job: the opening of an activity, and the number of earlier activities of the run with the same opening.
type Step = (Context, usize);

/// The first point at which a run does not do what the others do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Disagreement {
    /// Index of the run among the runs that were given.
    pub run: usize,
    /// The run's name.
    pub name: String,
    /// Index of the activity in the run, from 0. If the run lacks a step, the index at which the others have it.
    pub activity: usize,
    /// Index of the IU in the activity, from 0.
    pub iu: usize,
    /// The context that the run has there; `None` if its activity has ended.
    pub had: Option<Context>,
    /// The context that the others have there; `None` if their activity has ended.
    pub others: Option<Context>,
}

/// A sequence of contexts that fulfils a step, and the demonstrations that show it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Sequence {
    /// Index of the activity in the job, from 0.
    pub(super) activity: u16,
    /// The contexts in order.
    pub(super) contexts: Vec<Context>,
    /// The demonstrations: index of the run, and index of the activity in that run.
    pub(super) shown: Vec<(usize, usize)>,
}

/// What the runs have in common.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Agreement {
    /// The nominal sequences in the order of their activities; the most common sequence of an activity comes first.
    pub(super) sequences: Vec<Sequence>,
    /// The runs that do something else, one entry per run. They are left out.
    pub(super) disagreements: Vec<Disagreement>,
    /// Whether all runs that agree have the steps in the same order.
    pub(super) has_one_order: bool,
}

/// Finds what the runs have in common.
pub(super) fn agree(runs: &[Run]) -> Agreement {
    let steps: Vec<Vec<Step>> = runs.iter().map(steps_of).collect();
    let nominal = nominal_steps(&steps);
    let sequences = nominal_sequences(runs, &steps, &nominal);
    let mut disagreements = Vec::new();
    let mut kept = Vec::new();
    for (index, run) in runs.iter().enumerate() {
        match disagreement(index, run, &steps[index], &nominal, &sequences) {
            Some(found) => disagreements.push(found),
            None => kept.push(index),
        }
    }
    let has_one_order = kept.windows(2).all(|pair| steps[pair[0]] == steps[pair[1]]);
    // The run and the activity in it, for each run that shows these contexts in this step.
    let shown = |step: &Step, contexts: &[Context]| -> Vec<(usize, usize)> {
        kept.iter()
            .filter_map(|&run| Some((run, steps[run].iter().position(|other| other == step)?)))
            .filter(|&(run, activity)| runs[run].activities[activity].contexts() == contexts)
            .collect()
    };
    let sequences = (0u16..)
        .zip(&nominal)
        .flat_map(|(activity, step)| sequences[step].iter().map(move |contexts| (activity, step, contexts)))
        .map(|(activity, step, contexts)| Sequence {
            activity,
            contexts: contexts.clone(),
            shown: shown(step, contexts),
        })
        .filter(|sequence| !sequence.shown.is_empty())
        .collect();
    Agreement { sequences, disagreements, has_one_order }
}

fn steps_of(run: &Run) -> Vec<Step> {
    let mut before: BTreeMap<Context, usize> = BTreeMap::new();
    run.activities
        .iter()
        .map(|activity| {
            let opening = opening(activity.ius.first().map_or(Context::IDLE, |iu| iu.context));
            let count = before.entry(opening).or_default();
            *count += 1;
            (opening, *count - 1)
        })
        .collect()
}

/// Hand and first object of a context: at the beginning of an activity the object may be at another one already.
fn opening(Context([hand, j, _, _]): Context) -> Context {
    Context([hand, j, 0, 0])
}

/// The steps that more than half of the runs have, in the order of their mean index.
fn nominal_steps(steps: &[Vec<Step>]) -> Vec<Step> {
    let mut indices: BTreeMap<Step, Vec<usize>> = BTreeMap::new();
    for run in steps {
        for (index, step) in run.iter().enumerate() {
            indices.entry(*step).or_default().push(index);
        }
    }
    indices.retain(|_, indices| 2 * indices.len() > steps.len());
    let mut nominal: Vec<(f64, Step)> = indices
        .into_iter()
        .map(|(step, indices)| (indices.iter().sum::<usize>() as f64 / indices.len() as f64, step))
        .collect();
    nominal.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    nominal.into_iter().map(|(_, step)| step).collect()
}

type Sequences = BTreeMap<Step, Vec<Vec<Context>>>;

/// For each step its most common sequence, followed by the variants that enough runs have.
fn nominal_sequences(runs: &[Run], steps: &[Vec<Step>], nominal: &[Step]) -> Sequences {
    let min_runs = MIN_VARIANT_RUNS.max((MIN_VARIANT_SHARE * runs.len() as f64).ceil() as usize);
    let mut all = Sequences::new();
    for step in nominal {
        let mut counts: BTreeMap<Vec<Context>, usize> = BTreeMap::new();
        for (run, steps) in runs.iter().zip(steps) {
            if let Some(index) = steps.iter().position(|other| other == step) {
                *counts.entry(run.activities[index].contexts()).or_default() += 1;
            }
        }
        let mut counts: Vec<(Vec<Context>, usize)> = counts.into_iter().collect();
        // Ties go to the longer sequence: a contact that was missed is more common than a contact that never happened.
        counts.sort_by_key(|(contexts, count)| std::cmp::Reverse((*count, contexts.len())));
        let is_allowed =
            |(index, (_, count)): &(usize, (Vec<Context>, usize))| *index == 0 || *count >= min_runs;
        let allowed = counts.into_iter().enumerate().filter(is_allowed).map(|(_, (contexts, _))| contexts);
        all.insert(*step, allowed.collect());
    }
    all
}

/// The first point at which a run does something that is in no nominal sequence.
fn disagreement(
    index: usize,
    run: &Run,
    steps: &[Step],
    nominal: &[Step],
    sequences: &Sequences,
) -> Option<Disagreement> {
    let at = |activity, iu, had, others| {
        Some(Disagreement { run: index, name: run.name.clone(), activity, iu, had, others })
    };
    for (activity, step) in steps.iter().enumerate() {
        let contexts = run.activities[activity].contexts();
        let Some(allowed) = sequences.get(step) else {
            // The others do the first nominal step that this run has not done yet.
            let others = nominal.iter().find(|step| !steps[..activity].contains(step)).map(|step| step.0);
            return at(activity, 0, contexts.first().copied(), others);
        };
        if !allowed.contains(&contexts) {
            let common = &allowed[0];
            let iu = contexts.iter().zip(common).take_while(|(had, other)| had == other).count();
            return at(activity, iu, contexts.get(iu).copied(), common.get(iu).copied());
        }
    }
    let missing = nominal.iter().position(|step| !steps.contains(step))?;
    at(missing, 0, steps.get(missing).map(|step| step.0), Some(nominal[missing].0))
}
