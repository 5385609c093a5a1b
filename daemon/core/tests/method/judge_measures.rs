//! A verdict names the measure that is out of its bounds, its value and what was shown, as early as that can be known.

use crate::common::bench::PERIOD_NS;
use crate::common::script::{Part, Still, Toward, idle, objects_of, part, short, stream, teach};
use crate::common::work::{IN_ORDER, forgiving, judged, measure, polish, polish_and_measure};
use andon_core::bounds::{Bounds, Range};
use andon_core::config::Method;
use andon_core::couple::Waiting;
use andon_core::input::Side;
use andon_core::job::{Job, MeasureBounds, NominalActivity, NominalIu};
use andon_core::segment::Segmenter;
use andon_core::set::ActivitySet;
use andon_core::verdict::{Level, Measure, Measured, Outcome, Verdict};
use std::f32::consts::PI;

/// The job with other bounds for the strokes of the polisher and the brick at the meter.
fn bounded(change: impl Fn(&mut NominalIu<'static>)) -> Job<'static> {
    let job = forgiving(polish_and_measure());
    let with = |nominal: &NominalActivity<'static>| {
        let mut ius = nominal.ius.to_vec();
        change(&mut ius[1]);
        NominalActivity { ius: ius.leak(), ..*nominal }
    };
    Job { activities: job.activities.iter().map(with).collect::<Vec<_>>().leak(), ..job }
}

/// The verdicts on a job that has a measure out of its bounds, in short, with the measure.
fn measured(job: &Job<'_>, right: &[Part]) -> Vec<(String, Measured)> {
    let verdicts = judged(job, &stream(right, &[]));
    verdicts.iter().filter_map(|verdict| Some((short(verdict), verdict.measured?))).collect()
}

fn value(measure: Measure, value: f32, shown: [f32; 2]) -> Measured {
    Measured { measure, value, shown_min: shown[0], shown_max: shown[1] }
}

fn first(found: &[(String, Measured)]) -> (&str, Measured) {
    (found[0].0.as_str(), found[0].1)
}

#[test]
fn too_few_strokes_are_counted_in_the_verdicts_on_iu_activity_and_job() {
    let right = [polish(3), measure()].concat();
    let strokes = value(Measure::Strokes, 2.0, [5.0, 5.0]);
    let said = |words: &str| (words.to_owned(), strokes);
    assert_eq!(
        measured(&forgiving(polish_and_measure()), &right),
        [said("r0.1 IuAnomaly TooShort"), said("r0 ActivityAnomaly TooShort!"), said("JobAnomaly TooShort")]
    );
}

#[test]
fn too_many_strokes_are_counted_while_they_happen() {
    let verdicts = judged(&forgiving(polish_and_measure()), &stream(&[polish(9), measure()].concat(), &[]));
    let wrong = verdicts.iter().find(|verdict| verdict.outcome == Outcome::Anomaly).unwrap();
    assert_eq!(short(wrong), "r0.1 IuAnomaly TooLong!");
    assert_eq!(wrong.measured, Some(value(Measure::Strokes, 6.0, [5.0, 5.0])));
    assert!(wrong.decided_ns < (30 + 9 * 16) * PERIOD_NS, "{wrong:?}");
}

#[test]
fn a_step_that_is_too_short_or_too_long_says_its_seconds() {
    let at_the_meter = |frames: usize| {
        let parts = [part([1, 6, 0, 0], 30, Toward(5)), part([1, 6, 6, 3], frames, Still)];
        [&polish(6)[..], &parts, &[part([0, 0, 6, 3], 20, Still), idle(20)]].concat()
    };
    let job = forgiving(polish_and_measure());
    let shown = [40.0 / 30.0; 2];
    let short = measured(&job, &at_the_meter(15));
    assert_eq!(first(&short), ("r1.1 IuAnomaly TooShort", value(Measure::Duration, 0.5, shown)));
    let long = measured(&job, &at_the_meter(90));
    assert_eq!(first(&long), ("r1.1 IuAnomaly TooLong!", value(Measure::Duration, 61.0 / 30.0, shown)));
}

#[test]
fn a_hand_may_wait_for_the_other_one() {
    let waits = [part([1, 6, 0, 0], 30, Toward(5)), part([1, 6, 6, 3], 400, Still), idle(20)];
    let right = [&polish(6)[..], &waits].concat();
    let left = [part([2, 8, 0, 0], 30, Toward(3)), idle(600)];
    let one_handed = forgiving(polish_and_measure());
    let two_handed = {
        let lift = forgiving(teach(&[&left])).activities[0];
        let all = [one_handed.activities, &[NominalActivity { activity: 2, ..lift }]].concat();
        Job { activities: all.leak(), ..one_handed }
    };
    let job_of = |job: &Job<'_>, waiting: Waiting| {
        let is_two_handed = job.activities.len() > one_handed.activities.len();
        let mut couples = stream(&right, if is_two_handed { &left } else { &[] });
        couples[210..600].iter_mut().for_each(|couples| couples.hands[0].waiting = waiting);
        let verdicts = judged(job, &couples);
        short(verdicts.iter().rfind(|verdict| verdict.level == Level::Job).unwrap())
    };
    assert_eq!(job_of(&two_handed, Waiting::Yes), "JobOk");
    assert_eq!(job_of(&two_handed, Waiting::No), "JobAnomaly TooLong");
    // It may have waited, unless nobody has shown the job with another hand.
    assert_eq!(job_of(&two_handed, Waiting::Unknown), "NotJudged Blind");
    assert_eq!(
        [Waiting::Unknown, Waiting::Yes].map(|waiting| job_of(&one_handed, waiting)),
        ["JobAnomaly TooLong"; 2]
    );
}

#[test]
fn a_path_a_stroke_a_direction_and_a_place_are_measured_in_metres_and_degrees() {
    let any = Bounds { min: 0, max: u32::MAX };
    let job = |bounds: fn(&mut MeasureBounds)| {
        bounded(move |iu| {
            (iu.frames, iu.reversals) = (any, any);
            bounds(&mut iu.measures);
        })
    };
    let right = [polish(6), measure()].concat();
    let of = |job: &Job<'_>| {
        let found = measured(job, &right);
        (found[0].0.clone(), found[0].1.measure, found[0].1.value)
    };
    let (said, measure, metres) = of(&job(|bounds| bounds.path_m = Range { min: 0.0, max: 0.5 }));
    assert_eq!((said.as_str(), measure), ("r0.1 IuAnomaly TooLong!", Measure::Path));
    assert!((0.5..0.55).contains(&metres), "{metres}");
    let (said, measure, metres) = of(&job(|bounds| bounds.max_lateral_m = 0.05));
    assert_eq!((said.as_str(), measure), ("r0.1 IuAnomaly TooLong!", Measure::LateralDeviation));
    assert!((0.05..0.07).contains(&metres), "{metres}");
    let (said, measure, metres) = of(&job(|bounds| bounds.stroke_m = Range { min: 0.0, max: 0.01 }));
    assert_eq!((said.as_str(), measure), ("r0.1 IuAnomaly Motion", Measure::StrokeLength));
    assert!((metres - 0.14).abs() < 0.03, "{metres}");
    let (said, measure, degrees) =
        of(&job(|bounds| (bounds.axis.centre, bounds.axis.max) = ([-1.0, 0.0], 0.5)));
    assert_eq!((said.as_str(), measure), ("r0.1 IuAnomaly Motion", Measure::Direction));
    assert!((80.0..=90.0).contains(&degrees), "{degrees}");
    let (said, measure, metres) =
        of(&job(|bounds| (bounds.place_m.centre[1], bounds.place_m.max) = (9.0, 0.1)));
    assert_eq!((said.as_str(), measure), ("r0.1 IuAnomaly Motion", Measure::Place));
    assert!((8.0..10.0).contains(&metres), "{metres}");
}

#[test]
fn what_is_not_judged_says_what_was_measured_all_the_same() {
    // Of six strokes, only one in ten of the frames of the last three has come.
    let mut couples = stream(&[polish(6), measure()].concat(), &[]);
    let mut frame = 0;
    couples.retain(|_| {
        frame += 1;
        !(30 + 3 * 16..30 + 6 * 16 - 4).contains(&frame) || frame % 10 == 0
    });
    let verdicts = judged(&forgiving(polish_and_measure()), &couples);
    let unjudged: Vec<&Verdict> = verdicts
        .iter()
        .filter(|verdict| verdict.outcome == Outcome::NotJudged && verdict.level == Level::Iu)
        .collect();
    assert_eq!(unjudged[0].measured.map(|measured| measured.measure), Some(Measure::Strokes), "{unjudged:?}");
    assert!(verdicts.iter().all(|verdict| verdict.outcome != Outcome::Anomaly), "{verdicts:?}");
}

#[test]
fn what_is_right_and_what_is_wrong_for_another_reason_names_no_measure() {
    let right = [polish(6), measure()].concat();
    assert_eq!(measured(&forgiving(polish_and_measure()), &right), []);
    let wrong = [measure(), measure()].concat();
    assert_eq!(measured(&forgiving(polish_and_measure()), &wrong), []);
}

#[test]
fn a_job_that_does_not_know_what_was_shown_names_no_measure() {
    let job = bounded(|iu| iu.measures.shown = None);
    assert_eq!(measured(&job, &[polish(3), measure()].concat()), []);
}

/// The lateral deviation of the way of the right hand with the brick away from the meter. It is at it for 20 frames. In the first 10 it goes round in
/// half a circle of 10 cm, and then it rests.
fn lateral_away_m(is_known_to_touch: bool) -> f32 {
    let parts =
        [part([1, 6, 0, 0], 30, Toward(5)), part([1, 6, 6, 3], 20, Still), part([1, 6, 0, 0], 10, Still)];
    let mut segmenter = Segmenter::new(Side::Right, &Method::default()).unwrap();
    for (frame, couples) in stream(&parts, &[]).iter().enumerate() {
        let mut couple = couples.hands[0];
        let angle = PI * (frame as f32 - 30.0).clamp(0.0, 10.0) / 10.0;
        couple.tips = Some([0.05 * angle.cos(), 0.05 * angle.sin(), 0.0]);
        couple.position = couple.position.filter(|_| is_known_to_touch || frame >= 40);
        segmenter.step(&couple, &mut |_| {});
    }
    segmenter.measures()[0].lateral_m
}

#[test]
fn the_way_away_begins_where_the_two_are_known_to_be_together() {
    assert!(lateral_away_m(true) > 0.045);
    assert!(lateral_away_m(false) < 0.005);
}

/// The job in which both steps are ordered, and each has to move its part.
fn moving() -> Job<'static> {
    let job = forgiving(polish_and_measure());
    let with = |nominal: &NominalActivity<'static>| {
        let mut ius = nominal.ius.to_vec();
        ius[0].measures.path_m.min = 0.1;
        NominalActivity { ius: ius.leak(), ..*nominal }
    };
    let activities: Vec<_> = job.activities.iter().map(with).collect();
    Job { activities: activities.leak(), laws: &IN_ORDER, ..job }
}

#[test]
fn a_hand_that_lets_go_of_what_it_has_not_moved_has_not_begun() {
    let touch = |part: u16, motions| [crate::common::script::part([1, part, 0, 0], 20, motions), idle(10)];
    let said = |parts: &[&[Part]]| {
        let verdicts = judged(&moving(), &stream(&parts.concat(), &[]));
        short(verdicts.iter().find(|verdict| verdict.level == Level::Job).unwrap())
    };
    let (polish, measure) = (polish(6), measure());
    assert_eq!(said(&[&touch(5, Still), &polish, &measure]), "JobOk", "it corrects its grip");
    assert_eq!(said(&[&polish, &touch(5, Still), &measure]), "JobOk");
    assert_eq!(said(&[&touch(6, Still), &polish, &measure]), "JobOk", "it is not too early");
    assert_eq!(said(&[&touch(6, Toward(5)), &polish, &measure]), "JobAnomaly WrongOrder", "that was moved");
    assert_eq!(said(&[&touch(5, Still), &measure]), "JobAnomaly WrongOrder", "nothing was polished");
    assert_eq!(said(&[&polish, &touch(6, Still)]), "JobAnomaly NotCompleted", "nothing was measured");
}

#[test]
fn a_touch_that_begins_no_step_accuses_no_job_although_the_bench_shows_that_nothing_was_done() {
    for part in [5, 6] {
        let touch = [crate::common::script::part([1, part, 0, 0], 20, Still), idle(300)];
        let mut couples = stream(&touch, &[]);
        couples.iter_mut().for_each(|couples| couples.at_start = objects_of(ActivitySet::first(2)));
        let verdicts = judged(&moving(), &couples);
        let is_accused = verdicts.iter().any(|verdict| verdict.outcome == Outcome::Anomaly);
        assert!(!is_accused, "{:?}", verdicts.iter().map(short).collect::<Vec<_>>());
    }
}

#[test]
fn a_touch_of_which_a_frame_is_missing_accuses_nobody() {
    let touch = |part: u16, hidden: usize| {
        let still = |frames| crate::common::script::part([1, part, 0, 0], frames, Still);
        [still(8), Part { seen: false, ..still(hidden) }, still(12 - hidden), idle(10)]
    };
    let (polish, measure) = (polish(6), measure());
    for hidden in [1, 2, 3, 6, 10] {
        for parts in [
            [&touch(5, hidden)[..], &polish, &measure].concat(),
            [&touch(6, hidden)[..], &polish, &measure].concat(),
            [&polish[..], &touch(5, hidden), &measure].concat(),
        ] {
            let verdicts = judged(&moving(), &stream(&parts, &[]));
            let is_accused = verdicts.iter().any(|verdict| verdict.outcome == Outcome::Anomaly);
            assert!(!is_accused, "{hidden}: {:?}", verdicts.iter().map(short).collect::<Vec<_>>());
        }
    }
}
