//! Where a hand is that rests at what it has moved. Markers show it more exactly than the landmarks of a hand, which would seem to make strokes.

use super::super::geometry::{add, rotated, subtract};
use super::super::poses::{HandPose, ObjectPose, Source};
use super::{Interaction, Scene, squared_distance};
use crate::capacity::HANDS;
use crate::input::Point;

/// The place is the mean of the first frames in which the object rests. Halved or doubled, none of 975 runs of people is judged otherwise.
const MEAN_FRAMES: u16 = 10;

/// Where a hand holds an object that has moved with it: the centre of the finger tips in the frame of the object.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hold {
    object: usize,
    at: Point,
    /// How many frames it is the mean of.
    frames: u16,
    moves: bool,
    /// For how many frames in a row the hand has been seen too far away to hold it there.
    away: u8,
}

impl Hold {
    /// One frame later, in which the object rests and is held here.
    fn rest(self, at: Point) -> Self {
        if self.frames == MEAN_FRAMES {
            return Self { moves: false, ..self };
        }
        let change = subtract(at, self.at).map(|change| change / f32::from(self.frames + 1));
        Self { at: add(self.at, change), frames: self.frames + 1, moves: false, ..self }
    }

    /// Where the hand acts on the bench while the object rests. `None` if it is seen farther away than `max_m` from where it would hold it.
    fn acts_at(&self, hand: &HandPose, object: &ObjectPose, max_m: f32) -> Option<Point> {
        let at = add(object.position, rotated(self.at, object.orientation));
        (squared_distance(at, hand.grip()) < max_m * max_m).then_some(at)
    }
}

impl Scene {
    /// Places the hands at what they have moved and what rests now, until it is believed that they have left it. While it moves, they are as seen.
    pub(super) fn place_hands(&mut self, gripped: [Option<usize>; HANDS]) {
        for (hand, gripped) in gripped.into_iter().enumerate() {
            self.holds[hand] = self.hold(hand, gripped);
            if let Some(hold) = self.holds[hand].filter(|hold| !hold.moves)
                && let Some((pose, object)) = self.both_seen(hand, hold.object)
            {
                let held_at = hold.acts_at(&pose, &object, self.method.hand_contact.on_m);
                let away = held_at.map_or(hold.away + 1, |_| 0);
                self.holds[hand] = (away < self.method.persist_frames).then_some(Hold { away, ..hold });
                self.hands[hand].revise(1, |pose| pose.held_at = held_at);
            }
        }
    }

    /// Where the hand holds what it acts on, if that has moved with it. Where it is not known whether it moves, nothing changes.
    fn hold(&self, hand: usize, gripped: Option<usize>) -> Option<Hold> {
        let Interaction::Acts { j: object, .. } = self.interactions[hand] else { return None };
        let before = self.holds[hand].filter(|hold| hold.object == object);
        let Some((pose, seen)) = self.both_seen(hand, object).filter(|_| gripped == Some(object)) else {
            return before;
        };
        let at = seen.own(pose.grip());
        match self.has_moved(object) {
            Some(true) => {
                let new = Hold { object, at, frames: 0, moves: true, away: 0 };
                Some(Hold { moves: true, ..before.unwrap_or(new) })
            }
            Some(false) => before.map(|hold| hold.rest(at)),
            None => before,
        }
    }

    /// The newest poses of a hand and an object, if both were seen.
    fn both_seen(&self, hand: usize, object: usize) -> Option<(HandPose, ObjectPose)> {
        let (hand, object) = (*self.hands[hand].ago(0), *self.objects[object].poses.ago(0));
        (hand.source == Source::Seen && object.source == Source::Seen).then_some((hand, object))
    }
}
