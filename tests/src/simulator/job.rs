//! The job of the paper's second experiment: to polish the brick, then to measure it.

use super::Random;
use super::bench::{BRICK_ID, Bench, METER_ID, POLISHER_ID, Pose};
use super::flaw::Flaw;
use super::movement::Truth;
use super::performance::Performance;
use super::script::{Action, Script};
use andon_core::input::Side;
use andon_learn::recording::Recording;
use std::f64::consts::{FRAC_PI_2, PI};

/// Number of strokes of a complete polishing; the paper's `J1` stops halfway.
pub(super) const STROKES: u32 = 6;

pub(super) const POLISHER: Pose = Pose { at: [-0.25, -0.1], yaw: FRAC_PI_2 };
pub(super) const BRICK: Pose = Pose { at: [-0.1, 0.08], yaw: 0.0 };
pub(super) const METER: Pose = Pose { at: [0.28, 0.13], yaw: 0.0 };

/// Carries out the job of the second experiment.
pub fn perform(performance: &Performance, flaw: Flaw) -> (Recording, Truth) {
    let (person, mut random) = performance.person(flaw as u64);
    let part = |id, pose: Pose| (id, pose.at[0], pose.at[1], pose.yaw);
    let mut bench = Bench::new(&[part(POLISHER_ID, POLISHER), part(BRICK_ID, BRICK), part(METER_ID, METER)]);
    performance.settle(&mut bench, &person, &mut random);
    disturb(&mut bench, flaw, &mut random);
    let side = if flaw == Flaw::WrongHand { Side::Left } else { Side::Right };
    let script = Script { side, actions: actions(flaw, &bench, &mut random) };
    performance.record(&script, &person, &bench, &mut random)
}

/// Moves the parts as the flaw requires.
fn disturb(bench: &mut Bench, flaw: Flaw, random: &mut Random) {
    match flaw {
        Flaw::Shifted => bench.move_all([0.08, -0.05], 0.0),
        Flaw::Turned => bench.move_all([0.0; 2], if random.uniform() < 0.5 { PI / 6.0 } else { -PI / 6.0 }),
        Flaw::PartsMoved => {
            for id in [METER_ID, POLISHER_ID, BRICK_ID] {
                let direction = random.between(0.0, 2.0 * PI);
                let yaw = if random.uniform() < 0.5 { 0.21 } else { -0.21 };
                bench.move_part(id, [0.03 * direction.cos(), 0.03 * direction.sin()], yaw);
            }
        }
        Flaw::Reversed => {
            // The brick is at the meter already.
            let meter = bench.pose(METER_ID);
            bench.set_pose(BRICK_ID, Pose { at: meter.point([-0.05 - 0.06, 0.0]), yaw: meter.yaw });
        }
        _ => {}
    }
}

fn actions(flaw: Flaw, bench: &Bench, random: &mut Random) -> Vec<Action> {
    let polishing = polishing(flaw, bench);
    let measuring = measuring(flaw, bench, random);
    let mut all = match flaw {
        Flaw::WrongOrder => [measuring, polishing].concat(),
        Flaw::HalfSpeed => [vec![Action::Tempo(2.0)], polishing, measuring].concat(),
        _ => [polishing, measuring].concat(),
    };
    all.push(Action::Rest);
    all
}

/// The first activity: to polish the brick, and to put the polisher back.
fn polishing(flaw: Flaw, bench: &Bench) -> Vec<Action> {
    let polish = |tool: u16, strokes: Vec<Action>| {
        let bring = Action::Bring { to: BRICK_ID, heading: FRAC_PI_2, gap_m: 0.0 };
        let put_back = [Action::Put(bench.pose(tool)), Action::Release];
        [vec![Action::Take(tool), bring], strokes, put_back.to_vec()].concat()
    };
    let strokes = |count, along| Action::Stroke { on: BRICK_ID, count, along };
    let all_strokes = strokes(STROKES, 0.0);
    match flaw {
        Flaw::J1 => polish(POLISHER_ID, vec![strokes(STROKES / 2, 0.0)]),
        Flaw::CutShort => polish(POLISHER_ID, vec![strokes(1, 0.0)]),
        Flaw::Across => polish(POLISHER_ID, vec![strokes(STROKES, FRAC_PI_2)]),
        Flaw::WrongObject => polish(METER_ID, vec![all_strokes]),
        Flaw::StepLeftOut => {
            let lifted = Pose { at: [POLISHER.at[0], POLISHER.at[1] + 0.05], yaw: POLISHER.yaw };
            let put_back = Action::Put(bench.pose(POLISHER_ID));
            vec![Action::Take(POLISHER_ID), Action::Put(lifted), put_back, Action::Release]
        }
        Flaw::ActivityLeftOut => Vec::new(),
        Flaw::StepTwice => polish(POLISHER_ID, vec![all_strokes]).repeat(2),
        Flaw::Rushed => polish(POLISHER_ID, vec![Action::Tempo(0.33), all_strokes, Action::Tempo(1.0)]),
        Flaw::OffPicture => {
            polish(POLISHER_ID, vec![strokes(3, 0.0), Action::LeavePicture(2.0), strokes(3, 0.0)])
        }
        _ => polish(POLISHER_ID, vec![all_strokes]),
    }
}

/// The second activity: to bring the brick to the meter.
fn measuring(flaw: Flaw, bench: &Bench, random: &mut Random) -> Vec<Action> {
    let take = Action::Take(BRICK_ID);
    let bring = Action::Bring { to: METER_ID, heading: 0.0, gap_m: 0.005 };
    match flaw {
        Flaw::J2 => {
            let from = bench.pose(BRICK_ID);
            let direction = random.between(-0.6, 0.6);
            let at = from.point([0.06 * direction.cos(), 0.06 * direction.sin()]);
            vec![take, Action::Put(Pose { at, yaw: from.yaw }), Action::Release]
        }
        Flaw::Reversed => vec![take, Action::Pull([-0.2, 0.0]), Action::Release],
        Flaw::Hesitation => vec![take, Action::Hesitate(1.5), bring, Action::Hold(0.6), Action::Release],
        _ => vec![take, bring, Action::Hold(0.6), Action::Release],
    }
}
