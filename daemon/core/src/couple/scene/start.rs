//! What of a job has not been done, as the bench shows it: a part that an activity moves for good still lies where it did at the beginning.
//!
//! A judge that starts in the middle of a job did not see its beginning. Parts that lie where the job begins still tell what has not been
//! done.

use super::Scene;
use crate::couple::geometry::{norm, subtract};
use crate::couple::interaction::Interaction;
use crate::couple::poses::Source;
use crate::object::StartPlace;
use crate::set::ActivitySet;

/// Whether an object lies where it does at the beginning of the job.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    place: Option<StartPlace>,
    is_there: bool,
}

impl Start {
    pub(super) fn new(place: Option<StartPlace>) -> Self {
        Self { place, is_there: false }
    }

    pub(super) fn place(self) -> Option<StartPlace> {
        self.place
    }

    fn undone(self) -> ActivitySet {
        self.place.filter(|_| self.is_there).map_or(ActivitySet::EMPTY, |start| start.moved_by)
    }
}

impl Scene {
    /// The activities that have not been done, as the frame `age` frames before the newest shows. Call it once for each frame, in order: an
    /// object that is out of sight for no longer than `blind_ms` lies where it lay, unless a hand acts on it. It lies there only once
    /// it has been seen to rest there.
    pub(super) fn undone(&mut self, age: usize) -> ActivitySet {
        let mut undone = ActivitySet::EMPTY;
        for index in 0..self.objects.len() {
            let node = &self.objects[index];
            let (pose, start) = (node.poses.ago(age), node.start);
            let lies_within = |start: StartPlace| start.place.distance(pose.position) <= start.place.max;
            // A touch that begins in this frame finds the object where it lay.
            let acts = |(what, lasted): (&Interaction, u32)| what.acts_on(index) && lasted > 1;
            let is_held = || self.interactions.iter().zip(self.lasted).any(acts);
            let is_there = match pose.source {
                Source::Seen => {
                    start.place.is_some_and(lies_within) && (start.is_there || self.lies(index, age))
                }
                _ => start.is_there && pose.unseen <= self.blind_frames && !is_held(),
            };
            let start = &mut self.objects[index].start;
            start.is_there = is_there;
            undone |= start.undone();
        }
        undone
    }

    /// Whether an object that is seen stays where it is for most of the time in which a change would be believed.
    fn lies(&self, object: usize, age: usize) -> bool {
        let seen = |age: usize| self.seen_object(object, age);
        let moved = seen(age).zip(self.newest_known(age, seen));
        moved.is_some_and(|(from, (newest, to))| self.shows_rest(age, newest, norm(subtract(to, from))))
    }
}
