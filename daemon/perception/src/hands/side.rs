//! Whether a track is a right or a left hand, decided over time.

use crate::detections::Side;

/// Maximum weight of one look, in log odds: a model that is sure and wrong must be so for several frames.
const MAX_PER_LOOK: f32 = 2.0;
/// Maximum weight of all looks together: five sure ones, so that a mistake can be corrected.
const MAX_EVIDENCE: f32 = 10.0;
/// The evidence that decides a side: odds of 3 to 1.
const DECIDED: f32 = 1.1;
/// The evidence for the other side that reverses a decision.
const REVERSED: f32 = 4.0;

/// The evidence for the side of one hand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Evidence {
    /// Log odds that it is a right hand.
    right: f32,
    side: Option<Side>,
}

impl Evidence {
    /// Takes in one look: the probability that it is a right hand.
    pub(crate) fn take(&mut self, right: f32) {
        let odds = (right / (1.0 - right)).ln().clamp(-MAX_PER_LOOK, MAX_PER_LOOK);
        // The infinite odds of a probability of exactly 0 or 1 are clamped; NaN is no evidence.
        if !odds.is_nan() {
            self.right = (self.right + odds).clamp(-MAX_EVIDENCE, MAX_EVIDENCE);
        }
    }

    /// Decides the side of the only hand in a frame.
    pub(crate) fn settle(&mut self) {
        self.side = settled(self.side, self.right);
    }

    /// Decides the sides of the two hands in a frame. One is right and one is left; the evidence is compared.
    pub(crate) fn settle_pair(&mut self, other: &mut Self) {
        let apart = matches!((self.side, other.side), (Some(a), Some(b)) if a != b);
        let before = if apart { self.side } else { None };
        // If the evidence does not decide, the hand whose side was decided first keeps it.
        let side = settled(before, self.right - other.right).or(self.side).or(other.side.map(Side::other));
        self.side = side;
        other.side = side.map(Side::other);
    }

    /// The side, if it is decided.
    pub(crate) fn side(&self) -> Option<Side> {
        self.side
    }
}

/// The side when the log odds for a right hand are `right`.
fn settled(before: Option<Side>, right: f32) -> Option<Side> {
    match before {
        None if right.abs() < DECIDED => None,
        None => Some(likelier(right)),
        Some(Side::Right) if right < -REVERSED => Some(Side::Left),
        Some(Side::Left) if right > REVERSED => Some(Side::Right),
        kept => kept,
    }
}

fn likelier(right: f32) -> Side {
    if right >= 0.0 { Side::Right } else { Side::Left }
}
