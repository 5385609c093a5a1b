//! Work of two hands by feel. Runs of one person are judged twice: by the job that the nine others teach, and by the job of another
//! person.
//!
//! The people are drawn. `ANDON_SEED` chooses them, and `ANDON_SETS` how many sets of ten runs, by turns of each work. `ANDON_LEFT_OUT` says how many
//! runs of a set are judged by the others. `ANDON_BOXES=1` takes a camera that sees boxes instead of motion capture. `-- --nocapture` prints the table.
#![allow(clippy::unwrap_used)]

use andon_core::config::Method;
use andon_core::input::Side;
use andon_core::verdict::Outcome;
use andon_learn::job_file::JobFile;
use andon_learn::recording::Recording;
use andon_learn::run::Run;
use andon_learn::strictness::Strictness;
use andon_learn::teach::{TeachError, TeachOptions, teach};
use andon_tests::deletion::{self, Deletion, Hidden};
use andon_tests::rate::Rate;
use andon_tests::simulator::{ByFeel, Lapse, Noise, Performance, Random, perform_by_feel};
use andon_tests::{environment, workers};
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::Mutex;

/// The number of right runs of one set.
const RUNS: u64 = 10;

/// In how many of them there is each lapse as well. As many are left out unless it is said otherwise: each costs as much as all that it is judged by.
const WITH_LAPSES: u64 = 5;

/// The share of right runs that may be accused.
const MAX_ACCUSED: f64 = 0.1;

/// The share of lapses that must be found.
const MIN_FOUND: f64 = 0.75;

/// The share of these lapses that may be called right.
const MAX_CALLED_RIGHT: f64 = 0.1;

/// The share of right runs of one person that may be accused where another person alone has taught the job.
const MAX_ACCUSED_OF_ANOTHER: f64 = 0.2;

/// One person does one work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Set {
    seed: u64,
    work: ByFeel,
    person: u64,
    by_boxes: bool,
}

impl Set {
    fn recording(self, repetition: u64, lapse: Option<Lapse>) -> Recording {
        let Self { seed, work, person, by_boxes } = self;
        let noise = if by_boxes { Noise::boxes() } else { Noise::motion_capture() };
        perform_by_feel(&Performance { seed, person, repetition, noise }, work, lapse)
    }

    fn run(self, repetition: u64) -> Run {
        let name = format!("run {repetition}");
        Run::new(&name, "", &self.recording(repetition, None), &Method::default()).unwrap()
    }

    /// The job that all right runs but the one that is left out teach, if one is, and whether `teach` trusts it.
    fn taught_without(self, left_out: Option<u64>) -> Result<(JobFile, bool), TeachError> {
        let others = (0..RUNS).filter(|repetition| Some(*repetition) != left_out);
        let runs: Vec<Run> = others.map(|repetition| self.run(repetition)).collect();
        let options = TeachOptions::new(self.work.name(), "", Method::default());
        let (job, report) = teach(&runs, &options)?;
        Ok((job, report.is_trusted()))
    }
}

/// What the judge says of a whole recording, as `andond replay` counts it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Said {
    Right,
    Accused,
    NotJudged,
}

fn said(job: &JobFile, recording: &Recording) -> Said {
    let verdicts = deletion::judged(job, recording);
    if deletion::is_accused(&verdicts) {
        Said::Accused
    } else if deletion::jobs(&verdicts).contains(&Outcome::Ok)
        && verdicts.iter().all(|verdict| verdict.outcome != Outcome::NotJudged)
    {
        Said::Right
    } else {
        Said::NotJudged
    }
}

/// What came of it that one run was left out.
struct Case {
    /// Whether `teach` trusted the others; none if they taught no job.
    is_trusted: Option<bool>,
    right_run: Option<Said>,
    lapses: Vec<(Lapse, Said)>,
    hand_lost: Vec<Said>,
}

fn left_out(set: Set, repetition: u64) -> Case {
    let Ok((job, is_trusted)) = set.taught_without(Some(repetition)) else {
        return Case { is_trusted: None, right_run: None, lapses: Vec::new(), hand_lost: Vec::new() };
    };
    let whole = set.recording(repetition, None);
    let lost = |side| Deletion::Stretch(Hidden::Hand(side), 6.0, 2.0).of(&whole, &mut Random::new(0, &[]));
    let lapses = Lapse::ALL.iter().filter(|_| repetition < WITH_LAPSES);
    Case {
        is_trusted: Some(is_trusted),
        right_run: Some(said(&job, &whole)),
        lapses: lapses.map(|lapse| (*lapse, said(&job, &set.recording(repetition, Some(*lapse))))).collect(),
        hand_lost: Side::ALL.iter().map(|side| said(&job, &lost(*side))).collect(),
    }
}

/// How often `teach` did not trust the runs or taught nothing, and what was said of what was left out.
#[derive(Debug, Default)]
struct Counts {
    cases: u32,
    refused: u32,
    without_job: u32,
    right_runs: BTreeMap<Said, u32>,
    lapses: BTreeMap<Said, u32>,
    each_lapse: BTreeMap<Lapse, BTreeMap<Said, u32>>,
    hand_lost: BTreeMap<Said, u32>,
}

impl Counts {
    fn add(&mut self, case: &Case) {
        self.cases += 1;
        self.refused += u32::from(case.is_trusted != Some(true));
        self.without_job += u32::from(case.is_trusted.is_none());
        let count = |counts: &mut BTreeMap<Said, u32>, said| *counts.entry(said).or_default() += 1;
        case.right_run.into_iter().for_each(|said| count(&mut self.right_runs, said));
        case.hand_lost.iter().for_each(|said| count(&mut self.hand_lost, *said));
        for (lapse, said) in &case.lapses {
            count(&mut self.lapses, *said);
            count(self.each_lapse.entry(*lapse).or_default(), *said);
        }
    }

    /// One line of the table.
    fn line(&self) -> String {
        format!(
            "{} of {} refused, {} without a job | right runs {} | lapses {} | a hand lost {}",
            self.refused,
            self.cases,
            self.without_job,
            words(&self.right_runs),
            words(&self.lapses),
            words(&self.hand_lost)
        )
    }
}

fn number(counts: &BTreeMap<Said, u32>, said: Said) -> u32 {
    counts.get(&said).copied().unwrap_or_default()
}

fn rate(counts: &BTreeMap<Said, u32>, said: Said) -> Rate {
    Rate::new(number(counts, said) as usize, counts.values().sum::<u32>() as usize)
}

fn words(counts: &BTreeMap<Said, u32>) -> String {
    let [right, accused, not_judged] =
        [Said::Right, Said::Accused, Said::NotJudged].map(|said| number(counts, said));
    format!("{right} / {accused} / {not_judged}")
}

/// As many sets as are asked for, by turns of each work, and whether a camera sees boxes.
fn sets() -> (Vec<Set>, bool) {
    let seed = environment::seed();
    let by_boxes = environment::number("ANDON_BOXES", 0) != 0;
    let works = ByFeel::ALL.len() as u64;
    let set = |index| {
        let (work, person) = (ByFeel::ALL[(index % works) as usize], 1 + index / works);
        Set { seed, work, person, by_boxes }
    };
    ((0..environment::number("ANDON_SETS", 3)).map(set).collect(), by_boxes)
}

#[test]
fn people_who_work_by_feel_are_judged_by_what_their_other_runs_teach() {
    let (sets, by_boxes) = sets();
    let left_out_runs = environment::number("ANDON_LEFT_OUT", WITH_LAPSES);
    let cases: Vec<(Set, u64)> =
        sets.iter().flat_map(|set| (0..left_out_runs).map(|repetition| (*set, repetition))).collect();
    let counts: Mutex<BTreeMap<Set, Counts>> = Mutex::default();
    let total: Mutex<Counts> = Mutex::default();
    let done = workers::for_each(&cases, |(set, repetition)| {
        let case = left_out(*set, *repetition);
        counts.lock().unwrap().entry(*set).or_default().add(&case);
        total.lock().unwrap().add(&case);
        Ok::<(), Infallible>(())
    });
    done.unwrap();
    println!("right / accused / not judged");
    let counts = counts.into_inner().unwrap();
    for (set, counts) in &counts {
        println!("{set:?}: {}", counts.line());
    }
    let total = total.into_inner().unwrap();
    println!("all: {}", total.line());
    total.each_lapse.iter().for_each(|(lapse, counts)| println!("{lapse:?}: {}", words(counts)));
    if by_boxes {
        // Too little of these is taught for a bar.
        return;
    }
    let lapses = |said| Rate::of_groups(counts.values().map(|of_set| rate(&of_set.lapses, said)));
    let right_runs = |said| Rate::of_groups(counts.values().map(|of_set| rate(&of_set.right_runs, said)));
    right_runs(Said::Accused).expect_at_most(MAX_ACCUSED, "right runs accused");
    lapses(Said::Accused).expect_at_least(MIN_FOUND, "lapses found");
    lapses(Said::Right).expect_at_most(MAX_CALLED_RIGHT, "lapses called right");
}

#[test]
fn people_who_work_by_feel_are_judged_by_what_another_person_teaches() {
    let (sets, by_boxes) = sets();
    let counts: Mutex<Vec<BTreeMap<Said, u32>>> = Mutex::default();
    let done = workers::for_each(&sets, |set| {
        let Ok((job, _)) = set.taught_without(None) else { return Ok::<(), Infallible>(()) };
        let another = Set { person: set.person + 1, ..*set };
        let all: Vec<Said> = (0..RUNS).map(|run| said(&job, &another.recording(run, None))).collect();
        println!("{set:?}, judged on person {}: {all:?}", another.person);
        let mut of_set = BTreeMap::new();
        all.into_iter().for_each(|said| *of_set.entry(said).or_default() += 1);
        println!("right / accused / not judged: {}", words(&of_set));
        counts.lock().unwrap().push(of_set);
        Ok(())
    });
    done.unwrap();
    let accused = counts.into_inner().unwrap().into_iter().map(|of_set| rate(&of_set, Said::Accused));
    if !by_boxes {
        Rate::of_groups(accused)
            .expect_at_most(MAX_ACCUSED_OF_ANOTHER, "right runs of another person accused");
    }
}

#[test]
fn a_stricter_job_keeps_the_rules_that_a_run_contradicts_and_says_so() {
    let set = Set { seed: 4711, work: ByFeel::Kitchen, person: 1, by_boxes: false };
    let runs: Vec<Run> = (0..RUNS).map(|repetition| set.run(repetition)).collect();
    let report = |number: u8| {
        let options = TeachOptions::new("kitchen", "", Method::default());
        let strictness = Strictness::new(number).unwrap();
        teach(&runs, &options.with_strictness(strictness)).unwrap().1.to_string()
    };
    let [usual, strict] = [3, 5].map(report);
    assert!(usual.contains("none of your 10 runs is rejected by") && usual.contains("these rules give way:"));
    assert!(strict.contains(" of your 10 runs ") && !strict.contains("these rules give way:"), "{strict}");
    assert!(!strict.contains("none of your 10 runs is rejected by"), "{strict}");
    assert!(strict.contains("no rule gives way to a run that contradicts it"), "{strict}");
}
