//! The recent poses of hands and objects on the grid.

use super::geometry::{
    Cloud, Quaternion, about_z, add, distance, inverse, rotated, rotation_after, subtract, unit, yaw,
};
use crate::capacity::PERSIST_FRAMES;
use crate::input::{Hand, Object, Point, Space, is_on_bench};

/// How far from its landmarks a hand hides things, in metres: the length of a palm. Halved or doubled, 1 or 2 of 975 runs of people are judged
/// otherwise.
const COVERED_M: f32 = 0.12;

/// Frames that are remembered: `persist_frames` before and after the one whose couple is made.
pub(super) const REMEMBERED: usize = 2 * PERSIST_FRAMES + 1;

/// The newest [`REMEMBERED`] items, the newest at age 0.
#[derive(Clone, Debug, Default)]
pub(super) struct Recent<T> {
    items: [T; REMEMBERED],
    newest: usize,
}

impl<T: Copy> Recent<T> {
    pub(super) fn push(&mut self, item: T) {
        self.newest = (self.newest + 1) % REMEMBERED;
        self.items[self.newest] = item;
    }

    /// Changes the newest `count` items, or as many as are remembered.
    pub(super) fn revise(&mut self, count: u32, mut change: impl FnMut(&mut T)) {
        for age in 0..REMEMBERED.min(count as usize) {
            change(&mut self.items[(self.newest + REMEMBERED - age) % REMEMBERED]);
        }
    }

    /// The item of the newest frame and of the one before.
    pub(super) fn newest_two(&self) -> [T; 2] {
        [0, 1].map(|age| *self.ago(age))
    }

    /// The item of `age` frames ago, or the oldest one if that is no longer remembered.
    pub(super) fn ago(&self, age: usize) -> &T {
        &self.items[(self.newest + REMEMBERED - age.min(REMEMBERED - 1)) % REMEMBERED]
    }
}

/// The orientation of the bench.
pub(super) const UPRIGHT: Quaternion = [1.0, 0.0, 0.0, 0.0];

/// Where a pose comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    /// The hand or object has never been seen.
    Never,
    /// It was seen in this frame.
    Seen,
    /// It is hidden, and moved with what is seen. An object moves with the hand that carries it, a hand with the object that it holds.
    Carried,
    /// It is hidden by a hand that is at it, and is taken to lie where it was last seen.
    Covered,
    /// It was not seen, for no reason that is known: the last pose is kept.
    Kept,
}

impl Source {
    /// Whether the pose stands for where the hand or object is: it was seen, or there is a reason to assume the pose.
    pub(super) fn is_known(self) -> bool {
        matches!(self, Self::Seen | Self::Carried | Self::Covered)
    }
}

/// Where a hand or an object was in one frame of the grid, how that is known, and for how long it was unseen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fix {
    pub(super) place: Point,
    pub(super) source: Source,
    pub(super) unseen: u32,
}

/// A hand in one frame of the grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct HandPose {
    pub(super) source: Source,
    /// Frames since it was seen.
    pub(super) unseen: u32,
    pub(super) middle_knuckle: Point,
    wrist: Point,
    pub(super) tips: [Point; 3],
    /// Where what it holds shows the centre of the finger tips to be, while it rests.
    pub(super) held_at: Option<Point>,
}

impl Default for HandPose {
    /// It has never been seen.
    fn default() -> Self {
        let nowhere = [0.0; 3];
        Self {
            source: Source::Never,
            unseen: u32::MAX,
            middle_knuckle: nowhere,
            wrist: nowhere,
            tips: [nowhere; 3],
            held_at: None,
        }
    }
}

impl HandPose {
    /// The pose of a hand that is seen; `None` if a number is not finite or too large.
    pub(super) fn seen(hand: &Hand, space: Space) -> Option<Self> {
        let points = [hand.wrist, hand.middle_knuckle, hand.tips[0], hand.tips[1], hand.tips[2]];
        let points = points.map(|point| space.flat(point));
        if !points.iter().all(|point| is_on_bench(*point)) {
            return None;
        }
        let [wrist, middle_knuckle, tips @ ..] = points;
        Some(Self { source: Source::Seen, unseen: 0, middle_knuckle, wrist, tips, held_at: None })
    }

    pub(super) fn fix(self) -> Fix {
        Fix { place: self.middle_knuckle, source: self.source, unseen: self.unseen }
    }

    /// Direction from the wrist to the middle knuckle about z, in radians.
    fn yaw(&self) -> f32 {
        let along = subtract(self.middle_knuckle, self.wrist);
        libm::atan2f(along[1], along[0])
    }

    /// The pose in the next frame if the hand is not seen in it.
    pub(super) fn kept(self) -> Self {
        match self.source {
            Source::Never => self,
            _ => Self { source: Source::Kept, unseen: self.unseen.saturating_add(1), held_at: None, ..self },
        }
    }

    /// The pose of a hidden hand that holds an object while that moves so: as a rigid body.
    pub(super) fn holding(self, from: &ObjectPose, to: &ObjectPose) -> Self {
        let moved = |point| add(to.position, rotated(from.own(point), to.orientation));
        Self {
            source: Source::Carried,
            middle_knuckle: moved(self.middle_knuckle),
            wrist: moved(self.wrist),
            tips: self.tips.map(moved),
            ..self
        }
    }

    pub(super) fn cloud(&self) -> Option<Cloud> {
        Cloud::new(&self.tips)
    }

    /// Whether the hand may be at what is within `radius_m` of this point of the bench.
    pub(super) fn is_over(&self, point: Point, radius_m: f32) -> bool {
        let mut parts = self.tips.iter().chain(core::iter::once(&self.middle_knuckle));
        let is_near = |part: &Point| distance(*part, point) < COVERED_M + radius_m;
        self.source != Source::Never && parts.any(is_near)
    }

    /// Whether the hand or the forearm may hide this point of the bench.
    pub(super) fn covers(&self, point: Point) -> bool {
        // The forearm goes on from the wrist in the direction of the palm.
        let forearm = add(self.wrist, subtract(self.wrist, self.middle_knuckle));
        let hides = |part: Point| distance(part, point) < COVERED_M;
        self.source == Source::Seen && (self.is_over(point, 0.0) || hides(self.wrist) || hides(forearm))
    }

    /// Where it acts: the centre of the finger tips, as exactly as that is known.
    pub(super) fn acts_at(&self) -> Point {
        self.held_at.unwrap_or(self.grip())
    }

    /// The centre of the finger tips, where an object is held.
    pub(super) fn grip(&self) -> Point {
        add(add(self.tips[0], self.tips[1]), self.tips[2]).map(|sum| sum / 3.0)
    }
}

/// An object in one frame of the grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObjectPose {
    pub(super) source: Source,
    /// Frames since it was seen.
    pub(super) unseen: u32,
    pub(super) position: Point,
    pub(super) orientation: Quaternion,
}

impl Default for ObjectPose {
    /// It has never been seen.
    fn default() -> Self {
        Self { source: Source::Never, unseen: u32::MAX, position: [0.0; 3], orientation: UPRIGHT }
    }
}

impl ObjectPose {
    /// The pose of an object that is seen; `None` if a number is not finite or too large, or the quaternion has length zero.
    pub(super) fn seen(object: &Object, space: Space) -> Option<Self> {
        if !is_on_bench(object.position) {
            return None;
        }
        let whole = unit(object.orientation)?;
        let (position, orientation) = match space {
            Space::Metric => (object.position, whole),
            Space::Plane => ([object.position[0], object.position[1], 0.0], about_z(yaw(whole))),
        };
        Some(Self { source: Source::Seen, unseen: 0, position, orientation })
    }

    pub(super) fn fix(self) -> Fix {
        Fix { place: self.position, source: self.source, unseen: self.unseen }
    }

    /// This point of the bench in the object's own frame of reference.
    pub(super) fn own(&self, point: Point) -> Point {
        rotated(subtract(point, self.position), inverse(self.orientation))
    }

    /// The pose in the next frame if the object is not seen in it and no hand carries it. It is `covered` only from the frame on in which it vanished.
    pub(super) fn kept(self, covered: bool) -> Self {
        let source = match self.source {
            Source::Never => return self,
            Source::Kept => Source::Kept,
            Source::Seen | Source::Covered if covered => Source::Covered,
            _ => Source::Kept,
        };
        Self { source, unseen: self.unseen.saturating_add(1), ..self }
    }
}

/// How an object lies in the hand that carries it, as a rigid body that rotates with it about z and keeps its tilt.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grip {
    offset: Point,
    rotation: Quaternion,
    /// It has moved with the hand, and so shows where that is. What lies still does not.
    pub(super) has_followed: bool,
}

impl Grip {
    pub(super) fn new(pose: &HandPose, object: &ObjectPose, has_followed: bool) -> Self {
        let back = inverse(about_z(pose.yaw()));
        Self {
            offset: rotated(subtract(object.position, pose.grip()), back),
            rotation: rotation_after(back, object.orientation),
            has_followed,
        }
    }

    /// The pose of the object in the next frame.
    pub(super) fn carried(&self, pose: &HandPose, before: &ObjectPose) -> ObjectPose {
        let hand = about_z(pose.yaw());
        ObjectPose {
            source: Source::Carried,
            unseen: before.unseen.saturating_add(1),
            position: add(pose.grip(), rotated(self.offset, hand)),
            orientation: unit(rotation_after(hand, self.rotation)).unwrap_or(before.orientation),
        }
    }
}
