//! What a judge says that did not see what came before. It speaks of what the bench shows, of what may be the remainder of something, and of the job
//! after it.

use crate::common::script::{Part, Still, Toward, idle, objects_of, part, short, stream, teach};
use crate::common::work::{IN_ORDER, away, bring, measure, polish, polish_and_measure};
use andon_core::anomaly::Judge;
use andon_core::config::Method;
use andon_core::couple::{Couples, Unseen, Visibility};
use andon_core::job::{Job, Law};
use andon_core::set::ActivitySet;

/// The verdicts of a judge that did not see what came before, on a bench that shows these activities not to have been done.
fn judged_cold(job: &Job<'_>, parts: &[Part], undone: impl Fn(usize) -> ActivitySet) -> Vec<String> {
    let couples = stream(parts, &[]).into_iter().enumerate();
    let couples =
        couples.map(|(frame, couples)| Couples { at_start: objects_of(undone(frame)), ..couples }).collect();
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
fn a_hand_that_was_hidden_is_named_even_where_nobody_saw_what_came_before() {
    let right = [idle(5), part([1, 5, 0, 0], 28, Toward(3)), idle(20)];
    let job = teach(&[&right[1..]]);
    let mut couples = stream(&right, &[]);
    for couples in &mut couples[12..28] {
        couples.hands[0].motion = None;
    }
    for couples in &mut couples[15..25] {
        let hand = &mut couples.hands[0];
        hand.visibility[0] = Visibility::Assumed;
        hand.unseen |= Unseen::CONTEXT;
    }
    let said = judged_cold_by(&job, couples);
    assert_eq!(said[0], "r0.0 NotJudged HandNotSeen");
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
fn a_part_that_has_not_been_seen_to_leave_its_place_was_not_brought_back_there() {
    let (first, job) = (polish(6), polish_and_measure());
    let frames: usize = first.iter().map(|part| part.frames).sum();
    // It is hidden when the hand takes it, and assumed where it lay until the next step has begun.
    let verdicts = judged_cold(&job, &[first, measure()].concat(), |frame| {
        if frame < frames + 5 { ActivitySet::first(2) } else { ActivitySet::EMPTY }
    });
    assert_eq!(verdicts.last().unwrap(), "JobOk", "{verdicts:?}");
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
fn the_first_step_that_an_idle_hand_begins_is_judged_although_other_touches_may_come_in_it() {
    let laws: [Law; 2] = [true, false].map(|allows_insertions| Law { allows_insertions, ..Law::FREE });
    let job = Job { laws: Box::leak(Box::new(laws)), ..polish_and_measure() };
    let said = |before: usize| {
        judged_cold_by(&job, stream(&[&[idle(before)][..], &polish(2), &measure()].concat(), &[]))
    };
    assert_eq!(said(60)[1], "r0.1 IuAnomaly TooShort", "{:?}", said(60));
    // What a hand goes on with that was not seen to be idle may have begun before.
    assert_eq!(said(2)[1], "r0.1 NotJudged BeginningNotSeen", "{:?}", said(2));
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
    couples[105].unseen |= Unseen::MOVER;
    assert_eq!(judged_cold_by(&job, couples).last().unwrap(), "JobOk", "the next piece is put in place");
}

/// The verdicts of a judge that sees the tool first in the hand, at a part that the job does not bring it to.
fn elsewhere_at_first(is_object_new: bool) -> Vec<String> {
    let mut couples = stream(&[idle(30), part([1, 5, 5, 3], 10, Still), idle(20)], &[]);
    for couples in &mut couples {
        couples.hands[0].unseen |= Unseen::ARRIVAL.when(is_object_new && couples.hands[0].context.is_touch());
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
        couples.hands[0].unseen |= Unseen::ARRIVAL.when(couples.hands[0].context.0[3] != 0);
    }
    let verdicts = judged_cold_by(&polish_and_measure(), couples);
    assert!(verdicts.contains(&"r0.2 IuAnomaly Motion!".to_owned()), "{verdicts:?}");
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
        couples.hands[0].unseen |= Unseen::CONTEXT.when(is_missing);
        couples.hands[0].unseen |= Unseen::CHANGE.when(frame > 30);
    }
    let verdicts = judged_cold_by(&job, couples);
    assert!(verdicts.iter().all(|verdict| !verdict.contains("Anomaly")), "{verdicts:?}");
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

#[test]
fn what_comes_while_a_hand_goes_on_with_an_earlier_step_comes_behind_it() {
    let hold = [part([2, 6, 0, 0], 60, Still), part([2, 6, 6, 5], 96, Still), part([2, 6, 0, 0], 90, Still)];
    let free = Law { runs: 6, ..Law::FREE };
    let later = Law { after_begin: ActivitySet::of(0), ..free };
    let job = Job { laws: &[free, later, free], ..teach(&[&hold, &polish(6), &measure()]) };
    let right = [&polish(6)[..], &measure()].concat();
    // Only that the hand had begun before shows that what it does is not the remainder of another piece.
    let said = |hand_begins: usize, others_begin: usize| {
        let left = [&[idle(hand_begins)][..], &hold, &[idle(20)]].concat();
        let couples = stream(&[&[idle(others_begin)][..], &right].concat(), &left);
        judged_cold_by(&job, couples).last().unwrap().clone()
    };
    assert_eq!(said(40, 60), "JobOk");
    assert!(said(80, 40).contains("NotJudged"));
}

#[test]
fn a_hand_that_was_not_seen_to_come_may_steady_the_other_part() {
    let steadies = [part([2, 5, 5, 6], 60, Still), idle(20)];
    let optional = Law { is_required: false, runs: 6, ..Law::FREE };
    let required = Law { runs: 6, ..Law::FREE };
    let rests = |rests: &'static [u16], before: &[Part]| {
        let job = Job {
            passive_contacts: rests,
            laws: &[required, optional],
            ..teach(&[&polish(6), &[steadies[0], idle(20)]])
        };
        let left = [before, &[steadies[0], part([0, 0, 5, 6], 40, Still), idle(20)]].concat();
        let couples = stream(&[&[idle(40)][..], &polish(6)].concat(), &left);
        judged_cold_by(&job, couples).iter().any(|verdict| verdict.contains("Anomaly"))
    };
    assert!(!rests(&[6], &[]));
    assert!(rests(&[6], &[idle(30)]), "it was seen to come");
    assert!(rests(&[], &[]), "no hand steadies that");
}

#[test]
fn what_comes_once_and_behind_what_it_must_come_before_is_wrong_whatever_came_before() {
    let lift = [part([2, 4, 0, 0], 40, Toward(1)), part([2, 4, 4, 8], 110, Still), idle(20)];
    let taught = teach(&[&polish(6), &measure(), &lift]);
    // The other hand has begun this piece, and is in the middle of it when the polisher is taken.
    let right = [&[idle(20)][..], &measure(), &polish(6)].concat();
    let couples = stream(&right, &lift);
    let said_with = |is_once: bool| {
        let polishing = Law { is_once, ..IN_ORDER[0] };
        let job = Job { laws: &[polishing, IN_ORDER[1], Law::FREE], ..taught };
        judged_cold_by(&job, couples.clone()).last().unwrap().clone()
    };
    assert_eq!(said_with(true), "JobAnomaly WrongOrder", "it comes too late or a second time");
    assert!(said_with(false).starts_with("NotJudged"), "it may have come before as well");
}
