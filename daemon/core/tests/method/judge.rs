//! The verdicts on what a scripted worker does.

use crate::common::bench::PERIOD_NS;
use crate::common::script::{Part, Still, Strokes, Toward, idle, part, short, stream, teach};
use crate::common::work::{
    IN_ORDER, POLISH_OK, expect, forgiving, judged, measure, polish, polish_and_measure, with_free_ends,
};
use andon_core::anomaly::{Judge, Unusable};
use andon_core::bounds::Bounds;
use andon_core::config::Method;
use andon_core::job::{Job, Law, NominalActivity, NominalIu};
use andon_core::set::ActivitySet;
use andon_core::verdict::{Level, Outcome, Reason, Verdict};

#[test]
fn a_job_done_as_taught_is_right_as_soon_as_it_is_complete() {
    let right = [polish(6), measure()].concat();
    let verdicts = expect(
        &polish_and_measure(),
        &right,
        &[&POLISH_OK[..], &["r1.0 IuOk", "r1.1 IuOk", "r1.2 IuOk!", "r1 ActivityOk!", "JobOk"]].concat(),
    );
    // The job ends in the frame in which the hand lets go of the brick.
    let release = (30 + 96 + 30 + 20 + 30 + 40) * PERIOD_NS;
    let job = verdicts.last().unwrap();
    assert_eq!((job.began_ns, job.ended_ns, job.decided_ns), (0, release, release + 5 * PERIOD_NS));
    assert_eq!(job.activity, 2);
    let stroke = &verdicts[1];
    assert_eq!((stroke.nearest, stroke.threshold, stroke.distance), (Some(0), Some(3.0), Some(0.0)));
    assert_eq!((stroke.began_ns, stroke.ended_ns), (30 * PERIOD_NS, 126 * PERIOD_NS));
}

#[test]
fn polishing_cut_short_is_too_short_although_dtw_forgives_it() {
    let right = [polish(3), measure()].concat();
    let verdicts = expect(
        &forgiving(polish_and_measure()),
        &right,
        &[
            "r0.0 IuOk",
            "r0.1 IuAnomaly TooShort",
            "r0 ActivityAnomaly TooShort!",
            "r0.2 IuOk",
            "r1.0 IuOk",
            "r1.1 IuOk",
            "r1.2 IuOk!",
            "r1 ActivityOk!",
            "JobAnomaly TooShort",
        ],
    );
    assert!(verdicts[1].distance.unwrap() <= verdicts[1].threshold.unwrap());
}

#[test]
fn a_wrong_object_is_an_anomaly_at_its_touch_and_the_following_ius_are_judged_on_their_own() {
    let wrong = polish(6).map(|mut part| {
        part.context = part.context.map(|id| if id == 5 { 9 } else { id });
        part
    });
    let right = [&wrong[..], &measure()].concat();
    let verdicts = expect(
        &polish_and_measure(),
        &right,
        &[
            "r0.0 IuAnomaly WrongObject!",
            "r0 ActivityAnomaly WrongObject!",
            "r0.1 IuAnomaly WrongObject!",
            "r0.2 IuAnomaly WrongObject!",
            "r1.0 IuOk",
            "r1.1 IuOk",
            "r1.2 IuOk!",
            "r1 ActivityOk!",
            "JobAnomaly WrongObject",
        ],
    );
    assert_eq!(verdicts[0].ended_ns, 0);
    assert_eq!(verdicts[0].nearest, None);
}

#[test]
fn the_wrong_order_is_an_anomaly_at_the_first_touch_if_the_order_matters() {
    let right = [measure(), polish(6)].concat();
    let job = Job { laws: &IN_ORDER, ..polish_and_measure() };
    let verdicts = expect(
        &job,
        &right,
        &[
            "r0 ActivityAnomaly WrongOrder!",
            "r0.0 IuOk",
            "r0.1 IuOk",
            "r0.2 IuOk!",
            "r1.0 IuOk",
            "r1.1 IuOk",
            "r1.2 IuOk",
            "r1 ActivityOk!",
            "JobAnomaly WrongOrder",
        ],
    );
    assert_eq!((verdicts[0].nearest, verdicts[0].decided_ns), (Some(1), 5 * PERIOD_NS));
}

#[test]
fn any_order_is_right_if_the_order_does_not_matter() {
    let right = [measure(), polish(6)].concat();
    let verdicts = judged(&polish_and_measure(), &stream(&right, &[]));
    assert_eq!(short(verdicts.last().unwrap()), "JobOk");
}

#[test]
fn a_missing_iu_makes_activity_and_job_incomplete() {
    // The brick is taken, moved a little and put down; it never goes to the meter.
    let right = [&polish(6)[..], &[part([1, 6, 0, 0], 30, Toward(5)), idle(20)]].concat();
    let verdicts = expect(
        &polish_and_measure(),
        &right,
        &[&POLISH_OK[..], &["r1.0 IuOk", "r1 ActivityAnomaly NotCompleted", "JobAnomaly NotCompleted"]]
            .concat(),
    );
    assert_eq!(verdicts[5].nearest, Some(1));
}

#[test]
fn a_missing_activity_makes_the_job_incomplete_and_is_named() {
    let verdicts =
        expect(&polish_and_measure(), &polish(6), &[&POLISH_OK[..], &["JobAnomaly NotCompleted"]].concat());
    assert_eq!(verdicts[4].nearest, Some(1));
}

#[test]
fn an_activity_done_twice_is_an_anomaly_as_soon_as_more_comes_than_its_last_iu_again_if_the_order_matters() {
    let right = [&polish(6)[..], &polish(6), &measure()].concat();
    expect(
        &Job { laws: &IN_ORDER, ..polish_and_measure() },
        &right,
        &[
            &POLISH_OK[..],
            &["r1.0 IuOk", "r1 ActivityAnomaly WrongOrder!", "r1.1 IuOk", "r1.2 IuOk"],
            &["r2.0 IuOk", "r2.1 IuOk", "r2.2 IuOk!", "r2 ActivityOk!", "JobAnomaly WrongOrder"],
        ]
        .concat(),
    );
}

#[test]
fn a_hand_that_takes_again_what_it_has_put_down_and_lets_go_puts_it_right() {
    let again = [part([1, 5, 0, 0], 10, Toward(6)), idle(20)];
    let right = [&polish(6)[..], &again, &measure()].concat();
    let job = Job { laws: &IN_ORDER, ..polish_and_measure() };
    let verdicts = judged(&job, &stream(&right, &[]));
    assert_eq!(short(verdicts.last().unwrap()), "JobOk");
    assert!(verdicts.iter().all(|verdict| verdict.outcome == Outcome::Ok), "{verdicts:?}");
}

#[test]
fn what_is_put_right_after_the_last_step_begins_no_job_and_the_next_piece_is_right() {
    let job = teach(&[&polish(6)]);
    let again = [part([1, 5, 0, 0], 10, Toward(6)), idle(20)];
    let piece = [&POLISH_OK[..], &["JobOk"]].concat();
    expect(&job, &[&polish(6)[..], &again].concat(), &piece);
    let next = ["r1.0 IuOk", "r1.1 IuOk", "r1.2 IuOk", "r1 ActivityOk!", "JobOk"];
    expect(&job, &[&polish(6)[..], &again, &polish(6)].concat(), &[&piece[..], &next].concat());
}

#[test]
fn in_any_order_an_activity_that_comes_again_belongs_to_the_next_job() {
    let right = [&polish(6)[..], &polish(6), &measure()].concat();
    expect(
        &polish_and_measure(),
        &right,
        &[
            &POLISH_OK[..],
            &["JobAnomaly NotCompleted"],
            &POLISH_OK[..],
            &["r1.0 IuOk", "r1.1 IuOk", "r1.2 IuOk!", "r1 ActivityOk!", "JobOk"],
        ]
        .concat(),
    );
}

#[test]
fn a_wrong_motion_is_an_anomaly_before_its_end() {
    let mut right = polish(6).to_vec();
    right[1].motions = Toward(3);
    let verdicts = expect(
        &polish_and_measure(),
        &right,
        &[
            "r0.0 IuOk",
            "r0.1 IuAnomaly Motion!",
            "r0 ActivityAnomaly Motion!",
            "r0.2 IuOk",
            "JobAnomaly Motion",
        ],
    );
    let motion = &verdicts[1];
    assert!(motion.ended_ns < 80 * PERIOD_NS, "{motion:?}");
    assert!(motion.distance.unwrap() > motion.threshold.unwrap());
}

#[test]
fn an_iu_longer_than_its_reference_may_be_farther_from_it() {
    // 20 frames in a neighbouring direction are 3.42 away; the threshold is 3 for the 30 frames of the reference.
    let carried =
        |frames: usize| [part([1, 6, 0, 0], 20, Toward(6)), part([1, 6, 0, 0], frames - 20, Toward(5))];
    let job = polish_and_measure();
    let carry = |job: &Job<'_>, frames| {
        let right = [&polish(6)[..], &carried(frames), &measure()[1..]].concat();
        let verdicts = judged(job, &stream(&right, &[]));
        verdicts.into_iter().find(|verdict| verdict.activity == 1 && verdict.iu == Some(0)).unwrap()
    };
    let outcome = |job, frames| {
        let verdict = carry(job, frames);
        (verdict.outcome, verdict.threshold)
    };
    assert_eq!(outcome(&job, 30), (Outcome::Anomaly, Some(3.0)));
    assert_eq!(outcome(&job, 45), (Outcome::Ok, Some(4.5)));
    let as_in_the_paper = Job { max_slowdown: 1.0, ..job };
    assert_eq!(outcome(&as_in_the_paper, 45), (Outcome::Anomaly, Some(3.0)));
}

#[test]
fn how_long_a_hand_rests_at_either_end_of_an_iu_is_not_its_motion() {
    let carried = |before: usize, after: usize| {
        let [rest_before, rest_after] = [before, after].map(|frames| part([1, 5, 0, 0], frames, Still));
        [rest_before, part([1, 5, 0, 0], 30, Toward(3)), rest_after, idle(20)]
    };
    let job = teach(&[&carried(12, 12)]);
    let outcome = |job: &Job<'_>, parts: &[Part]| judged(job, &stream(parts, &[]))[0].outcome;
    assert_eq!(outcome(&job, &carried(0, 0)), Outcome::Anomaly);
    assert_eq!(outcome(&job, &carried(24, 0)), Outcome::Anomaly);
    let job = with_free_ends(job);
    for (before, after) in [(0, 0), (24, 0), (0, 24)] {
        assert_eq!(outcome(&job, &carried(before, after)), Outcome::Ok, "{before} and {after} frames");
    }
    // A rest between two motions is one.
    let [rest, there, ..] = carried(12, 12);
    let halved = Part { frames: 15, ..there };
    assert_eq!(outcome(&job, &[halved, rest, halved, idle(20)]), Outcome::Anomaly);
}

#[test]
fn a_hand_may_go_on_just_before_the_other_one_ends_what_their_parts_do() {
    let hold = |rest: usize, frames: usize| {
        [part([2, 5, 5, 7], rest, Still), part([2, 5, 5, 7], frames, Toward(3)), idle(20)]
    };
    let job = teach(&[&hold(60, 0)]);
    let least_wrong = |job: &Job<'_>| {
        let outcome = |frames: usize| judged(job, &stream(&[], &hold(40, frames)))[0].outcome;
        (0..30).find(|frames| outcome(*frames) == Outcome::Anomaly).unwrap()
    };
    assert_eq!(least_wrong(&with_free_ends(job)), least_wrong(&job) + 5);
}

#[test]
fn an_iu_that_lasts_too_long_is_an_anomaly_in_its_first_frame_too_many() {
    let mut right = [polish(6), measure()].concat();
    right[5].frames = 200;
    let verdicts = judged(&polish_and_measure(), &stream(&right, &[]));
    let long = verdicts.iter().find(|verdict| verdict.reason == Reason::TooLong).unwrap();
    assert_eq!(short(long), "r1.1 IuAnomaly TooLong!");
    // Its bound is 60 frames; the 61st is one too many.
    assert_eq!(long.ended_ns - long.began_ns, 60 * PERIOD_NS);
}

#[test]
fn too_many_strokes_are_too_long_before_their_time_is_over() {
    let mut right = polish(6).to_vec();
    right[1].motions = Strokes(8);
    let verdicts = judged(&forgiving(polish_and_measure()), &stream(&right, &[]));
    assert_eq!(short(&verdicts[1]), "r0.1 IuAnomaly TooLong!");
}

#[test]
fn an_extra_iu_shifts_the_following_ones_and_does_not_make_them_wrong() {
    let mut right = polish(6).to_vec();
    right.splice(1..1, [part([1, 5, 5, 9], 12, Still), part([1, 5, 0, 0], 30, Toward(3))]);
    let verdicts: Vec<String> =
        judged(&polish_and_measure(), &stream(&right, &[])).iter().map(short).collect();
    assert_eq!(
        verdicts[..3],
        ["r0.0 IuOk", "r0.1 IuAnomaly WrongObject!", "r0 ActivityAnomaly WrongObject!"]
    );
    // The second grasp could be the end of the activity too, but its direction is wrong; polishing is found again.
    assert_eq!(verdicts[4..], ["r0.3 IuOk", "r0.4 IuOk", "JobAnomaly WrongObject"]);
}

#[test]
fn a_skipped_iu_is_an_anomaly_and_the_following_ones_are_judged_on_their_own() {
    let skipping = &polish(6)[1..];
    expect(
        &polish_and_measure(),
        skipping,
        &[
            "r0.0 IuAnomaly WrongOrder!",
            "r0 ActivityAnomaly WrongOrder!",
            "r0.1 IuOk",
            "JobAnomaly WrongOrder",
        ],
    );
}

#[test]
fn a_wrong_activity_may_be_done_again_but_the_job_remains_an_anomaly() {
    let right = [&polish(3)[..], &[part([1, 8, 0, 0], 10, Still), idle(10)], &polish(6), &measure()].concat();
    let verdicts: Vec<String> =
        judged(&polish_and_measure(), &stream(&right, &[])).iter().map(short).collect();
    assert!(verdicts.contains(&"r2 ActivityOk!".into()), "{verdicts:?}");
    assert_eq!(verdicts.last().unwrap(), "JobAnomaly TooShort");
    assert_eq!(verdicts.iter().filter(|verdict| verdict.starts_with("Job")).count(), 1);
}

#[test]
fn the_next_touch_after_a_job_begins_another() {
    let right = [polish(6), measure(), polish(6), measure()].concat();
    let verdicts = judged(&polish_and_measure(), &stream(&right, &[]));
    let jobs: Vec<&Verdict> = verdicts.iter().filter(|verdict| verdict.level == Level::Job).collect();
    assert_eq!(jobs.iter().map(|job| job.outcome).collect::<Vec<_>>(), [Outcome::Ok, Outcome::Ok]);
    let again = (30 + 96 + 30 + 20 + 30 + 40 + 20 + 20) * PERIOD_NS;
    assert_eq!(jobs[1].began_ns, again);
    assert_eq!(verdicts[verdicts.len() / 2].activity, 0);
}

#[test]
fn both_hands_at_once_have_verdicts_of_their_own() {
    let hold = [part([2, 4, 0, 0], 60, Toward(1)), part([2, 4, 4, 8], 60, Still), idle(20)];
    let job = teach(&[&polish(6), &hold]);
    let verdicts = judged(&job, &stream(&polish(6), &hold));
    let verdicts: Vec<String> = verdicts.iter().map(short).collect();
    assert_eq!(
        verdicts,
        [
            "r0.0 IuOk",
            "l1.0 IuOk",
            "l1.1 IuOk",
            "l1 ActivityOk!",
            "r0.1 IuOk",
            "r0.2 IuOk",
            "r0 ActivityOk!",
            "JobOk"
        ]
    );
}

#[test]
fn an_activity_may_follow_one_that_the_other_hand_is_still_doing() {
    let hold = [part([2, 4, 0, 0], 60, Toward(1)), part([2, 4, 4, 8], 60, Still), idle(20)];
    let job = Job { laws: &IN_ORDER, ..teach(&[&polish(6), &hold]) };
    let last = |right: &[Part], left: &[Part]| {
        let verdicts = judged(&job, &stream(right, left));
        short(verdicts.last().unwrap())
    };
    // Both begin in the same frame; then the second begins before the first has ended.
    assert_eq!(last(&polish(6), &hold), "JobOk");
    assert_eq!(last(&polish(6), &[&[idle(20)][..], &hold].concat()), "JobOk");
    assert_eq!(last(&[&[idle(20)][..], &polish(6)].concat(), &hold), "JobAnomaly WrongOrder");
}

#[test]
fn a_wrong_activity_may_be_done_again_at_once() {
    let right = [&polish(3)[..], &polish(6), &measure()].concat();
    let verdicts: Vec<String> =
        judged(&polish_and_measure(), &stream(&right, &[])).iter().map(short).collect();
    assert_eq!(verdicts[3..8], ["r0.2 IuOk", "r1.0 IuOk", "r1.1 IuOk", "r1.2 IuOk", "r1 ActivityOk!"]);
    assert_eq!(verdicts.last().unwrap(), "JobAnomaly TooShort");
}

#[test]
fn an_iu_too_long_to_be_compared_is_not_judged() {
    let mut job = polish_and_measure();
    let mut ius = job.activities[0].ius.to_vec();
    let any = Bounds { min: 0, max: u32::MAX };
    ius[0] = NominalIu { frames: any, reversals: any, threshold: f32::MAX, ..ius[0] };
    let activities = [NominalActivity { activity: 0, ius: &ius }];
    job.activities = &activities;
    let mut right = polish(6);
    right[0].frames = 3000;
    assert_eq!(short(&judged(&job, &stream(&right, &[]))[0]), "r0.0 NotJudged Overload!");
}

#[test]
fn touching_the_same_object_again_continues_the_activity_until_it_has_matched() {
    let polish_but = |with: &[Part]| {
        let mut right = polish(6).to_vec();
        right.splice(1..1, with.iter().copied());
        judged(&polish_and_measure(), &stream(&right, &[])).iter().map(short).collect::<Vec<_>>()
    };
    // The hand brings the polisher to the wrong part, lets go and takes it again: that is still one activity.
    let verdicts = polish_but(&[part([1, 5, 5, 3], 10, Still), idle(3), part([1, 5, 0, 0], 10, Toward(3))]);
    assert_eq!(verdicts[1], "r0.1 IuAnomaly WrongObject!");
    assert!(verdicts.iter().all(|verdict| !verdict.starts_with("r1")), "{verdicts:?}");
    // The hand corrects its grip: that is still one IU.
    assert_eq!(polish_but(&[idle(3), part([1, 5, 0, 0], 10, Toward(3))])[..4], POLISH_OK);
}

#[test]
fn a_part_that_the_hand_lets_go_of_in_the_middle_is_not_done_with_it() {
    // The polisher is taken and put back, and another part comes.
    let right = [&[part([1, 5, 0, 0], 30, Toward(3)), idle(20)], &measure()[..]].concat();
    expect(
        &polish_and_measure(),
        &right,
        &[
            "r0.0 IuOk",
            "r0 ActivityAnomaly NotCompleted",
            "r1.0 IuOk",
            "r1.1 IuOk",
            "r1.2 IuOk!",
            "r1 ActivityOk!",
            "JobAnomaly NotCompleted",
        ],
    );
    // It is moved too little before that, which shows only now.
    let short_of = [&[part([1, 5, 0, 0], 10, Toward(3)), idle(20)], &measure()[..]].concat();
    let verdicts = judged(&polish_and_measure(), &stream(&short_of, &[]));
    assert_eq!(short(&verdicts[0]), "r0.0 IuAnomaly TooShort");
    assert_eq!(verdicts[0].ended_ns, verdicts[0].began_ns + 10 * PERIOD_NS);
}

#[test]
fn a_matched_activity_waits_while_a_longer_candidate_may_go_on() {
    let short_one = [part([1, 5, 0, 0], 30, Toward(3)), idle(20)];
    let long = [part([1, 5, 0, 0], 30, Toward(3)), part([1, 5, 5, 6], 40, Still), idle(20)];
    let job = teach(&[&short_one, &long]);
    // The long one, then the short one: only the end of the recording shows that it was the short one.
    let right = [&long[..], &short_one].concat();
    expect(
        &job,
        &right,
        &["r0.0 IuOk", "r0.1 IuOk", "r0 ActivityOk!", "r1.0 IuOk", "r1 ActivityOk", "JobOk"],
    );
    // Here the touch of the next job shows it.
    let right = [&long[..], &short_one, &long].concat();
    let verdicts: Vec<String> = judged(&job, &stream(&right, &[])).iter().map(short).collect();
    assert_eq!(verdicts[4..6], ["r1 ActivityOk", "JobOk"]);
    assert_eq!(verdicts[6], "r0.0 IuOk");
}

#[test]
fn variants_fulfil_the_same_activity() {
    let other = [part([1, 5, 0, 0], 20, Toward(1)), part([1, 5, 5, 6], 40, Still), idle(20)];
    let taught = teach(&[&polish(6), &other, &measure()]);
    let activities: Vec<NominalActivity<'_>> = taught
        .activities
        .iter()
        .map(|nominal| NominalActivity { activity: nominal.activity / 2, ..*nominal })
        .collect();
    let job = Job { activities: &activities, laws: &IN_ORDER, ..taught };
    let right = [&other[..], &measure()].concat();
    let verdicts = judged(&job, &stream(&right, &[]));
    assert_eq!(short(verdicts.last().unwrap()), "JobOk");
}

#[test]
fn commands_start_and_end_a_job() {
    let job = polish_and_measure();
    let mut judge = Judge::new(&job, Method::default()).unwrap();
    let mut verdicts = Vec::new();
    let couples = stream(&polish(6), &[]);
    judge.start(&mut |event| verdicts.extend(event.verdict()));
    for couples in &couples[..60] {
        judge.step(couples, &mut |event| verdicts.extend(event.verdict()));
    }
    judge.start(&mut |event| verdicts.extend(event.verdict()));
    let verdicts: Vec<String> = verdicts.iter().map(short).collect();
    // The command cuts the polishing short; then a new job is open, in which nothing has been touched.
    assert_eq!(
        verdicts,
        ["r0.0 IuOk", "r0.1 IuAnomaly TooShort", "r0 ActivityAnomaly TooShort!", "JobAnomaly TooShort"]
    );
    let mut ended = Vec::new();
    judge.finish(&mut |event| ended.extend(event.verdict()));
    assert_eq!(ended.iter().map(short).collect::<Vec<_>>(), ["JobAnomaly NotCompleted"]);
    // It was to begin with the next frame, and ended before that frame came.
    assert_eq!((ended[0].began_ns, ended[0].ended_ns), (60 * PERIOD_NS, 60 * PERIOD_NS));
}

#[test]
fn a_job_that_cannot_be_used_is_refused_with_the_index_of_its_fault() {
    let job = polish_and_measure();
    let refusal =
        |activities: &[NominalActivity<'_>]| Judge::new(&Job { activities, ..job }, Method::default()).err();
    assert_eq!(refusal(&[]), Some(Unusable::Activities { given: 0 }));
    assert_eq!(refusal(&vec![job.activities[0]; 33]), Some(Unusable::Activities { given: 33 }));
    let none = NominalActivity { activity: 1, ius: &[] };
    assert_eq!(refusal(&[job.activities[0], none]), Some(Unusable::Ius { nominal: 1, given: 0 }));
    let right = job.activities[0].ius;
    let damaged = [
        NominalIu { threshold: f32::NAN, ..right[1] },
        NominalIu { reference: &[], ..right[1] },
        NominalIu { frames: Bounds { min: 2, max: 1 }, ..right[1] },
    ];
    for damaged in damaged {
        let ius = [right[0], damaged];
        let activities = [NominalActivity { activity: 0, ius: &ius }];
        assert_eq!(refusal(&activities), Some(Unusable::Iu { nominal: 0, iu: 1 }));
    }
    let behind = |activity| Law { after_end: ActivitySet::of(activity), ..Law::FREE };
    for laws in [&[behind(0)][..], &[behind(2)], &[behind(1), behind(0)]] {
        let refused = Judge::new(&Job { laws, ..job }, Method::default()).err();
        assert_eq!(refused, Some(Unusable::Law { activity: 0 }), "{laws:?}");
    }
    let beyond = [NominalActivity { activity: 32, ..job.activities[0] }];
    assert_eq!(refusal(&beyond), Some(Unusable::Law { activity: 32 }));
    let release_first = [job.activities[1].ius[2]];
    let activities = [NominalActivity { activity: 0, ius: &release_first }];
    assert_eq!(refusal(&activities), Some(Unusable::Iu { nominal: 0, iu: 0 }));
}
