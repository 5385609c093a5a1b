//! Which objects lie where they do at the beginning of the job.
//!
//! A judge that starts in the middle of a job did not see its beginning. Parts that lie where the job begins still tell what has not been
//! done.

use super::Scene;
use crate::couple::interaction::Interaction;
use crate::couple::poses::Source;

impl Scene {
    /// Finds the objects that lie where the job begins in the frame `age` frames before the newest. Call it once for each frame, in order. An object
    /// that is out of sight for no longer than `blind_ms` lies where it lay, unless a hand acts on it. It lies there only once it has been seen to
    /// rest there.
    pub(super) fn push_at_start(&mut self, age: usize) {
        for index in 0..self.objects.len() {
            let (node, was_there) = (&self.objects[index], self.at_start.contains(index));
            let pose = node.poses.ago(age);
            let lies_within =
                || node.shape.start.is_some_and(|place| place.distance(pose.position) <= place.max);
            // A touch that begins in this frame finds the object where it lay.
            let acts = |(what, lasted): (&Interaction, u32)| what.acts_on(index) && lasted > 1;
            let is_held = || self.interactions.iter().zip(self.lasted).any(acts);
            let is_there = match pose.source {
                Source::Seen => lies_within() && (was_there || self.lies(index, age)),
                _ => was_there && pose.unseen <= self.blind_frames && !is_held(),
            };
            self.at_start.set(index, is_there);
        }
    }

    /// Whether an object that is seen stays where it is for most of the time in which a change would be believed.
    fn lies(&self, object: usize, age: usize) -> bool {
        let moved = self.moved(age, |age| self.seen_object(object, age));
        moved.is_some_and(|(newest, path_m)| self.shows_rest(age, newest, path_m))
    }
}
