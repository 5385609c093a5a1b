//! What the runs have in common: the nominal activities, found from the contexts alone.
//!
//! A *step* is an opening (hand and first object of an activity) and how many times that opening came before in the
//! run. The steps that most runs have make the job; within a step the sequence of contexts that most runs have is
//! nominal, and another one that enough runs have is a variant. A run that has anything else is left out.

use crate::run::Run;
use andon_core::couple::Context;
use std::collections::BTreeMap;

/// A variant needs this many runs: two could share the same slip.
const VARIANT_RUNS: usize = 3;

/// And this share of the runs: among many runs three could share the same slip.
const VARIANT_SHARE: f64 = 0.2;

/// Which step of the job an activity is: its first context, and how many activities before it in the run began so.
pub type Step = (Context, usize);

/// Where a run does not do what the others do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Disagreement {
    /// The run's place among the runs given.
    pub run: usize,
    /// The run's name.
    pub name: String,
    /// The activity in the run, from 0; where the run lacks a step, the place where the others have it.
    pub activity: usize,
    /// The IU in the activity, from 0.
    pub iu: usize,
    /// The context that the run has there; `None` when it has ended.
    pub had: Option<Context>,
    /// The context that the others have there; `None` when they have ended.
    pub others: Option<Context>,
}

/// A sequence of contexts that fulfils a step, and who shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sequence {
    /// The number of the activity in the job.
    pub activity: u16,
    /// The contexts in order.
    pub contexts: Vec<Context>,
    /// The demonstrations: run, and activity in the run.
    pub shown: Vec<(usize, usize)>,
}

/// What the runs have in common.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Agreement {
    /// The nominal sequences, by number of the activity; the most common of an activity comes first.
    pub sequences: Vec<Sequence>,
    /// Runs that do something else, one line each; they are left out.
    pub disagreements: Vec<Disagreement>,
    /// Whether all runs that agree have the steps in one order.
    pub one_order: bool,
}

/// Finds what the runs have in common.
pub fn agree(runs: &[Run]) -> Agreement {
    let steps: Vec<Vec<Step>> = runs.iter().map(steps_of).collect();
    let nominal = nominal_steps(&steps);
    let sequences = nominal_sequences(runs, &steps, &nominal);
    let mut agreement = Agreement::default();
    let mut kept = Vec::new();
    for run in 0..runs.len() {
        match disagreement(run, &runs[run], &steps[run], &nominal, &sequences) {
            Some(found) => agreement.disagreements.push(found),
            None => kept.push(run),
        }
    }
    agreement.one_order = kept.windows(2).all(|pair| steps[pair[0]] == steps[pair[1]]);
    for (number, step) in nominal.iter().enumerate() {
        for contexts in &sequences[step] {
            let shown: Vec<(usize, usize)> = kept
                .iter()
                .filter_map(|&run| Some((run, steps[run].iter().position(|other| other == step)?)))
                .filter(|&(run, activity)| runs[run].activities[activity].contexts() == *contexts)
                .collect();
            if !shown.is_empty() {
                agreement.sequences.push(Sequence {
                    activity: number as u16,
                    contexts: contexts.clone(),
                    shown,
                });
            }
        }
    }
    agreement
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

/// Hand and first object: an activity may begin with its object already at another one.
fn opening(Context([hand, j, _, _]): Context) -> Context {
    Context([hand, j, 0, 0])
}

/// The steps that more than half of the runs have, in the order of their mean place.
fn nominal_steps(steps: &[Vec<Step>]) -> Vec<Step> {
    let mut places: BTreeMap<Step, Vec<usize>> = BTreeMap::new();
    for run in steps {
        for (place, step) in run.iter().enumerate() {
            places.entry(*step).or_default().push(place);
        }
    }
    places.retain(|_, places| 2 * places.len() > steps.len());
    let mut nominal: Vec<(f64, Step)> = places
        .into_iter()
        .map(|(step, places)| (places.iter().sum::<usize>() as f64 / places.len() as f64, step))
        .collect();
    nominal.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    nominal.into_iter().map(|(_, step)| step).collect()
}

type Sequences = BTreeMap<Step, Vec<Vec<Context>>>;

/// For each step its most common sequence, then the variants that enough runs have.
fn nominal_sequences(runs: &[Run], steps: &[Vec<Step>], nominal: &[Step]) -> Sequences {
    let needed = VARIANT_RUNS.max((VARIANT_SHARE * runs.len() as f64).ceil() as usize);
    let mut all = Sequences::new();
    for step in nominal {
        let mut counts: BTreeMap<Vec<Context>, usize> = BTreeMap::new();
        for (run, steps) in runs.iter().zip(steps) {
            if let Some(place) = steps.iter().position(|other| other == step) {
                *counts.entry(run.activities[place].contexts()).or_default() += 1;
            }
        }
        let mut counts: Vec<(Vec<Context>, usize)> = counts.into_iter().collect();
        // Ties go to the longer sequence: a contact that was missed is more common than one that never was.
        counts.sort_by_key(|(contexts, count)| std::cmp::Reverse((*count, contexts.len())));
        let enough = |(place, (contexts, count)): (usize, (Vec<Context>, usize))| {
            (place == 0 || count >= needed).then_some(contexts)
        };
        all.insert(*step, counts.into_iter().enumerate().filter_map(enough).collect());
    }
    all
}

/// The first place where a run does something that is in no nominal sequence.
fn disagreement(
    run: usize,
    what: &Run,
    steps: &[Step],
    nominal: &[Step],
    sequences: &Sequences,
) -> Option<Disagreement> {
    let at = |activity, iu, had, others| {
        Some(Disagreement { run, name: what.name.clone(), activity, iu, had, others })
    };
    for (place, step) in steps.iter().enumerate() {
        let contexts = what.activities[place].contexts();
        let Some(allowed) = sequences.get(step) else {
            // The others do whatever is nominal here and not yet done.
            let others = nominal.iter().find(|step| !steps[..place].contains(step)).map(|step| step.0);
            return at(place, 0, contexts.first().copied(), others);
        };
        if !allowed.contains(&contexts) {
            let common = &allowed[0];
            let iu = contexts.iter().zip(common).take_while(|(had, other)| had == other).count();
            return at(place, iu, contexts.get(iu).copied(), common.get(iu).copied());
        }
    }
    let missing = nominal.iter().position(|step| !steps.contains(step))?;
    at(missing, 0, steps.get(missing).map(|step| step.0), Some(nominal[missing].0))
}
