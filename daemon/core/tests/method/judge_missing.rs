//! What is said where couples are missing, and where a part was never seen.

use crate::common::script::{idle, objects_of, short, stream};
use crate::common::work::{IN_ORDER, away, judged, measure, polish, polish_and_measure};
use andon_core::couple::{Context, Couple, Couples, Unseen, Visibility};
use andon_core::job::Job;
use andon_core::set::ActivitySet;
use andon_core::verdict::{Level, Outcome, Verdict};

#[test]
fn couples_that_are_missing_accuse_nobody() {
    let job = polish_and_measure();
    let whole = stream(&[polish(6), measure()].concat(), &[]);
    for first in (5..whole.len() - 60).step_by(5) {
        for missing in [6, 15, 40] {
            let mut left = whole.clone();
            left.drain(first..first + missing);
            let verdicts = judged(&job, &left);
            let accused = verdicts.iter().find(|verdict| verdict.outcome == Outcome::Anomaly);
            assert_eq!(accused, None, "without {missing} from {first}");
        }
    }
}

/// Whether hand and part move together is read from a few frames around each. So one that is missing may let a contact seem to end later.
#[test]
fn a_step_is_not_too_short_where_a_frame_shortly_before_it_was_missing() {
    let before: usize = polish(6).iter().map(|part| part.frames).sum();
    let is_accused = |frames: usize, missing: Option<usize>| {
        let mut parts = measure();
        parts[1].frames = frames;
        let begins = before + parts[0].frames;
        let mut couples = stream(&[polish(6), parts].concat(), &[]);
        if let Some(missing) = missing {
            let hand = &mut couples[begins - missing].hands[0];
            hand.visibility[0] = Visibility::Assumed;
            hand.unseen |= Unseen::CONTEXT;
        }
        judged(&polish_and_measure(), &couples).iter().any(|verdict| verdict.outcome == Outcome::Anomaly)
    };
    let too_short = (1..measure()[1].frames).rev().find(|frames| is_accused(*frames, None)).unwrap();
    assert_eq!([1, 2, 3].map(|missing| is_accused(too_short, Some(missing))), [false; 3]);
    assert!(is_accused(too_short, Some(20)), "long before it nothing is read from the frame");
}

/// What the judge says where the encoder starts again after this many couples. It does not see at once what a hand holds.
fn with_a_restart(job: &Job<'_>, whole: &[Couples], first: usize) -> Vec<Verdict> {
    let mut left = whole.to_vec();
    left.drain(first..first + 6);
    for couples in &mut left[first..first + 8] {
        couples.hands = couples.hands.map(|hand| Couple::idle(hand.side, hand.captured_ns));
        couples
            .hands
            .iter_mut()
            .for_each(|hand| (hand.visibility[0], hand.unseen) = (Visibility::Seen, Unseen::CHANGE));
    }
    judged(job, &left)
}

#[test]
fn an_encoder_that_starts_again_accuses_nobody() {
    let whole = stream(&[polish(6), measure(), polish(6), measure()].concat(), &[]);
    for job in [polish_and_measure(), Job { laws: &IN_ORDER, ..polish_and_measure() }] {
        for first in 5..whole.len() - 60 {
            let verdicts = with_a_restart(&job, &whole, first);
            let accused = verdicts.iter().find(|verdict| verdict.outcome == Outcome::Anomaly);
            assert_eq!(accused, None, "from {first}");
        }
    }
}

#[test]
fn an_encoder_that_starts_again_knows_only_the_parts_that_it_sees() {
    let job = polish_and_measure();
    let mut whole = stream(&[polish(6), measure()].concat(), &[]);
    let (first, end) = (170, whole.len() - 15);
    // The meter is hidden until the brick has been measured.
    for couples in &mut whole[first..end] {
        couples.out_of_sight = objects_of(ActivitySet::of(1));
        let context = &mut couples.hands[0].context;
        *context =
            if context.is_release() { Context::IDLE } else { Context([context.0[0], context.0[1], 0, 0]) };
    }
    let outcomes = |couples: &[Couples]| -> Vec<Outcome> {
        judged(&job, couples)
            .iter()
            .filter(|verdict| verdict.level == Level::Job)
            .map(|verdict| verdict.outcome)
            .collect()
    };
    assert_eq!(outcomes(&whole), [Outcome::Anomaly], "it was seen before");
    whole.drain(first..first + 6);
    assert_eq!(outcomes(&whole), [Outcome::NotJudged]);
}

/// A hand may have used what was hidden before the encoder started again and is hidden still.
#[test]
fn a_pause_shows_no_start_while_an_encoder_that_starts_again_has_not_seen_what_was_hidden_before() {
    let said = |is_hidden: bool, is_out_of_sight: bool| {
        let mut couples = stream(&[&[away(300)][..], &measure(), &[idle(20)]].concat(), &[]);
        couples[20..66].iter_mut().for_each(|couples| couples.unseen |= Unseen::BENCH.when(is_hidden));
        for couples in &mut couples[66..299] {
            couples.out_of_sight = objects_of(ActivitySet::first(is_out_of_sight.into()));
        }
        couples.drain(60..66);
        short(judged(&polish_and_measure(), &couples).last().unwrap())
    };
    assert_eq!(said(false, false), "JobAnomaly NotCompleted");
    assert_eq!(said(true, false), "JobAnomaly NotCompleted", "all was in sight for 8 s");
    for is_hidden in [true, false] {
        assert!(said(is_hidden, true).starts_with("NotJudged"), "{is_hidden}");
    }
}

#[test]
fn what_lies_where_it_lay_after_couples_were_missing_for_long_may_be_that_of_the_next_piece() {
    let job = polish_and_measure();
    let mut couples = stream(&[polish(6), measure(), polish(6)].concat(), &[]);
    let frames: usize = polish(6).iter().map(|part| part.frames).sum();
    let next = couples.len() - frames;
    // The brick lies where it lay until it is measured, and so does that of the next piece.
    couples.iter_mut().for_each(|couples| couples.at_start = objects_of(ActivitySet::of(1)));
    for couples in &mut couples[next - 10..next] {
        couples.at_start = objects_of(ActivitySet::first(2));
    }
    couples.drain(frames - 15..next - 8);
    let verdicts = judged(&job, &couples);
    let first = verdicts.iter().find(|verdict| verdict.level == Level::Job).unwrap();
    assert_eq!(first.outcome, Outcome::NotJudged, "it may have been measured unseen");
}

#[test]
fn what_uses_a_part_that_was_never_seen_accuses_nobody_and_what_does_not_is_still_found() {
    let job = polish_and_measure();
    // The tool comes away from where it was used too soon.
    let mut wrong = [polish(6), measure()].concat();
    wrong.truncate(1);
    wrong.push(idle(40));
    let outcome = |out_of_sight: ActivitySet| {
        let mut couples = stream(&wrong, &[]);
        couples.iter_mut().for_each(|couples| couples.out_of_sight = objects_of(out_of_sight));
        judged(&job, &couples).last().unwrap().outcome
    };
    assert_eq!(outcome(ActivitySet::EMPTY), Outcome::Anomaly);
    assert_eq!(outcome(ActivitySet::of(0)), Outcome::NotJudged);
    // One frame that shows it is enough.
    let mut couples = stream(&wrong, &[]);
    couples[10..].iter_mut().for_each(|couples| couples.out_of_sight = objects_of(ActivitySet::of(0)));
    assert_eq!(judged(&job, &couples).last().unwrap().outcome, Outcome::Anomaly);
}
