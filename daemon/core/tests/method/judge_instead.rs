//! A step that is done with another part: the part is wrong, not the order.

use crate::common::script::{Part, Still, Toward, idle, object, part, short, stream, teach};
use crate::common::work::{IN_ORDER, judged, measure};
use andon_core::anomaly::Judge;
use andon_core::config::Method;
use andon_core::job::Job;
use andon_core::verdict::{Level, Verdict};

const SHOWN: u16 = 5;
const OTHER: u16 = 3;

/// A part is pressed against the brick for so many frames, without a stroke, and put back.
fn press(id: u16, frames: usize) -> [Part; 4] {
    [
        part([1, id, 0, 0], 30, Toward(3)),
        part([1, id, id, 6], frames, Still),
        part([1, id, 0, 0], 30, Toward(7)),
        idle(20),
    ]
}

fn press_and_measure() -> Job<'static> {
    teach(&[&press(SHOWN, 60), &measure()])
}

fn in_order() -> Job<'static> {
    Job { laws: &IN_ORDER, ..press_and_measure() }
}

fn job_of(verdicts: &[Verdict]) -> (String, Option<u16>) {
    let job = verdicts.iter().find(|verdict| verdict.level == Level::Job).unwrap();
    (short(job), job.nearest)
}

#[test]
fn a_step_without_strokes_that_is_done_with_another_part_has_the_wrong_part_and_not_the_wrong_order() {
    let parts = [&press(OTHER, 60)[..], &measure()].concat();
    for job in [in_order(), press_and_measure()] {
        let verdicts = judged(&job, &stream(&parts, &[]));
        assert_eq!(job_of(&verdicts), ("JobAnomaly WrongObject".to_owned(), Some(0)));
        let all: Vec<String> = verdicts.iter().map(short).collect();
        assert!(all.iter().all(|verdict| !verdict.contains("WrongOrder")), "{all:?}");
    }
}

#[test]
fn a_part_that_is_only_put_aside_is_not_used_instead() {
    let parts = [&press(OTHER, 10)[..], &measure()].concat();
    for (job, reason) in [(in_order(), "WrongOrder"), (press_and_measure(), "NotCompleted")] {
        let (word, _) = job_of(&judged(&job, &stream(&parts, &[])));
        assert_eq!(word, format!("JobAnomaly {reason}"));
    }
}

#[test]
fn what_is_done_with_another_part_and_then_with_the_right_one_is_right() {
    let parts = [&press(OTHER, 60)[..], &press(SHOWN, 60), &measure()].concat();
    for job in [in_order(), press_and_measure()] {
        assert_eq!(job_of(&judged(&job, &stream(&parts, &[]))).0, "JobOk");
    }
}

#[test]
fn what_may_have_come_before_a_recording_is_not_judged_but_the_step_is_named_that_another_part_was_used_for()
{
    let parts = [&press(OTHER, 60)[..], &measure(), &[idle(200)]].concat();
    let job = in_order();
    let mut judge = Judge::<Vec<_>>::with_memory(&job, Method::default()).unwrap();
    let mut verdicts = Vec::new();
    for couples in stream(&parts, &[]) {
        judge.step(&couples, &mut |event| verdicts.extend(event.verdict()));
    }
    judge.finish(&mut |event| verdicts.extend(event.verdict()));
    assert_eq!(job_of(&verdicts), ("NotJudged BeginningNotSeen".to_owned(), Some(0)));
}

/// A part is carried about for so many frames, at nothing that the runs show it to meet, and put back.
fn carry(id: u16, frames: usize) -> [Part; 2] {
    [part([1, id, 0, 0], frames, Toward(3)), idle(20)]
}

#[test]
fn a_part_that_no_run_shows_at_the_other_one_is_used_instead_if_it_is_in_hand_for_as_long_as_the_step_takes()
{
    let reasons = [(120, ["WrongObject", "WrongObject"]), (40, ["WrongOrder", "NotCompleted"])];
    for (frames, reasons) in reasons {
        let parts = [&carry(9, frames)[..], &measure()].concat();
        for (job, reason) in [in_order(), press_and_measure()].into_iter().zip(reasons) {
            // The part belongs to the job, which only has it rest.
            let job = Job { passive_contacts: &[9], ..job };
            let word = job_of(&judged(&job, &stream(&parts, &[])));
            assert_eq!(
                word,
                (format!("JobAnomaly {reason}"), Some(if reason == "WrongOrder" { 1 } else { 0 }))
            );
        }
    }
}

#[test]
fn what_a_step_works_at_is_not_used_instead_of_its_part() {
    let parts = [&press(SHOWN, 60)[..], &carry(OTHER, 200)].concat();
    // The other part is the one to which the second step brings the brick.
    assert_eq!(job_of(&judged(&press_and_measure(), &stream(&parts, &[]))).0, "JobAnomaly NotCompleted");
}

#[test]
fn a_step_of_which_an_object_was_never_seen_blames_no_part() {
    let parts = [&press(OTHER, 60)[..], &measure()].concat();
    let mut couples = stream(&parts, &[]);
    let taken = couples.len() - measure().iter().map(|part| part.frames).sum::<usize>();
    for couples in &mut couples[..taken + 20] {
        couples.out_of_sight = object(OTHER);
    }
    let verdicts: Vec<String> = judged(&in_order(), &couples).iter().map(short).collect();
    assert!(verdicts.iter().all(|verdict| !verdict.contains("Anomaly")), "{verdicts:?}");
}
