//! Which hand a track is, decided over time.

use crate::detections::Side;

/// One look counts this much at most, in log odds: a model that is sure and wrong must be so for several frames.
const MOST_A_LOOK: f32 = 2.0;
/// What has been gathered never counts more than this: five sure looks, so that a real mistake can be mended.
const MOST_GATHERED: f32 = 10.0;
/// Under this nothing is said yet: odds of 3 to 1.
const DECIDED: f32 = 1.1;
/// What is decided is only taken back by this much evidence for the contrary.
const TAKEN_BACK: f32 = 4.0;

/// What is known of the side of one hand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Evidence {
    /// Log odds that it is a right hand.
    right: f32,
    side: Option<Side>,
}

impl Evidence {
    /// One more look: the probability that it is a right hand.
    pub(crate) fn look(&mut self, right: f32) {
        let odds = (right / (1.0 - right)).ln().clamp(-MOST_A_LOOK, MOST_A_LOOK);
        // A probability of exactly 0 or 1 has infinite odds and is clamped; NaN says nothing.
        if !odds.is_nan() {
            self.right = (self.right + odds).clamp(-MOST_GATHERED, MOST_GATHERED);
        }
    }

    /// Decides the side of the only hand in a frame.
    pub(crate) fn settle(&mut self) {
        self.side = settled(self.side, self.right);
    }

    /// Decides the sides of the two hands in a frame: one is a right and one a left one, by which is the righter.
    pub(crate) fn settle_pair(&mut self, other: &mut Self) {
        let apart = matches!((self.side, other.side), (Some(a), Some(b)) if a != b);
        let before = if apart { self.side } else { None };
        // Where nothing tells them apart, the one that was decided first keeps its side.
        let side = settled(before, self.right - other.right).or(self.side).or(other.side.map(Side::other));
        self.side = side;
        other.side = side.map(Side::other);
    }

    /// The side, once it is decided.
    pub(crate) fn side(&self) -> Option<Side> {
        self.side
    }
}

/// The side after the log odds for the right one are `right`.
fn settled(before: Option<Side>, right: f32) -> Option<Side> {
    match before {
        None if right.abs() < DECIDED => None,
        None => Some(likelier(right)),
        Some(Side::Right) if right < -TAKEN_BACK => Some(Side::Left),
        Some(Side::Left) if right > TAKEN_BACK => Some(Side::Right),
        kept => kept,
    }
}

fn likelier(right: f32) -> Side {
    if right >= 0.0 { Side::Right } else { Side::Left }
}
