//! What is said of work that a hand did which was not seen.

use crate::common::script::{Part, idle, objects_of, short, stream, teach};
use crate::common::work::{away, bring, jobs, judged, measure, polish, polish_and_measure};
use andon_core::couple::Unseen;
use andon_core::set::ActivitySet;
use andon_core::verdict::{Level, Outcome};

/// The verdicts on pieces of which a part is brought to the table and back. Of the second piece only the way back is seen. While the hand is not
/// seen before that, the part may move.
fn second_half_after(is_carried_unseen: bool) -> Vec<String> {
    let whole = [bring(3, 2, 1), bring(2, 3, 5)].concat();
    let job = teach(&[&whole]);
    let frames: usize = whole.iter().map(|part| part.frames).sum();
    let pieces = [&whole[..], &[idle(30), away(70), idle(90)], &bring(2, 3, 5)].concat();
    let mut couples = stream(&pieces, &[]);
    for couples in &mut couples[frames + 50..frames + 80] {
        couples.unseen |= Unseen::CARRIER.when(is_carried_unseen);
    }
    judged(&job, &couples).iter().map(short).filter(|verdict| !verdict.starts_with('r')).collect()
}

#[test]
fn what_was_carried_unseen_before_the_first_touch_may_be_the_beginning_of_the_next_piece() {
    assert_eq!(second_half_after(true), ["JobOk", "NotJudged HandNotSeen"]);
    assert_eq!(second_half_after(false), ["JobOk", "JobAnomaly WrongOrder"]);
}

#[test]
fn what_was_carried_unseen_before_a_pause_ends_a_job_may_go_on_after_it() {
    let (to_table, back) = (bring(3, 2, 1), bring(2, 3, 5));
    let job = teach(&[&[to_table, back].concat()]);
    let mut couples = stream(&[&to_table[..2], &[away(200), idle(60)], &back].concat(), &[]);
    for couples in &mut couples[60..90] {
        couples.unseen |= Unseen::CARRIER | Unseen::MOVER;
    }
    let verdicts = judged(&job, &couples);
    assert!(verdicts.iter().all(|verdict| verdict.outcome != Outcome::Anomaly), "{verdicts:?}");
}

#[test]
fn a_piece_of_which_no_hand_was_seen_is_not_judged() {
    let job = polish_and_measure();
    let mut couples = stream(&[away(300)], &[]);
    couples[30..120].iter_mut().for_each(|couples| couples.unseen |= Unseen::CARRIER);
    let said = jobs(&job, &couples);
    assert_eq!(said, ["began in frame 30", "NotJudged HandNotSeen"]);
    assert_eq!(jobs(&job, &couples[..150]), said, "the recording ends");
    couples.iter_mut().for_each(|couples| couples.at_start = objects_of(ActivitySet::first(2)));
    assert_eq!(jobs(&job, &couples), said, "what lies where it lay may have been brought back");
    // The next piece comes at once.
    let mut couples = stream(&[&[away(100)][..], &polish(6), &measure()].concat(), &[]);
    couples[30..95].iter_mut().for_each(|couples| couples.unseen |= Unseen::CARRIER);
    assert_eq!(jobs(&job, &couples), ["began in frame 100", "NotJudged HandNotSeen", "JobOk"]);
}

#[test]
fn an_activity_that_must_have_ended_unseen_swallows_no_other_piece() {
    let halves = [bring(3, 2, 1), bring(2, 3, 5)];
    let job = teach(&[&halves
        .map(|half| half.map(|part| if part.context == [0; 4] { idle(1) } else { part }))
        .concat()]);
    // A hand that has let go is never idle: what it left there lies there until it comes back.
    let [to_table, back] = halves.map(|half| half[..4].to_vec());
    let hidden = Part { seen: false, frames: 100, ..to_table[3] };
    let mut couples = stream(&[&to_table[..], &[hidden], &to_table, &back, &to_table, &back].concat(), &[]);
    for couples in &mut couples {
        couples.hands[1].unseen = couples.hands[1].unseen.without(Unseen::CONTEXT);
    }
    let verdicts = judged(&job, &couples);
    let verdicts: Vec<_> = verdicts.iter().map(short).filter(|verdict| !verdict.starts_with('r')).collect();
    assert!(verdicts.iter().all(|verdict| !verdict.contains("Anomaly")), "{verdicts:?}");
    assert_eq!(verdicts.last().unwrap(), "JobOk", "{verdicts:?}");
}

/// The brick is seen only for the last strokes, of which there are too few.
#[test]
fn what_a_hand_already_holds_may_have_been_at_a_part_before_that_was_first_seen() {
    let [grasp, stroke, carry, end] = polish(6);
    let said = |is_object_new: bool| {
        let hidden = Part { context: [1, 5, 0, 0], frames: 66, ..stroke };
        let seen = Part { frames: 30, ..stroke };
        let mut couples = stream(&[grasp, hidden, seen, carry, end], &[]);
        for couple in couples.iter_mut().map(|couples| &mut couples.hands[0]) {
            couple.unseen |= Unseen::ARRIVAL.when(is_object_new && couple.context.is_pair());
        }
        judged(&polish_and_measure(), &couples).iter().map(short).collect::<Vec<_>>()
    };
    assert!(said(false).iter().any(|verdict| verdict.contains("Anomaly TooShort")), "{:?}", said(false));
    assert!(!said(true).iter().any(|verdict| verdict.contains("TooShort")), "{:?}", said(true));
}

#[test]
fn a_job_is_not_right_with_what_may_belong_to_the_next_piece() {
    let job = polish_and_measure();
    let first: usize = polish(6).iter().map(|part| part.frames).sum();
    let said = |undone: ActivitySet, is_seen: bool| -> String {
        let mut couples = stream(&[&polish(6)[..], &[idle(90)], &measure()].concat(), &[]);
        // Something that lay on the bench at first does not any more, so it is not set as it was.
        couples[..2].iter_mut().for_each(|couples| couples.at_start = objects_of(ActivitySet::first(2)));
        couples[first + 80..].iter_mut().for_each(|couples| couples.at_start = objects_of(undone));
        // For less time than anybody needs to end the piece and to begin another one.
        if !is_seen {
            couples.drain(first + 5..first + 35);
        }
        let verdicts = judged(&job, &couples);
        short(verdicts.iter().find(|verdict| verdict.level == Level::Job).unwrap())
    };
    // What was polished lies where it lay before, so it may be the next piece that is measured.
    assert_eq!(said(ActivitySet::of(0), false), "NotJudged FramesMissing");
    assert_eq!(said(ActivitySet::EMPTY, false), "JobOk");
    assert_eq!(said(ActivitySet::of(0), true), "JobOk", "it was only put back");
}
