//! Where a job begins and ends, and what is said of what was not seen.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use andon_core::anomaly::Judge;
use andon_core::config::Method;
use andon_core::couple::{Couples, Sight};
use andon_core::job::{Job, Law};
use andon_core::set::ActivitySet;
use andon_core::verdict::{Level, Outcome, Reason};
use common::bench::PERIOD_NS;
use common::script::{Part, Still, Toward, idle, part, short, stream, teach};
use common::work::{
    IN_ORDER, away, bring, expect, forgiving, jobs, judged, measure, polish, polish_and_measure,
};
use core::ops::Range;

#[test]
fn the_beginning_of_every_job_is_an_event() {
    let right = [idle(5), part([1, 5, 0, 0], 30, Toward(3)), idle(20)];
    let job = teach(&[&right[1..]]);
    let twice = [&right[..], &right].concat();
    assert_eq!(jobs(&job, &stream(&twice, &[])), ["began in frame 5", "JobOk", "began in frame 60", "JobOk"]);
}

#[test]
fn the_beginning_of_the_job_after_one_that_was_not_judged_is_an_event() {
    let right = [idle(5), part([1, 5, 0, 0], 30, Toward(3)), idle(20)];
    let job = teach(&[&right[1..]]);
    let mut unseen = right;
    unseen[1].sighted = false;
    let twice = [&unseen[..], &right].concat();
    assert_eq!(
        jobs(&job, &stream(&twice, &[])),
        ["began in frame 5", "NotJudged ObjectNotSeen", "began in frame 60", "JobOk"]
    );
}

#[test]
fn a_pause_without_hands_does_not_end_the_job_while_the_bench_stays_as_it_is() {
    let right = [&polish(6)[..], &[away(900)], &measure()].concat();
    let verdicts = judged(&polish_and_measure(), &stream(&right, &[]));
    assert_eq!(short(verdicts.last().unwrap()), "JobOk");
    assert_eq!(verdicts.iter().filter(|verdict| verdict.level == Level::Job).count(), 1);
}

#[test]
fn a_pause_without_hands_ends_the_job_after_idle_end_ms_if_the_bench_was_rearranged() {
    let right = [&polish(6)[..], &[away(300)]].concat();
    let mut couples = stream(&right, &[]);
    couples[250].has_moved_unseen = true;
    let verdicts = judged(&polish_and_measure(), &couples);
    let job = verdicts.last().unwrap();
    // The brick may have been measured while no hand was seen.
    assert_eq!(short(job), "NotJudged HandNotSeen");
    // 4 s after the bench was rearranged.
    assert_eq!(job.ended_ns, (250 + 121) * PERIOD_NS);
}

/// After a pause in which the bench is empty, the piece is measured and never polished. Before the pause something is moved.
fn measured_after_a_pause(moved: impl Fn(&mut Couples)) -> String {
    measured_after_a_pause_with(20..60, moved)
}

fn measured_after_a_pause_with(frames: Range<usize>, change: impl Fn(&mut Couples)) -> String {
    let mut couples = stream(&[&[away(300)][..], &measure(), &[idle(20)]].concat(), &[]);
    couples[frames].iter_mut().for_each(change);
    short(judged(&polish_and_measure(), &couples).last().unwrap())
}

#[test]
fn a_pause_shows_the_start_of_a_job_unless_a_hand_that_was_not_seen_has_carried_something_before() {
    assert_eq!(measured_after_a_pause(|_| ()), "JobAnomaly NotCompleted");
    assert_eq!(
        measured_after_a_pause(|couples| couples.has_moved_unseen = true),
        "JobAnomaly NotCompleted",
        "the next piece is put in place"
    );
    assert_eq!(
        measured_after_a_pause(|couples| couples.is_carried_unseen = true),
        "NotJudged BeginningNotSeen"
    );
}

#[test]
fn a_pause_before_the_first_job_that_is_watched_may_be_one_in_the_middle_of_a_job() {
    let job = polish_and_measure();
    let said = |parts: &[Part]| judged_cold_by(&job, stream(parts, &[])).last().unwrap().clone();
    let measured = [&[away(300)][..], &measure(), &[idle(20)]].concat();
    assert_eq!(said(&measured), "NotJudged BeginningNotSeen");
    let whole = [&polish(6)[..], &measure()].concat();
    assert_eq!(said(&[&[away(300)][..], &whole].concat()), "JobOk");
    assert_eq!(said(&[&whole[..], &measured].concat()), "JobAnomaly NotCompleted");
}

#[test]
fn a_pause_shows_the_start_of_a_job_only_while_the_bench_is_in_sight() {
    let hidden = |frames| measured_after_a_pause_with(frames, |couples| couples.is_bench_hidden = true);
    assert_eq!(hidden(0..170), "JobAnomaly NotCompleted", "4 s of it were in sight");
    assert_eq!(hidden(200..205), "JobAnomaly NotCompleted", "too short a time to do anything");
    for frames in [0..300, 0..200, 200..300, 200..220] {
        assert!(hidden(frames.clone()).starts_with("NotJudged"), "{frames:?}");
    }
}

#[test]
fn a_job_in_which_objects_moved_without_a_hand_is_not_right() {
    let right = [polish(6), measure()].concat();
    let mut couples = stream(&right, &[]);
    couples[170].has_moved_unseen = true;
    let verdicts = judged(&polish_and_measure(), &couples);
    assert_eq!(short(verdicts.last().unwrap()), "NotJudged HandNotSeen");
    couples[170].has_moved_unseen = false;
    couples.last_mut().unwrap().has_moved_unseen = true;
    let verdicts = judged(&polish_and_measure(), &couples);
    assert_eq!(short(verdicts.last().unwrap()), "JobOk", "the next piece is put in place");
}

#[test]
fn a_judge_that_was_started_in_the_middle_of_a_job_accuses_nothing_that_came_before() {
    let job = Job { laws: &IN_ORDER, ..polish_and_measure() };
    let right = [polish(6), measure(), polish(6), measure()].concat();
    let couples = stream(&right, &[]);
    for start in (0..286).step_by(10) {
        let mut judge = Judge::<Vec<_>>::with_memory(&job, Method::default()).unwrap();
        let mut verdicts = Vec::new();
        couples[start..]
            .iter()
            .for_each(|couples| judge.step(couples, &mut |event| verdicts.extend(event.verdict())));
        judge.finish(&mut |event| verdicts.extend(event.verdict()));
        let verdicts: Vec<String> = verdicts.iter().map(short).collect();
        assert!(verdicts.iter().all(|verdict| !verdict.contains("Anomaly")), "{start}: {verdicts:?}");
        assert_eq!(verdicts.last().unwrap(), "JobOk", "{start}: {verdicts:?}");
    }
}

#[test]
fn after_a_fault_the_next_job_is_right() {
    let faults: [(&str, Vec<Part>); 5] = [
        ("cut short", [polish(3), measure()].concat()),
        ("left out", polish(6).to_vec()),
        ("reversed", [measure(), polish(6)].concat()),
        ("not completed", [&polish(6)[..], &measure()[..1], &[idle(20)]].concat()),
        ("wrong object", [&[part([1, 9, 0, 0], 30, Still), idle(20)][..], &measure()].concat()),
    ];
    for order_matters in [false, true] {
        let job = Job { laws: if order_matters { &IN_ORDER } else { &[] }, ..polish_and_measure() };
        for (name, fault) in &faults {
            let right = [polish(6), measure()].concat();
            let mut couples = stream(&[&right[..], fault, &right, &right].concat(), &[]);
            let fault_frames: usize = right.iter().chain(fault).map(|part| part.frames).sum();
            // The parts of the next piece are put in place.
            couples[fault_frames - 1].has_moved_unseen = true;
            let verdicts = judged(&job, &couples);
            let fault_ends = fault_frames as u64 * PERIOD_NS;
            let later = verdicts.iter().filter(|verdict| verdict.began_ns >= fault_ends);
            let accused: Vec<String> =
                later.filter(|verdict| verdict.outcome == Outcome::Anomaly).map(short).collect();
            assert!(accused.is_empty(), "{name}, {order_matters}: {accused:?}");
            let jobs: Vec<Outcome> = verdicts
                .iter()
                .filter(|verdict| verdict.level == Level::Job)
                .map(|job| job.outcome)
                .collect();
            assert_eq!(jobs[0], Outcome::Ok, "{name}, {order_matters}");
            assert_eq!(jobs[jobs.len() - 2..], [Outcome::Ok; 2], "{name}, {order_matters}: {jobs:?}");
            let is_fault = *name != "reversed" || order_matters;
            // What is missing may have been done by a hand that was overlooked while the parts moved.
            let is_right = jobs.iter().all(|outcome| *outcome == Outcome::Ok);
            assert_eq!(is_right, !is_fault, "{name}, {order_matters}: {jobs:?}");
        }
    }
}

#[test]
fn a_hand_in_the_picture_may_pause_for_any_time() {
    let right = [&polish(6)[..], &[idle(1000)], &measure()].concat();
    let verdicts = judged(&polish_and_measure(), &stream(&right, &[]));
    assert_eq!(short(verdicts.last().unwrap()), "JobOk");
}

#[test]
fn an_iu_that_was_out_of_sight_is_not_judged_and_never_ok() {
    let mut right = [polish(6), measure()].concat();
    right[1].sighted = false;
    expect(
        &polish_and_measure(),
        &right,
        &[
            "r0.0 IuOk",
            "r0.1 NotJudged ObjectNotSeen!",
            "r0.2 IuOk",
            "r0 NotJudged ObjectNotSeen!",
            "r1.0 IuOk",
            "r1.1 IuOk",
            "r1.2 IuOk!",
            "r1 ActivityOk!",
            "NotJudged ObjectNotSeen",
        ],
    );
}

#[test]
fn ius_that_may_have_happened_out_of_sight_are_no_anomaly() {
    // The hand is out of sight with the polisher in it, and is seen again when the polishing is over.
    let mut right = [polish(6), measure()].concat();
    right[0].sighted = false;
    right.remove(1);
    let verdicts: Vec<String> =
        judged(&polish_and_measure(), &stream(&right, &[])).iter().map(short).collect();
    assert!(
        verdicts[0].contains("NotJudged ObjectNotSeen")
            && verdicts.iter().all(|verdict| !verdict.contains("Anomaly")),
        "{verdicts:?}"
    );
    assert_eq!(verdicts.last().unwrap(), "NotJudged ObjectNotSeen");
}

/// The couples of a camera of which only every n-th frame was processed.
fn thinned(couples: &[Couples], count: usize) -> Vec<Couples> {
    let of = |(index, couples): (usize, &Couples)| Couples { is_captured: index % count == 0, ..*couples };
    couples.iter().enumerate().map(of).collect()
}

#[test]
fn an_iu_with_fewer_frames_than_the_job_needs_is_neither_right_nor_wrong_and_its_verdict_says_how_many_came()
{
    let job = Job { min_captured: 0.5, ..polish_and_measure() };
    for strokes in [6, 2] {
        let work = stream(&[polish(strokes), measure()].concat(), &[]);
        assert_eq!(
            judged(&job, &thinned(&work, 2)).iter().map(short).collect::<Vec<_>>(),
            judged(&polish_and_measure(), &work).iter().map(short).collect::<Vec<_>>()
        );
        let few = judged(&job, &thinned(&work, 3));
        let ius = few.iter().filter(|verdict| verdict.level == Level::Iu && verdict.context.is_touch());
        for iu in ius {
            assert_eq!((iu.outcome, iu.reason), (Outcome::NotJudged, Reason::TooFewFrames), "{iu:?}");
            assert!((30..37).contains(&iu.captured_percent.unwrap()), "{iu:?}");
        }
        assert_eq!(short(few.last().unwrap()), "NotJudged TooFewFrames");
    }
}

#[test]
fn a_job_that_breaks_off_anywhere_accuses_nobody() {
    let (job, work) = (polish_and_measure(), stream(&[polish(6), measure()].concat(), &[]));
    let job = Job { laws: &IN_ORDER, ..job };
    for cut in 1..work.len() {
        let mut judge = Judge::<Vec<_>>::with_memory(&job, Method::default()).unwrap().at_start_of_job();
        let mut verdicts = Vec::new();
        work[..cut]
            .iter()
            .for_each(|couples| judge.step(couples, &mut |event| verdicts.extend(event.verdict())));
        let before = verdicts.len();
        judge.break_off(&mut |event| verdicts.extend(event.verdict()));
        let accused = verdicts[before..].iter().find(|verdict| verdict.outcome == Outcome::Anomaly);
        assert_eq!(accused, None, "cut after {cut} of {}", work.len());
        let mut unjudged = verdicts[before..].iter().filter(|verdict| verdict.outcome == Outcome::NotJudged);
        assert!(unjudged.all(|verdict| verdict.reason == Reason::BrokenOff), "cut after {cut}: {verdicts:?}");
        judge.break_off(&mut |event| panic!("{event:?} after the end"));
    }
}

/// Lets the right hand (0) or its `o_j` (1) be assumed.
fn assume(couples: &mut [Couples], what: usize) {
    for couples in couples {
        couples.hands[0].sight[what] = Sight::Assumed;
        couples.hands[0].is_clear = false;
    }
}

/// A piece that is polished with half the strokes. While the hand takes the polisher, something is hidden; `is_rivalled` is whether the hand
/// may have taken that instead, for as long as it holds what it took.
fn taken_in_doubt(is_rivalled: bool) -> Vec<String> {
    let right = [vec![idle(20)], polish(3).to_vec(), measure().to_vec()].concat();
    let mut couples = stream(&right, &[]);
    assume(&mut couples[15..25], 1);
    for couples in &mut couples[15..25] {
        couples.hands[0].is_doubtful = true;
    }
    for couples in &mut couples[20..128] {
        couples.hands[0].is_rivalled = is_rivalled;
    }
    judged(&polish_and_measure(), &couples).iter().map(short).collect()
}

#[test]
fn a_fault_of_which_only_the_first_touch_was_hidden_is_found() {
    let verdicts = taken_in_doubt(false);
    assert!(verdicts.contains(&"r0.1 IuAnomaly TooShort".to_owned()), "{verdicts:?}");
    assert_eq!(verdicts.last().unwrap(), "JobAnomaly TooShort");
}

#[test]
fn what_is_done_with_an_object_that_may_be_another_one_accuses_nobody() {
    let verdicts = taken_in_doubt(true);
    assert!(verdicts.iter().all(|verdict| !verdict.contains("Anomaly")), "{verdicts:?}");
    assert_eq!(verdicts.last().unwrap(), "NotJudged ObjectNotSeen");
}

/// The verdicts of a judge that did not see what came before, on a bench that shows these activities not to have been done.
fn judged_cold(job: &Job<'_>, parts: &[Part], undone: impl Fn(usize) -> ActivitySet) -> Vec<String> {
    let couples = stream(parts, &[]).into_iter().enumerate();
    let couples = couples.map(|(frame, couples)| Couples { undone: undone(frame), ..couples }).collect();
    judged_cold_by(job, couples)
}

/// The verdicts of a judge that did not see what came before these couples.
fn judged_cold_by(job: &Job<'_>, couples: Vec<Couples>) -> Vec<String> {
    let mut judge = Judge::<Vec<_>>::with_memory(job, Method::default()).unwrap();
    let mut verdicts = Vec::new();
    for couples in &couples {
        judge.step(couples, &mut |event| verdicts.extend(event.verdict()));
    }
    judge.finish(&mut |event| verdicts.extend(event.verdict()));
    verdicts.iter().map(short).collect()
}

/// That nobody saw what came before does not explain what was hidden later.
#[test]
fn a_hand_that_was_hidden_is_named_even_where_nobody_saw_what_came_before() {
    let right = [idle(5), part([1, 5, 0, 0], 28, Toward(3)), idle(20)];
    let job = teach(&[&right[1..]]);
    let mut couples = stream(&right, &[]);
    for couples in &mut couples[12..28] {
        couples.hands[0].motion = None;
    }
    for couples in &mut couples[15..25] {
        let hand = &mut couples.hands[0];
        (hand.sight[0], hand.is_clear) = (Sight::Assumed, false);
    }
    let said = judged_cold_by(&job, couples);
    assert_eq!(said[0], "r0.0 NotJudged HandNotSeen!");
    assert_eq!(said[1], "r0 NotJudged HandNotSeen!");
}

#[test]
fn parts_that_lie_where_the_job_begins_show_what_has_not_been_done() {
    let job = Job { laws: &IN_ORDER, ..polish_and_measure() };
    let polishing = ActivitySet::of(0);
    let without_polishing = judged_cold(&job, &measure(), |_| polishing);
    assert_eq!(without_polishing.last().unwrap(), "JobAnomaly WrongOrder");
    let unknown = judged_cold(&job, &measure(), |_| ActivitySet::EMPTY);
    assert_eq!(unknown.last().unwrap(), "NotJudged BeginningNotSeen", "it may have been polished before");
    let job = polish_and_measure();
    let not_measured = judged_cold(&job, &polish(6), |_| ActivitySet::of(1));
    assert_eq!(not_measured.last().unwrap(), "JobAnomaly NotCompleted");
    let unknown = judged_cold(&job, &polish(6), |_| ActivitySet::EMPTY);
    assert_eq!(unknown.last().unwrap(), "NotJudged BeginningNotSeen", "it may have been measured before");
}

#[test]
fn a_bench_that_is_set_as_it_was_at_first_is_that_of_the_next_piece() {
    let job = polish_and_measure();
    let (first, right) = (polish(6), [polish(6), measure()].concat());
    let frames: usize = first.iter().map(|part| part.frames).sum();
    let all = ActivitySet::first(2);
    let verdicts = judged_cold(&job, &[&first[..], &right].concat(), |frame| {
        if frame < 5 || (frames - 5..frames + 5).contains(&frame) { all } else { ActivitySet::EMPTY }
    });
    let jobs: Vec<_> = verdicts.iter().filter(|verdict| verdict.starts_with("Job")).collect();
    assert_eq!(jobs, ["JobAnomaly NotCompleted", "JobOk"], "{verdicts:?}");
}

#[test]
fn a_step_that_was_not_judged_and_comes_again_may_only_go_on() {
    let brick = [part([1, 6, 0, 0], 30, Toward(5)), idle(20)];
    let job = teach(&[&polish(6), &brick]);
    let unseen = Part { sighted: false, ..brick[0] };
    let all = [&[idle(5), unseen, idle(20)], &brick[..], &polish(6)].concat();
    // The polisher lies where it lay, and so does the brick, until it is seen to be taken.
    let undone = |frame| if frame < 55 { ActivitySet::first(2) } else { ActivitySet::of(0) };
    let verdicts = judged_cold(&job, &all, undone);
    assert!(verdicts.iter().all(|verdict| !verdict.contains("Anomaly")), "{verdicts:?}");
    assert!(verdicts[0].contains("NotJudged"), "{verdicts:?}");
    // So it is where another step with the same part was right.
    let [grasp, _, carry, _] = polish(6);
    let other = [grasp, part([1, 5, 5, 7], 96, Still), carry, idle(20)];
    let job = teach(&[&polish(6), &other, &brick]);
    let unseen = other.map(|part| Part { sighted: false, ..part });
    let all = [&[idle(5)], &polish(6)[..], &unseen, &other, &brick].concat();
    let verdicts = judged_cold(&job, &all, |_| ActivitySet::of(2));
    assert!(verdicts.iter().all(|verdict| !verdict.contains("Anomaly")), "{verdicts:?}");
}

#[test]
fn after_the_second_half_of_an_activity_its_first_half_begins_another_one() {
    let (to_table, back) = (bring(3, 2, 1), bring(2, 3, 5));
    let whole = [to_table, back].concat();
    let job = teach(&[&whole]);
    let jobs_of = |parts: &[Part]| -> Vec<String> {
        let mut verdicts = judged_cold(&job, parts, |_| ActivitySet::EMPTY);
        verdicts.retain(|verdict| !verdict.starts_with('r'));
        verdicts
    };
    // The first half may have come before what was seen, but nothing excuses that the second one does not come after it.
    assert_eq!(
        jobs_of(&[back, to_table].concat()),
        ["NotJudged BeginningNotSeen", "JobAnomaly NotCompleted"]
    );
    assert_eq!(jobs_of(&[&back, &whole[..]].concat()), ["NotJudged BeginningNotSeen", "JobOk"]);
}

#[test]
fn a_job_begins_with_its_first_step_although_a_hand_steadied_something_before() {
    let job = polish_and_measure();
    let right = [&[idle(120)][..], &polish(6), &measure()].concat();
    let mut couples = stream(&right, &[idle(60), part([2, 5, 5, 6], 20, Still), idle(20)]);
    couples[105].has_moved_unseen = true;
    assert_eq!(judged_cold_by(&job, couples).last().unwrap(), "JobOk", "the next piece is put in place");
}

/// The verdicts of a judge that sees the tool first in the hand, at a part that the job does not bring it to.
fn elsewhere_at_first(is_object_new: bool) -> Vec<String> {
    let mut couples = stream(&[idle(30), part([1, 5, 5, 3], 10, Still), idle(20)], &[]);
    for couples in &mut couples {
        couples.hands[0].is_object_new = is_object_new && couples.hands[0].context.is_touch();
    }
    judged_cold_by(&polish_and_measure(), couples)
}

#[test]
fn where_a_part_is_when_it_is_first_seen_in_the_hand_accuses_nobody() {
    let verdicts = elsewhere_at_first(true);
    assert!(
        !verdicts.is_empty() && verdicts.iter().all(|verdict| verdict.contains("NotJudged")),
        "{verdicts:?}"
    );
    let verdicts = elsewhere_at_first(false);
    assert!(verdicts[0].contains("IuAnomaly WrongObject"), "{verdicts:?}");
}

#[test]
fn what_is_wrong_after_a_part_was_first_seen_is_found() {
    let mut wrong = polish(6);
    wrong[2] = wrong[0];
    let mut couples = stream(&[&[idle(30)][..], &wrong].concat(), &[]);
    for couples in &mut couples {
        couples.hands[0].is_object_new = couples.hands[0].context.0[3] != 0;
    }
    let verdicts = judged_cold_by(&polish_and_measure(), couples);
    assert!(verdicts.contains(&"r0.2 IuAnomaly Motion!".to_owned()), "{verdicts:?}");
}

#[test]
fn the_piece_after_one_whose_end_was_hidden_is_right() {
    let job = teach(&[&polish(6)]);
    let [grasp, stroke, ..] = polish(6);
    let hidden = [grasp, stroke, away(25), idle(30)];
    let verdicts = judged(&job, &stream(&[&hidden[..], &polish(6)].concat(), &[]));
    let jobs: Vec<_> = verdicts.iter().filter(|verdict| verdict.level == Level::Job).map(short).collect();
    assert_eq!(jobs, ["NotJudged HandNotSeen", "JobOk"]);
    let job = Job { laws: &IN_ORDER, ..polish_and_measure() };
    let mut unseen = measure();
    unseen[0].sighted = false;
    let pieces = [&polish(6)[..], &[unseen[0], idle(30)], &polish(6), &measure()].concat();
    let verdicts = judged(&job, &stream(&pieces, &[]));
    let jobs: Vec<_> = verdicts.iter().filter(|verdict| verdict.level == Level::Job).map(short).collect();
    assert_eq!(jobs.last().unwrap(), "JobOk", "{jobs:?}");
    assert_eq!(jobs.len(), 2, "{jobs:?}");
}

#[test]
fn a_hand_that_was_idle_before_a_doubt_may_have_ended_what_was_hidden() {
    let job = teach(&[&polish(6), &measure()]);
    let [grasp, stroke, ..] = polish(6);
    // The tool is put back while it is hidden.
    let hidden =
        [idle(5), grasp, stroke, Part { sighted: false, ..part(stroke.context, 60, Still) }, idle(60)];
    let mut couples = stream(&[&hidden[..], &polish(6), &measure()].concat(), &[]);
    let ended: usize = hidden[..4].iter().map(|part| part.frames).sum();
    for (frame, couples) in couples[ended + 10..ended + 55].iter_mut().enumerate() {
        // Single frames in the first half second, and then many.
        let is_missing = frame % 10 == 9 || frame > 30;
        couples.hands[0].is_clear &= !is_missing;
        couples.hands[0].is_doubtful |= frame > 30;
    }
    let verdicts = judged_cold_by(&job, couples);
    assert!(verdicts.iter().all(|verdict| !verdict.contains("Anomaly")), "{verdicts:?}");
}

#[test]
fn a_part_that_passes_where_it_was_shown_to_rest_accuses_nobody_unless_it_is_left_there() {
    let [carry, rest, left, end] = measure();
    let at_meter = |motions| part(rest.context, 9, motions);
    let jobs_of = |parts: &[Part]| -> Vec<String> {
        let verdicts = judged(&polish_and_measure(), &stream(&[&polish(6)[..], parts].concat(), &[]));
        verdicts.iter().map(short).filter(|verdict| !verdict.starts_with('r')).collect()
    };
    assert_eq!(jobs_of(&[carry, at_meter(Toward(5)), carry, rest, left, end]), ["NotJudged Passing"]);
    assert_eq!(jobs_of(&[carry, at_meter(Still), carry, rest, left, end]), ["JobAnomaly TooShort"]);
    assert_eq!(jobs_of(&[carry, at_meter(Toward(5)), left, end]), ["JobAnomaly TooShort"]);
}

#[test]
fn what_a_hand_goes_on_with_from_the_job_before_may_belong_to_this_one() {
    let left = [part([2, 6, 6, 5], 60, Still), part([0, 0, 6, 5], 20, Still), idle(20)];
    let job = teach(&[&polish(6), &left]);
    let [grasp, stroke, carry, end] = polish(6);
    // Little was seen of the first piece, and the right hand is busy with the second one when the left hand comes to that.
    let unseen = |part: Part| Part { sighted: false, ..part };
    let right = [idle(5), unseen(stroke), unseen(carry), idle(40), grasp, stroke, carry, end];
    let steadies = part([2, 5, 5, 6], 10, Still);
    let left_work = [&[idle(45), unseen(left[0]), idle(110), steadies, idle(30)][..], &left].concat();
    let verdicts = judged_cold_by(&job, stream(&right, &left_work));
    assert!(verdicts.iter().all(|verdict| !verdict.contains("Anomaly")), "{verdicts:?}");
}

#[test]
fn a_part_that_a_hand_has_let_go_of_unjudged_excuses_nothing_in_the_next_job() {
    let left = [part([2, 6, 6, 3], 60, Still), part([0, 0, 6, 3], 20, Still), idle(20)];
    let brick = [part([1, 7, 0, 0], 30, Toward(5)), idle(20)];
    let once = Law { is_once: true, runs: 6, ..Law::FREE };
    let later = Law { after_begin: ActivitySet::of(0), ..once };
    let job = Job { laws: &[once, later, later], ..teach(&[&polish(6), &left, &brick]) };
    let frames: usize = polish(6).iter().map(|part| part.frames).sum();
    // The brick and the part of the left hand are left out.
    let right =
        [&[idle(5)][..], &polish(6), &brick, &[idle(80)], &polish(6), &polish(6), &polish(6)].concat();
    let unseen = Part { sighted: false, ..left[0] };
    let left = [idle(frames + 65), unseen, Part { frames: 3 * frames + 100, ..left[1] }];
    let verdicts = judged_cold_by(&job, stream(&right, &left));
    assert!(verdicts.contains(&"JobAnomaly WrongOrder".to_owned()), "{verdicts:?}");
}

/// The polisher is taken, and put down again. From before it is taken until this frame, something is hidden that it may have been used on.
fn used_unseen_until(frame: usize) -> Vec<String> {
    let taken = Part { frames: 30 + 96 + 30, ..polish(6)[0] };
    let all = [vec![idle(20), taken, idle(20)], measure().to_vec()].concat();
    let mut couples = stream(&all, &[]);
    for couples in &mut couples[15..frame] {
        (couples.hands[0].is_clear, couples.hands[0].is_doubtful) = (false, true);
    }
    judged(&polish_and_measure(), &couples).iter().map(short).collect()
}

#[test]
fn what_was_hidden_since_an_iu_began_in_doubt_may_lie_between_it_and_its_like() {
    let is_wrong = |verdicts: Vec<String>| verdicts.iter().any(|verdict| verdict.contains("Anomaly"));
    assert!(!is_wrong(used_unseen_until(150)));
    assert!(is_wrong(used_unseen_until(25)), "too short a time to polish");
}

/// The last verdict on an IU that is one frame too short, if this many of its frames were not seen.
fn one_frame_too_short(assumed: usize) -> String {
    let [grasp, ..] = polish(6);
    let job = teach(&[&[grasp, idle(20)]]);
    let mut couples = stream(&[idle(30), Part { frames: 14, ..grasp }, idle(20)], &[]);
    assume(&mut couples[35..35 + assumed], 0);
    short(judged(&job, &couples).last().unwrap())
}

#[test]
fn a_frame_that_was_not_seen_may_shift_an_end() {
    assert_eq!(one_frame_too_short(0), "JobAnomaly TooShort");
    assert_eq!(one_frame_too_short(1), "NotJudged HandNotSeen");
}

#[test]
fn motion_that_was_assumed_accuses_nobody() {
    let [grasp, ..] = polish(6);
    let job = teach(&[&[grasp, idle(20)]]);
    let bent = [idle(30), Part { frames: 26, ..grasp }, part(grasp.context, 4, Toward(7)), idle(20)];
    let mut couples = stream(&bent, &[]);
    assert_eq!(short(judged(&job, &couples).last().unwrap()), "JobAnomaly Motion");
    assume(&mut couples[45..60], 1);
    assert_eq!(short(judged(&job, &couples).last().unwrap()), "NotJudged ObjectNotSeen");
}

/// What is said of a job with so many strokes, of which 4 of every 8 frames are not seen.
fn strokes_with_gaps(strokes: usize) -> String {
    let mut couples = stream(&[polish(strokes), measure()].concat(), &[]);
    for gap in couples[34..30 + 16 * strokes].chunks_mut(8) {
        for couples in gap.iter_mut().take(4) {
            let hand = &mut couples.hands[0];
            (hand.motion, hand.position, hand.sight[1]) = (None, None, Sight::Assumed);
        }
    }
    short(judged(&forgiving(polish_and_measure()), &couples).last().unwrap())
}

#[test]
fn two_thirds_of_the_strokes_are_not_right_because_frames_are_missing() {
    assert_eq!(strokes_with_gaps(4), "NotJudged Blind");
    assert_eq!(strokes_with_gaps(6), "JobOk");
}

/// What is said of a job that is measured first and then polished, if the hand was hidden for so many frames before.
fn in_the_wrong_order(hidden: usize) -> Vec<String> {
    let job = Job { laws: &IN_ORDER, ..polish_and_measure() };
    let work = [&[idle(20), away(hidden), idle(60)][..], &measure(), &polish(6)].concat();
    let verdicts = judged(&job, &stream(&work, &[]));
    verdicts.iter().map(short).filter(|verdict| !verdict.contains('.')).collect()
}

#[test]
fn what_may_have_come_unseen_and_comes_afterwards_is_not_right() {
    let seen = in_the_wrong_order(0);
    assert_eq!(seen, ["r0 ActivityAnomaly WrongOrder!", "r1 ActivityOk!", "JobAnomaly WrongOrder"]);
    let hidden = in_the_wrong_order(100);
    assert_eq!(hidden, ["r0 ActivityOk!", "r1 NotJudged HandNotSeen!", "NotJudged HandNotSeen"]);
}
