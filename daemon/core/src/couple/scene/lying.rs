//! What lies still: how far it seems to move by drift, and whether it lies where it does at the beginning of the job. Also to a judge that starts in
//! the middle of it, that tells what has not been done.

use super::Scene;
use crate::couple::interaction::Interaction;
use crate::couple::poses::{HandPose, Recent, Source};

impl Scene {
    /// While all hands are seen and none acts on anything, nothing moves. A hand that has never been seen may not be there.
    pub(super) fn push_drift(&mut self, age: usize) {
        let acts = self.interactions.iter().any(|what| matches!(what, Interaction::Acts { .. }));
        let is_hidden =
            |hand: &Recent<HandPose>| !matches!(hand.ago(age).source, Source::Seen | Source::Never);
        // What was seen before may be the work of a hand that is seen only now.
        let appears = |hand: &Recent<HandPose>| {
            [age, age + 1].map(|age| hand.ago(age).source == Source::Never) == [false, true]
        };
        let is_idle = !acts && !self.hands.iter().any(|hand| is_hidden(hand) || appears(hand));
        self.idle_frames = if is_idle { self.idle_frames.saturating_add(1) } else { 0 };
        let persist = self.method.persist_frames;
        if self.idle_frames == persist.into() {
            self.objects.iter_mut().for_each(|node| node.drift.begin());
        }
        if self.idle_frames <= persist.into() {
            return;
        }
        let has_seen_hand = self.hands.iter().any(|hand| hand.ago(age).source != Source::Never);
        for object in 0..self.objects.len() {
            let before = self.seen_object(object, age + usize::from(persist));
            if let Some((now, before)) = self.seen_object(object, age).zip(before) {
                self.objects[object].drift.push(now, before, has_seen_hand);
            }
        }
    }

    /// How far an object at rest seems to move at most while a change is believed, in metres. 0 where that is not known.
    pub(super) fn drift_m(&self, object: usize) -> f32 {
        self.objects[object].drift.bound_m().unwrap_or_default()
    }

    /// Finds the objects that lie where the job begins in the frame `age` frames before the newest. Call it once for each frame, in order. One lies
    /// there once it has been seen to rest there. What is out of sight for no longer than `blind_ms` lies where it lay, unless a hand acts on it.
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
