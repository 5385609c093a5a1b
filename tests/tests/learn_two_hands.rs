//! Jobs of two hands: five people show each, and others do it right, do it wrong, or are not seen.
//!
//! The people follow from a seed. `ANDON_SEED` chooses another.
#![allow(clippy::unwrap_used)]

use andon_core::config::Method;
use andon_core::input::Side;
use andon_core::verdict::{Level, Outcome, Verdict};
use andon_learn::job_file::JobFile;
use andon_learn::recording::Recording;
use andon_learn::run::Run;
use andon_learn::teach::{TeachOptions, teach};
use andon_tests::deletion::{self, Deletion, Hidden, is_accused, length_s, try_deletions, try_two_pieces};
use andon_tests::environment;
use andon_tests::simulator::{Noise, Performance, Random, TwoHanded, perform_with_two_hands};
use andon_tests::station::without_points;

/// The percentage of the right jobs of others that must be accepted: five people do not show how all others move.
const MIN_ACCEPTED: usize = 90;

/// The percentage of the faults of others that must be found where less is known: not every part lies where nothing else does, nor is held
/// where others hold it.
const MIN_FOUND: usize = 75;

fn recording(work: TwoHanded, person: u64, is_faulty: bool) -> Recording {
    recording_seen(Noise::default(), work, person, is_faulty)
}

fn recording_seen(noise: Noise, work: TwoHanded, person: u64, is_faulty: bool) -> Recording {
    let seed = environment::number("ANDON_SEED", 71);
    perform_with_two_hands(&Performance { seed, person, repetition: 1, noise }, work, is_faulty)
}

fn run(recording: &Recording) -> Run {
    Run::new("run", "", recording, &Method::default()).unwrap()
}

/// Five people show the work.
fn taught(work: TwoHanded) -> JobFile {
    taught_seen(Noise::default(), work)
}

fn taught_seen(noise: Noise, work: TwoHanded) -> JobFile {
    taught_by(&(1..=5).map(|person| run(&recording_seen(noise, work, person, false))).collect::<Vec<_>>())
}

fn taught_by(runs: &[Run]) -> JobFile {
    let options =
        TeachOptions { measure_rate: false, ..TeachOptions::new("two hands", "", Method::default()) };
    teach(runs, &options).unwrap().0
}

fn judged(job: &JobFile, recording: &Recording) -> Vec<Verdict> {
    run(recording).judge(job).unwrap()
}

fn is_right(verdicts: &[Verdict]) -> bool {
    let mut jobs = verdicts.iter().filter(|verdict| verdict.level == Level::Job);
    jobs.all(|job| job.outcome == Outcome::Ok) && !is_accused(verdicts)
}

#[test]
fn what_may_differ_between_hands_is_right_and_every_fault_is_found() {
    let (mut right, mut of, mut missed) = (0, 0, Vec::new());
    for work in TwoHanded::ALL {
        let job = taught(work);
        let accepted = (6..18).filter(|person| is_right(&judged(&job, &recording(work, *person, false))));
        let count = accepted.count();
        println!("{work:?}: {count} of 12 accepted");
        (right, of) = (right + count, of + 12);
        missed.extend(
            (6..12)
                .filter(|person| is_right(&judged(&job, &recording(work, *person, true))))
                .map(|person| (work, person)),
        );
    }
    assert!(100 * right >= MIN_ACCEPTED * of, "{right} of {of}");
    assert!(missed.is_empty(), "{missed:?}");
}

#[test]
fn runs_in_which_a_hand_waits_for_the_other_one_are_taught_like_those_in_which_it_does_not() {
    let mut refused = Vec::new();
    for first in (1..100).step_by(5) {
        let runs: Vec<Run> =
            (first..first + 5).map(|person| run(&recording(TwoHanded::WaitingHand, person, false))).collect();
        let (_, report) = teach(&runs, &TeachOptions::new("two hands", "", Method::default())).unwrap();
        let text = report.to_string();
        let said = text.lines().next().unwrap_or_default().to_owned();
        refused.extend(said.starts_with("not usable").then_some(said));
    }
    println!("{} of 20 refused: {refused:#?}", refused.len());
    assert!(refused.len() <= 4, "{refused:#?}");
}

/// Right jobs are accepted and faults found as elsewhere, with these errors of all that is seen.
fn expect_no_more_doubt_with(noise: Noise) {
    let (mut right, mut of, mut accused, mut missed) = (0, 0, Vec::new(), Vec::new());
    for work in TwoHanded::ALL {
        let job = taught_seen(noise, work);
        for person in 6..18 {
            let verdicts = judged(&job, &recording_seen(noise, work, person, false));
            (right, of) = (right + usize::from(is_right(&verdicts)), of + 1);
            accused.extend(is_accused(&verdicts).then_some((work, person)));
        }
        let is_missed = |person: &u64| is_right(&judged(&job, &recording_seen(noise, work, *person, true)));
        missed.extend((6..12).filter(is_missed).map(|person| (work, person)));
    }
    println!("{right} of {of} accepted, {accused:?} accused, {missed:?} missed");
    assert!(100 * right >= MIN_ACCEPTED * of, "{right} of {of}");
    assert!(missed.is_empty(), "{missed:?}");
}

/// 2.5 mm along each axis, as a depth camera sees parts without markers.
fn inexact(marker_memory: f64) -> Noise {
    Noise { marker_px: 2.0, marker_memory, ..Noise::default() }
}

#[test]
fn parts_that_are_seen_inexactly_put_right_jobs_in_doubt_no_more_than_others() {
    expect_no_more_doubt_with(inexact(0.0));
}

#[test]
fn parts_that_drift_put_right_jobs_in_doubt_no_more_than_others() {
    expect_no_more_doubt_with(inexact(0.9));
}

/// The recording as of a station that does not say where its parts are touched, with markers that say nothing of how they lie.
fn with_mere_positions(whole: Recording) -> Recording {
    let mut whole = without_points(whole);
    for object in whole.frames.iter_mut().flat_map(|frame| &mut frame.objects) {
        object.orientation = [1.0, 0.0, 0.0, 0.0];
    }
    whole
}

#[test]
fn where_two_hands_hold_a_part_is_learnt_of_both() {
    let shown = |person, is_faulty| {
        run(&with_mere_positions(recording(TwoHanded::SymmetricalLift, person, is_faulty)))
    };
    let job = taught_by(&(1..=5).map(|person| shown(person, false)).collect::<Vec<_>>());
    let accepted = (6..18).filter(|person| is_right(&shown(*person, false).judge(&job).unwrap())).count();
    assert!(100 * accepted >= MIN_ACCEPTED * 12, "{accepted} of 12 accepted");
    let alone: Vec<Vec<Verdict>> = (6..18).map(|person| shown(person, true).judge(&job).unwrap()).collect();
    let found = alone.iter().filter(|verdicts| is_accused(verdicts)).count();
    assert!(!alone.iter().any(|verdicts| is_right(verdicts)), "one hand alone is called right");
    assert!(100 * found >= MIN_FOUND * 12, "{found} of 12 found");
}

/// The recording with one hand unseen in a stretch of time; its last second stays.
fn without(whole: &Recording, side: Side, from_s: f64, seconds: f64) -> Recording {
    Deletion::Stretch(Hidden::Hand(side), from_s, seconds).of(whole, &mut Random::new(0, &[]))
}

/// Of jobs at the workshop's bench, how many right ones are accepted, and how many faulty ones are found and taken for right, of 36 each.
fn workshop_judged(seen: impl Fn(Recording) -> Recording) -> [usize; 3] {
    let shown = |person, is_faulty| run(&seen(recording(TwoHanded::Workshop, person, is_faulty)));
    let [mut right, mut found, mut missed] = [0; 3];
    for first in [1, 101, 201] {
        let job = taught_by(&(first..first + 5).map(|person| shown(person, false)).collect::<Vec<_>>());
        for person in first + 5..first + 17 {
            let [right_job, faulty_job] =
                [false, true].map(|is_faulty| shown(person, is_faulty).judge(&job).unwrap());
            right += usize::from(is_right(&right_job));
            found += usize::from(is_accused(&faulty_job));
            missed += usize::from(is_right(&faulty_job));
        }
    }
    [right, found, missed]
}

#[test]
fn tools_that_lie_side_by_side_and_a_hand_that_goes_on_early_accuse_nobody() {
    for (points, [right, found, missed]) in
        [("no", workshop_judged(with_mere_positions)), ("given", workshop_judged(|whole| whole))]
    {
        println!("{points} points: {right} of 36 accepted, {found} found, {missed} missed");
        assert!(100 * right >= MIN_ACCEPTED * 36, "{right} of 36 accepted");
        assert!(100 * found >= MIN_FOUND * 36 && missed == 0, "{found} of 36 found, {missed} missed");
    }
}

#[test]
fn a_hand_that_is_not_seen_for_a_while_accuses_nobody() {
    let (mut accused, mut of) = (Vec::new(), 0);
    for work in TwoHanded::ALL {
        let job = taught(work);
        for person in 6..9 {
            let whole = recording(work, person, false);
            if !is_right(&judged(&job, &whole)) {
                continue;
            }
            for side in Side::ALL {
                for tenth in 1..10 {
                    for seconds in [0.2, 0.5, 1.2, 3.0] {
                        let from_s = length_s(&whole) * f64::from(tenth) / 10.0;
                        of += 1;
                        if is_accused(&judged(&job, &without(&whole, side, from_s, seconds))) {
                            accused.push((work, person, side, tenth, seconds));
                        }
                    }
                }
            }
        }
    }
    assert!(accused.is_empty(), "{} of {of}: {accused:?}", accused.len());
}

#[test]
fn a_judge_that_did_not_see_the_start_finds_faults_by_the_parts_that_lie_where_they_lay() {
    let (mut found, mut right) = (0, Vec::new());
    for work in TwoHanded::ALL {
        let job = taught(work);
        for person in 6..12 {
            let verdicts = deletion::judged(&job, &recording(work, person, true));
            found += usize::from(is_accused(&verdicts));
            right.extend(is_right(&verdicts).then_some((work, person)));
        }
    }
    println!("{found} of {} found", 6 * TwoHanded::ALL.len());
    assert!(right.is_empty(), "{right:?}");
    assert!(100 * found >= MIN_FOUND * 6 * TwoHanded::ALL.len(), "{found}");
}

/// `ANDON_SEED` and `ANDON_CASES` choose other deletions.
#[test]
fn nothing_is_accused_for_what_was_not_seen_where_parts_have_their_places() {
    let (seed, cases) = (environment::number("ANDON_SEED", 71), environment::number("ANDON_CASES", 30));
    for work in TwoHanded::ALL {
        let job = taught(work);
        let all: Vec<Recording> = (6..14).map(|person| recording(work, person, false)).collect();
        let right: Vec<&Recording> =
            all.iter().filter(|whole| is_right(&deletion::judged(&job, whole))).collect();
        assert!(!right.is_empty(), "{work:?}: no correct job is right as a whole");
        let tried = try_deletions(&job, &right, seed, cases);
        assert!(tried.accused.is_empty(), "{work:?}: {:?}", tried.accused);
        let tried = try_two_pieces(&job, &right, seed, cases);
        assert!(tried.accused.is_empty(), "{work:?}, two pieces: {:?}", tried.accused);
    }
}
