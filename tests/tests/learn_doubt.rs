//! A verdict accuses only what was seen: whatever observations are deleted from a correct job, none of its verdicts becomes an anomaly.
//! And after any fault the next correct job is right.
//!
//! The people and the deletions follow from a seed. `ANDON_SEED` and `ANDON_CASES` choose others.
#![allow(clippy::unwrap_used)]

use andon_core::config::Method;
use andon_core::verdict::Outcome;
use andon_learn::job_file::JobFile;
use andon_learn::recording::Recording;
use andon_learn::run::Run;
use andon_learn::teach::{TeachOptions, teach};
use andon_tests::deletion::{jobs, judged, length_s, one_after_the_other, try_deletions, try_two_pieces};
use andon_tests::environment;
use andon_tests::simulator::{Expected, Flaw, Noise, Performance, perform};

fn seed() -> u64 {
    environment::number("ANDON_SEED", 71)
}

fn recording(person: u64, repetition: u64, flaw: Flaw) -> Recording {
    perform(&Performance { seed: seed(), person, repetition, noise: Noise::default() }, flaw).0
}

fn run(recording: &Recording) -> Run {
    Run::new("run", "", recording, &Method::default()).unwrap()
}

/// Five people show the job.
fn taught() -> JobFile {
    let runs: Vec<Run> = (1..=5).map(|person| run(&recording(person, 1, Flaw::None))).collect();
    teach(&runs, &TeachOptions::new("polish and measure", "", Method::default())).unwrap().0
}

#[test]
fn nothing_is_accused_for_what_was_not_seen() {
    let (job, cases) = (taught(), environment::number("ANDON_CASES", 120));
    let whole: Vec<Recording> = (6..=11).map(|person| recording(person, 1, Flaw::None)).collect();
    // A correct job that is accused although all of it was seen says nothing about deletions.
    let accepted: Vec<&Recording> =
        whole.iter().filter(|whole| jobs(&judged(&job, whole)) == [Outcome::Ok]).collect();
    assert!(accepted.len() >= 4, "only {} of 6 correct jobs are right", accepted.len());
    let tried = try_deletions(&job, &accepted, seed(), cases);
    println!("{} of {cases} accused, {} right", tried.accused.len(), tried.right);
    assert!(tried.accused.is_empty(), "{:?}", tried.accused);
    let tried = try_two_pieces(&job, &accepted, seed(), cases);
    assert!(tried.accused.is_empty(), "two pieces: {:?}", tried.accused);
}

#[test]
fn after_any_fault_the_next_correct_job_is_right() {
    let job = taught();
    let right: Vec<Recording> = (2..=3).map(|repetition| recording(6, repetition, Flaw::None)).collect();
    assert!(right.iter().all(|right| jobs(&judged(&job, right)) == [Outcome::Ok]));
    let lost: Vec<&str> = Flaw::ALL
        .into_iter()
        .filter(|flaw| flaw.expected() != Expected::Ok)
        .filter(|flaw| {
            let fault = recording(6, 1, *flaw);
            let all = one_after_the_other(&[&fault, &right[0], &right[1]], 0.9);
            let verdicts = judged(&job, &all);
            let next_ns = (length_s(&fault) * 1e9) as u64 + fault.frames[0].captured_ns;
            let later = verdicts.iter().filter(|verdict| verdict.began_ns > next_ns);
            let is_right = jobs(&verdicts).ends_with(&[Outcome::Ok; 2]);
            later.copied().any(|verdict| verdict.outcome == Outcome::Anomaly) || !is_right
        })
        .map(Flaw::name)
        .collect();
    assert!(lost.is_empty(), "lost after {lost:?}");
}

#[test]
fn two_jobs_back_to_back_are_right() {
    let job = taught();
    let right: Vec<Recording> = (2..=4).map(|repetition| recording(7, repetition, Flaw::None)).collect();
    let all = one_after_the_other(&[&right[0], &right[1], &right[2]], 0.04);
    assert_eq!(jobs(&judged(&job, &all)), [Outcome::Ok; 3]);
}
