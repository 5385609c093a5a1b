//! The paper's second experiment (IV-B): anomaly detection in a job of two activities.

use super::confusion::{Confusion, Rounds};
use super::error::ExperimentError;
use super::score::score;
use super::training::{Encodings, Training};
use super::variation::Variation;
use crate::folder::{CORRECT, Labelled};
use andon_core::config::Method;
use andon_core::couple::Couples;
use andon_core::verdict::{self, Level, Verdict};
use andon_learn::job_file::JobFile;
use andon_learn::recording::NamedObject;
use andon_learn::run::{RunError, verdicts};
use oorandom::Rand64;
use std::borrow::Cow;
use std::collections::BTreeSet;

/// Share of the correct executions that are in a training set: 14 of the paper's 21.
const TRAINING: (usize, usize) = (2, 3);

/// Fewer correct executions than this cannot be divided.
const MIN_CORRECT: usize = 3;

/// Number of rounds of the cross-validation.
const ROUNDS: usize = 10;

/// The name of the flawed executions, and the IU that the paper's subjects perform wrongly, by the indices of its activity and of itself.
const FLAWS: [(&str, usize, usize); 2] = [("J1", 0, 1), ("J2", 1, 1)];

/// How executions are divided into a training set and a test set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// The paper's split in 10 rounds. Each is trained with two thirds of the correct executions at random (14 of 21) and tested with the others and
    /// all flawed ones.
    Random,
    /// One round per person, tested with all executions of this person and trained with the correct ones of the others.
    LeavePersonOut,
}

impl Split {
    /// The name of the split in the table.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::LeavePersonOut => "person out",
        }
    }
}

/// The result of one variation under one split.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The rules.
    pub variation: Variation,
    /// The split.
    pub split: Split,
    /// The confusion matrices of the IUs.
    pub ius: Rounds,
    /// The confusion matrices of the activities.
    pub activities: Rounds,
    /// The number of false positives among the IUs of a `J2`, where the hand puts the brick down again. By the paper's protocol only the IU that
    /// never comes is wrong.
    pub accused_in_j2: u32,
    /// The number of correct executions that were tested.
    pub correct_jobs: u32,
    /// The number of correct executions whose job verdict is OK.
    pub correct_jobs_ok: u32,
    /// The number of flawed executions that were tested.
    pub flawed_jobs: u32,
    /// The number of flawed executions with an anomaly in any verdict.
    pub flawed_jobs_found: u32,
    /// The number of `J1` that were tested.
    pub j1: u32,
    /// The number of `J1` in which the IU that stopped halfway was judged correct.
    pub j1_missed: u32,
    /// The number of rounds in which the training executions had nothing in common.
    pub untaught: u32,
}

/// Runs the experiment with each variation under each split; the outcomes are in the order of splits, then variations. `seed` is that of the
/// random split. `progress` is called with the share that is done, 0 to 1.
///
/// # Errors
/// If there are too few executions, or a job cannot be taught or used by the judge. Where a variation finds where hands and objects meet,
/// another one may find nothing in common.
pub fn run(
    all: &[Labelled],
    method: &Method,
    variations: &[Variation],
    splits: &[Split],
    seed: u64,
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<Outcome>, ExperimentError> {
    let divided: Vec<(Split, Vec<Round>)> = splits
        .iter()
        .map(|split| Ok((*split, rounds(all, *split, seed)?)))
        .collect::<Result<_, ExperimentError>>()?;
    let steps = (variations.len() * divided.iter().map(|(_, rounds)| rounds.len()).sum::<usize>()) as f64;
    let unfiltered = Method { filter_frames: 1, ..*method };
    // Where no variation is without the filter, nothing is encoded again.
    let needs_both = variations.iter().any(|variation| !variation.is_filtered);
    let raw = if needs_both { encoded_again(all, &unfiltered)? } else { Vec::new() };
    let finds_contact_regions = variations.iter().any(|variation| variation.finds_contact_regions);
    let mut judged = Judged { all, couples: vec![None; all.len()], objects: Vec::new() };
    let (mut outcomes, mut done) = (Vec::new(), 0);
    for (split, rounds) in divided {
        let first = outcomes.len();
        outcomes.extend(variations.iter().map(|variation| Outcome::new(variation, split)));
        for (training, test) in rounds {
            let filtered = Training::new(all, &training, *method);
            let raw = needs_both.then(|| Training::new(&raw, &training, unfiltered));
            let mut encodings = Encodings::new(filtered, raw, variations)?;
            for outcome in &mut outcomes[first..] {
                match encodings.teach(&outcome.variation) {
                    Err(nothing) if finds_contact_regions && nothing.is_of_runs() => outcome.untaught += 1,
                    job => judged.add_to(outcome, &job?, &test)?,
                }
                done += 1;
                progress(f64::from(done) / steps);
            }
        }
    }
    Ok(outcomes)
}

fn encoded_again(all: &[Labelled], method: &Method) -> Result<Vec<Labelled>, RunError> {
    let again = |one: &Labelled| Ok(Labelled { run: one.run.encoded_with(method)?, ..one.clone() });
    all.iter().map(again).collect()
}

/// The indices of the training executions, and of the test executions.
type Round = (Vec<usize>, Vec<usize>);

fn rounds(all: &[Labelled], split: Split, seed: u64) -> Result<Vec<Round>, ExperimentError> {
    let is_flawed = |one: &Labelled| one.what != CORRECT;
    let indices = |keep: &dyn Fn(&Labelled) -> bool| -> Vec<usize> {
        (0..all.len()).filter(|&index| keep(&all[index])).collect()
    };
    let correct = indices(&|one| one.what == CORRECT);
    let flawed = indices(&is_flawed);
    if correct.len() < MIN_CORRECT || flawed.is_empty() {
        return Err(ExperimentError::TooFew { correct: correct.len(), flawed: flawed.len() });
    }
    Ok(match split {
        Split::Random => random_rounds(&correct, &flawed, seed),
        Split::LeavePersonOut => people(all)
            .into_iter()
            .map(|person| {
                let training = indices(&|one| one.what == CORRECT && one.person != person);
                let test = indices(&|one| one.person == person && (one.what == CORRECT || is_flawed(one)));
                (training, test)
            })
            .filter(|(training, test)| !training.is_empty() && !test.is_empty())
            .collect(),
    })
}

fn random_rounds(correct: &[usize], flawed: &[usize], seed: u64) -> Vec<Round> {
    let mut random = Rand64::new(u128::from(seed));
    let mut round = || {
        let mut training = correct.to_vec();
        // Fisher and Yates.
        for last in (1..training.len()).rev() {
            training.swap(last, random.rand_range(0..last as u64 + 1) as usize);
        }
        let mut test = training.split_off(TRAINING.0 * training.len() / TRAINING.1);
        test.extend(flawed);
        (training, test)
    };
    (0..ROUNDS).map(|_| round()).collect()
}

/// The numbers of the people, in ascending order.
fn people(all: &[Labelled]) -> BTreeSet<u32> {
    all.iter().map(|one| one.person).collect()
}

/// The executions as a judge sees them.
struct Judged<'a> {
    all: &'a [Labelled],
    /// What the judge works on in each of them that was needed so far, if the job has these objects. The filter comes after it.
    couples: Vec<Option<Cow<'a, [Couples]>>>,
    objects: Vec<NamedObject>,
}

impl Judged<'_> {
    /// Adds what a job says of the executions with these indices.
    fn add_to(&mut self, outcome: &mut Outcome, job: &JobFile, test: &[usize]) -> Result<(), RunError> {
        // The objects are the same under all rules, and mostly in all rounds, so each execution is encoded once for all of them.
        if self.objects != job.objects {
            self.couples.fill(None);
            self.objects.clone_from(&job.objects);
        }
        outcome.ius.0.push(Confusion::default());
        outcome.activities.0.push(Confusion::default());
        for &index in test {
            let (one, couples) = (&self.all[index], &mut self.couples[index]);
            let couples = match couples {
                Some(couples) => couples,
                none => none.insert(one.run.couples_for(job)?),
            };
            let verdicts = verdicts(couples, job).map_err(RunError::Job)?;
            outcome.count(one, job, &verdicts);
        }
        Ok(())
    }
}

impl Outcome {
    /// Before the first round.
    fn new(variation: &Variation, split: Split) -> Self {
        Self {
            variation: variation.clone(),
            split,
            ius: Rounds::default(),
            activities: Rounds::default(),
            accused_in_j2: 0,
            correct_jobs: 0,
            correct_jobs_ok: 0,
            flawed_jobs: 0,
            flawed_jobs_found: 0,
            j1: 0,
            j1_missed: 0,
            untaught: 0,
        }
    }

    /// Counts one execution in the newest round.
    fn count(&mut self, one: &Labelled, job: &JobFile, verdicts: &[Verdict]) {
        let job_is = |outcome| verdicts.iter().any(|one| one.level == Level::Job && one.outcome == outcome);
        if one.what == CORRECT {
            self.correct_jobs += 1;
            self.correct_jobs_ok += u32::from(job_is(verdict::Outcome::Ok));
        } else {
            self.flawed_jobs += 1;
            self.flawed_jobs_found +=
                u32::from(verdicts.iter().any(|one| one.outcome == verdict::Outcome::Anomaly));
        }
        let flaw = FLAWS.iter().find(|(name, ..)| *name == one.what);
        if flaw.is_none() && one.what != CORRECT {
            // Which of its IUs is wrong is not known.
            return;
        }
        let (Some(ius), Some(activities)) = (self.ius.0.last_mut(), self.activities.0.last_mut()) else {
            return;
        };
        for (number, scored) in score(job, verdicts).activities.iter().enumerate() {
            activities.count(flaw.is_some_and(|(_, activity, _)| *activity == number), scored.is_accused);
            for (index, &is_accused) in scored.accused_ius.iter().enumerate() {
                let is_wrong = flaw.is_some_and(|(_, activity, iu)| (*activity, *iu) == (number, index));
                ius.count(is_wrong, is_accused);
                self.accused_in_j2 += u32::from(!is_wrong && is_accused && one.what == "J2");
                let is_j1 = is_wrong && one.what == "J1";
                self.j1 += u32::from(is_j1);
                self.j1_missed += u32::from(is_j1 && !is_accused);
            }
        }
    }
}
