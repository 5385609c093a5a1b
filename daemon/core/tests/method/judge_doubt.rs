//! Where a job begins and ends, and what is said of what was not seen.

use crate::common::bench::PERIOD_NS;
use crate::common::script::{Part, Still, Toward, idle, part, short, stream, teach};
use crate::common::work::{
    IN_ORDER, away, expect, forgiving, jobs, judged, measure, polish, polish_and_measure,
};
use andon_core::anomaly::{Event, Judge};
use andon_core::config::Method;
use andon_core::couple::{Couple, Couples, Unseen, Visibility};
use andon_core::job::Job;
use andon_core::verdict::{Level, Outcome, Reason, Verdict};
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
    couples[250].unseen |= Unseen::MOVER;
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
        measured_after_a_pause(|couples| couples.unseen |= Unseen::MOVER),
        "JobAnomaly NotCompleted",
        "the next piece is put in place"
    );
    assert_eq!(
        measured_after_a_pause(|couples| couples.unseen |= Unseen::CARRIER),
        "NotJudged BeginningNotSeen"
    );
}

#[test]
fn a_pause_shows_the_start_of_a_job_only_while_the_bench_is_in_sight() {
    let hidden = |frames| measured_after_a_pause_with(frames, |couples| couples.unseen |= Unseen::BENCH);
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
    couples[170].unseen |= Unseen::MOVER;
    let verdicts = judged(&polish_and_measure(), &couples);
    assert_eq!(short(verdicts.last().unwrap()), "NotJudged HandNotSeen");
    couples[170].unseen = couples[170].unseen.without(Unseen::MOVER);
    couples.last_mut().unwrap().unseen |= Unseen::MOVER;
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
            couples[fault_frames - 1].unseen |= Unseen::MOVER;
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
    let of = |(index, couples): (usize, &Couples)| {
        let unseen = Unseen::FRAME.when(index % count != 0);
        let hands = couples.hands.map(|couple| Couple { unseen: couple.unseen | unseen, ..couple });
        Couples { unseen: couples.unseen | unseen, hands, ..*couples }
    };
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

/// Nobody knows what came between the pause and the touch.
#[test]
fn a_pause_before_the_couples_broke_off_shows_no_start() {
    let (job, pause) = (Job { laws: &IN_ORDER, ..polish_and_measure() }, 300);
    let work = stream(&[&[away(pause), idle(20)][..], &measure(), &[idle(20)]].concat(), &[]);
    let said = |breaks_off: bool| {
        let mut judge = Judge::<Vec<_>>::with_memory(&job, Method::default()).unwrap().between_jobs();
        let mut verdicts = Vec::new();
        let mut take = |event: Event| verdicts.extend(event.verdict());
        work[..pause].iter().for_each(|couples| judge.step(couples, &mut take));
        if breaks_off {
            judge.break_off(&mut take);
        }
        work[pause..].iter().for_each(|couples| judge.step(couples, &mut take));
        judge.finish(&mut take);
        short(verdicts.last().unwrap())
    };
    assert_eq!(said(false), "JobAnomaly WrongOrder");
    assert_eq!(said(true), "NotJudged BeginningNotSeen");
}

/// Lets the right hand (0) or its `o_j` (1) be assumed.
fn assume(couples: &mut [Couples], what: usize) {
    for couples in couples {
        couples.hands[0].visibility[what] = Visibility::Assumed;
        couples.hands[0].unseen |= Unseen::CONTEXT;
    }
}

/// A piece that is polished with half the strokes. While the hand takes the polisher, something is hidden. `is_object_ambiguous` is whether the hand
/// may have taken that instead, for as long as it holds what it took.
fn taken_in_doubt(is_object_ambiguous: bool) -> Vec<String> {
    let right = [vec![idle(20)], polish(3).to_vec(), measure().to_vec()].concat();
    let mut couples = stream(&right, &[]);
    assume(&mut couples[15..25], 1);
    for couples in &mut couples[15..25] {
        couples.hands[0].unseen |= Unseen::CHANGE;
    }
    for couples in &mut couples[20..128] {
        couples.hands[0].unseen |= Unseen::TAKING.when(is_object_ambiguous);
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

#[test]
fn what_is_done_with_an_object_beside_which_another_one_was_first_seen_accuses_nobody() {
    let verdicts = |is_object_ambiguous: bool, is_new: bool| -> Vec<String> {
        let right = [vec![idle(20)], polish(3).to_vec(), measure().to_vec()].concat();
        let mut couples = stream(&right, &[]);
        couples[22..30]
            .iter_mut()
            .for_each(|couples| couples.hands[0].unseen |= Unseen::ARRIVAL.when(is_new));
        couples[20..128]
            .iter_mut()
            .for_each(|couples| couples.hands[0].unseen |= Unseen::TAKING.when(is_object_ambiguous));
        judged(&polish_and_measure(), &couples).iter().map(short).collect()
    };
    for (is_object_ambiguous, is_new) in [(true, false), (false, true)] {
        assert_eq!(verdicts(is_object_ambiguous, is_new).last().unwrap(), "JobAnomaly TooShort");
    }
    let in_doubt = verdicts(true, true);
    assert!(in_doubt.iter().all(|verdict| !verdict.contains("Anomaly")), "{in_doubt:?}");
    assert!(in_doubt.last().unwrap().starts_with("NotJudged"), "{in_doubt:?}");
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

/// The polisher is taken, and put down again. From before it is taken until this frame, something is hidden that it may have been used on.
fn used_unseen_until(frame: usize) -> Vec<String> {
    let taken = Part { frames: 30 + 96 + 30, ..polish(6)[0] };
    let all = [vec![idle(20), taken, idle(20)], measure().to_vec()].concat();
    let mut couples = stream(&all, &[]);
    for couples in &mut couples[15..frame] {
        couples.hands[0].unseen |= Unseen::CONTEXT | Unseen::CHANGE;
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
            (hand.motion, hand.position, hand.visibility[1]) = (None, None, Visibility::Assumed);
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

/// What is said of a brick that is polished by two strokes of six, if the hand is hidden in so many frames where that ends.
fn polished_too_little(hidden: usize) -> Vec<Verdict> {
    let [bring, rub, retreat, end] = polish(2);
    let from = bring.frames + rub.frames - 1;
    let mut couples = stream(&[bring, rub, retreat, end], &[]);
    assume(&mut couples[from..from + hidden], 0);
    couples[from..from + hidden].iter_mut().for_each(|couples| couples.hands[0].unseen |= Unseen::CHANGE);
    judged(&forgiving(teach(&[&polish(6)])), &couples).split_off(1)
}

#[test]
fn what_ends_in_doubt_is_wrong_once_it_is_certain_that_it_has_ended() {
    let wrong =
        ["r0.1 IuAnomaly TooShort", "r0 ActivityAnomaly TooShort!", "r0.2 IuOk", "JobAnomaly TooShort"];
    assert_eq!(polished_too_little(3).iter().map(short).collect::<Vec<_>>(), wrong);
    // The other strokes fit into the gap.
    let said = polished_too_little(25);
    assert_eq!(said.last().map(short).as_deref(), Some("NotJudged HandNotSeen"), "{said:?}");
    // What it would have been accused of is told all the same.
    assert!(said[0].measured.is_some(), "{said:?}");
}
