//! The order of a job as a partial one: what stands before what in all runs, and whether that is evidence for a law.
//!
//! Every run that was shown is right. A before B is law where all runs that have both agree, and the gap between them is safely large. Its mean over
//! the runs is large enough ([`margin`]) on the clock with the least spread for its size. Those clocks are the sequence of the one hand that does
//! both, that of the job for what one hand does too, and time. Between two hands only time counts, and hands that begin within a few seconds of each
//! other show nothing. A person does not mind which is first. An order that all runs have without that evidence is the usual order: another one is a
//! note.
//!
//! Two unrelated steps are in the same order in all `n` runs with a probability of `2^(1-n)`. One run shows no order.

use super::options::TeachOptions;
use super::sequence::{Agreement, Sequence};
use super::strength::{Rule, Strengths};
use crate::job_file::{Relation, RelationKind, TaughtStep};
use crate::run::{Activity, Run};
use crate::statistics::{deviation, mean};
use andon_core::couple::Context;
use std::collections::BTreeSet;

/// The smallest deviation of a gap that is believed, in seconds or places of a sequence: a few runs may agree by chance. With it, the same order in
/// two runs is a law of one hand from the middle strictness on, and not below. Halved or doubled, none of 70 jobs that five runs or more teach
/// differs.
const MIN_DEVIATION: f64 = 0.02;

/// Two hands that come within this many seconds of each other, beyond the bound, show no order. Halved and doubled, 2 and 7 of 31 jobs have other
/// laws, and no verdict on 198 jobs of others changes.
const BETWEEN_HANDS_S: f64 = 3.0;

/// The probability that two unrelated steps come in the same order in all of this number of runs.
pub(super) fn chance_of_one_order(runs: usize) -> f64 {
    0.5_f64.powi(runs as i32 - 1)
}

struct Occurrence<'a> {
    activity: &'a Activity,
    began_s: f64,
    /// When the hand let go, or the activity ended.
    ended_s: f64,
    /// Its place in the sequence of the run, and of its hand in it.
    places: [f64; 2],
}

impl<'a> Occurrence<'a> {
    fn new(run: &'a Run, index: usize) -> Self {
        let activity = &run.activities[index];
        let of_hand = run.activities[..index].iter().filter(|before| before.side == activity.side).count();
        let mut touches = activity.ius.iter().filter(|iu| iu.context.is_touch());
        let seconds = |ns: u64| ns as f64 * 1e-9;
        Self {
            activity,
            began_s: touches.next().map_or(0.0, |iu| seconds(iu.began_ns)),
            ended_s: seconds(activity.ended_ns()),
            places: [index as f64, of_hand as f64],
        }
    }
}

/// The steps of the job with their relations to those before them. The options say how strict that is, and may say whether the order matters.
pub(super) fn steps(
    runs: &[Run],
    agreement: &Agreement,
    options: &TeachOptions,
    strengths: &Strengths,
) -> Vec<TaughtStep> {
    let keys = &agreement.keys;
    let all: Vec<Vec<Option<Occurrence<'_>>>> = agreement
        .steps
        .iter()
        .map(|step| {
            let of_run = step.iter().zip(&agreement.used);
            of_run.map(|(index, run)| Some(Occurrence::new(&runs[*run], (*index)?))).collect()
        })
        .collect();
    let step = |later: usize| {
        let after = (0..later).filter_map(|earlier| {
            let relation = relation(earlier, &all[earlier], &all[later], options)?;
            let (one, other) = (keys[earlier], keys[later]);
            let is_law = strengths.is_law(Rule::Order(one.min(other), one.max(other)));
            Some(if is_law { relation } else { Relation { kind: RelationKind::Usual, ..relation } })
        });
        let count = all[later].iter().flatten().count();
        TaughtStep {
            is_required: count == agreement.used.len() && strengths.is_law(Rule::Required(keys[later])),
            completes: completed_by(later, agreement),
            is_once: false,
            allows_insertions: allows_insertions(later, agreement),
            runs: count as u16,
            after: after.collect(),
            moves: Vec::new(),
        }
    };
    let mut steps: Vec<TaughtStep> = (0..all.len()).map(step).collect();
    let is_once =
        |index| strengths.is_law(Rule::Once(keys[index])) && has_its_place(index, &steps, agreement);
    let once: Vec<bool> = (0..all.len()).map(is_once).collect();
    steps.iter_mut().zip(once).for_each(|(step, once)| step.is_once = once);
    steps
}

fn allows_insertions(step: usize, agreement: &Agreement) -> bool {
    agreement
        .sequences
        .iter()
        .any(|sequence| usize::from(sequence.activity) == step && sequence.allows_insertions)
}

/// The sequences that do only a part of what other runs do in one, where this step is a part of it. Whoever lets go in the middle does two steps.
fn completed_by(step: usize, agreement: &Agreement) -> Vec<u16> {
    let sequences = &agreement.sequences;
    let of_step = |sequence: &&Sequence| usize::from(sequence.activity) == step;
    let is_in = |rest: &[Context]| {
        sequences
            .iter()
            .filter(of_step)
            .any(|own| rest.windows(own.contexts.len()).any(|part| part == own.contexts))
    };
    let is_part = |part: &Sequence| {
        let mut others = sequences.iter().filter(|other| other.activity == part.activity);
        others.any(|whole| whole.contexts.strip_prefix(part.contexts.as_slice()).is_some_and(is_in))
    };
    let is_always_there = |part: &Sequence| {
        part.shown.iter().all(|(run, _)| {
            let index = agreement.used.iter().position(|used| used == run);
            index.is_some_and(|index| agreement.steps[step][index].is_some())
        })
    };
    let is_completed =
        |part: &Sequence| usize::from(part.activity) != step && is_part(part) && is_always_there(part);
    (0u16..).zip(sequences).filter(|(_, part)| is_completed(part)).map(|(index, _)| index).collect()
}

/// The relation of a step to one that has a lower number in the job, if there is one.
fn relation(
    activity: usize,
    earlier: &[Option<Occurrence<'_>>],
    later: &[Option<Occurrence<'_>>],
    options: &TeachOptions,
) -> Option<Relation> {
    let both: Vec<_> =
        earlier.iter().zip(later).filter_map(|(a, b)| Some((a.as_ref()?, b.as_ref()?))).collect();
    let gaps = |gap: &dyn Fn(&Occurrence<'_>, &Occurrence<'_>) -> f64| -> Vec<f64> {
        both.iter().map(|(a, b)| gap(a, b)).collect()
    };
    let begins = gaps(&|a, b| b.began_s - a.began_s);
    let quantile = options.strictness.law_quantile(both.len(), is_shared(&both));
    let kind = match options.order_matters {
        Some(true) => Some(RelationKind::Begin),
        Some(false) => None,
        None if both.len() < 2 || begins.iter().any(|gap| *gap <= 0.0) => None,
        None if both.iter().all(|(a, b)| a.activity.side == b.activity.side) => {
            let places = [0, 1].map(|clock| gaps(&|a, b| b.places[clock] - a.places[clock]));
            let is_law = |gaps: &Vec<f64>| margin(gaps, quantile) >= 0.0;
            let clocks = [&places[0], &places[1], &begins];
            Some(if clocks.into_iter().any(is_law) { RelationKind::Begin } else { RelationKind::Usual })
        }
        None => between_hands(&begins, &gaps(&|a, b| b.began_s - a.ended_s), is_shared(&both), quantile),
    };
    kind.map(|kind| Relation {
        activity: activity as u16,
        kind,
        runs: both.len() as u16,
        gap_s: mean(&begins) as f32,
    })
}

fn between_hands(begins: &[f64], ends: &[f64], is_shared: bool, quantile: f64) -> Option<RelationKind> {
    // A hand that takes up what the other one has put down waits for it.
    let after_end_s = if is_shared { 0.0 } else { BETWEEN_HANDS_S };
    if margin(ends, quantile) >= after_end_s {
        Some(RelationKind::End)
    } else if margin(begins, quantile) >= BETWEEN_HANDS_S {
        Some(RelationKind::Begin)
    } else {
        (mean(begins) >= BETWEEN_HANDS_S).then_some(RelationKind::Usual)
    }
}

/// Whether these gaps between one hand and the other, which is at the same part, show that one comes first, in seconds.
pub(super) fn is_order_of_hands(gaps: &[f64], options: &TeachOptions) -> bool {
    gaps.len() > 1 && margin(gaps, options.strictness.law_quantile(gaps.len(), true)) >= BETWEEN_HANDS_S
}

/// By how much the mean of these gaps exceeds the least one with which the next gap is positive too. It is that of this quantile of Student's t.
fn margin(gaps: &[f64], quantile: f64) -> f64 {
    let spread = deviation(gaps, 1).max(MIN_DEVIATION) * (1.0 + 1.0 / gaps.len() as f64).sqrt();
    mean(gaps) - quantile * spread
}

/// Whether the two steps have a part in common in all runs.
fn is_shared(both: &[(&Occurrence<'_>, &Occurrence<'_>)]) -> bool {
    let parts = |step: &Occurrence<'_>| -> BTreeSet<u16> {
        step.activity.ius.iter().flat_map(|iu| iu.context.0[1..].to_vec()).filter(|id| *id != 0).collect()
    };
    both.iter().all(|(a, b)| !parts(a).is_disjoint(&parts(b)))
}

/// Whether a second time has no place for this step. All runs have it and no run has it again. Law orders it with every other step of its hand, of
/// which there is one at least.
fn has_its_place(index: usize, steps: &[TaughtStep], agreement: &Agreement) -> bool {
    let hand = |step: usize| agreement.keys[step].opening[0];
    let mut others =
        (0..steps.len()).filter(|other| *other != index && hand(*other) == hand(index)).peekable();
    let is_law = |earlier: usize, later: usize| {
        let mut laws = steps[later].after.iter().filter(|relation| relation.kind != RelationKind::Usual);
        laws.any(|relation| usize::from(relation.activity) == earlier)
    };
    steps[index].is_required
        && others.peek().is_some()
        && others.all(|other| is_law(index.min(other), index.max(other)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_does_in_two_steps_what_others_do_in_one_has_to_do_both() {
        let (there, back) = ([[1, 5, 5, 3], [1, 5, 5, 7]], [[1, 5, 5, 7], [1, 5, 5, 3]]);
        let sequence = |activity: u16, contexts: &[[u16; 4]], shown: &[(usize, usize)]| Sequence {
            activity,
            contexts: contexts.iter().copied().map(Context).collect(),
            shown: shown.to_vec(),
            ..Sequence::default()
        };
        let whole = sequence(0, &[there, back].concat(), &[(0, 0), (1, 0)]);
        let part = sequence(0, &there, &[(2, 0), (3, 0)]);
        let rest = sequence(1, &back, &[(2, 1), (3, 1)]);
        let agreement = |sequences: &[&Sequence], last: Option<usize>| Agreement {
            sequences: sequences.iter().copied().cloned().collect(),
            used: (0..4).collect(),
            steps: vec![vec![Some(0); 4], vec![None, None, Some(1), last]],
            ..Agreement::default()
        };
        let all = [&whole, &part, &rest];
        assert_eq!(completed_by(1, &agreement(&all, Some(1))), [1]);
        assert!(completed_by(0, &agreement(&all, Some(1))).is_empty());
        assert!(completed_by(1, &agreement(&all, None)).is_empty(), "a run shows that the part is enough");
        assert!(completed_by(1, &agreement(&[&part, &rest], Some(1))).is_empty(), "nobody does both in one");
    }
}
