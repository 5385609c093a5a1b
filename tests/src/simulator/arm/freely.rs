//! How a hand moves that nobody has drilled: its ways, counts and pauses differ from time to time.

use super::Arm;
use crate::simulator::{Vector, add, length, scale, subtract, turn};
use std::f64::consts::TAU;

/// How often a grip is corrected, of all times that a hand takes something or puts it down.
const CORRECTED: f64 = 0.06;

/// How a hand works to and fro or around with a tool.
#[derive(Clone, Copy, Debug)]
pub(in crate::simulator) struct Swing {
    /// Half of the long way across, in metres.
    pub size_m: f64,
    /// The short way across as a share of the long one: 0 is to and fro, 1 a circle.
    pub roundness: f64,
    /// The direction of the long way, in radians.
    pub along: f64,
    /// How long it takes once around, in seconds.
    pub period_s: f64,
}

impl Arm<'_> {
    /// Begins here instead of at the usual place of rest, and comes back to it.
    pub(in crate::simulator) fn rest_at(&mut self, at: Vector) {
        (self.rest, self.at) = (at, at);
    }

    /// Moves to a point, now faster and now slower, by a way that may deviate to either side.
    pub(in crate::simulator) fn wander_to(&mut self, to: Vector) {
        let way = length(subtract(to, self.at));
        let seconds = self.person.movement_s(way) * self.random.factor(0.2);
        let lateral = (self.person.lateral + 0.08 * self.random.normal()) * way;
        self.go_in(to, seconds, lateral);
    }

    /// Reaches for a part, takes it, and at times corrects the grip.
    pub(in crate::simulator) fn grasp(&mut self, id: u16, at: Vector) {
        let slack = [0.005 * self.random.normal(), 0.005 * self.random.normal()];
        self.wander_to(add(add(at, self.person.grip_offset_m), slack));
        self.held = Some(id);
        let seconds = 0.4 * self.random.factor(0.4);
        self.fidget(0.003, seconds);
        if self.random.uniform() < CORRECTED {
            self.correct_grip();
        }
    }

    /// Lets go of what it holds for a moment, and takes it again.
    fn correct_grip(&mut self) {
        let (held, at) = (self.held.take(), self.at);
        let (away_m, direction) = (self.random.between(0.01, 0.05), self.random.between(0.0, TAU));
        let aside = add(at, turn([away_m, 0.0], direction));
        let seconds = 0.25 * self.random.factor(0.4);
        self.go_in(aside, seconds, 0.0);
        self.go_in(at, seconds, 0.0);
        self.held = held;
        self.dwell();
    }

    /// Lifts what it holds, and wobbles as often as it happens: never, once, or a few times.
    pub(in crate::simulator) fn lift(&mut self) {
        while self.random.uniform() < 0.35 {
            let way = turn([self.random.between(0.008, 0.025), 0.0], self.random.between(0.0, TAU));
            let (at, seconds) = (self.at, 0.25 * self.random.factor(0.3));
            self.go_in(add(at, way), seconds, 0.0);
            self.go_in(at, seconds, 0.0);
        }
    }

    /// Puts what it holds down near a point, may shift it there, and lets it go.
    pub(in crate::simulator) fn put(&mut self, at: Vector) {
        let slack = [0.012 * self.random.normal(), 0.012 * self.random.normal()];
        self.wander_to(add(at, slack));
        let seconds = 0.3 * self.random.factor(0.4);
        self.fidget(0.006, seconds);
        if self.random.uniform() < CORRECTED {
            self.correct_grip();
        }
        self.release();
        if self.random.uniform() < 0.3 {
            // The hand stays at the part for a while.
            let seconds = 0.8 * self.random.factor(0.5);
            self.wait(seconds);
        }
    }

    /// Stays about where it is for this long, with small movements of this size.
    pub(in crate::simulator) fn fidget(&mut self, size_m: f64, seconds: f64) {
        let (middle, until_s) = (self.at, self.now_s() + seconds);
        while self.now_s() < until_s {
            let to = self.near(middle, size_m);
            let seconds = 0.35 * self.random.factor(0.4);
            self.go_in(to, seconds, 0.0);
        }
    }

    /// Works about a point until that time, as people stir and brush: no round is like the one before. What it does slowly drifts.
    pub(in crate::simulator) fn work(&mut self, middle: Vector, swing: Swing, until_s: f64) {
        let mut round = swing;
        let (mut at_angle, mut drift) = (self.random.between(0.0, TAU), [0.0; 2]);
        let reached = |round: Swing, angle: f64, drift: Vector| {
            let own = [round.size_m * angle.cos(), round.size_m * round.roundness * angle.sin()];
            add(add(middle, drift), turn(own, round.along))
        };
        self.wander_to(reached(round, at_angle, drift));
        while self.now_s() < until_s {
            at_angle += TAU / (round.period_s * self.rate_hz);
            if at_angle > TAU {
                at_angle -= TAU;
                let along = swing.along + 0.15 * self.random.normal();
                round = Swing {
                    size_m: swing.size_m * self.random.factor(0.2),
                    along,
                    period_s: swing.period_s * self.random.factor(0.12),
                    ..swing
                };
                drift = self.near(scale(drift, 0.7), 0.004);
            }
            // A hand does not leap from one round to the next.
            let way = subtract(reached(round, at_angle, drift), self.at);
            self.at = add(self.at, scale(way, 0.35));
            self.moments.push(super::Moment { at: self.at, held: self.held });
        }
    }

    /// A point near this one.
    fn near(&mut self, at: Vector, deviation_m: f64) -> Vector {
        add(at, [deviation_m * self.random.normal(), deviation_m * self.random.normal()])
    }
}
