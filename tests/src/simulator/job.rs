//! The jobs of the paper's experiments, and everything that a shop floor does to them.

use super::bench::{Bench, Pose};
use super::movement::{Action, Script, Truth, carry_out};
use super::noise::Noise;
use super::{Person, Random};
use andon_core::input::Side;
use andon_learn::recording::Recording;
use std::f64::consts::{FRAC_PI_2, PI};

/// Strokes of a whole polishing; the paper's `J1` stops halfway.
const STROKES: u32 = 6;

/// What goes wrong, or looks as if it did, in the job of the paper's second experiment: polish the brick, measure it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Flaw {
    /// Nothing.
    None,
    /// The paper's `J1`: polishing stops halfway, 3 strokes of 6.
    J1,
    /// The paper's `J2`: the brick is taken, moved a little and put down, never measured.
    J2,
    /// The meter is taken in place of the polisher and rubbed with.
    WrongObject,
    /// Measured first, polished after.
    WrongOrder,
    /// The polisher is taken and put back, the brick is not touched with it.
    StepLeftOut,
    /// The polishing is left out altogether.
    ActivityLeftOut,
    /// The polishing is done twice.
    StepTwice,
    /// One stroke of six.
    CutShort,
    /// The brick is taken from the meter in place of brought to it.
    Reversed,
    /// Rubbed across the brick in place of along it.
    Across,
    /// All strokes, at three times the speed.
    Rushed,
    /// All with the left hand.
    WrongHand,
    /// A pause of a second and a half in mid-carry: no anomaly.
    Hesitation,
    /// The whole bench lies 8 cm off: no anomaly.
    Shifted,
    /// The whole bench is turned by 30 degrees: no anomaly.
    Turned,
    /// Each part lies 3 cm and 12 degrees off: no anomaly.
    PartsMoved,
    /// The hand leaves the picture for two seconds while it polishes.
    OffPicture,
    /// All of it takes twice the time: no anomaly.
    HalfSpeed,
}

impl Flaw {
    /// All of them.
    pub const ALL: [Self; 19] = [
        Self::None,
        Self::J1,
        Self::J2,
        Self::WrongObject,
        Self::WrongOrder,
        Self::StepLeftOut,
        Self::ActivityLeftOut,
        Self::StepTwice,
        Self::CutShort,
        Self::Reversed,
        Self::Across,
        Self::Rushed,
        Self::WrongHand,
        Self::Hesitation,
        Self::Shifted,
        Self::Turned,
        Self::PartsMoved,
        Self::OffPicture,
        Self::HalfSpeed,
    ];

    /// As it stands in a file's name.
    pub const fn word(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::J1 => "J1",
            Self::J2 => "J2",
            Self::WrongObject => "wrong_object",
            Self::WrongOrder => "order",
            Self::StepLeftOut => "step_left_out",
            Self::ActivityLeftOut => "activity_left_out",
            Self::StepTwice => "twice",
            Self::CutShort => "cut_short",
            Self::Reversed => "reversed",
            Self::Across => "across",
            Self::Rushed => "rushed",
            Self::WrongHand => "wrong_hand",
            Self::Hesitation => "hesitation",
            Self::Shifted => "shifted",
            Self::Turned => "turned",
            Self::PartsMoved => "parts_moved",
            Self::OffPicture => "off_picture",
            Self::HalfSpeed => "half_speed",
        }
    }

    /// What the judge must say of a job with this flaw.
    pub const fn expected(self) -> Expected {
        match self {
            Self::None
            | Self::Hesitation
            | Self::Shifted
            | Self::Turned
            | Self::PartsMoved
            | Self::HalfSpeed => Expected::Right,
            Self::OffPicture => Expected::NotOk,
            _ => Expected::Anomaly,
        }
    }
}

/// What the judge must say of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expected {
    /// Every verdict is OK.
    Right,
    /// There is an anomaly, and the job is not OK.
    Anomaly,
    /// There may be an anomaly or none, but not everything is OK: part of it was not seen.
    NotOk,
}

/// Where things lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Layout {
    /// The plan, with each person's and each repetition's own small differences.
    Plan,
    /// The paper's drilling configurations, 0 to 2.
    Drilling(usize),
}

/// Who does what, the how-manieth time.
#[derive(Clone, Copy, Debug)]
pub struct Performance {
    /// Seed of everything.
    pub seed: u64,
    /// The person's number.
    pub person: u64,
    /// The repetition.
    pub repetition: u64,
    /// What is taken away.
    pub noise: Noise,
}

impl Performance {
    fn person(&self, what: u64) -> (Person, Random) {
        let mut random = Random::new(self.seed, &[2, self.person, self.repetition, what]);
        let person = Person::new(self.seed, self.person).repetition(&mut random);
        (person, random)
    }

    /// This person's bench: where the parts lie is the person's habit, and a little different each time.
    fn settle(&self, bench: &mut Bench, person: &Person, random: &mut Random) {
        let mut habit = Random::new(self.seed, &[3, self.person]);
        bench.jitter(&mut habit, 0.5 * person.layout_m, 0.05);
        bench.jitter(random, 0.006, 0.04);
    }

    fn record(
        &self,
        script: &Script,
        person: &Person,
        bench: &Bench,
        random: &mut Random,
    ) -> (Recording, Truth) {
        let truth = carry_out(script, person, bench, self.noise.rate_hz, random);
        let mut habit = Random::new(self.seed, &[4, self.person]);
        (self.noise.see(&truth, person, &mut habit, random), truth)
    }
}

const POLISHER: Pose = Pose { at: [-0.25, -0.1], yaw: FRAC_PI_2 };
const BRICK: Pose = Pose { at: [-0.1, 0.08], yaw: 0.0 };
const METER: Pose = Pose { at: [0.28, 0.13], yaw: 0.0 };

/// Carries out the job of the second experiment.
pub fn perform(performance: &Performance, flaw: Flaw) -> (Recording, Truth) {
    let (person, mut random) = performance.person(flaw as u64);
    let place = |id, pose: Pose| (id, pose.at[0], pose.at[1], pose.yaw);
    let mut bench = Bench::new(&[place(5, POLISHER), place(6, BRICK), place(3, METER)]);
    performance.settle(&mut bench, &person, &mut random);
    match flaw {
        Flaw::Shifted => bench.move_all([0.08, -0.05], 0.0),
        Flaw::Turned => bench.move_all([0.0; 2], if random.uniform() < 0.5 { PI / 6.0 } else { -PI / 6.0 }),
        Flaw::PartsMoved => {
            for id in [3, 5, 6] {
                let way = random.between(0.0, 2.0 * PI);
                let yaw = if random.uniform() < 0.5 { 0.21 } else { -0.21 };
                bench.move_part(id, [0.03 * way.cos(), 0.03 * way.sin()], yaw);
            }
        }
        Flaw::Reversed => {
            // The brick lies at the meter already.
            let meter = bench.parts.iter().find(|(part, _)| part.id == 3).map_or(METER, |(_, pose)| *pose);
            for (_, pose) in bench.parts.iter_mut().filter(|(part, _)| part.id == 6) {
                *pose = Pose { at: meter.point([-0.05 - 0.06, 0.0]), yaw: meter.yaw };
            }
        }
        _ => {}
    }
    let side = if flaw == Flaw::WrongHand { Side::Left } else { Side::Right };
    let script = Script { side, actions: actions(flaw, &bench, &mut random) };
    performance.record(&script, &person, &bench, &mut random)
}

fn actions(flaw: Flaw, bench: &Bench, random: &mut Random) -> Vec<Action> {
    let back =
        |id: u16| bench.parts.iter().find(|(part, _)| part.id == id).map_or(POLISHER, |(_, pose)| *pose);
    let polish = |tool: u16, strokes: Vec<Action>| {
        let mut all = vec![Action::Take(tool), Action::Bring { to: 6, heading: FRAC_PI_2, gap_m: 0.0 }];
        all.extend(strokes);
        all.extend([Action::Put(back(tool)), Action::Release]);
        all
    };
    let strokes = |count, along| vec![Action::Stroke { on: 6, count, along }];
    let bring = Action::Bring { to: 3, heading: 0.0, gap_m: 0.005 };
    let measure = vec![Action::Take(6), bring, Action::Hold(0.6), Action::Release];
    let usual = polish(5, strokes(STROKES, 0.0));
    let first = match flaw {
        Flaw::J1 => polish(5, strokes(STROKES / 2, 0.0)),
        Flaw::CutShort => polish(5, strokes(1, 0.0)),
        Flaw::Across => polish(5, strokes(STROKES, FRAC_PI_2)),
        Flaw::WrongObject => polish(3, strokes(STROKES, 0.0)),
        Flaw::StepLeftOut => {
            let lifted = Pose { at: [POLISHER.at[0], POLISHER.at[1] + 0.05], yaw: POLISHER.yaw };
            vec![Action::Take(5), Action::Put(lifted), Action::Put(back(5)), Action::Release]
        }
        Flaw::ActivityLeftOut => Vec::new(),
        Flaw::StepTwice => [usual.clone(), usual.clone()].concat(),
        Flaw::Rushed => {
            let rushed = vec![Action::Tempo(0.33), strokes(STROKES, 0.0)[0], Action::Tempo(1.0)];
            polish(5, rushed)
        }
        Flaw::OffPicture => {
            polish(5, [strokes(3, 0.0), vec![Action::LeavePicture(2.0)], strokes(3, 0.0)].concat())
        }
        _ => usual,
    };
    let second = match flaw {
        Flaw::J2 => {
            let from = back(6);
            let way = random.between(-0.6, 0.6);
            let moved = Pose { at: from.point([0.06 * way.cos(), 0.06 * way.sin()]), yaw: from.yaw };
            vec![Action::Take(6), Action::Put(moved), Action::Release]
        }
        Flaw::Reversed => vec![Action::Take(6), Action::Pull([-0.2, 0.0]), Action::Release],
        Flaw::Hesitation => [vec![Action::Take(6), Action::Hesitate(1.5)], measure[1..].to_vec()].concat(),
        _ => measure,
    };
    let mut all = match flaw {
        Flaw::WrongOrder => [second, first].concat(),
        Flaw::HalfSpeed => [vec![Action::Tempo(2.0)], first, second].concat(),
        _ => [first, second].concat(),
    };
    all.push(Action::Rest);
    all
}

/// Carries out an activity of the first experiment, by the name that the paper gives it.
///
/// # Panics
/// If the paper has no such activity.
#[allow(clippy::panic)]
pub fn perform_activity(performance: &Performance, activity: &str, layout: Layout) -> (Recording, Truth) {
    let what = activity.bytes().fold(100, |sum, byte| 31 * sum + u64::from(byte));
    let what = if let Layout::Drilling(place) = layout { what + place as u64 } else { what };
    let (person, mut random) = performance.person(what);
    let bring = |to| Action::Bring { to, heading: 0.0, gap_m: 0.005 };
    let leave = [Action::Hold(0.4), Action::Release, Action::Rest];
    let (places, actions): (Vec<_>, Vec<Action>) = match activity {
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
    };
    let mut bench = Bench::new(&places);
    performance.settle(&mut bench, &person, &mut random);
    if activity == "disassembly" {
        // Interlocked: where the corner is, the profile's tip is.
        let corner = bench.parts[1].1;
        bench.parts[0].1 = Pose { at: corner.point([-0.11, 0.0]), yaw: corner.yaw };
    }
    performance.record(&Script { side: Side::Right, actions }, &person, &bench, &mut random)
}
