//! Two hands of real people. Each does a run of its own at a bench of its own, beside the other and at its own time.

use super::capture::{BOX, Capture, RATE_HZ, SHELF, TABLE};
use super::{RUNS, all_taught_by_others};
use andon_core::config::Method;
use andon_core::input::{Frame, Point, Side, Space};
use andon_core::verdict::Outcome;
use andon_learn::job_file::JobFile;
use andon_learn::recording::Recording;
use andon_learn::run::Run;
use andon_learn::teach::TeachOptions;
use andon_tests::deletion::{Deletion, Hidden, is_accused, jobs, length_s};
use andon_tests::environment;
use andon_tests::rate::Rate;
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

/// Which run the left hand does beside which of the right hand, and how much later.
struct Pairing {
    shift: u32,
    late: Vec<i32>,
}

impl Pairing {
    fn any(random: &mut Random) -> Self {
        let shift = 1 + random.index(8) as u32;
        let late =
            RUNS.map(|_| (f64::from(RATE_HZ) * random.between(-MAX_LATE_S, MAX_LATE_S)) as i32).collect();
        Self { shift, late }
    }

    /// The run of the left hand beside this one. Each run has another one beside it.
    fn other(&self, number: u32) -> u32 {
        1 + (number - 1 + self.shift) % 9
    }

    fn recording(&self, number: u32, right: Capture, left: Capture) -> Recording {
        let both = together(&right.recording(), &left.recording(), self.late[number as usize - 1]);
        without_points(both)
    }

    fn whole(&self, number: u32) -> Recording {
        self.recording(number, Capture::read(number), Capture::read(self.other(number)))
    }
}

fn method() -> Method {
    Method { space: Space::Metric, ..Method::default() }
}

fn run(recording: &Recording) -> Run {
    Run::new("run", "", recording, &method()).unwrap()
}

/// For each run, its number and the job that is taught by all others.
fn taught(pairing: &Pairing) -> Vec<(u32, JobFile)> {
    let runs: Vec<Run> = RUNS.map(|number| run(&pairing.whole(number))).collect();
    all_taught_by_others(&runs, &TeachOptions::new("two hands", "", method()))
}

/// Which run the left hand does beside which, and how much later, is drawn.
#[test]
fn two_hands_that_each_do_a_run_of_their_own_are_right_and_what_either_leaves_out_is_found() {
    let pairing = Pairing::any(&mut Random::new(environment::seed(), &[7]));
    let (mut right, mut found) = (Vec::new(), Vec::new());
    for (number, job) in taught(&pairing) {
        let judged = |recording: &Recording| run(recording).judge(&job).unwrap();
        right.push(jobs(&judged(&pairing.whole(number))) == [Outcome::Ok]);
        let (one, two) = (Capture::read(number), Capture::read(pairing.other(number)));
        for (side, fault) in [
            (Side::Right, pairing.recording(number, one.clone().without_second_half(), two.clone())),
            (Side::Left, pairing.recording(number, one, two.without_second_half())),
        ] {
            let is_found = is_accused(&judged(&fault));
            if !is_found {
                println!("what the {} hand leaves out in run {number} is not found", side.name());
            }
            found.push(is_found);
        }
    }
    Rate::of(right).expect_at_least(0.95, "runs of two hands right");
    Rate::of(found).expect_at_least(0.97, "faults found");
    let parts: Vec<u16> = run(&pairing.whole(1)).objects.iter().map(|object| object.shape.id).collect();
    assert_eq!(parts, [BOX, TABLE, SHELF, BOX + OF_LEFT, TABLE + OF_LEFT, SHELF + OF_LEFT]);
}

/// How often each hand is lost in a run, and for how long, in seconds.
const LOST: usize = 3;
const LOST_S: [f64; 2] = [0.2, 0.4];

/// The recording as of a tracker that loses each hand now and then.
fn with_hands_lost(mut recording: Recording, random: &mut Random) -> Recording {
    let length_s = length_s(&recording);
    for side in Side::ALL {
        for _ in 0..LOST {
            let from_s = random.between(0.0, length_s);
            let lost = Deletion::Stretch(Hidden::Hand(side), from_s, random.between(LOST_S[0], LOST_S[1]));
            recording = lost.of(&recording, random);
        }
    }
    recording
}

/// The IUs last for 0.4 to 0.9 s. When the hands are lost is drawn as well. What was not seen accuses nobody, whatever is drawn.
#[test]
fn hands_that_are_lost_for_a_moment_are_believed_to_hold_what_they_held() {
    let mut random = Random::new(environment::seed(), &[8]);
    let pairing = Pairing::any(&mut random);
    let (mut right, mut accused) = (Vec::new(), 0);
    let taught = taught(&pairing);
    for (number, job) in &taught {
        for _ in 0..4 {
            let verdicts = run(&with_hands_lost(pairing.whole(*number), &mut random)).judge(job).unwrap();
            right.push(jobs(&verdicts) == [Outcome::Ok]);
            accused += usize::from(is_accused(&verdicts));
        }
    }
    Rate::of(right).expect_at_least(0.6, "right although hands were lost");
    assert_eq!(accused, 0, "accused for what was not seen");
}
