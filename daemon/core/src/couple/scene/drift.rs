//! How far objects that lie still seem to move, by drift.

use super::super::interaction::Interaction;
use super::super::poses::{HandPose, Recent, Source};
use super::Scene;

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

    /// How far apart two positions of an object, or of one in the frame of another, may be by drift, in metres. Finger tips err at least so.
    pub(super) fn pair_drift_m(&self, j: usize, l: Option<usize>) -> f32 {
        libm::hypotf(self.drift_m(j), l.map_or(0.0, |l| self.drift_m(l)))
    }

    /// How far an object at rest seems to move at most while a change is believed, in metres. 0 where that is not known.
    pub(super) fn drift_m(&self, object: usize) -> f32 {
        self.objects[object].drift.bound_m().unwrap_or_default()
    }
}
