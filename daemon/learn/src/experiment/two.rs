//! The paper's second experiment (IV-B): anomaly detection in a job of two activities.

use super::confusion::Rounds;
use super::score::score;
use super::variation::Variation;
use super::{Confusion, ExperimentError};
use crate::folder::Labelled;
use crate::run::Run;
use crate::teach::{TeachOptions, teach};
use andon_core::config::Method;
use andon_core::verdict::Kind;
use oorandom::Rand64;

/// Correct executions in a training set, of the paper's 21.
const TRAINING: usize = 14;

/// Rounds of the cross-validation.
const ROUNDS: usize = 10;

/// A flawed execution, and the IU that the paper has its subjects fail: activity and IU, from 0.
const FLAWS: [(&str, usize, usize); 2] = [("J1", 0, 1), ("J2", 1, 1)];

/// A correct execution.
const CORRECT: &str = "none";

/// How executions are divided into training and test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// The paper's: 14 of the 21 correct ones at random, 10 rounds; all flawed ones are tested.
    Random,
    /// All of one person are tested, after training on the correct ones of the others; a round a person.
    LeavePersonOut,
}

/// What one variation reached under one split.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The rules.
    pub variation: Variation,
    /// The split.
    pub split: Split,
    /// At the level of IUs.
    pub ius: Rounds,
    /// At the level of activities.
    pub activities: Rounds,
    /// Of the falsely accused IUs those that are in a `J2`, where the hand puts the brick down again: by the paper's protocol
    /// only the IU that never comes is wrong.
    pub accused_in_j2: u32,
    /// Correct executions whose job verdict is `JobOk`, and all correct executions tested.
    pub jobs: (u32, u32),
}

/// Runs the experiment with each variation under each split. `progress` is called with the share that is done.
///
/// # Errors
/// Too few executions, a job that cannot be taught, or one with other activities than the protocol has.
pub fn run(
    all: &[Labelled],
    method: &Method,
    variations: &[Variation],
    splits: &[Split],
    seed: u64,
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<Outcome>, ExperimentError> {
    let mut outcomes = Vec::new();
    let steps = (variations.len() * splits.len()) as f64;
    for &split in splits {
        let rounds = rounds(all, split, seed)?;
        for variation in variations {
            outcomes.push(outcome(all, method, variation, split, &rounds)?);
            progress(outcomes.len() as f64 / steps);
        }
    }
    Ok(outcomes)
}

/// Indices of training and of test executions.
type Round = (Vec<usize>, Vec<usize>);

fn rounds(all: &[Labelled], split: Split, seed: u64) -> Result<Vec<Round>, ExperimentError> {
    let is_flawed = |one: &Labelled| FLAWS.iter().any(|(word, ..)| *word == one.what);
    let places = |keep: &dyn Fn(&Labelled) -> bool| -> Vec<usize> {
        (0..all.len()).filter(|&place| keep(&all[place])).collect()
    };
    let correct = places(&|one| one.what == CORRECT);
    let flawed = places(&is_flawed);
    if correct.len() <= TRAINING || flawed.is_empty() {
        return Err(ExperimentError::TooFew { correct: correct.len(), flawed: flawed.len() });
    }
    Ok(match split {
        Split::Random => {
            let mut random = Rand64::new(u128::from(seed));
            let mut round = || {
                let mut shuffled = correct.clone();
                // Fisher and Yates.
                for last in (1..shuffled.len()).rev() {
                    shuffled.swap(last, random.rand_range(0..last as u64 + 1) as usize);
                }
                let test = shuffled.split_off(TRAINING);
                (shuffled, [test, flawed.clone()].concat())
            };
            (0..ROUNDS).map(|_| round()).collect()
        }
        Split::LeavePersonOut => {
            let mut people: Vec<u32> = all.iter().map(|one| one.person).collect();
            people.sort_unstable();
            people.dedup();
            let round = |person: &u32| {
                let training = places(&|one| one.what == CORRECT && one.person != *person);
                let test = places(&|one| one.person == *person && (one.what == CORRECT || is_flawed(one)));
                (training, test)
            };
            people
                .iter()
                .map(round)
                .filter(|(training, test)| !training.is_empty() && !test.is_empty())
                .collect()
        }
    })
}

fn outcome(
    all: &[Labelled],
    method: &Method,
    variation: &Variation,
    split: Split,
    rounds: &[Round],
) -> Result<Outcome, ExperimentError> {
    let options = TeachOptions {
        cost: variation.cost(method.bins),
        slowness: variation.slowness,
        rule: variation.rule,
        bounds: variation.bounds,
        ..TeachOptions::new("experiment 2", "", *method)
    };
    let mut outcome = Outcome {
        variation: variation.clone(),
        split,
        ius: Rounds::default(),
        activities: Rounds::default(),
        accused_in_j2: 0,
        jobs: (0, 0),
    };
    for (training, test) in rounds {
        let runs: Vec<Run> = training.iter().map(|&place| all[place].run.clone()).collect();
        let (job, _) = teach(&runs, &options)?;
        let (mut ius, mut activities) = (Confusion::default(), Confusion::default());
        for one in test.iter().map(|&place| &all[place]) {
            let verdicts = job.with_job(|lent| one.run.judge(lent, method))?;
            let flaw = FLAWS.iter().find(|(word, ..)| *word == one.what);
            let score = score(&job, &verdicts);
            outcome.jobs.1 += u32::from(flaw.is_none());
            let right = verdicts.iter().any(|verdict| verdict.kind == Kind::JobOk);
            outcome.jobs.0 += u32::from(flaw.is_none() && right);
            for (number, (accused, said)) in score.activities.iter().enumerate() {
                activities.count(flaw.is_some_and(|(_, activity, _)| *activity == number), *accused);
                for (place, accused) in said.iter().enumerate() {
                    let wrong = flaw.is_some_and(|(_, activity, iu)| (*activity, *iu) == (number, place));
                    ius.count(wrong, *accused);
                    outcome.accused_in_j2 += u32::from(!wrong && *accused && one.what == "J2");
                }
            }
        }
        outcome.ius.0.push(ius);
        outcome.activities.0.push(activities);
    }
    Ok(outcome)
}
