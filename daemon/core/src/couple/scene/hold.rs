//! Where a hand is that rests at what it has moved, as that shows it. Markers are seen more exactly than the landmarks of a hand, which would
//! seem to make strokes.

use super::super::geometry::{add, rotated, subtract};
use super::super::poses::{HandPose, ObjectPose, Source};
use super::{Interaction, Scene, squared_distance};
use crate::capacity::HANDS;
use crate::input::Point;

/// The place is a running mean of about as many frames, in which they moved together.
const MEAN_FRAMES: u16 = 10;

/// Where a hand holds an object that has moved with it: the centre of the finger tips in the frame of reference of the object.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hold {
    object: usize,
    at: Point,
    frames: u16,
    /// The object does not move now, as far as that is known.
    rests: bool,
}

impl Hold {
    /// One that has just begun.
    fn new(object: usize, at: Point) -> Self {
        Self { object, at, frames: 1, rests: false }
    }

    /// One frame later. While the object rests, it is held where it was; where it is not known whether it moves, nothing changes.
    fn next(self, at: Point, has_moved: Option<bool>) -> Self {
        match has_moved {
            Some(true) => {
                let frames = (self.frames + 1).min(MEAN_FRAMES);
                let change = subtract(at, self.at).map(|change| change / f32::from(frames));
                Self { at: add(self.at, change), frames, rests: false, ..self }
            }
            Some(false) => Self { rests: true, ..self },
            None => self,
        }
    }

    /// Where the hand acts on the bench; `None` if it is seen farther away than `max_m` from where it would hold the object.
    fn acts_at(&self, hand: &HandPose, object: &ObjectPose, max_m: f32) -> Option<Point> {
        let at = add(object.position, rotated(self.at, object.orientation));
        (squared_distance(at, hand.grip()) < max_m * max_m).then_some(at)
    }
}

impl Scene {
    /// Places the hands at what they have moved and what rests now. While it moves, how the hand is seen to move counts.
    pub(super) fn place_hands(&mut self, gripped: [Option<usize>; HANDS]) {
        for (hand, gripped) in gripped.into_iter().enumerate() {
            self.holds[hand] = self.hold(hand, gripped);
            if let Some(hold) = self.holds[hand].filter(|hold| hold.rests)
                && let Some((pose, object)) = self.both_seen(hand, hold.object)
            {
                let held_at = hold.acts_at(&pose, &object, self.method.hand_contact.on_m);
                self.hands[hand].revise(1, |pose| pose.held_at = held_at);
            }
        }
    }

    /// Where the hand holds what it acts on, if that has moved with it.
    fn hold(&self, hand: usize, gripped: Option<usize>) -> Option<Hold> {
        let Interaction::Acts { j: object, .. } = self.interactions[hand] else { return None };
        let before = self.holds[hand].filter(|hold| hold.object == object);
        let Some((pose, seen)) = self.both_seen(hand, object).filter(|_| gripped == Some(object)) else {
            return before;
        };
        let (at, has_moved) = (seen.own(pose.grip()), self.has_moved(object));
        let begins = has_moved == Some(true);
        before.map(|hold| hold.next(at, has_moved)).or_else(|| begins.then(|| Hold::new(object, at)))
    }

    /// The newest poses of a hand and an object, if both were seen.
    fn both_seen(&self, hand: usize, object: usize) -> Option<(HandPose, ObjectPose)> {
        let (hand, object) = (*self.hands[hand].ago(0), *self.objects[object].poses.ago(0));
        (hand.source == Source::Seen && object.source == Source::Seen).then_some((hand, object))
    }
}
