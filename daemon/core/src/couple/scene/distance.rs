//! The edges of the scene graph: where and how near hands and objects meet (paper III-A.1, III-A.2). Two objects meet at their interaction
//! points, or where the runs of a job have shown them to.

use super::super::geometry::{Cloud, distance, subtract};
use super::super::poses::{ObjectPose, Source};
use super::{Node, Scene, squared_distance};
use crate::bounds::Around;
use crate::capacity::{CONTACT_REGIONS, INTERACTION_POINTS, OBJECTS};
use crate::config::{Contact, Method};
use crate::input::Point;
use crate::object::{ContactRegion, HAND_WIDTH_M, ObjectShape, REACH_M};
use heapless::Vec;

/// Where and how near something is met.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// `None`: at the interaction points.
    points: Option<Cloud>,
    contact: Contact,
}

/// An object as it is known before it is seen.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    pub(super) id: u16,
    points: Cloud,
    hand: Place,
    /// With the ids of the other objects.
    others: Vec<(u16, Place), CONTACT_REGIONS>,
    /// Maximum distance from the position at which it is met, in metres, beyond how near others must come.
    pub(super) radius_m: f32,
    /// The ids of the objects with which it has no contact ([`ObjectShape::incidental`]).
    incidental: Vec<u16, OBJECTS>,
    /// How far the finger tips may be from where it is touched and still carry it, in metres.
    pub(super) held_within_m: f32,
    pub(super) is_position_only: bool,
    pub(super) start: Option<Around<3>>,
}

impl Shape {
    /// `None` where there is no interaction point.
    pub(super) fn new(shape: &ObjectShape, method: &Method) -> Option<Self> {
        let cloud = |points: &Vec<Point, INTERACTION_POINTS>| {
            let flat: Vec<Point, INTERACTION_POINTS> =
                points.iter().map(|point| method.space.flat(*point)).collect();
            Cloud::new(&flat)
        };
        let points = cloud(&shape.interaction_points)?;
        let places = shape
            .contact_regions
            .iter()
            .map(|met| (met.with, Place { points: cloud(&met.points), contact: met.contact }));
        let of_hand = places.clone().find(|(with, _)| *with == ContactRegion::HAND).map(|(_, place)| place);
        let is_met_within = |met: &ContactRegion| {
            let radius_m = cloud(&met.points).map_or(points.radius(), |learnt| learnt.radius());
            radius_m + f32::max(met.contact.off_m - method.object_contact.off_m, 0.0)
        };
        Some(Self {
            id: shape.id,
            points,
            hand: of_hand.unwrap_or(Place { points: None, contact: method.hand_contact }),
            others: places.filter(|(with, _)| *with != ContactRegion::HAND).collect(),
            radius_m: shape.contact_regions.iter().map(is_met_within).fold(points.radius(), f32::max),
            incidental: shape.incidental.clone(),
            held_within_m: if of_hand.is_none() && !shape.has_points() { REACH_M } else { HAND_WIDTH_M },
            is_position_only: shape.is_position_only,
            start: shape.start,
        })
    }

    /// Whether a contact with the other object counts.
    pub(super) fn may_touch(&self, other: &Self) -> bool {
        !self.incidental.contains(&other.id) && !other.incidental.contains(&self.id)
    }

    fn other(&self, id: u16) -> Option<&Place> {
        self.others.iter().find(|(with, _)| *with == id).map(|(_, place)| place)
    }
}

/// An object of which the pose is known, with its interaction points in the bench frame.
type Posed<'a> = (&'a Shape, &'a ObjectPose, Cloud);

impl Scene {
    pub(super) fn push_edges(&mut self) {
        let posed: Vec<Posed<'_>, OBJECTS> = self.objects.iter().map(|node| posed(node, 0)).collect();
        let persist = self.method.persist_frames;
        let is_known = |pose: &ObjectPose| pose.source.is_known() && pose.unseen <= self.blind_frames;
        for (hand, edges) in self.hands.iter().zip(&mut self.touches) {
            let hand = hand.ago(0);
            let tips = hand.cloud().filter(|_| hand.source == Source::Seen);
            for (posed, edge) in posed.iter().zip(edges) {
                match tips {
                    Some(tips) if is_known(posed.1) => {
                        let (shape, contact) = (posed.0, &posed.0.hand.contact);
                        let is_in_reach = tips.comes_within(shape.radius_m + contact.off_m, posed.1.position);
                        let distance = is_in_reach.then(|| tips.distance(&met_by_hand(posed)));
                        edge.push(distance.unwrap_or(f32::INFINITY), contact, persist);
                    }
                    _ => edge.push_unknown(),
                }
            }
        }
        let known: [bool; OBJECTS] =
            core::array::from_fn(|index| posed.get(index).is_some_and(|(_, pose, _)| is_known(pose)));
        // Side by side, because most pairs need nothing else of the objects.
        let extent = |(shape, pose, _): &Posed<'_>| (pose.position, shape.radius_m);
        let extents: [_; OBJECTS] =
            core::array::from_fn(|index| posed.get(index).map_or(([0.0; 3], 0.0), extent));
        let (usual, rest_m) = (&self.method.object_contact, self.rest_m());
        for (i, (one, edges)) in posed.iter().zip(&mut self.adjacent).enumerate() {
            for (j, (other, edge)) in posed.iter().zip(edges).enumerate().skip(i + 1) {
                let are_known = known[i] && known[j];
                let are_far = are_known && !are_in_reach(extents[i], extents[j], usual);
                if are_far || !one.0.may_touch(other.0) {
                    edge.push(f32::INFINITY, usual, persist);
                } else if !are_known {
                    edge.push_unknown();
                } else {
                    let (apart_m, contact) = (apart(one, other), contact_of(one.0, other.0, usual));
                    edge.push(apart_m, &contact, persist);
                    let rest = || rest_together([i, j].map(|object| &self.objects[object]), persist, rest_m);
                    let middle_m = f32::midpoint(contact.on_m, contact.off_m);
                    if !edge.is_known() && apart_m < middle_m && rest() {
                        edge.settle(persist);
                    }
                }
            }
        }
    }

    pub(super) fn distance_from_hand(&self, hand: usize, j: usize, age: usize) -> f32 {
        let met = || met_by_hand(&posed(&self.objects[j], age));
        self.hands[hand].ago(age).cloud().map_or(f32::INFINITY, |tips| tips.distance(&met()))
    }

    pub(super) fn distance_of_objects(&self, i: usize, j: usize, age: usize) -> f32 {
        let [one, other] = [i, j].map(|object| posed(&self.objects[object], age));
        apart(&one, &other)
    }

    pub(super) fn are_in_reach(&self, i: usize, j: usize, age: usize) -> bool {
        self.reaches(i, self.objects[j].poses.ago(age).position, j, age)
    }

    /// Whether an object may meet another one that lies there.
    pub(super) fn reaches(&self, object: usize, lies: Point, other: usize, age: usize) -> bool {
        let [one, other] = [object, other].map(|object| &self.objects[object]);
        let (one, other) = ((one.poses.ago(age).position, one.shape.radius_m), (lies, other.shape.radius_m));
        are_in_reach(one, other, &self.method.object_contact)
    }

    pub(super) fn hand_contact(&self, object: usize) -> Contact {
        self.objects[object].shape.hand.contact
    }

    pub(super) fn object_contact(&self, i: usize, j: usize) -> Contact {
        contact_of(&self.objects[i].shape, &self.objects[j].shape, &self.method.object_contact)
    }
}

/// An object as it was `age` frames before the newest.
fn posed(node: &Node, age: usize) -> Posed<'_> {
    let pose = node.poses.ago(age);
    (&node.shape, pose, node.shape.points.at(pose.position, pose.orientation))
}

/// Where a hand meets an object.
fn met_by_hand((shape, pose, points): &Posed<'_>) -> Cloud {
    shape.hand.points.map_or(*points, |learnt| learnt.at(pose.position, pose.orientation))
}

/// Whether two objects have been seen to rest relative to each other in the newest `persist` frames.
fn rest_together(objects: [&Node; 2], persist: u8, rest_m: f32) -> bool {
    let apart = |age: usize| {
        let [one, other] = objects.map(|node| node.poses.ago(age));
        let are_seen = one.source == Source::Seen && other.source == Source::Seen;
        are_seen.then(|| subtract(one.position, other.position))
    };
    let moved = apart(0).zip(apart(persist.into()));
    moved.is_some_and(|(now, before)| distance(now, before) <= rest_m)
}

/// Where two objects were shown to meet, and whether it is the first one that has the place.
fn place_of<'a>(one: &'a Shape, other: &'a Shape) -> Option<(&'a Place, bool)> {
    let of_one = one.other(other.id).map(|place| (place, true));
    of_one.or_else(|| other.other(one.id).map(|place| (place, false)))
}

/// How near two objects were shown to meet, or as `usual`.
fn contact_of(one: &Shape, other: &Shape, usual: &Contact) -> Contact {
    place_of(one, other).map_or(*usual, |(place, _)| place.contact)
}

/// Whether two objects with these positions and radii may meet. The radius holds what a learnt contact reaches beyond the usual one.
fn are_in_reach(one: (Point, f32), other: (Point, f32), usual: &Contact) -> bool {
    let reach = one.1 + other.1 + usual.off_m;
    squared_distance(one.0, other.0) <= reach * reach
}

/// How far two objects are from meeting each other, in metres.
fn apart(one: &Posed<'_>, other: &Posed<'_>) -> f32 {
    let learnt = place_of(one.0, other.0).and_then(|(place, is_of_one)| Some((place.points?, is_of_one)));
    let Some((points, is_of_one)) = learnt else { return one.2.distance(&other.2) };
    let [at, with] = if is_of_one { [one.1, other.1] } else { [other.1, one.1] };
    let place = points.at(at.position, at.orientation);
    Cloud::new(&[with.position]).map_or(f32::INFINITY, |with| with.distance(&place))
}
