//! Work of two hands: what they share, who waits for whom, and what does not matter.

use super::arm::{Arm, see};
use super::bench::{BRICK_ID, Bench, METER_ID, POLISHER_ID};
use super::performance::Performance;
use super::{Random, Vector, add, scale, subtract};
use andon_core::input::Side;
use andon_learn::recording::Recording;

const PROFILE_ID: u16 = 1;
const CORNER_ID: u16 = 2;
const DRILL_ID: u16 = 7;

/// The end at which the right hand holds the profile, in its own frame. The left one holds it where its own grasp point is.
const END: Vector = [0.11, 0.0];

/// A job of two hands. Each has something that differs from time to time and is right, and one fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TwoHanded {
    /// The left hand holds the brick while the right one polishes it, and begins before it or after it. Fault: three strokes of six.
    HoldWhileWorking,
    /// The left hand brings the corner to the middle, where the right one takes it over and puts it away. Fault: it stays in the middle.
    HandOver,
    /// The left hand moves the corner, then the drill. The right one moves the polisher at any time from one second before to three after. Fault: the
    /// drill comes before the corner.
    LateHand,
    /// The right hand moves the corner, then the drill; in about half of the times the left one rests at the meter. Fault: the drill is left out.
    RestingHand,
    /// Both hands lift the profile, and either may be first. Fault: the right hand carries it alone.
    SymmetricalLift,
    /// Each hand takes what lies on the other's side, so that their ways cross. Fault: the left hand does nothing.
    CrossingHands,
    /// The left hand moves the corner and goes away at once, or rests there until the right one has moved drill and polisher. Fault: the drill is
    /// left out.
    WaitingHand,
    /// The left hand brings the brick to the middle and holds it there. Meanwhile the right one polishes it and drills, and puts both tools back side
    /// by side. It may begin to bring the brick back as soon as the drill is lifted. Fault: the drill is left out.
    Workshop,
}

impl TwoHanded {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::HoldWhileWorking,
        Self::HandOver,
        Self::LateHand,
        Self::RestingHand,
        Self::SymmetricalLift,
        Self::CrossingHands,
        Self::WaitingHand,
        Self::Workshop,
    ];

    /// The parts on the bench, and where they lie.
    const fn parts(self) -> &'static [(u16, Vector)] {
        match self {
            Self::HoldWhileWorking => &[(POLISHER_ID, [0.2, -0.05]), (BRICK_ID, [0.0, 0.15])],
            Self::HandOver => &[(CORNER_ID, [-0.3, 0.1])],
            Self::LateHand | Self::WaitingHand => {
                &[(CORNER_ID, [-0.35, 0.05]), (DRILL_ID, [-0.15, 0.05]), (POLISHER_ID, [0.2, 0.0])]
            }
            Self::RestingHand => &[(CORNER_ID, [0.1, 0.05]), (DRILL_ID, [0.3, 0.0]), (METER_ID, [-0.3, 0.1])],
            Self::SymmetricalLift => &[(PROFILE_ID, [0.0, 0.05])],
            Self::CrossingHands => &[(CORNER_ID, [-0.2, 0.1]), (DRILL_ID, [0.2, 0.1])],
            Self::Workshop => {
                &[(BRICK_ID, [-0.3, 0.1]), (POLISHER_ID, [0.15, -0.05]), (DRILL_ID, [0.22, 0.05])]
            }
        }
    }
}

/// Carries out a job of two hands, with its fault or right.
pub fn perform_with_two_hands(performance: &Performance, work: TwoHanded, is_faulty: bool) -> Recording {
    let (person, mut random) = performance.person(100 + work as u64);
    let parts: Vec<(u16, f64, f64, f64)> =
        work.parts().iter().map(|(id, [x, y])| (*id, *x, *y, 0.0)).collect();
    let mut bench = Bench::new(&parts);
    performance.settle(&mut bench, &person, &mut random);
    let rate_hz = performance.noise.rate_hz;
    let mut arm = |side: Side| {
        let own = Random::new(
            performance.seed,
            &[5, performance.person, performance.repetition, side as u64, work as u64],
        );
        let mut arm = Arm::new(&person, side, rate_hz, own);
        arm.wait(0.5 + 0.1 * random.uniform());
        arm
    };
    let mut arms = [arm(Side::Right), arm(Side::Left)];
    let mut stage = Stage { bench: &bench, random: &mut random, is_faulty };
    stage.act(work, &mut arms);
    arms.iter_mut().for_each(Arm::go_home);
    let mut habit = Random::new(performance.seed, &[4, performance.person]);
    see(arms, &bench, &performance.noise, &mut habit, &mut random)
}

struct Stage<'a> {
    bench: &'a Bench,
    random: &'a mut Random,
    is_faulty: bool,
}

impl Stage<'_> {
    fn act<'a>(&mut self, work: TwoHanded, [right, left]: &mut [Arm<'a>; 2]) {
        match work {
            TwoHanded::HoldWhileWorking => self.hold_while_working(right, left),
            TwoHanded::HandOver => self.hand_over(right, left),
            TwoHanded::LateHand => self.late_hand(right, left),
            TwoHanded::RestingHand => self.resting_hand(right, left),
            TwoHanded::SymmetricalLift => self.lift(right, left),
            TwoHanded::WaitingHand => self.waiting_hand(right, left),
            TwoHanded::Workshop => self.workshop(right, left),
            TwoHanded::CrossingHands => {
                right.wait(self.random.between(0.0, 0.6));
                self.move_part(right, CORNER_ID, [0.1, 0.3]);
                if !self.is_faulty {
                    left.wait(self.random.between(0.0, 0.6));
                    self.move_part(left, DRILL_ID, [-0.1, 0.3]);
                }
            }
        }
    }

    fn at(&self, id: u16) -> Vector {
        self.bench.pose(id).at
    }

    /// The hand takes a part, brings it away by this vector, and goes home.
    fn move_part(&self, arm: &mut Arm<'_>, id: u16, way: Vector) {
        arm.take(id, self.grasp(id));
        arm.bring(way);
        arm.go_home();
    }

    fn grasp(&self, id: u16) -> Vector {
        self.bench.pose(id).point(super::Part::of(id).grasp)
    }

    fn hold_while_working(&mut self, right: &mut Arm<'_>, left: &mut Arm<'_>) {
        let brick = self.at(BRICK_ID);
        left.wait(self.random.between(0.0, 1.5));
        left.go(add(brick, [-0.06, 0.0]));
        let strokes = if self.is_faulty { 3 } else { 6 };
        let worked_s =
            self.work_at(right, POLISHER_ID, add(brick, [0.03, 0.0]), |right| right.stroke(strokes));
        left.wait_until(worked_s - 0.2);
        left.go_home();
    }

    fn hand_over(&mut self, right: &mut Arm<'_>, left: &mut Arm<'_>) {
        let middle = [self.random.between(-0.02, 0.02), 0.15];
        left.take(CORNER_ID, self.at(CORNER_ID));
        left.go(middle);
        if self.is_faulty {
            return left.release();
        }
        right.wait_until(left.now_s() - 0.6 + 0.2 * self.random.normal());
        right.go(add(middle, [0.012, 0.0]));
        let taken_s = right.now_s().max(left.now_s()) + 0.2;
        right.wait_until(taken_s);
        right.take(CORNER_ID, right.at());
        left.wait_until(right.now_s());
        left.release();
        right.wait_until(left.now_s());
        right.bring([0.25, 0.1]);
    }

    fn late_hand(&mut self, right: &mut Arm<'_>, left: &mut Arm<'_>) {
        let late_s = self.random.between(-1.0, 3.0);
        right.wait(late_s);
        left.wait(-late_s);
        let (first, second) = if self.is_faulty { (DRILL_ID, CORNER_ID) } else { (CORNER_ID, DRILL_ID) };
        self.move_part(left, first, [0.05, 0.35]);
        self.move_part(left, second, [0.05, 0.35]);
        self.move_part(right, POLISHER_ID, [0.1, 0.3]);
    }

    fn waiting_hand(&mut self, right: &mut Arm<'_>, left: &mut Arm<'_>) {
        left.take(CORNER_ID, self.grasp(CORNER_ID));
        left.go(add(left.at(), [0.0, 0.3]));
        right.wait_until(left.now_s());
        if !self.is_faulty {
            self.move_part(right, DRILL_ID, [0.1, 0.3]);
        }
        self.move_part(right, POLISHER_ID, [0.1, 0.3]);
        if self.random.uniform() < 0.3 {
            left.wait_until(right.now_s());
        }
        left.release();
    }

    fn workshop(&mut self, right: &mut Arm<'_>, left: &mut Arm<'_>) {
        let lies = self.grasp(BRICK_ID);
        left.take(BRICK_ID, lies);
        let way = subtract([self.random.between(-0.01, 0.01), 0.15], self.at(BRICK_ID));
        left.go(add(left.at(), way));
        let brick = add(self.at(BRICK_ID), way);
        right.wait_until(left.now_s() - self.random.between(0.0, 0.6));
        let mut worked_s = self.work_at(right, POLISHER_ID, add(brick, [0.03, 0.0]), |right| right.stroke(6));
        if !self.is_faulty {
            worked_s = self.work_at(right, DRILL_ID, brick, |right| right.wait(1.0));
        }
        left.wait_until(worked_s + self.random.between(0.1, 1.0));
        left.go(lies);
        left.release();
    }

    /// The hand takes a tool, brings its tip to this point, works with it until the time that is returned, and puts it back.
    fn work_at<'a>(&self, arm: &mut Arm<'a>, id: u16, point: Vector, work: impl FnOnce(&mut Arm<'a>)) -> f64 {
        arm.take(id, self.grasp(id));
        let before = arm.at();
        arm.go(add(point, scale(super::Part::of(id).tip, -1.0)));
        arm.dwell();
        work(arm);
        let worked_s = arm.now_s();
        arm.bring(subtract(before, arm.at()));
        worked_s
    }

    fn resting_hand(&mut self, right: &mut Arm<'_>, left: &mut Arm<'_>) {
        if self.random.uniform() < 0.5 {
            left.wait(self.random.between(0.0, 2.0));
            left.go(self.grasp(METER_ID));
            left.wait(self.random.between(0.8, 4.0));
        }
        self.move_part(right, CORNER_ID, [-0.1, 0.25]);
        if !self.is_faulty {
            self.move_part(right, DRILL_ID, [-0.05, 0.3]);
        }
    }

    fn lift<'a>(&mut self, right: &mut Arm<'a>, left: &mut Arm<'a>) {
        right.wait(self.random.between(0.0, 0.5));
        right.take(PROFILE_ID, self.bench.pose(PROFILE_ID).point(END));
        let way = [self.random.between(-0.01, 0.01), 0.3];
        if self.is_faulty {
            return right.bring(way);
        }
        left.wait(self.random.between(0.0, 0.5));
        left.take(PROFILE_ID, self.at(PROFILE_ID));
        let together_s = right.now_s().max(left.now_s()) + 0.1;
        let (seconds, lateral) = (1.0 * self.random.factor(0.15), 0.02 * self.random.normal());
        for arm in [right, left] {
            arm.wait_until(together_s);
            arm.go_in(add(arm.at(), way), seconds, lateral);
            arm.release();
        }
    }
}
