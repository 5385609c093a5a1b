//! Two pieces are never one: what may have been done in the time that nobody watched, and how often a piece gets a verdict.

use crate::common::script::{Part, Still, Toward, idle, part, short, stream, teach};
use crate::common::work::{IN_ORDER, away, judged, measure, polish, polish_and_measure};
use andon_core::couple::{Couples, Unseen, Visibility};
use andon_core::input::Side;
use andon_core::job::{Job, Law};
use andon_core::verdict::{Level, Outcome};

/// These parts, of which nothing is seen in some frames: what a hand did before them, it does not.
fn unwatched(parts: &[Part], hidden: core::ops::Range<usize>) -> Vec<Couples> {
    let mut couples = stream(parts, &[]);
    for couples in &mut couples[hidden] {
        couples.unseen |= Unseen::FRAME | Unseen::BENCH;
        for couple in &mut couples.hands {
            couple.visibility[0] = Visibility::Unseen;
            couple.unseen |= Unseen::FRAME | Unseen::CONTEXT | Unseen::CHANGE;
        }
    }
    couples
}

/// The verdicts on jobs where the polisher was put down, nobody watched for as many frames, and the brick is measured.
fn measured_after(frames: usize, job: &Job<'_>) -> Vec<String> {
    let polished: usize = polish(6).iter().map(|part| part.frames).sum();
    let parts = [&polish(6)[..], &[away(frames)], &measure()].concat();
    let verdicts = judged(job, &unwatched(&parts, polished..polished + frames));
    verdicts.iter().filter(|verdict| verdict.level == Level::Job).map(short).collect()
}

/// The fewest frames after which the job is not right any more.
fn needed(job: &Job<'_>) -> usize {
    let needed = (1..400).find(|frames| measured_after(*frames, job) != ["JobOk"]).unwrap();
    for frames in [needed, needed + 1, 399, 5000] {
        assert_eq!(measured_after(frames, job), ["NotJudged FramesMissing"], "{frames} frames");
    }
    needed
}

#[test]
fn no_job_is_right_over_a_time_in_which_the_quickest_end_the_piece() {
    let any_order = polish_and_measure();
    let measuring = any_order.activities[1].ius.iter().filter(|iu| iu.context.is_touch());
    let shown = measuring.map(|iu| iu.reference.len()).sum::<usize>();
    // The piece is measured, and another one begins with its measuring. Where there is an order, that is wrong.
    for job in [&any_order, &Job { laws: &IN_ORDER, ..any_order }] {
        let needed = needed(job);
        assert!((shown * 5 / 10..=shown * 7 / 10).contains(&needed), "{needed}");
    }
}

#[test]
fn a_job_that_begins_with_what_may_come_last_is_not_right_if_nobody_watched_before_it() {
    let job = polish_and_measure();
    assert_eq!(job.laws, [] as [Law; 0], "any order");
    let pieces = [&polish(6)[..], &measure(), &[away(200)], &measure(), &polish(6), &[idle(20)]].concat();
    let begun: usize = [polish(6), measure()].concat().iter().map(|part| part.frames).sum();
    let jobs = |hidden: usize| -> Vec<String> {
        let verdicts = judged(&job, &unwatched(&pieces, begun..begun + hidden));
        verdicts.iter().filter(|verdict| verdict.level == Level::Job).map(short).collect()
    };
    assert_eq!(jobs(9), ["JobOk", "JobOk"]);
    let unwatched = jobs(200);
    assert_eq!(unwatched[0], "JobOk");
    // The polishing may be that of the piece after the one that was measured.
    assert!(unwatched[1..].iter().all(|job| job.starts_with("NotJudged")), "{unwatched:?}");
}

#[test]
fn a_hand_that_keeps_its_part_while_the_other_one_begins_the_next_piece_is_still_at_it() {
    let hold = [
        part([2, 7, 0, 0], 30, Toward(3)),
        part([2, 7, 7, 3], 40, Still),
        part([0, 0, 7, 3], 20, Still),
        idle(20),
    ];
    let turn = [part([2, 8, 0, 0], 30, Toward(3)), part([2, 8, 8, 3], 40, Still), idle(20)];
    let job = teach(&[&polish(6), &hold, &turn]);
    // The left hand breaks off, and the right one is at the same step again when the left one begins what it has done already.
    let right = [&polish(6)[..], &[idle(20)], &polish(6)].concat();
    let again = right[..6].iter().map(|part| part.frames).sum::<usize>();
    let begun = hold.iter().map(|part| part.frames).sum::<usize>() + turn[0].frames;
    for shift in 0..=10 {
        let rest = idle(again + shift - 5 - begun);
        let left = [&hold[..], &turn[..1], &[rest], &hold].concat();
        let verdicts = judged(&job, &stream(&right, &left));
        let of_right = verdicts.iter().filter(|verdict| verdict.side == Some(Side::Right));
        let wrong: Vec<String> =
            of_right.filter(|verdict| verdict.outcome == Outcome::Anomaly).map(short).collect();
        assert_eq!(wrong, [""; 0], "{} frames after its next IU has begun", shift as i64 - 5);
    }
}

#[test]
fn a_hand_that_is_never_seen_gets_one_verdict_for_all_that_it_carries() {
    let parts = [&polish(6)[..], &measure(), &[away(900)]].concat();
    let mut couples = stream(&parts, &[]);
    let carried = couples.len() - 700;
    couples[carried..carried + 400].iter_mut().for_each(|couples| couples.unseen |= Unseen::CARRIER);
    let verdicts = judged(&polish_and_measure(), &couples);
    let jobs: Vec<String> =
        verdicts.iter().filter(|verdict| verdict.level == Level::Job).map(short).collect();
    assert_eq!(jobs, ["JobOk", "NotJudged HandNotSeen"]);
}
