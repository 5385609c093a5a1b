//! Objects that are seen so seldom that no motion of theirs is measured. A hand that takes one and puts it down between two such glimpses is not seen
//! to act on it.

use super::super::noise::has_moved;
use crate::input::Point;

/// The places at which an object was seen lately.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Glimpses {
    /// Where it was seen last.
    newest: Option<Point>,
    /// Frames since then.
    unseen: u32,
    /// How many times in a row it has been elsewhere, unmeasured each time.
    moves: u8,
}

impl Glimpses {
    /// Takes where the object is seen in the newest frame, or `None`. Says whether it is carried about unmeasured. For that, it has been farther away
    /// than [`MOVED_M`] at two glimpses in a row. Each is more than `persist` and at most `blind` frames after the one before. What was only
    /// exchanged while nothing was seen has been elsewhere once.
    pub(super) fn push(&mut self, seen: Option<Point>, persist: u32, blind: u32) -> bool {
        self.unseen = self.unseen.saturating_add(1);
        let Some(place) = seen else { return false };
        let is_glimpse = persist < self.unseen && self.unseen <= blind;
        let is_elsewhere = self.newest.is_some_and(|lay| has_moved(lay, place));
        let moves = if is_glimpse && is_elsewhere { self.moves.saturating_add(1) } else { 0 };
        *self = Self { newest: Some(place), unseen: 0, moves };
        moves >= 2
    }
}
