//! Two arms at one bench: each moves by itself, and the parts follow the hands that hold them.

mod freely;

pub(super) use freely::Swing;

use super::bench::{Bench, Pose};
use super::movement::{Instant, Truth, hand_yaw, minimum_jerk};
use super::noise::Noise;
use super::script::Labels;
use super::{Person, Random, Vector, add, length, scale, subtract, turn};
use andon_core::input::Side;
use andon_learn::recording::Recording;

/// Where a hand is in one frame, and what it holds.
#[derive(Clone, Copy)]
struct Moment {
    at: Vector,
    held: Option<u16>,
}

/// One hand of a person, and what it has done so far.
pub(super) struct Arm<'a> {
    person: &'a Person,
    random: Random,
    rate_hz: f64,
    side: Side,
    rest: Vector,
    at: Vector,
    held: Option<u16>,
    moments: Vec<Moment>,
}

impl<'a> Arm<'a> {
    pub(super) fn new(person: &'a Person, side: Side, rate_hz: f64, random: Random) -> Self {
        let rest = [if side == Side::Left { -0.25 } else { 0.25 }, -0.3];
        Self { person, random, rate_hz, side, rest, at: rest, held: None, moments: Vec::new() }
    }

    /// For how long it has been at work, in seconds.
    pub(super) fn now_s(&self) -> f64 {
        self.moments.len() as f64 / self.rate_hz
    }

    pub(super) fn wait(&mut self, seconds: f64) {
        let frames = (seconds.max(0.0) * self.rate_hz).round() as usize;
        self.moments.extend(std::iter::repeat_n(Moment { at: self.at, held: self.held }, frames));
    }

    pub(super) fn wait_until(&mut self, time_s: f64) {
        self.wait(time_s - self.now_s());
    }

    /// Moves to a point in the person's own time, with the person's own lateral deviation.
    pub(super) fn go(&mut self, to: Vector) {
        let way = length(subtract(to, self.at));
        let seconds = self.person.movement_s(way) * self.random.factor(0.06);
        let lateral = (self.person.lateral + 0.02 * self.random.normal()) * way;
        self.go_in(to, seconds, lateral);
    }

    /// Moves to a point in this time, with this lateral deviation in metres.
    pub(super) fn go_in(&mut self, to: Vector, seconds: f64, lateral: f64) {
        let (from, way) = (self.at, subtract(to, self.at));
        let aside = scale(turn(way, std::f64::consts::FRAC_PI_2), lateral / length(way).max(1e-6));
        let frames = (seconds * self.rate_hz).round().max(1.0) as usize;
        for frame in 1..=frames {
            let progress = minimum_jerk(frame as f64 / frames as f64);
            let bell = 16.0 * (progress * (1.0 - progress)).powi(2);
            self.at = add(add(from, scale(way, progress)), scale(aside, bell));
            self.moments.push(Moment { at: self.at, held: self.held });
        }
    }

    pub(super) fn dwell(&mut self) {
        let seconds = self.person.dwell_s * self.random.factor(0.2);
        self.wait(seconds);
    }

    /// Reaches for a part at this point and takes it.
    pub(super) fn take(&mut self, id: u16, at: Vector) {
        let slack = [0.004 * self.random.normal(), 0.004 * self.random.normal()];
        self.go(add(add(at, self.person.grip_offset_m), slack));
        self.held = Some(id);
        self.dwell();
    }

    pub(super) fn release(&mut self) {
        self.dwell();
        self.held = None;
        self.dwell();
    }

    /// Carries what it holds by this way, and lets it go there.
    pub(super) fn bring(&mut self, way: Vector) {
        let slack = [0.006 * self.random.normal(), 0.006 * self.random.normal()];
        self.go(add(add(self.at, way), slack));
        self.release();
    }

    /// Rubs with what it holds.
    pub(super) fn stroke(&mut self, count: u32) {
        let middle = self.at;
        for half in 0..2 * count {
            let way = 0.5 * self.person.stroke_m * self.random.factor(0.08);
            let seconds = self.person.half_stroke_s * self.random.factor(0.06);
            self.go_in(add(middle, [if half % 2 == 0 { way } else { -way }, 0.0]), seconds, 0.0);
        }
        self.go_in(middle, self.person.half_stroke_s, 0.0);
    }

    pub(super) fn go_home(&mut self) {
        self.go(self.rest);
    }

    /// Where it is, in metres.
    pub(super) fn at(&self) -> Vector {
        self.at
    }
}

/// What a camera sees of both arms, which begin at the same time.
pub(super) fn see(
    mut arms: [Arm<'_>; 2],
    bench: &Bench,
    noise: &Noise,
    habit: &mut Random,
    random: &mut Random,
) -> Recording {
    let end_s = arms.iter().map(Arm::now_s).fold(0.0, f64::max) + 0.8;
    arms.iter_mut().for_each(|arm| arm.wait_until(end_s));
    let poses = poses(&arms, bench);
    let [right, left] = arms.map(|arm| noise.see(&truth(&arm, &poses), arm.person, habit, random));
    let mut both = right;
    both.header.hands = vec![Side::Right, Side::Left];
    for frame in &mut both.frames {
        let same = left.frames.iter().find(|other| other.captured_ns == frame.captured_ns);
        // There is room for both hands.
        frame.hands.extend(same.into_iter().flat_map(|other| other.hands.clone()));
    }
    both
}

/// The poses of the parts in each frame. A part is where the hands that hold it have carried it, in the middle between two.
fn poses(arms: &[Arm<'_>; 2], bench: &Bench) -> Vec<Vec<(u16, Pose)>> {
    let mut bench = bench.clone();
    let mut held: [Option<(u16, Vector)>; 2] = [None; 2];
    let frames = arms.iter().map(|arm| arm.moments.len()).min().unwrap_or(0);
    (0..frames)
        .map(|frame| {
            for (held, arm) in held.iter_mut().zip(arms) {
                let Moment { at, held: id } = arm.moments[frame];
                *held = id.map(|id| match *held {
                    Some((before, own)) if before == id => (id, own),
                    _ => (id, subtract(bench.pose(id).at, at)),
                });
            }
            for id in held.iter().flatten().map(|(id, _)| *id).collect::<Vec<_>>() {
                let of_part = held.iter().zip(arms).filter_map(|(held, arm)| {
                    held.filter(|(other, _)| *other == id).map(|(_, own)| add(arm.moments[frame].at, own))
                });
                let places: Vec<Vector> = of_part.collect();
                let middle = scale(places.iter().copied().fold([0.0; 2], add), 1.0 / places.len() as f64);
                bench.set_pose(id, Pose { at: middle, ..bench.pose(id) });
            }
            bench.parts.iter().map(|(part, pose)| (part.id, *pose)).collect()
        })
        .collect()
}

fn truth(arm: &Arm<'_>, poses: &[Vec<(u16, Pose)>]) -> Truth {
    let instant = |frame: usize, moment: &Moment, poses: &[(u16, Pose)]| Instant {
        time_s: frame as f64 / arm.rate_hz,
        grip: Some(moment.at),
        hand_yaw: hand_yaw(arm.side, moment.at),
        closed: if moment.held.is_some() { 1.0 } else { 0.0 },
        held: moment.held,
        poses: poses.to_vec(),
    };
    let moments = arm.moments.iter().zip(poses).enumerate();
    let instants = moments.map(|(frame, (moment, poses))| instant(frame, moment, poses)).collect();
    Truth { side: arm.side, instants, labels: Labels::default() }
}
