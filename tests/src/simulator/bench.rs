//! The parts on the bench, and their poses.

use super::{Random, Vector, add, turn};
use andon_core::object::ObjectShape;
use andon_learn::recording::NamedObject;

/// A part that can be taken.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// The part's id.
    pub id: u16,
    /// The name that people use for it.
    pub name: &'static str,
    /// Grasp point, in metres in the part's own frame, like all points here.
    pub grasp: Vector,
    /// The point that is brought to another part.
    pub tip: Vector,
    /// The point to which the tip of another part is brought.
    pub work: Vector,
    /// Interaction points.
    pub points: &'static [Vector],
}

/// The id of the meter.
pub(super) const METER_ID: u16 = 3;
/// The id of the polisher.
pub(super) const POLISHER_ID: u16 = 5;
/// The id of the brick.
pub(super) const BRICK_ID: u16 = 6;

/// The id of the whisk.
pub(super) const WHISK_ID: u16 = 8;
/// The id of the bottle.
pub(super) const BOTTLE_ID: u16 = 9;
/// The id of the bowl.
pub(super) const BOWL_ID: u16 = 10;
/// The id of the brush.
pub(super) const BRUSH_ID: u16 = 11;
/// The id of the bottle of glue.
pub(super) const GLUE_ID: u16 = 12;
/// The id of the tray.
pub(super) const TRAY_ID: u16 = 13;
/// The id of the cloth.
pub(super) const CLOTH_ID: u16 = 14;
/// The id of the spray.
pub(super) const SPRAY_ID: u16 = 15;
/// The id of the plate.
pub(super) const PLATE_ID: u16 = 16;

/// The parts of the paper's experiments, and those of work that is done by feel, which have no points.
pub(super) const PARTS: [Part; 16] = [
    part(1, "profile", [0.0, 0.0], [0.11, 0.0], [0.0, 0.0], &[[0.0, 0.0], [0.11, 0.0]]),
    part(2, "corner", [0.0, 0.0], [0.0, 0.0], [0.0, 0.0], &[[0.0, 0.0], [0.0, 0.03]]),
    part(
        METER_ID,
        "meter",
        [0.02, 0.0],
        [0.12, 0.0],
        [-0.05, 0.0],
        &[[-0.05, 0.0], [0.02, 0.0], [0.12, 0.0]],
    ),
    part(4, "box", [0.0, 0.1], [0.0, 0.0], [0.0, 0.0], &[[0.0, 0.0], [0.02, 0.02], [0.02, -0.02]]),
    part(
        POLISHER_ID,
        "polisher",
        [0.0, 0.0],
        [0.105, 0.0],
        [0.0, 0.0],
        &[[0.0, 0.0], [0.105, 0.015], [0.105, -0.015]],
    ),
    part(
        BRICK_ID,
        "brick",
        [-0.03, 0.0],
        [0.06, 0.0],
        [0.0, 0.0],
        &[[-0.06, 0.0], [-0.03, 0.0], [0.0, 0.0], [0.03, 0.0], [0.06, 0.0]],
    ),
    part(7, "drill", [0.0, 0.0], [0.12, 0.0], [0.0, 0.0], &[[0.0, 0.0], [0.12, 0.0]]),
    mere_position(WHISK_ID, "whisk"),
    mere_position(BOTTLE_ID, "bottle"),
    mere_position(BOWL_ID, "bowl"),
    mere_position(BRUSH_ID, "brush"),
    mere_position(GLUE_ID, "glue"),
    mere_position(TRAY_ID, "tray"),
    mere_position(CLOTH_ID, "cloth"),
    mere_position(SPRAY_ID, "spray"),
    mere_position(PLATE_ID, "plate"),
];

/// A part of which only the position of its marker is known.
const fn mere_position(id: u16, name: &'static str) -> Part {
    part(id, name, [0.0; 2], [0.0; 2], [0.0; 2], &[[0.0; 2]])
}

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
    /// If there is none: scripts name only the parts of this list.
    #[allow(clippy::panic)]
    pub fn of(id: u16) -> Self {
        PARTS.into_iter().find(|part| part.id == id).unwrap_or_else(|| panic!("no part has id {id}"))
    }

    /// The part as it is in the header of a track file.
    pub fn named(&self) -> NamedObject {
        let points = self.points.iter().map(|[x, y]| [*x as f32, *y as f32, 0.0]);
        NamedObject {
            name: self.name.to_owned(),
            shape: ObjectShape {
                id: self.id,
                interaction_points: points.collect(),
                ..ObjectShape::default()
            },
        }
    }
}

/// Position and direction on the bench.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Position in metres.
    pub at: Vector,
    /// Direction in radians, counter-clockwise.
    pub yaw: f64,
}

impl Pose {
    /// The position on the bench of a point of the part's own frame.
    pub fn point(&self, own: Vector) -> Vector {
        add(self.at, turn(own, self.yaw))
    }
}

/// A part of a plan: id, x and y in metres, yaw in radians.
pub type PlannedPart = (u16, f64, f64, f64);

/// The bench before the first movement.
#[derive(Clone, Debug)]
pub struct Bench {
    /// The parts and their poses.
    pub parts: Vec<(Part, Pose)>,
    /// Rest position of the hand, in metres.
    pub rest: Vector,
}

impl Bench {
    /// A bench with these parts.
    pub fn new(parts: &[PlannedPart]) -> Self {
        let parts = parts.iter().map(|&(id, x, y, yaw)| (Part::of(id), Pose { at: [x, y], yaw })).collect();
        Self { parts, rest: [0.15, -0.28] }
    }

    /// Moves each part a little by itself, because nobody puts parts exactly where the plan says. The deviations are in metres and radians.
    pub fn jitter(&mut self, random: &mut Random, deviation_m: f64, deviation_yaw: f64) {
        for (_, pose) in &mut self.parts {
            pose.at = add(pose.at, [deviation_m * random.normal(), deviation_m * random.normal()]);
            pose.yaw += deviation_yaw * random.normal();
        }
    }

    /// Shifts the whole bench, and turns it about its centre.
    pub fn move_all(&mut self, shift: Vector, yaw: f64) {
        for (_, pose) in &mut self.parts {
            *pose = Pose { at: add(shift, turn(pose.at, yaw)), yaw: pose.yaw + yaw };
        }
        self.rest = add(shift, turn(self.rest, yaw));
    }

    /// The ids of the parts that are farther from each other than this, in metres.
    pub(super) fn apart(&self, min_m: f64) -> Vec<(u16, u16)> {
        let points =
            |(part, pose): &(Part, Pose)| part.points.iter().map(|own| pose.point(*own)).collect::<Vec<_>>();
        let is_apart = |[one, other]: [&(Part, Pose); 2]| {
            let near = |[x, y]: Vector, [to_x, to_y]: Vector| (to_x - x).hypot(to_y - y) < min_m;
            !points(one).into_iter().any(|from| points(other).into_iter().any(|to| near(from, to)))
        };
        let pairs = self.parts.iter().flat_map(|one| self.parts.iter().map(move |other| [one, other]));
        pairs
            .filter(|[one, other]| one.0.id < other.0.id)
            .filter(|pair| is_apart(*pair))
            .map(|[one, other]| (one.0.id, other.0.id))
            .collect()
    }

    /// The pose of a part; the origin if it is not on the bench.
    pub(super) fn pose(&self, id: u16) -> Pose {
        let found = self.parts.iter().find(|(part, _)| part.id == id);
        found.map_or(Pose { at: [0.0; 2], yaw: 0.0 }, |(_, pose)| *pose)
    }

    /// Moves a part to a pose.
    pub(super) fn set_pose(&mut self, id: u16, pose: Pose) {
        for (_, own) in self.parts.iter_mut().filter(|(part, _)| part.id == id) {
            *own = pose;
        }
    }

    /// Shifts and turns one part.
    pub fn move_part(&mut self, id: u16, shift: Vector, yaw: f64) {
        for (_, pose) in self.parts.iter_mut().filter(|(part, _)| part.id == id) {
            *pose = Pose { at: add(pose.at, shift), yaw: pose.yaw + yaw };
        }
    }
}
