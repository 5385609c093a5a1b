//! What is said where couples are missing, and where a part was never seen.
#![allow(clippy::unwrap_used)]

mod common;

use andon_core::set::ActivitySet;
use andon_core::verdict::Outcome;
use common::script::{idle, stream};
use common::work::{judged, measure, polish, polish_and_measure};

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

#[test]
fn what_uses_a_part_that_was_never_seen_accuses_nobody_and_what_does_not_is_still_found() {
    let job = polish_and_measure();
    // The tool comes away from where it was used too soon.
    let mut wrong = [polish(6), measure()].concat();
    wrong.truncate(1);
    wrong.push(idle(40));
    let outcome = |out_of_sight: ActivitySet| {
        let mut couples = stream(&wrong, &[]);
        couples.iter_mut().for_each(|couples| couples.out_of_sight = out_of_sight);
        judged(&job, &couples).last().unwrap().outcome
    };
    assert_eq!(outcome(ActivitySet::EMPTY), Outcome::Anomaly);
    assert_eq!(outcome(ActivitySet::of(0)), Outcome::NotJudged);
    // One frame that shows it is enough.
    let mut couples = stream(&wrong, &[]);
    couples[10..].iter_mut().for_each(|couples| couples.out_of_sight = ActivitySet::of(0));
    assert_eq!(judged(&job, &couples).last().unwrap().outcome, Outcome::Anomaly);
}
