//! The order of a job is a partial one. What breaks a law is an anomaly that names it, and what was only not shown before is a note.

use crate::common::script::{Part, Still, Toward, idle, part, short, stream, teach};
use crate::common::work::{bring, judged, measure, polish};
use andon_core::job::{Job, Law, NominalActivity};
use andon_core::set::ActivitySet;
use andon_core::verdict::{BrokenOrder, Level, Note, OrderFault, Outcome, Verdict};

/// The left hand lifts the lid off.
fn lift() -> [Part; 3] {
    [part([2, 4, 0, 0], 40, Toward(1)), part([2, 4, 4, 8], 40, Still), idle(20)]
}

/// Polishing is 0 and measuring 1, by the right hand; the left hand's lifting is 2.
fn job(laws: &[Law]) -> Job<'static> {
    Job { laws: laws.to_vec().leak(), ..teach(&[&polish(6), &measure(), &lift()]) }
}

const FREE: Law = Law { runs: 6, ..Law::FREE };
const AFTER_POLISHING: Law = Law { after_begin: ActivitySet::of(0), ..FREE };

fn after(frames: usize, parts: &[Part]) -> Vec<Part> {
    [&[idle(frames)][..], parts].concat()
}

fn job_of(verdicts: &[Verdict]) -> Verdict {
    *verdicts.iter().find(|verdict| verdict.level == Level::Job).unwrap()
}

fn activity(verdicts: &[Verdict], nearest: u16) -> Verdict {
    let is_it = |verdict: &&Verdict| verdict.level == Level::Activity && verdict.nearest == Some(nearest);
    *verdicts.iter().find(is_it).unwrap()
}

fn in_a_row() -> Vec<Part> {
    [polish(6), measure()].concat()
}

#[test]
fn what_no_law_orders_may_come_in_any_order() {
    let job = job(&[FREE, AFTER_POLISHING, FREE]);
    for wait in [0, 20, 120, 250] {
        let verdicts = judged(&job, &stream(&in_a_row(), &after(wait, &lift())));
        assert_eq!((short(&job_of(&verdicts)).as_str(), job_of(&verdicts).note), ("JobOk", None), "{wait}");
    }
    let reversed = [measure(), polish(6)].concat();
    let verdicts = judged(&job, &stream(&reversed, &lift()));
    assert_eq!(short(&job_of(&verdicts)), "JobAnomaly WrongOrder");
}

#[test]
fn a_broken_law_is_told_with_the_first_frame_that_breaks_it_and_names_what_should_have_come_before() {
    let begun = Law { after_begin: ActivitySet::of(0), ..FREE };
    let ended = Law { after_end: ActivitySet::of(0), ..FREE };
    for (law, wait, fault) in [
        (&[FREE, FREE, begun][..], 0, OrderFault::NotBegun),
        (&[FREE, FREE, ended][..], 0, OrderFault::NotBegun),
        (&[FREE, FREE, ended][..], 60, OrderFault::NotEnded),
    ] {
        let work = stream(&after(10, &in_a_row()), &after(wait, &lift()));
        let verdicts = judged(&job(law), &work);
        let lifting = activity(&verdicts, 2);
        assert_eq!(
            short(&lifting),
            "l0 ActivityAnomaly WrongOrder!".replace('0', &lifting.activity.to_string())
        );
        let broken = BrokenOrder { fault, activity: 0, runs: 6 };
        assert_eq!((lifting.broken, job_of(&verdicts).broken), (Some(broken), Some(broken)));
        assert_eq!(lifting.began_ns, lifting.ended_ns, "at its first touch");
    }
    // The law asks for the beginning only.
    let verdicts = judged(&job(&[FREE, FREE, begun]), &stream(&in_a_row(), &after(1, &lift())));
    assert_eq!(short(&job_of(&verdicts)), "JobOk");
}

#[test]
fn what_is_optional_accuses_nobody_where_it_is_missing_and_only_where_it_comes_too_late() {
    let optional = Law { is_required: false, ..FREE };
    let after_lifting = Law { after_end: ActivitySet::of(2), ..FREE };
    let job = job(&[after_lifting, AFTER_POLISHING, optional]);
    let outcome = |left: &[Part]| {
        let verdicts = judged(&job, &stream(&after(110, &in_a_row()), left));
        (short(&job_of(&verdicts)), job_of(&verdicts).broken.map(|broken| broken.fault))
    };
    assert_eq!(outcome(&lift()), ("JobOk".into(), None));
    assert_eq!(outcome(&[]), ("JobOk".into(), None));
    assert_eq!(outcome(&after(200, &lift())), ("JobAnomaly WrongOrder".into(), Some(OrderFault::TooLate)));
    assert_eq!(outcome(&after(80, &lift())), ("JobAnomaly WrongOrder".into(), Some(OrderFault::NotEnded)));
}

#[test]
fn where_a_part_is_done_of_what_others_do_in_one_the_rest_is_required() {
    let (there, back) = (bring(3, 7, 3), bring(7, 3, 7));
    let whole = [&there[..4], &back[..]].concat();
    let taught = teach(&[&whole, &there, &back]);
    let activities: Vec<NominalActivity<'_>> = taught
        .activities
        .iter()
        .zip([0, 0, 1])
        .map(|(nominal, activity)| NominalActivity { activity, ..*nominal })
        .collect();
    let outcome = |completes: ActivitySet, parts: &[Part]| {
        let laws = [FREE, Law { is_required: false, completes, ..AFTER_POLISHING }];
        let job = Job { activities: &activities, laws: &laws, ..taught };
        short(&job_of(&judged(&job, &stream(&[parts, &[idle(200)]].concat(), &[]))))
    };
    let in_two = [&there[..], &[idle(30)], &back[..]].concat();
    for completes in [ActivitySet::EMPTY, ActivitySet::of(1)] {
        assert_eq!(outcome(completes, &whole), "JobOk");
        assert_eq!(outcome(completes, &in_two), "JobOk");
    }
    assert_eq!(outcome(ActivitySet::EMPTY, &there), "JobOk");
    assert_eq!(outcome(ActivitySet::of(1), &there), "JobAnomaly NotCompleted");
}

#[test]
fn a_job_waits_for_what_is_optional_and_may_come_last() {
    let job =
        job(&[FREE, AFTER_POLISHING, Law { is_required: false, after_end: ActivitySet::of(1), ..FREE }]);
    let with = after(330, &lift());
    for (left, activities) in [(&with[..], 3), (&[][..], 2)] {
        let piece = |left: &[Part]| stream(&[&in_a_row()[..], &[idle(200)]].concat(), left);
        let frames = piece(left).len();
        let mut left = left.to_vec();
        left.push(idle(frames - left.iter().map(|part| part.frames).sum::<usize>()));
        let twice = stream(&[&in_a_row()[..], &[idle(200)]].concat().repeat(2), &left.repeat(2));
        let verdicts = judged(&job, &twice);
        let jobs: Vec<(String, u16)> = verdicts
            .iter()
            .filter(|verdict| verdict.level == Level::Job)
            .map(|job| (short(job), job.activity))
            .collect();
        assert_eq!(jobs, [("JobOk".to_owned(), activities), ("JobOk".to_owned(), activities)]);
    }
}

#[test]
fn an_order_that_was_not_shown_and_breaks_no_law_is_a_note() {
    let usual = Law { usually_after: ActivitySet::of(2), ..FREE };
    let job = job(&[usual, AFTER_POLISHING, FREE]);
    let verdicts = judged(&job, &stream(&after(20, &in_a_row()), &lift()));
    assert_eq!(job_of(&verdicts).note, None);
    let verdicts = judged(&job, &stream(&in_a_row(), &after(20, &lift())));
    assert_eq!((short(&job_of(&verdicts)).as_str(), job_of(&verdicts).note), ("JobOk", Some(Note::Order)));
    assert_eq!((activity(&verdicts, 0).note, activity(&verdicts, 2).note), (Some(Note::Order), None));
}

#[test]
fn a_repetition_is_a_note_unless_a_law_forbids_it() {
    let once = Law { is_once: true, ..AFTER_POLISHING };
    let right = [polish(6), polish(6), measure()].concat();
    let left = [&lift()[..], &[idle(400)]].concat();
    let verdicts = judged(&job(&[FREE, AFTER_POLISHING, FREE]), &stream(&right, &left));
    assert_eq!((short(&job_of(&verdicts)).as_str(), job_of(&verdicts).note), ("JobOk", Some(Note::Again)));
    let right = [polish(6), measure(), measure()].concat();
    let verdicts = judged(&job(&[FREE, once, FREE]), &stream(&right, &after(300, &lift())));
    let broken = job_of(&verdicts).broken.unwrap();
    assert_eq!((broken.fault, broken.activity), (OrderFault::Again, 1));
}

/// The parts with the hand on the other side.
fn swapped(parts: &[Part]) -> Vec<Part> {
    let mut parts = parts.to_vec();
    for part in &mut parts {
        part.context[0] = if part.context[0] == 0 { 0 } else { 3 - part.context[0] };
    }
    parts
}

#[test]
fn a_step_of_the_other_hand_is_the_same_step_with_a_note() {
    let job = job(&[FREE, AFTER_POLISHING, FREE]);
    let verdicts = judged(&job, &stream(&swapped(&lift()), &swapped(&in_a_row())));
    assert_eq!(
        (short(&job_of(&verdicts)).as_str(), job_of(&verdicts).note),
        ("JobOk", Some(Note::OtherHand))
    );
    assert_eq!(activity(&verdicts, 2).context.0[0], 1, "the hand that did it");
    // Its motion is judged, and what was not done is missing.
    let verdicts = judged(&job, &stream(&in_a_row(), &[]));
    assert_eq!(short(&job_of(&verdicts)), "JobAnomaly NotCompleted");
    let mut other = swapped(&lift());
    other[0].motions = Toward(5);
    let verdicts = judged(&job, &stream(&[&other[..], &in_a_row()].concat(), &[]));
    assert_eq!(short(&job_of(&verdicts)), "JobAnomaly NotCompleted");
}

#[test]
fn a_hand_that_rests_at_a_part_of_the_job_is_a_note_and_at_any_other_an_anomaly() {
    let job = job(&[FREE, AFTER_POLISHING, FREE]);
    // The fixture, the brick that is polished, and the polisher that the other hand has.
    for object in [3, 6, 5] {
        let rest = [idle(60), part([2, object, 0, 0], 50, Still), idle(20)];
        let left = [&lift()[..], &rest].concat();
        let verdicts = judged(&job, &stream(&in_a_row(), &left));
        assert!(verdicts.iter().all(|verdict| verdict.outcome == Outcome::Ok), "{object}: {verdicts:#?}");
        assert_eq!(job_of(&verdicts).note, Some(Note::Step), "{object}");
        let verdicts = judged(&Job { passive_contacts: &[object], ..job }, &stream(&in_a_row(), &left));
        assert_eq!((short(&job_of(&verdicts)).as_str(), job_of(&verdicts).note), ("JobOk", None), "{object}");
    }
    let foreign = [&lift()[..], &[part([2, 9, 0, 0], 50, Still), idle(20)]].concat();
    assert_eq!(short(&job_of(&judged(&job, &stream(&in_a_row(), &foreign)))), "JobAnomaly WrongObject");
}

#[test]
fn what_is_not_like_an_optional_step_is_none_where_its_part_is_touched_in_other_ways_as_well() {
    let optional = Law { is_required: false, ..FREE };
    let mut longer = lift();
    longer[0].frames = 400;
    let judged = |law: Law, rests: &[u16]| {
        let laws = [FREE, AFTER_POLISHING, law];
        let job = Job { passive_contacts: rests, ..job(&laws) };
        short(&job_of(&judged(&job, &stream(&in_a_row(), &longer))))
    };
    let object = longer[0].context[1];
    assert_eq!(judged(optional, &[]), "JobAnomaly TooLong");
    assert_eq!(judged(optional, &[object]), "JobOk");
    assert_eq!(judged(FREE, &[object]), "JobAnomaly TooLong");
}

#[test]
fn a_release_at_the_end_may_be_missing() {
    let without = [&measure()[..2], &[idle(40)]].concat();
    let right = [&polish(6)[..], &without].concat();
    let verdicts = judged(&job(&[FREE, AFTER_POLISHING, FREE]), &stream(&right, &lift()));
    assert_eq!(short(&job_of(&verdicts)), "JobOk");
}

#[test]
fn an_order_that_may_have_been_kept_unseen_accuses_nobody() {
    let after_lifting = Law { after_end: ActivitySet::of(2), ..FREE };
    let job = job(&[FREE, after_lifting, FREE]);
    let right = [&polish(6)[..], &[idle(100)], &measure()].concat();
    let left = after(150, &lift());
    let (from, to) = (100, 340);
    let mut couples = stream(&right, &left);
    for (index, couples) in couples.iter_mut().enumerate().filter(|(index, _)| (from..to).contains(index)) {
        // The left hand is seen again while the right one measures already.
        let visibility = couples.hands[1].visibility;
        couples.hands[1] = andon_core::couple::Couple::idle(couples.hands[1].side, couples.captured_ns);
        couples.hands[1].visibility = if index == from { visibility } else { couples.hands[1].visibility };
    }
    let verdicts = judged(&job, &couples);
    assert!(verdicts.iter().all(|verdict| verdict.outcome != Outcome::Anomaly), "{verdicts:#?}");
}

#[test]
fn what_a_hand_is_in_the_middle_of_has_begun_although_a_part_of_it_was_not_judged() {
    let hold = [part([2, 6, 0, 0], 60, Still), part([2, 6, 6, 5], 96, Still), part([2, 6, 0, 0], 90, Still)];
    let laws = [FREE, AFTER_POLISHING];
    let job = Job { laws: &laws, ..teach(&[&hold, &polish(6)]) };
    let [carry, work, back] = hold;
    let unseen = |context| Part { context, frames: 8, sighted: false, ..carry };
    let seen = Part { frames: 40, ..work };
    let goes_on = [carry, seen, unseen(carry.context), Part { frames: 30, ..work }, back, idle(20)];
    // The hand goes away, and the two parts seem to stay together because one of them is hidden.
    let lets_go = [carry, seen, Part { frames: 60, ..unseen([0, 0, 6, 5]) }, idle(20)];
    for left in [&goes_on[..], &lets_go] {
        let verdicts = judged(&job, &stream(&after(180, &polish(6)), &after(40, left)));
        assert_eq!(activity(&verdicts, 0).outcome, Outcome::NotJudged);
        assert!(verdicts.iter().all(|verdict| verdict.outcome != Outcome::Anomaly), "{verdicts:?}");
    }
}

/// Lifting has this law, and the first IU of each activity is told only when its part has moved.
fn job_of_parts_that_move(law: Law) -> Job<'static> {
    let moves = |nominal: &NominalActivity<'static>| {
        let mut ius = nominal.ius.to_vec();
        ius[0].measures.path_m.min = 0.1;
        NominalActivity { ius: ius.leak(), ..*nominal }
    };
    let job = job(&[FREE, AFTER_POLISHING, law]);
    Job { activities: job.activities.iter().map(moves).collect::<Vec<_>>().leak(), ..job }
}

/// A hand that has touched its part first is first, although it is not said so before the part moves. Where both begin at once it may have been
/// either, and yet neither can have ended before the other began.
#[test]
fn what_begins_after_the_first_touch_has_not_begun_before_it() {
    let said = |law, wait: usize| {
        let lifting = [&[part([2, 4, 0, 0], 20, Still)][..], &lift()].concat();
        let job = job_of_parts_that_move(law);
        let verdicts = judged(&job, &stream(&after(wait, &in_a_row()), &lifting));
        (short(&job_of(&verdicts)), job_of(&verdicts).broken.map(|broken| broken.fault))
    };
    let not_begun = || ("JobAnomaly WrongOrder".into(), Some(OrderFault::NotBegun));
    assert_eq!(said(AFTER_POLISHING, 12), not_begun(), "before the part moves");
    let after_its_end = Law { after_end: ActivitySet::of(0), ..FREE };
    assert_eq!(said(AFTER_POLISHING, 0).1, None, "in one frame");
    assert_eq!(said(after_its_end, 0).1, Some(OrderFault::NotEnded), "in one frame");
    for both_at_once in 1..5 {
        assert_eq!(said(AFTER_POLISHING, both_at_once).1, None, "{both_at_once}");
        assert_eq!(said(after_its_end, both_at_once), not_begun(), "{both_at_once}");
    }
}

#[test]
fn a_job_begins_with_the_step_of_one_hand_although_the_other_one_touched_its_part_before_and_let_go() {
    let frames = |parts: &[Part]| parts.iter().map(|part| part.frames).sum::<usize>();
    for wait in [1, 10, 19] {
        let work = after(wait, &polish(6));
        let touch = [part([2, 4, 0, 0], 20, Still), idle(frames(&work) - 20)];
        let verdicts = judged(&job_of_parts_that_move(FREE), &stream(&work, &touch));
        let job = job_of(&verdicts);
        assert_eq!((short(&job).as_str(), job.nearest), ("JobAnomaly NotCompleted", Some(1)), "{wait}");
    }
}
