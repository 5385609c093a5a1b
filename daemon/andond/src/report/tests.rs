//! What people read of each kind of verdict, word for word.
#![allow(clippy::unwrap_used)]

use andon_core::couple::Context;
use andon_core::input::Side;
use andon_core::verdict::{
    BrokenOrder, Level, Measure, Measured, Missing, Note, OrderFault, Outcome, Reason, Verdict,
};

use super::sample::{names, wrong};
use super::*;

fn strokes(value: f32) -> Option<Measured> {
    Some(Measured { measure: Measure::Strokes, value, shown_min: 6.0, shown_max: 6.0 })
}

#[track_caller]
fn reads(verdict: Verdict, expected: &str) {
    assert_eq!(verdict_sentence(&verdict, &names()), expected);
}

#[test]
fn another_part_is_told_with_the_one_that_was_expected() {
    let first = Verdict { iu: Some(0), context: Context([1, 6, 0, 0]), ..wrong(Reason::WrongObject) };
    reads(first, "right  ANOMALY     step 1 IU 1: took the brick; expected the polisher");
    let at = Verdict { context: Context([1, 5, 5, 3]), ..wrong(Reason::WrongObject) };
    reads(at, "right  ANOMALY     step 1 IU 2: the polisher at the meter; expected at the brick");
    let unknown = Verdict { iu: Some(0), context: Context([1, 9, 0, 0]), ..wrong(Reason::WrongObject) };
    reads(unknown, "right  ANOMALY     step 1 IU 1: took object 9; expected the polisher");
    let too_many = Verdict { iu: Some(7), ..wrong(Reason::WrongOrder) };
    reads(too_many, "right  ANOMALY     step 1 IU 8: polisher at brick; expected the end of step 1 (polish)");
    let put_down = Verdict { context: Context([1, 5, 0, 0]), ..wrong(Reason::WrongOrder) };
    reads(put_down, "right  ANOMALY     step 1 IU 2: polisher in hand; expected polisher at brick");
}

#[test]
fn the_other_hand_is_told_with_the_one_that_was_shown() {
    let left =
        Verdict { side: Some(Side::Left), context: Context([2, 5, 5, 6]), ..wrong(Reason::WrongObject) };
    reads(left, "left   ANOMALY     step 1 IU 2: polisher at brick, left hand; shown with the right");
    let noted = Verdict {
        level: Level::Activity,
        outcome: Outcome::Ok,
        side: Some(Side::Left),
        note: Some(Note::OtherHand),
        iu: None,
        ..wrong(Reason::None)
    };
    reads(noted, "left   ok          step 1 (polish): left hand, shown with the right; was it right?");
}

#[test]
fn what_was_not_judged_is_told_by_what_was_missing_and_how_much_of_it() {
    let missing = Missing::default();
    let says = |reason: Reason, missing: Missing, expected: &str| {
        let unseen =
            Verdict { level: Level::Activity, outcome: Outcome::NotJudged, missing, ..wrong(reason) };
        reads(unseen, &format!("right  NOT JUDGED  step 1 (polish): {expected}"));
    };
    let hand = Missing { hand: Some(Side::Left), seconds: Some(2.04), ..missing };
    says(Reason::HandNotSeen, hand, "the left hand was not seen for 2.0 s");
    says(Reason::HandNotSeen, missing, "parts moved and no hand was seen at them");
    says(Reason::ObjectNotSeen, Missing { object: Some(6), ..missing }, "the brick was not seen");
    says(
        Reason::FramesMissing,
        Missing { seconds: Some(1.3), ..missing },
        "no frame that shows the bench came for 1.3 s",
    );
    let few = |captured, needed| Missing {
        captured_percent: Some(captured),
        needed_percent: Some(needed),
        ..missing
    };
    says(Reason::TooFewFrames, few(20, 25), "only 20 of 100 frames came, and the job needs 25");
    says(Reason::TooFewFrames, few(50, 25), "only 50 of 100 frames came, too few to be sure");
    says(Reason::BeginningNotSeen, missing, "its beginning was not seen");
    says(Reason::BrokenOff, missing, "it was not watched to its end");
    says(Reason::Overload, missing, "it lasted longer than can be compared");
    says(Reason::MarkerTwice, Missing { object: Some(6), ..missing }, "marker 6 (brick) is in view twice");
    says(Reason::Passing, missing, "it cannot be told whether its parts touched");
    says(Reason::Blind, missing, "too little of it was seen");
}

#[test]
fn a_measure_is_told_with_its_unit_and_what_was_shown() {
    let short = Verdict { measured: strokes(3.0), ..wrong(Reason::TooShort) };
    reads(short, "right  ANOMALY     step 1 IU 2: polisher at brick: 3 strokes, shown 6");
    assert_eq!(names().fault(&short).as_deref(), Some("step 1 (polish): too few strokes"));
    let missing = Missing { object: Some(6), seconds: Some(1.4), ..Missing::default() };
    let unseen = Verdict { outcome: Outcome::NotJudged, reason: Reason::ObjectNotSeen, missing, ..short };
    reads(
        unseen,
        "right  NOT JUDGED  step 1 IU 2: polisher at brick: the brick was not seen for 1.4 s; \
         measured: 3 strokes, shown 6",
    );
}

#[test]
fn a_motion_and_an_order_are_told_against_what_was_shown() {
    let motion = Verdict { distance: Some(3.5), threshold: Some(2.25), ..wrong(Reason::Motion) };
    reads(
        motion,
        "right  ANOMALY     step 1 IU 2: polisher at brick: the motion differs from what was shown (distance 3.50, at most 2.25)",
    );
    let broken = |fault| Some(BrokenOrder { fault, activity: 0, runs: 5 });
    let order = |level, fault| Verdict {
        level,
        nearest: Some(1),
        iu: None,
        broken: broken(fault),
        ..wrong(Reason::WrongOrder)
    };
    reads(
        order(Level::Activity, OrderFault::NotBegun),
        "right  ANOMALY     step 2 (measure): came before step 1 (polish); shown after it in all 5 runs",
    );
    reads(
        order(Level::Activity, OrderFault::NotEnded),
        "right  ANOMALY     step 2 (measure): began before step 1 (polish) had ended; shown after its end in all 5 runs",
    );
    reads(
        Verdict { side: None, ..order(Level::Job, OrderFault::NotBegun) },
        "       ANOMALY     job: step 2 (measure) came before step 1 (polish); shown after it in all 5 runs",
    );
    reads(
        Verdict { nearest: Some(0), ..order(Level::Activity, OrderFault::Again) },
        "right  ANOMALY     step 1 (polish): done again; shown once in all 5 runs",
    );
    let ended =
        Verdict { level: Level::Job, nearest: Some(1), side: None, iu: None, ..wrong(Reason::NotCompleted) };
    reads(ended, "       ANOMALY     job: ended without step 2 (measure)");
}

#[test]
fn what_is_right_is_told_in_few_words() {
    let right = Verdict { outcome: Outcome::Ok, early: true, ..wrong(Reason::None) };
    reads(right, "right  ok          step 1 IU 2: polisher at brick");
    reads(Verdict { level: Level::Activity, iu: None, ..right }, "right  ok          step 1 (polish)");
    let job = Verdict { level: Level::Job, iu: None, side: None, nearest: None, ..right };
    reads(job, "       ok          job");
    reads(
        Verdict { note: Some(Note::Again), ..job },
        "       ok          job: a step done again, shown once; was it right?",
    );
    let other = Verdict { nearest: None, context: Context([1, 3, 0, 0]), ..right };
    reads(other, "right  ok          other step IU 2: meter in hand");
}

#[test]
fn a_fault_is_one_line_and_what_follows_from_it_stands_indented_beneath() {
    let fault = Verdict { measured: strokes(3.0), ..wrong(Reason::TooShort) };
    let step = Verdict { level: Level::Activity, iu: None, ..fault };
    let job = Verdict { level: Level::Job, side: None, ..step };
    let right = Verdict { nearest: Some(1), outcome: Outcome::Ok, measured: None, ..wrong(Reason::None) };
    let told = |verdicts: &[(&str, Verdict)]| -> Vec<String> {
        let mut teller = Teller::default();
        verdicts.iter().map(|(when, verdict)| teller.tell(when, verdict, &names()).text).collect()
    };
    assert_eq!(
        told(&[
            ("14:03:07", fault),
            ("14:03:07", step),
            ("14:03:09", right),
            ("14:03:12", job),
            ("14:03:20", job)
        ]),
        [
            "14:03:07  right  ANOMALY     step 1 IU 2: polisher at brick: 3 strokes, shown 6",
            "                               so step 1 (polish) is wrong",
            "14:03:09  right  ok          step 2 IU 2: polisher at brick",
            "14:03:12         ANOMALY     job, for the fault at 14:03:07: step 1 (polish): 3 strokes, shown 6",
            // The next job has its own faults.
            "14:03:20         ANOMALY     job: step 1 (polish): 3 strokes, shown 6",
        ]
    );
    assert_eq!(
        told(&[("   5.57 s", fault), ("   5.57 s", step), ("   5.57 s", job)])[1..],
        [
            "                                so step 1 (polish) is wrong",
            "                                so the job is wrong"
        ]
    );
}

/// Only the verdict on the IU knows which parts were meant.
#[test]
fn a_job_that_ends_after_another_part_was_taken_tells_both_again() {
    let taken = Verdict { iu: Some(0), context: Context([1, 6, 0, 0]), ..wrong(Reason::WrongObject) };
    let job = Verdict { level: Level::Job, iu: None, side: None, context: Context([0; 4]), ..taken };
    let mut teller = Teller::default();
    teller.tell("14:03:07", &taken, &names());
    assert_eq!(
        teller.tell("14:03:09", &job, &names()).text,
        "14:03:09         ANOMALY     job, for the fault at 14:03:07: step 1 (polish): took the brick; expected the polisher"
    );
    reads(job, "       ANOMALY     job: step 1 (polish): wrong part used");
}

/// The meter is used instead of the polisher.
#[test]
fn a_part_that_was_taken_instead_of_another_is_told_with_the_step_that_was_missed_for_it() {
    let ok = Verdict { outcome: Outcome::Ok, ..wrong(Reason::None) };
    let activity = Verdict { level: Level::Activity, iu: None, ..ok };
    let other = |part| Verdict {
        nearest: None,
        note: Some(Note::Step),
        context: Context([1, part, 0, 0]),
        ..activity
    };
    let broken = Some(BrokenOrder { fault: OrderFault::NotBegun, activity: 0, runs: 5 });
    let early = Verdict {
        outcome: Outcome::Anomaly,
        reason: Reason::WrongOrder,
        nearest: Some(1),
        broken,
        ..activity
    };
    let job = Verdict { level: Level::Job, side: None, ..early };
    let told = |verdicts: &[(&str, Verdict)]| -> Vec<String> {
        let mut teller = Teller::default();
        verdicts.iter().map(|(when, verdict)| teller.tell(when, verdict, &names()).text).collect()
    };
    let noted = "14:03:01  right  ok          other step (meter in hand): took the meter, and step 1 (polish) begins with the polisher; \
                 was it right?";
    assert_eq!(
        told(&[
            ("14:03:01", other(3)),
            ("14:03:07", early),
            ("14:03:09", Verdict { note: Some(Note::Step), ..job })
        ]),
        [
            noted,
            "14:03:07  right  ANOMALY     step 2 (measure): came before step 1 (polish); shown after it in all 5 runs; took the meter at \
             14:03:01, expected the polisher",
            "14:03:09         ANOMALY     job, for the fault at 14:03:07: step 2 (measure) came before step 1 (polish); shown after it in \
             all 5 runs; took the meter at 14:03:01, expected the polisher",
        ]
    );
    let ended = Verdict { reason: Reason::NotCompleted, nearest: Some(0), broken: None, ..job };
    assert_eq!(
        told(&[("14:03:01", other(3)), ("14:03:09", ended)]),
        [
            noted,
            "14:03:09         ANOMALY     job: ended without step 1 (polish); took the meter at 14:03:01, expected the polisher"
        ]
    );
    let unknown = Verdict { outcome: Outcome::NotJudged, reason: Reason::BeginningNotSeen, ..ended };
    assert_eq!(
        told(&[("14:03:01", other(3)), ("14:03:09", unknown)])[1],
        "14:03:09         NOT JUDGED  job: step 1 (polish): its beginning was not seen; took the meter at 14:03:01, expected the polisher"
    );
    // It is not known that one step was missed for another.
    let second = Verdict { nearest: Some(1), ..ended };
    assert_eq!(
        told(&[("14:03:01", other(3)), ("14:03:09", second)])[1],
        "14:03:09         ANOMALY     job: ended without step 2 (measure)"
    );
    assert_eq!(
        told(&[("14:03:01", other(5))]),
        [
            "14:03:01  right  ok          other step (polisher in hand): a step that was not shown, with parts of the job; was it right? \
          Next would be step 1 (polish)."
        ]
    );
}

#[test]
fn a_line_has_its_colour_and_a_stream_without_colours_takes_it_away() {
    let line = Teller::default().tell("14:03:07", &wrong(Reason::TooLong), &names());
    let mut coloured = Vec::new();
    line.write(&mut coloured).unwrap();
    assert!(coloured.starts_with(b"\x1b[31m14:03:07") && coloured.ends_with(b"\x1b[0m\n"));
    let mut plain = anstream::StripStream::new(Vec::new());
    line.write(&mut plain).unwrap();
    assert_eq!(String::from_utf8(plain.into_inner()).unwrap(), format!("{}\n", line.text));
}
