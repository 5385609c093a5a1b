//! From a script to the true positions at each instant, without noise.

use super::bench::{Bench, Part, Pose};
use super::script::{Action, Labels, Script, TrueIu};
use super::{Person, Random, Vector, add, length, scale, subtract, turn};
use andon_core::couple::Context;
use andon_core::input::Side;

/// Maximum distance between tip and work point of parts that touch, in metres.
const TOUCHING_M: f64 = 0.012;

/// The length of the straight way along which a part is brought to another one, in metres.
const APPROACH_M: f64 = 0.12;

/// The true positions at one instant.
#[derive(Clone, Debug)]
pub struct Instant {
    /// Time since the beginning, in seconds.
    pub time_s: f64,
    /// Centre of the finger tips on the bench, in metres; `None` while the hand is out of the picture.
    pub grip: Option<Vector>,
    /// Direction of the fingers in radians; 0 points away from the person.
    pub hand_yaw: f64,
    /// 0 if the hand is open, 1 if it is closed.
    pub closed: f64,
    /// Id of the held part.
    pub held: Option<u16>,
    /// Id and pose of each part.
    pub poses: Vec<(u16, Pose)>,
}

/// What truly happened.
#[derive(Clone, Debug)]
pub struct Truth {
    /// The hand.
    pub side: Side,
    /// One instant per frame.
    pub instants: Vec<Instant>,
    /// The IUs that were intended.
    pub labels: Labels,
}

/// Carries out a script, at `rate_hz` instants per second.
pub(super) fn carry_out(
    script: &Script,
    person: &Person,
    bench: &Bench,
    rate_hz: f64,
    random: &mut Random,
) -> Truth {
    let mut actor = Actor {
        person,
        random,
        rate_hz,
        bench: bench.clone(),
        grip: Some(bench.rest),
        side: script.side,
        closed: 0.0,
        held: None,
        resting_at: touching(bench),
        tempo: 1.0,
        hesitate_s: 0.0,
        instants: Vec::new(),
        labels: Labels::default(),
    };
    actor.hold(0.5);
    for action in &script.actions {
        actor.act(*action);
    }
    // The hand stays where it is until the recording is stopped.
    actor.hold(0.8);
    Truth { side: script.side, instants: actor.instants, labels: actor.labels }
}

/// The pairs of parts whose tip and work point touch before the first movement.
fn touching(bench: &Bench) -> Vec<(u16, u16)> {
    let mut pairs = Vec::new();
    for (part, pose) in &bench.parts {
        for (other, other_pose) in &bench.parts {
            let gap_m = length(subtract(pose.point(part.tip), other_pose.point(other.work)));
            if part.id != other.id && gap_m < TOUCHING_M {
                pairs.push((part.id, other.id));
            }
        }
    }
    pairs
}

/// Carries out one action after the other, and records an instant per frame.
struct Actor<'a> {
    person: &'a Person,
    random: &'a mut Random,
    rate_hz: f64,
    bench: Bench,
    grip: Option<Vector>,
    side: Side,
    closed: f64,
    /// The held part, and the point of its frame that the hand holds.
    held: Option<(Part, Vector)>,
    /// Each part that touches another one, and the id of that other part.
    resting_at: Vec<(u16, u16)>,
    /// Multiple of the usual time that an action takes.
    tempo: f64,
    /// Seconds for which the next movement stops in its middle.
    hesitate_s: f64,
    instants: Vec<Instant>,
    labels: Labels,
}

/// Progress of a minimum-jerk movement, 0 to 1, at a share of its duration, 0 to 1 (Flash and Hogan 1985).
pub(super) fn minimum_jerk(share: f64) -> f64 {
    let share = share.clamp(0.0, 1.0);
    share.powi(3) * (10.0 - 15.0 * share + 6.0 * share * share)
}

/// The direction of the fingers of a hand at this point: they point away from the shoulder, which is in front of the bench.
pub(super) fn hand_yaw(side: Side, at: Vector) -> f64 {
    let shoulder = match side {
        Side::Right => [0.2, -0.55],
        Side::Left => [-0.2, -0.55],
    };
    let away = subtract(at, shoulder);
    away[1].atan2(away[0]) - std::f64::consts::FRAC_PI_2
}

impl Actor<'_> {
    fn act(&mut self, action: Action) {
        match action {
            Action::Take(id) => self.take(id),
            Action::Bring { to, heading, gap_m } => self.bring(to, heading, gap_m),
            Action::Pull(by) => self.pull(by),
            Action::Put(pose) => self.put(pose),
            Action::Stroke { on, count, along } => self.stroke(on, count, along),
            Action::Hold(seconds) => self.hold(seconds),
            Action::Hesitate(seconds) => self.hesitate_s = seconds,
            Action::Release => self.release(),
            Action::Rest => self.go(self.bench.rest, None, 0.0),
            Action::LeavePicture(seconds) => self.leave_picture(seconds),
            Action::Tempo(factor) => self.tempo = factor,
        }
    }

    fn take(&mut self, id: u16) {
        let part = Part::of(id);
        let slack = [0.004 * self.random.normal(), 0.004 * self.random.normal()];
        let own = add(add(part.grasp, self.person.grip_offset_m), slack);
        self.go(self.bench.pose(id).point(own), None, 0.0);
        self.closed = 1.0;
        self.held = Some((part, own));
        let context = match self.resting_at.iter().find(|(j, _)| *j == id) {
            Some((_, l)) => self.context(id, *l),
            None => self.context(id, 0),
        };
        self.labels.activities.push(Vec::new());
        self.label(context);
        self.dwell();
    }

    fn bring(&mut self, to: u16, heading: f64, gap_m: f64) {
        let Some((part, _)) = self.held else { return };
        self.part_from(part.id);
        let there = self.bench.pose(to);
        let yaw = there.yaw + heading + 0.03 * self.random.normal();
        let slack = 0.003 * self.random.normal();
        let tip = add(there.point(Part::of(to).work), turn([-gap_m - slack, slack], yaw));
        let pose = Pose { at: subtract(tip, turn(part.tip, yaw)), yaw };
        // It arrives along its heading.
        let before = Pose { at: subtract(pose.at, turn([APPROACH_M, 0.0], yaw)), yaw };
        self.carry(before, 0.6);
        self.carry(pose, 0.0);
        self.label(self.context(part.id, to));
        self.resting_at.push((part.id, to));
        self.dwell();
    }

    fn pull(&mut self, by: Vector) {
        let Some((part, _)) = self.held else { return };
        let pose = self.bench.pose(part.id);
        self.carry(Pose { at: pose.point(by), yaw: pose.yaw }, 0.0);
        self.part_from(part.id);
    }

    fn put(&mut self, pose: Pose) {
        let Some((part, _)) = self.held else { return };
        self.part_from(part.id);
        let slack = [0.008 * self.random.normal(), 0.008 * self.random.normal()];
        let yaw = pose.yaw + 0.05 * self.random.normal();
        self.carry(Pose { at: add(pose.at, slack), yaw }, 0.0);
    }

    fn stroke(&mut self, on: u16, count: u32, along: f64) {
        let Some((part, _)) = self.held else { return };
        let middle = self.bench.pose(part.id);
        let along = self.bench.pose(on).yaw + along;
        let reach = |way_m: f64| Pose { at: add(middle.at, turn([way_m, 0.0], along)), ..middle };
        for half in 0..2 * count {
            let stroke = 0.5 * self.person.stroke_m * self.random.factor(0.08);
            let end = if half % 2 == 0 { stroke } else { -stroke };
            let seconds = self.person.half_stroke_s * self.random.factor(0.06);
            self.carry_in(reach(end), seconds * if half == 0 { 0.6 } else { 1.0 });
        }
        self.carry_in(middle, 0.6 * self.person.half_stroke_s);
    }

    fn release(&mut self) {
        let Some((part, _)) = self.held.take() else { return };
        self.dwell();
        self.closed = 0.0;
        if let Some((j, l)) = self.resting_at.iter().copied().find(|(j, _)| *j == part.id) {
            self.label(Context([0, 0, j, l]));
        }
    }

    fn leave_picture(&mut self, seconds: f64) {
        let back = self.grip;
        self.grip = None;
        self.hold(seconds);
        self.grip = back;
    }

    fn dwell(&mut self) {
        let seconds = self.person.dwell_s * self.random.factor(0.2);
        self.hold(seconds);
    }

    /// Carries the held part to a pose in the person's own time; see [`move_hand`](Self::move_hand) for `flow`.
    fn carry(&mut self, pose: Pose, flow: f64) {
        let Some((_, own)) = self.held else { return };
        self.go(pose.point(own), Some(pose), flow);
    }

    /// Carries the held part straight to a pose in this time.
    fn carry_in(&mut self, pose: Pose, seconds: f64) {
        let Some((_, own)) = self.held else { return };
        self.move_hand(pose.point(own), Some(pose), seconds, 0.0, 0.0);
    }

    /// Moves the hand, and the held part to a pose, in the person's own time.
    fn go(&mut self, to: Vector, part: Option<Pose>, flow: f64) {
        let way = self.grip.map_or(0.0, |grip| length(subtract(to, grip)));
        if way < 1e-4 {
            return;
        }
        let seconds = self.person.movement_s(way) * self.random.factor(0.06);
        let lateral = (self.person.lateral + 0.02 * self.random.normal()) * way;
        self.move_hand(to, part, seconds, lateral, flow);
    }

    /// Moves the hand, and the held part to a pose. `lateral` is the lateral deviation of the path in metres. `flow`, 0 to 1, says how much of the
    /// slowing down at the end is left out because the next movement takes over.
    fn move_hand(&mut self, to: Vector, part: Option<Pose>, seconds: f64, lateral: f64, flow: f64) {
        let Some(from) = self.grip else { return };
        let way = subtract(to, from);
        let aside = scale(turn(way, std::f64::consts::FRAC_PI_2), lateral / length(way).max(1e-6));
        let start = self.held.map(|(part, _)| self.bench.pose(part.id));
        let frames = (seconds * self.tempo * self.rate_hz).round().max(1.0) as usize;
        let pause_s = std::mem::take(&mut self.hesitate_s);
        // A movement that flows into the next one is cut off before it comes to rest.
        let cut = 1.0 - 0.4 * flow;
        let whole = minimum_jerk(cut);
        for frame in 1..=frames {
            let progress = minimum_jerk(cut * frame as f64 / frames as f64) / whole;
            let bell = 16.0 * (progress * (1.0 - progress)).powi(2);
            let grip = add(add(from, scale(way, progress)), scale(aside, bell));
            self.grip = Some(grip);
            if let (Some((held, own)), Some(start), Some(end)) = (self.held, start, part) {
                let yaw = start.yaw + progress * (end.yaw - start.yaw);
                self.bench.set_pose(held.id, Pose { at: subtract(grip, turn(own, yaw)), yaw });
            }
            self.record();
            if pause_s > 0.0 && frame == frames / 2 {
                self.hold(pause_s);
            }
        }
    }

    fn hold(&mut self, seconds: f64) {
        for _ in 0..(seconds * self.tempo * self.rate_hz).round() as usize {
            self.record();
        }
    }

    fn record(&mut self) {
        self.instants.push(Instant {
            time_s: self.now_s(),
            grip: self.grip,
            hand_yaw: hand_yaw(self.side, self.grip.unwrap_or(self.bench.rest)),
            closed: self.closed,
            held: self.held.map(|(part, _)| part.id),
            poses: self.bench.parts.iter().map(|(part, pose)| (part.id, *pose)).collect(),
        });
    }

    fn now_s(&self) -> f64 {
        self.instants.len() as f64 / self.rate_hz
    }

    /// Ends the contact of a held part with another one.
    fn part_from(&mut self, id: u16) {
        let before = self.resting_at.len();
        self.resting_at.retain(|(j, _)| *j != id);
        if self.resting_at.len() < before {
            self.label(self.context(id, 0));
        }
    }

    fn context(&self, j: u16, l: u16) -> Context {
        let hand = self.side as u16;
        if l == 0 { Context([hand, j, 0, 0]) } else { Context([hand, j, j, l]) }
    }

    /// Labels the beginning of an IU.
    fn label(&mut self, context: Context) {
        let began_s = self.now_s();
        if let Some(activity) = self.labels.activities.last_mut() {
            activity.push(TrueIu { context, began_s });
        }
    }
}
