//! The activities of the paper's first experiment.

use super::bench::{Bench, PlannedPart, Pose};
use super::job::{BRICK, POLISHER, STROKES};
use super::movement::Truth;
use super::performance::Performance;
use super::script::{Action, Script};
use andon_core::input::Side;
use andon_learn::recording::Recording;
use std::f64::consts::FRAC_PI_2;

/// The layout of the parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Layout {
    /// The plan, with small differences for each person and each repetition.
    Plan,
    /// One of the paper's three layouts for drilling, 0 to 2.
    Drilling(usize),
}

/// Carries out an activity of the first experiment, by the name that the paper gives it.
///
/// # Panics
/// If the paper has no such activity.
pub fn perform_activity(performance: &Performance, activity: &str, layout: Layout) -> (Recording, Truth) {
    let what = activity.bytes().fold(100, |sum, byte| 31 * sum + u64::from(byte));
    let what = if let Layout::Drilling(index) = layout { what + index as u64 } else { what };
    let (person, mut random) = performance.person(what);
    let (parts, actions) = plan(activity, layout);
    let mut bench = Bench::new(&parts);
    performance.settle(&mut bench, &person, &mut random);
    if activity == "disassembly" {
        // Profile and corner are assembled: the tip of the profile is at the corner.
        let corner = bench.pose(2);
        bench.set_pose(1, Pose { at: corner.point([-0.11, 0.0]), yaw: corner.yaw });
    }
    performance.record(&Script { side: Side::Right, actions }, &person, &bench, &mut random)
}

/// The parts and the actions.
// A name that the paper does not have is a mistake in a test.
#[allow(clippy::panic)]
fn plan(activity: &str, layout: Layout) -> (Vec<PlannedPart>, Vec<Action>) {
    let bring = |to| Action::Bring { to, heading: 0.0, gap_m: 0.005 };
    let leave = [Action::Hold(0.4), Action::Release, Action::Rest];
    match activity {
        "boxing" => (
            vec![(1, -0.1, 0.0, 0.0), (4, 0.24, 0.1, 0.0)],
            [vec![Action::Take(1), bring(4)], leave.into()].concat(),
        ),
        "measuring" => (
            vec![(1, -0.1, 0.0, 0.0), (3, 0.29, 0.1, 0.0)],
            [vec![Action::Take(1), bring(3)], leave.into()].concat(),
        ),
        "assembly" => (
            vec![(1, -0.1, 0.0, 0.0), (2, 0.24, 0.1, 0.0)],
            [vec![Action::Take(1), bring(2)], leave.into()].concat(),
        ),
        "disassembly" => (
            vec![(1, 0.13, 0.1, 0.0), (2, 0.24, 0.1, 0.0)],
            vec![Action::Take(1), Action::Hold(0.3), Action::Pull([-0.18, -0.05]), Action::Hold(0.4)],
        ),
        "polishing" => (
            vec![(5, POLISHER.at[0], POLISHER.at[1], POLISHER.yaw), (6, BRICK.at[0], BRICK.at[1], BRICK.yaw)],
            vec![
                Action::Take(5),
                Action::Bring { to: 6, heading: FRAC_PI_2, gap_m: 0.0 },
                Action::Stroke { on: 6, count: STROKES, along: 0.0 },
                Action::Pull([-0.15, 0.0]),
                Action::Hold(0.4),
            ],
        ),
        "drilling" => (
            match layout {
                Layout::Drilling(0) => vec![(7, 0.15, -0.1, 0.8), (6, -0.05, 0.1, 0.0)],
                Layout::Drilling(1) => vec![(7, -0.12, -0.12, 0.2), (6, 0.15, 0.05, -0.6)],
                _ => vec![(7, 0.25, 0.05, 2.4), (6, -0.08, -0.05, 0.7)],
            },
            vec![
                Action::Take(7),
                Action::Bring { to: 6, heading: FRAC_PI_2, gap_m: 0.005 },
                Action::Hold(5.0),
                Action::Pull([-0.15, 0.0]),
                Action::Hold(0.4),
            ],
        ),
        other => panic!("the paper has no activity {other:?}"),
    }
}
