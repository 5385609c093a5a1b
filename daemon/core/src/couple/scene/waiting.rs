//! Whether a hand waits for the other one, which says how long that takes.
//!
//! A hand may rest while the other one moves. That time does not count against the maximum of the duration, and makes no demonstration
//! stand out. Of 20 jobs shown by people who sometimes wait, 13 were refused while it counted, and 2 are.

use super::super::poses::Source;
use super::super::{Couple, Waiting};
use super::Scene;

impl Scene {
    /// Whether the hand of this couple waits for the other hand.
    pub(super) fn waiting(&self, couple: &Couple, of_other: &Couple, age: usize) -> Waiting {
        let [hand, other] = [couple, of_other].map(|couple| couple.side.index());
        let is_pair_at_rest = couple.motion.is_none_or(|motion| motion.is_pair_at_rest());
        if !couple.context.is_touch() || !is_pair_at_rest || self.moves(hand, age) == Some(true) {
            return Waiting::No;
        }
        let is_seen = self.hands[other].ago(age).source == Source::Seen;
        // Who holds something at another part to which it was brought works there, though it may not move, as who pours.
        let is_joining = of_other.context.is_touch() && of_other.context.0[3] != 0;
        let works = couple.context.0[3] == 0 && is_joining && self.holds[other].is_some();
        match self.moves(other, age).map(|moves| moves || works) {
            Some(true) if couple.motion.is_some() => Waiting::Yes,
            Some(false) if is_seen => Waiting::No,
            // What the other one held may lie there, and the hand be gone.
            _ => Waiting::Unknown,
        }
    }

    /// Whether a hand moves, as what it holds shows where it holds something that has moved with it.
    fn moves(&self, hand: usize, age: usize) -> Option<bool> {
        let held = self.interactions[hand].held().filter(|_| self.hands[hand].ago(age).held_at.is_some());
        let motion = match held {
            Some(object) => self.object_kinematics(object, age),
            None => self.hand_kinematics(hand, age),
        };
        Some(!self.method.is_at_rest(&motion?))
    }
}
