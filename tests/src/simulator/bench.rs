//! The parts on the bench, and where they lie.

use super::{Random, Vector, add, turn};
use andon_core::input::ObjectShape;
use andon_learn::recording::NamedObject;

/// A part that can be taken.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Identity.
    pub id: u16,
    /// What a person calls it.
    pub name: &'static str,
    /// Where it is taken, in its own frame, in metres.
    pub grasp: Vector,
    /// The point that is brought to another part, in its own frame.
    pub tip: Vector,
    /// The point that another part's tip is brought to, in its own frame.
    pub work: Vector,
    /// Where it can be touched, in its own frame.
    pub points: &'static [Vector],
}

/// The parts of the paper's experiments.
pub(super) const PARTS: [Part; 7] = [
    part(1, "profile", [0.0, 0.0], [0.11, 0.0], [0.0, 0.0], &[[0.0, 0.0], [0.11, 0.0]]),
    part(2, "corner", [0.0, 0.0], [0.0, 0.0], [0.0, 0.0], &[[0.0, 0.0], [0.0, 0.03]]),
    part(3, "meter", [0.02, 0.0], [0.12, 0.0], [-0.05, 0.0], &[[-0.05, 0.0], [0.02, 0.0], [0.12, 0.0]]),
    part(4, "box", [0.0, 0.1], [0.0, 0.0], [0.0, 0.0], &[[0.0, 0.0], [0.02, 0.02], [0.02, -0.02]]),
    part(5, "polisher", [0.0, 0.0], [0.105, 0.0], [0.0, 0.0], &[[0.0, 0.0], [0.105, 0.015], [0.105, -0.015]]),
    part(
        6,
        "brick",
        [-0.03, 0.0],
        [0.06, 0.0],
        [0.0, 0.0],
        &[[-0.06, 0.0], [-0.03, 0.0], [0.0, 0.0], [0.03, 0.0], [0.06, 0.0]],
    ),
    part(7, "drill", [0.0, 0.0], [0.12, 0.0], [0.0, 0.0], &[[0.0, 0.0], [0.12, 0.0]]),
];

const fn part(
    id: u16,
    name: &'static str,
    grasp: Vector,
    tip: Vector,
    work: Vector,
    points: &'static [Vector],
) -> Part {
    Part { id, name, grasp, tip, work, points }
}

impl Part {
    /// The part with this id.
    ///
    /// # Panics
    /// If there is none: a script names only what [`PARTS`] has.
    #[allow(clippy::panic)]
    pub fn of(id: u16) -> Self {
        PARTS.into_iter().find(|part| part.id == id).unwrap_or_else(|| panic!("no part has id {id}"))
    }

    /// As a track file's header has it.
    pub fn named(&self) -> NamedObject {
        let points = self.points.iter().map(|[x, y]| [*x as f32, *y as f32, 0.0]);
        NamedObject {
            name: self.name.to_owned(),
            shape: ObjectShape { id: self.id, interaction_points: points.collect() },
        }
    }
}

/// Place and turn on the bench.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Metres.
    pub at: Vector,
    /// Radians, counter-clockwise.
    pub yaw: f64,
}

impl Pose {
    /// Where a point of the thing is on the bench.
    pub fn point(&self, own: Vector) -> Vector {
        add(self.at, turn(own, self.yaw))
    }
}

/// Where the parts lie before the first movement.
#[derive(Clone, Debug)]
pub struct Bench {
    /// The parts that are there.
    pub parts: Vec<(Part, Pose)>,
    /// Where the hand rests.
    pub rest: Vector,
}

impl Bench {
    /// Parts at places: id, x, y in metres, yaw in radians.
    pub fn new(places: &[(u16, f64, f64, f64)]) -> Self {
        let parts = places.iter().map(|&(id, x, y, yaw)| (Part::of(id), Pose { at: [x, y], yaw })).collect();
        Self { parts, rest: [0.15, -0.28] }
    }

    /// Moves each part a little on its own: nobody puts things exactly where the plan says.
    pub fn jitter(&mut self, random: &mut Random, deviation_m: f64, deviation_yaw: f64) {
        for (_, pose) in &mut self.parts {
            pose.at = add(pose.at, [deviation_m * random.normal(), deviation_m * random.normal()]);
            pose.yaw += deviation_yaw * random.normal();
        }
    }

    /// Shifts and turns the whole bench about its middle.
    pub fn move_all(&mut self, shift: Vector, yaw: f64) {
        for (_, pose) in &mut self.parts {
            *pose = Pose { at: add(shift, turn(pose.at, yaw)), yaw: pose.yaw + yaw };
        }
        self.rest = add(shift, turn(self.rest, yaw));
    }

    /// Shifts and turns one part.
    pub fn move_part(&mut self, id: u16, shift: Vector, yaw: f64) {
        for (_, pose) in self.parts.iter_mut().filter(|(part, _)| part.id == id) {
            *pose = Pose { at: add(pose.at, shift), yaw: pose.yaw + yaw };
        }
    }
}
