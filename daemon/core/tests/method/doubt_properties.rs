//! Whatever observations are deleted from a correct job, none of its verdicts becomes an anomaly. Only its last second is always seen: the end of the
//! recording is the end of the job. And each object is seen in the first frame. One that has never been seen is not expected anywhere, because a
//! station may have objects that are for other jobs only.

use crate::common::bench::{Bench, encode, shapes};
use crate::common::seed::with_known_and_drawn_seed;
use crate::common::work::IN_ORDER;
use andon_core::anomaly::Judge;
use andon_core::bounds::{Around, Bounds, Range};
use andon_core::config::Method;
use andon_core::couple::Encoder;
use andon_core::input::{Frame, Side};
use andon_core::job::{Job, LocalCost, MeasureBounds, NominalActivity, NominalIu};
use andon_core::segment::{Event, HandEvent, JobSegmenter, Measures};
use andon_core::verdict::{Level, Outcome, Reason, Verdict};
use proptest::prelude::*;
use std::sync::LazyLock;

const TOOL: u16 = 5;
const BRICK: u16 = 6;
const METER: u16 = 3;
const ALL: [u16; 3] = [METER, TOOL, BRICK];

/// Frames at the end that are always seen.
const LAST: usize = 30;

/// A tool rubs the brick with six strokes and is put back; then the brick is brought to the meter.
fn work() -> Vec<Frame> {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BRICK, [0.3, 0.2]), (METER, [0.6, 0.0])]);
    bench.hand(Side::Right, [0.0, -0.3]).rest(20).go([0.0, 0.0], 20).rest(8).hold(Side::Right, TOOL);
    bench.go([0.27, 0.2], 25);
    for _ in 0..6 {
        bench.go([0.33, 0.2], 12).go([0.27, 0.2], 12);
    }
    bench.go([0.0, 0.0], 25).rest(8).let_go(Side::Right).go([0.1, -0.3], 20).rest(10);
    bench.go([0.3, 0.2], 25).rest(8).hold(Side::Right, BRICK).go([0.6, 0.02], 30).rest(30);
    bench.let_go(Side::Right).go([0.3, 0.4], 25).rest(LAST);
    bench.frames
}

/// The job that this work teaches, with thresholds and bounds like those of a few people for such work. Its memory is leaked, because
/// tests are short.
static JOB: LazyLock<Job<'static>> = LazyLock::new(|| {
    let mut segmenter = JobSegmenter::new(&Method::default()).unwrap();
    let mut activities: Vec<Vec<NominalIu<'static>>> = Vec::new();
    let mut motions = Vec::new();
    let mut take = |event: Event| match event {
        Event::Hand(_, HandEvent::ActivityBegan { .. }) => activities.push(Vec::new()),
        Event::Hand(_, HandEvent::IuFrame { motion, .. }) => motions.push(motion),
        Event::Hand(_, HandEvent::IuEnded(iu)) => activities.last_mut().unwrap().push(NominalIu {
            context: iu.context,
            reference: std::mem::take(&mut motions).leak(),
            threshold: 8.0,
            frames: Bounds { min: iu.frames * 7 / 10, max: iu.frames * 3 / 2 },
            reversals: Bounds { min: iu.measures.reversals * 9 / 10, max: iu.measures.reversals + 2 },
            measures: measures(&iu.measures),
        }),
        _ => {}
    };
    encode(&ALL, &work()).iter().for_each(|couples| segmenter.step(couples, &mut take));
    segmenter.finish(&mut take);
    let nominal: Vec<NominalActivity<'static>> =
        (0..).zip(activities).map(|(activity, ius)| NominalActivity { activity, ius: ius.leak() }).collect();
    assert_eq!(nominal.len(), 2);
    let cost = LocalCost::Circular { bins: 8 };
    Job {
        activities: nominal.leak(),
        laws: &IN_ORDER,
        objects: &[],
        passive_contacts: &[],
        cost,
        max_slowdown: 2.0,
        has_free_ends: false,
        min_captured: 0.0,
    }
});

/// Bounds as near to the measures as those of a few people.
fn measures(shown: &Measures) -> MeasureBounds {
    let around = |metres: f32| Range { min: 0.7 * metres, max: 1.4 * metres + 0.05 };
    MeasureBounds {
        stroke_m: around(shown.stroke_m.unwrap_or_default()),
        path_m: around(shown.path_m),
        max_detour_m: around(shown.detour_m).max,
        max_lateral_m: around(shown.lateral_m).max,
        axis: Around { centre: shown.axis, max: 0.5 },
        place_m: Around { centre: shown.place_m, max: 0.04 },
        shown: None,
    }
}

/// The verdicts of a judge that does not know whether the frames begin with a job.
fn judged(frames: &[Frame]) -> Vec<Verdict> {
    let mut encoder = Encoder::new(Method::default(), &shapes(&ALL)).unwrap();
    let mut judge = Judge::<Vec<_>>::with_memory(&JOB, Method::default()).unwrap();
    let mut couples = Vec::new();
    frames.iter().for_each(|frame| encoder.step(frame, &mut |made| couples.push(made)).unwrap());
    encoder.flush(&mut |made| couples.push(made));
    let mut verdicts = Vec::new();
    couples.iter().for_each(|couples| judge.step(couples, &mut |event| verdicts.extend(event.verdict())));
    judge.finish(&mut |event| verdicts.extend(event.verdict()));
    verdicts
}

/// What is not seen in a stretch of frames.
#[derive(Clone, Copy, Debug)]
enum Hidden {
    Hand,
    Object(u16),
    Objects,
    Frames,
}

fn stretch() -> impl Strategy<Value = (Hidden, usize, usize)> {
    let hidden = prop_oneof![
        Just(Hidden::Hand),
        prop::sample::select(ALL.to_vec()).prop_map(Hidden::Object),
        Just(Hidden::Objects),
        Just(Hidden::Frames),
    ];
    (hidden, 0..work().len(), prop_oneof![1..12usize, 1..120usize])
}

fn delete(
    mut frames: Vec<Frame>,
    stretches: &[(Hidden, usize, usize)],
    every: usize,
    from: usize,
) -> Vec<Frame> {
    let mut is_kept = vec![true; frames.len()];
    let objects = frames[from].objects.clone();
    for (hidden, begin, count) in stretches {
        for index in *begin..(begin + count).min(frames.len() - LAST) {
            match hidden {
                Hidden::Hand => frames[index].hands.clear(),
                Hidden::Object(id) => frames[index].objects.retain(|object| object.id != *id),
                Hidden::Objects => frames[index].objects.clear(),
                Hidden::Frames => is_kept[index] = false,
            }
        }
    }
    if let Some(first) = (from..frames.len()).find(|index| is_kept[*index] && index % every == 0) {
        frames[first].objects = objects;
    }
    let kept = frames
        .into_iter()
        .enumerate()
        .filter(|(index, _)| is_kept[*index] && index % every == 0 && *index >= from);
    kept.map(|(_, frame)| frame).collect()
}

/// How often each property is tried with each seed.
const CASES: u32 = 128;

#[test]
fn the_whole_work_is_right() {
    let jobs: Vec<Outcome> = judged(&work())
        .iter()
        .filter(|verdict| verdict.level == Level::Job)
        .map(|verdict| verdict.outcome)
        .collect();
    assert_eq!(jobs, [Outcome::Ok]);
}

/// The hand lets go of the polisher and takes the brick while nothing is seen. The brick is hidden for a moment longer than the polisher.
#[test]
fn a_hand_that_took_a_part_unseen_is_not_said_to_have_taken_it_late() {
    let left = delete(work(), &[(Hidden::Objects, 208, 117), (Hidden::Object(6), 323, 3)], 1, 0);
    let accused = judged(&left).into_iter().find(|verdict| verdict.outcome == Outcome::Anomaly);
    assert_eq!(accused, None);
}

/// Why IUs, activities and jobs are not judged when these stretches are deleted.
fn unjudged_reasons(hidden: Hidden, stretches: &[(usize, usize)]) -> Vec<Reason> {
    let stretches: Vec<_> = stretches.iter().map(|(begin, count)| (hidden, *begin, *count)).collect();
    let verdicts = judged(&delete(work(), &stretches, 1, 0));
    let unjudged = verdicts.iter().filter(|verdict| verdict.outcome == Outcome::NotJudged);
    unjudged.map(|verdict| verdict.reason).collect()
}

#[test]
fn nothing_is_accused_for_what_was_not_seen() {
    let stretches = prop::collection::vec(stretch(), 0..4);
    let every = prop_oneof![4 => Just(1), 1 => 2..9usize];
    let from = prop_oneof![4 => Just(0), 1 => 0..400usize];
    with_known_and_drawn_seed(CASES, &(stretches, every, from), |(stretches, every, from)| {
        let left = delete(work(), &stretches, every, from);
        let accused: Vec<Verdict> =
            judged(&left).into_iter().filter(|verdict| verdict.outcome == Outcome::Anomaly).collect();
        prop_assert!(accused.is_empty(), "{:?}", accused);
        Ok(())
    });
}

/// Where frames never came, nobody is told that something hid the work; where it was hidden, nobody is told to buy a faster machine.
#[test]
fn it_is_said_whether_frames_were_missing_or_did_not_show_the_work() {
    // A job that is seen from later on has no gap: there nobody knows what was before.
    let stretches = prop::collection::vec((1..work().len(), 1..120usize), 1..4);
    with_known_and_drawn_seed(CASES, &stretches, |stretches| {
        let missing = unjudged_reasons(Hidden::Frames, &stretches);
        let not_seen = [Reason::Blind, Reason::HandNotSeen, Reason::ObjectNotSeen];
        prop_assert!(!missing.iter().any(|reason| not_seen.contains(reason)), "{:?}", missing);
        let hidden = unjudged_reasons(Hidden::Hand, &stretches);
        let no_frames =
            [Reason::Overload, Reason::FramesMissing, Reason::TooFewFrames, Reason::ObjectNotSeen];
        prop_assert!(!hidden.iter().any(|reason| no_frames.contains(reason)), "{:?}", hidden);
        Ok(())
    });
}
