//! One whole step of the core, from a frame to its verdicts. Prints p50 and p99 and writes `target/bench/step.json` for `report.py`.
//!
//! Both hands carry an object to another one and back at the same time, and 32 objects are visible in every frame. The job has 20 nominal activities.
//! In `job` each of them has objects of its own. In `alike` the ten of each hand have the same objects, and all of them remain candidates to the end.
//! So no step of a job of this size can have more to do.
#![allow(missing_docs, clippy::unwrap_used)]

use andon_core::anomaly::Judge;
use andon_core::bounds::Bounds;
use andon_core::capacity::OBJECTS;
use andon_core::config::Method;
use andon_core::couple::{Context, Encoder, Motion};
use andon_core::input::{Frame, Hand, Object, Side};
use andon_core::job::{Job, LocalCost, MeasureBounds, NominalActivity, NominalIu};
use andon_core::object::ObjectShape;
use std::f32::consts::TAU;
use std::time::Instant;

/// Number of nominal activities per hand.
const ACTIVITIES: usize = 10;
/// Number of frames of each reference; the DTW figures are measured with the same length.
const FRAMES: usize = 150;
/// Number of frames of one activity and the pause after it.
const CYCLE: usize = 400;
/// Number of frames of the pause.
const PAUSE: usize = 60;
/// Number of steps that are measured, of which 400 are slower than p99.
const STEPS: usize = 40_000;
const PERIOD_NS: u64 = 33_333_333;

/// For each hand, the id of the object that it carries and of the object that it carries it to.
const CARRIED: [[u16; 2]; 2] = [[1, 2], [3, 4]];

fn main() {
    let report = serde_json::json!({ "job": measure("job", false), "alike": measure("alike", true) });
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../target/bench");
    std::fs::create_dir_all(folder).unwrap();
    std::fs::write(format!("{folder}/step.json"), report.to_string()).unwrap();
}

fn measure(name: &str, alike: bool) -> serde_json::Value {
    let references: Vec<Vec<Motion>> = (0..ACTIVITIES).map(reference).collect();
    let of_hand = |side: Side| {
        (0u16..)
            .zip(&references)
            .map(move |(k, reference)| nominal(side, reference, if alike { 0 } else { k }))
    };
    let ius: Vec<Vec<NominalIu<'_>>> = Side::ALL.into_iter().flat_map(of_hand).collect();
    let activities: Vec<NominalActivity<'_>> =
        (0u16..).zip(&ius).map(|(activity, ius)| NominalActivity { activity, ius }).collect();
    let job = Job {
        activities: &activities,
        laws: &[],
        objects: &[],
        passive_contacts: &[],
        cost: LocalCost::Circular { bins: 8 },
        max_slowdown: 2.0,
        has_free_ends: true,
        min_captured: 0.0,
    };
    let shapes: Vec<ObjectShape> = (1..=OBJECTS as u16).map(shape).collect();

    let mut encoder = Encoder::new(Method::default(), &shapes).unwrap();
    let mut judge = Judge::<Vec<_>>::with_memory(&job, Method::default()).unwrap().at_start_of_job();
    let (mut verdicts, mut ns) = (0u64, Vec::with_capacity(STEPS));
    for step in 0..STEPS {
        let frame = frame(step);
        let began = Instant::now();
        encoder.step(&frame, &mut |couples| judge.step(&couples, &mut |_| verdicts += 1)).unwrap();
        ns.push(began.elapsed().as_nanos() as u64);
    }
    // Each hand has three IUs and an activity per cycle. This shows that the steps were judged.
    assert!(verdicts >= (STEPS / CYCLE - 1) as u64 * 8, "only {verdicts} verdicts");
    ns.sort_unstable();
    let at = |share: f64| ns[((ns.len() - 1) as f64 * share) as usize] as f64 / 1e3;
    let (p50, p99, max) = (at(0.5), at(0.99), at(1.0));
    println!(
        "core step, {name}: p50 {p50:.1} us, p99 {p99:.1} us, max {max:.1} us, {verdicts} verdicts in {STEPS} steps"
    );
    serde_json::json!({ "p50_us": p50, "p99_us": p99, "max_us": max, "steps": STEPS })
}

/// A motion whose directions turn, each reference at a pace of its own.
fn reference(pace: usize) -> Vec<Motion> {
    let direction = |frame: usize| (frame / (pace + 3) % 9) as i8;
    (0..FRAMES).map(|frame| Motion([0, 0, direction(frame), 1, 0, direction(frame + pace), 0])).collect()
}

/// Grasp, contact and grasp again, with the objects that are carried, or with objects whose ids are higher by 4 times `after`. No distance
/// is too great and no duration too long, so that every candidate remains one.
fn nominal(side: Side, reference: &[Motion], after: u16) -> Vec<NominalIu<'_>> {
    let [j, l] = CARRIED[side.index()].map(|id| id + 4 * after);
    let h = side as u16;
    let any = Bounds { min: 0, max: u32::MAX };
    let contexts = [[h, j, 0, 0], [h, j, j, l], [h, j, 0, 0]];
    contexts
        .map(|context| NominalIu {
            context: Context(context),
            reference,
            threshold: 1e6,
            frames: any,
            reversals: any,
            measures: MeasureBounds::ANY,
        })
        .to_vec()
}

fn shape(id: u16) -> ObjectShape {
    let points = [[0.0; 3], [0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.01, 0.01, 0.0]];
    ObjectShape { id, interaction_points: points.into_iter().collect(), ..ObjectShape::default() }
}

/// A frame of the cycle: each hand carries its object from home to the other object and back, and then leaves.
fn frame(step: usize) -> Frame {
    let mut frame = Frame { captured_ns: step as u64 * PERIOD_NS, ..Frame::default() };
    let phase = step % CYCLE;
    let active = CYCLE - PAUSE;
    // 0 at home, 1 at the other object, where the hand stays while the sine is cut off.
    let way =
        if phase < active { ((phase as f32 / active as f32 * TAU / 2.0).sin() * 1.3).min(1.0) } else { 0.0 };
    let mut objects = [[0.0; 2]; OBJECTS];
    for (index, object) in objects.iter_mut().enumerate() {
        // The objects in the background are 12 cm apart, so that none of them touch.
        *object = [0.12 * (index % 8) as f32, 1.0 + 0.12 * (index / 8) as f32];
    }
    for (side, [j, l]) in Side::ALL.into_iter().zip(CARRIED) {
        let x = if side == Side::Right { 0.5 } else { -0.5 };
        let carried = [x, 0.3 * way];
        objects[usize::from(j) - 1] = carried;
        objects[usize::from(l) - 1] = [x, 0.31];
        let at = if phase < active { carried } else { [x, -0.3] };
        let point = |dx: f32, dy: f32| [at[0] + dx, at[1] + dy, 0.0];
        let tips = [point(-0.01, 0.0), point(0.0, 0.0), point(0.01, 0.0)];
        let hand =
            Hand { side, score: 1.0, wrist: point(0.0, -0.17), middle_knuckle: point(0.0, -0.08), tips };
        frame.hands.push(hand).unwrap();
    }
    for (id, [x, y]) in (1..).zip(objects) {
        frame.objects.push(Object { id, position: [x, y, 0.0], orientation: [1.0, 0.0, 0.0, 0.0] }).unwrap();
    }
    frame
}
