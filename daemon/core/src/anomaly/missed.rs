//! What did not show what a hand acts on: frames that never came, or frames in which it was hidden.

use crate::couple::{Couple, Sight};
use crate::verdict::Reason;

/// How many frames did not show what a hand acts on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Missed {
    period_ns: u64,
    newest_ns: u64,
    /// The hand or an object was hidden in them.
    captured: u32,
    /// They never came.
    uncaptured: u32,
}

impl Missed {
    pub(super) fn new(period_ns: u64) -> Self {
        Self { period_ns, newest_ns: u64::MAX, captured: 0, uncaptured: 0 }
    }

    /// Neither the newest couple nor anything before it matters.
    pub(super) fn forget(&mut self) {
        *self = Self { newest_ns: self.newest_ns, ..Self::new(self.period_ns) };
    }

    /// The next couple is of this time. Of a long gap, not all frames of the grid have a couple.
    pub(super) fn skip_to(&mut self, captured_ns: u64) {
        let elapsed_ns = captured_ns.saturating_sub(self.newest_ns).saturating_sub(self.period_ns / 2);
        let missing = u32::try_from(elapsed_ns / self.period_ns).unwrap_or(u32::MAX);
        self.uncaptured = self.uncaptured.saturating_add(missing);
        self.newest_ns = captured_ns;
    }

    /// Takes that couple.
    pub(super) fn count(&mut self, couple: &Couple, is_captured: bool) {
        // What is seen and not clear behind frames that never came is so because of them.
        let is_hidden = couple.sight != [Sight::Seen; 3] || self.uncaptured == 0;
        if !is_captured {
            self.uncaptured = self.uncaptured.saturating_add(1);
        } else if !couple.is_clear && is_hidden {
            self.captured = self.captured.saturating_add(1);
        }
    }

    /// Why too little is known: most of the frames that would have shown it never came, or they did not show it.
    pub(super) fn reason(missed: &[Self]) -> Reason {
        let most = |count: fn(&Self) -> u32| missed.iter().map(count).max();
        let is_overloaded = most(|missed| missed.uncaptured) > most(|missed| missed.captured);
        if is_overloaded { Reason::Overload } else { Reason::Blind }
    }
}
