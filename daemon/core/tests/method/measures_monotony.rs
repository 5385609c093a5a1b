//! Less observation only widens what was measured. A motion that is right in every measure has no wrong one, however little of it is seen.
//!
//! A hand moves a tool at a part as it likes, in straight strokes of any direction. The job allows what it measures and little more. Then some frames
//! go missing. Hidden motion is assumed to be at most twice as fast as seen motion, and not to reverse in less than four frames. The motions keep to
//! that.

use crate::common::bench::PERIOD_NS;
use crate::common::cases;
use crate::common::gaps::{Gap, gaps, hidden};
use crate::common::script::{Part, Still, idle, part, short, stream, teach};
use crate::common::seed::{drawn, wrong_cases};
use crate::common::work::judged;
use andon_core::bounds::{Around, Bounds, Range};
use andon_core::config::Method;
use andon_core::couple::{Couple, Couples};
use andon_core::input::{Point, Side};
use andon_core::job::{Job, MeasureBounds, NominalActivity, NominalIu};
use andon_core::segment::{HandEvent, Iu, Measures, Segmenter};
use andon_core::verdict::Outcome;
use andon_rate::Rate;
use proptest::prelude::*;
use std::f32::consts::TAU;

/// A straight stroke: its direction in radians, its length in frames, and its speed in metres per frame.
type Stroke = (f32, usize, f32);

fn strokes() -> impl Strategy<Value = Vec<Stroke>> {
    prop::collection::vec((0.0..TAU, 5..30usize, 0.003..0.006f32), 3..12)
}

/// Idle, the tool on its way, the tool at the part, idle.
const IDLE: usize = 30;
const WAY: usize = 30;

fn parts(strokes: &[Stroke]) -> [Part; 4] {
    let frames = strokes.iter().map(|(_, frames, _)| frames).sum();
    [idle(IDLE), part([1, 5, 0, 0], WAY, Still), part([1, 5, 5, 6], frames, Still), idle(IDLE)]
}

/// What both hands do, with these strokes at the part.
fn couples(strokes: &[Stroke]) -> Vec<Couples> {
    let mut couples = stream(&parts(strokes), &[]);
    let steps = strokes.iter().flat_map(|(angle, frames, speed)| {
        std::iter::repeat_n([speed * angle.cos(), speed * angle.sin()], *frames)
    });
    let mut position: Point = [0.0; 3];
    for (couples, step) in couples[IDLE + WAY..].iter_mut().zip(steps) {
        (position[0], position[1]) = (position[0] + step[0], position[1] + step[1]);
        (couples.hands[0].position, couples.hands[0].tips) = (Some(position), Some(position));
    }
    couples
}

/// The IUs of the right hand.
fn ius(couples: &[Couples]) -> Vec<Iu> {
    let mut segmenter = Segmenter::new(Side::Right, &Method::default()).unwrap();
    let mut ius = Vec::new();
    let mut take = |event: HandEvent| {
        if let HandEvent::IuEnded(iu) = event {
            ius.push(iu);
        }
    };
    let hands: Vec<Couple> = couples.iter().map(|couples| couples.hands[0]).collect();
    hands.iter().for_each(|couple| segmenter.step(couple, &mut take));
    segmenter.finish(hands.len() as u64 * PERIOD_NS, &mut take);
    ius
}

/// What differs from what this IU measures by no more than a standard deviation of people in general is right. Taught bounds are wider.
fn about(iu: &Iu) -> NominalIu<'static> {
    let Measures { reversals, stroke_m, path_m, detour_m, lateral_m, axis, place_m, .. } = iu.measures;
    let range = |metres: f32| Range { min: 0.88 * metres, max: 1.12 * metres };
    NominalIu {
        context: iu.context,
        reference: &[],
        threshold: f32::MAX,
        frames: Bounds { min: iu.frames, max: iu.frames },
        reversals: Bounds { min: reversals.saturating_sub(1), max: reversals + 1 },
        measures: MeasureBounds {
            stroke_m: stroke_m.map_or(MeasureBounds::ANY.stroke_m, range),
            path_m: range(path_m),
            max_detour_m: detour_m + 0.12 * path_m,
            max_lateral_m: lateral_m + 0.12 * path_m,
            axis: Around { centre: axis, max: 0.15 },
            place_m: Around { centre: place_m, max: 0.008 },
            shown: None,
        },
    }
}

/// A job of this one activity. Its distance is any, because only measures are tried.
fn job(strokes: &[Stroke], whole: &[Couples]) -> Job<'static> {
    let job = teach(&[&parts(strokes)[1..3]]);
    let with_reference =
        |(nominal, iu): (&NominalIu<'static>, Iu)| NominalIu { reference: nominal.reference, ..about(&iu) };
    let ius: Vec<NominalIu<'static>> =
        job.activities[0].ius.iter().zip(ius(whole)).map(with_reference).collect();
    Job { activities: vec![NominalActivity { activity: 0, ius: ius.leak() }].leak(), ..job }
}

/// What is accused of right motions of this seed because not all of it was seen, and of how many motions.
fn accused(seed: u64) -> (Vec<String>, usize) {
    wrong_cases(5_000, seed, &(strokes(), gaps()), |(strokes, gaps)| {
        let whole = couples(&strokes);
        let job = job(&strokes, &whole);
        assert_eq!(anomalies(&job, &whole), [""; 0], "{strokes:?}");
        let gaps: Vec<Gap> =
            gaps.into_iter().map(|(_, from, frames)| (0, from % whole.len(), frames)).collect();
        let less = anomalies(&job, &hidden(&whole, &gaps));
        (!less.is_empty()).then(|| format!("{less:?} {strokes:?} {gaps:?}"))
    })
}

fn anomalies(job: &Job<'_>, couples: &[Couples]) -> Vec<String> {
    let all = judged(job, couples).into_iter();
    all.filter(|verdict| verdict.outcome == Outcome::Anomaly).map(|verdict| short(&verdict)).collect()
}

#[test]
fn no_measure_of_a_right_motion_is_wrong_where_it_is_not_seen() {
    for seed in [cases::KNOWN, drawn()] {
        let (wrong, motions) = accused(seed);
        println!("PROPTEST_RNG_SEED={seed}: {} of {motions} {wrong:#?}", wrong.len());
        // It was 6 of 120,000: a curve that is hidden in several places turns back elsewhere than in either world.
        Rate::new(wrong.len(), motions).expect_at_most(0.0005, "accused");
    }
}
