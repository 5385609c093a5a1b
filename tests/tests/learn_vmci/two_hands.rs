//! Two hands of real people: each does a run of its own at a bench of its own, beside the other and at its own time.

use super::capture::{BOX, Capture, RATE_HZ, SHELF, TABLE};
use super::{RUNS, taught_by_others};
use andon_core::config::Method;
use andon_core::input::{Frame, Point, Side, Space};
use andon_core::verdict::Outcome;
use andon_learn::recording::Recording;
use andon_learn::run::Run;
use andon_learn::teach::TeachOptions;
use andon_tests::deletion::{is_accused, jobs};
use andon_tests::environment;
use andon_tests::simulator::Random;
use andon_tests::station::without_points;

/// The bench of the left hand mirrors that of the right one at this place along the x axis, in metres.
const MIRROR_M: f32 = -0.7;

/// By so much the ids of the parts of the left hand exceed those of the right one.
const OF_LEFT: u16 = 10;

/// Neither hand begins later than the other by more than this, in seconds.
const MAX_LATE_S: f64 = 1.0;

/// What a left hand would do that does the same in the mirror.
fn mirrored(frame: &Frame) -> Frame {
    let mirror = |[x, y, z]: Point| [2.0 * MIRROR_M - x, y, z];
    let mut frame = frame.clone();
    for hand in &mut frame.hands {
        hand.side = Side::Left;
        let points = hand.tips.iter_mut().chain([&mut hand.wrist, &mut hand.middle_knuckle]);
        points.for_each(|point| *point = mirror(*point));
    }
    for object in &mut frame.objects {
        let [w, x, y, z] = object.orientation;
        (object.id, object.position) = (object.id + OF_LEFT, mirror(object.position));
        object.orientation = [w, x, -y, -z];
    }
    frame
}

/// Both runs at once, the left one so many frames after the right one, or before it. Who waits or is done rests.
fn together(right: &Recording, left: &Recording, late: i32) -> Recording {
    let at = |run: &Recording, frame: i32| {
        run.frames[frame.clamp(0, run.frames.len() as i32 - 1) as usize].clone()
    };
    let (first, last) = (late.min(0), (right.frames.len() as i32).max(left.frames.len() as i32 + late));
    let frames = (first..last).map(|frame| {
        let (mut both, other) = (at(right, frame), mirrored(&at(left, frame - late)));
        both.hands.extend(other.hands);
        both.objects.extend(other.objects);
        both.captured_ns = (f64::from(frame - first) / f64::from(RATE_HZ) * 1e9).round() as u64;
        both
    });
    let mut both = Recording { frames: frames.collect(), ..right.clone() };
    both.header.hands = vec![Side::Right, Side::Left];
    for object in &left.header.objects {
        let mut object = object.clone();
        object.shape.id += OF_LEFT;
        object.name = format!("left {}", object.name);
        both.header.objects.push(object);
    }
    both
}

/// `ANDON_SEED` chooses which run the left hand does beside which, and how much later.
#[test]
fn two_hands_that_each_do_a_run_of_their_own_are_right_and_what_either_leaves_out_is_found() {
    let method = Method { space: Space::Metric, ..Method::default() };
    let seed = environment::number("ANDON_SEED", 72);
    let mut random = Random::new(seed, &[7]);
    let shift = 1 + random.index(8) as u32;
    let late: Vec<i32> =
        RUNS.map(|_| (f64::from(RATE_HZ) * random.between(-MAX_LATE_S, MAX_LATE_S)) as i32).collect();
    // Each run has another one beside it.
    let other = |number: u32| 1 + (number - 1 + shift) % 9;
    let compose = |number: u32, right: Capture, left: Capture| {
        let both = together(&right.recording(), &left.recording(), late[number as usize - 1]);
        Run::new("run", "", &without_points(both), &method).unwrap()
    };
    let whole = |number| compose(number, Capture::read(number), Capture::read(other(number)));
    let runs: Vec<Run> = RUNS.map(whole).collect();
    let (mut right, mut missed) = (Vec::new(), Vec::new());
    for (left_out, number) in RUNS.enumerate() {
        let (job, _) = taught_by_others(&runs, left_out, &TeachOptions::new("two hands", "", method));
        right.extend((jobs(&whole(number).judge(&job).unwrap()) == [Outcome::Ok]).then_some(number));
        let (one, two) = (Capture::read(number), Capture::read(other(number)));
        for (side, fault) in [
            (Side::Right, compose(number, one.clone().without_second_half(), two.clone())),
            (Side::Left, compose(number, one, two.without_second_half())),
        ] {
            missed.extend((!is_accused(&fault.judge(&job).unwrap())).then_some((number, side)));
        }
    }
    assert_eq!(right, RUNS.collect::<Vec<u32>>());
    assert!(missed.is_empty(), "{missed:?}");
    let parts: Vec<u16> = runs[0].objects.iter().map(|object| object.shape.id).collect();
    assert_eq!(parts, [BOX, TABLE, SHELF, BOX + OF_LEFT, TABLE + OF_LEFT, SHELF + OF_LEFT]);
}
