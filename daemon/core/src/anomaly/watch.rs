//! How well a hand and what it acts on have been seen lately.

use crate::couple::Couple;

/// What was not seen of one hand, as far as a verdict may rest on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watch {
    persist_frames: u32,
    /// How many frames up to the newest one were not clear.
    hidden_frames: u32,
    /// How many frames up to the newest one were not clear, or up to the one before if the newest is clear.
    gap: u32,
    /// Frames since the newest doubtful couple.
    since_doubt: u32,
    /// The hand has been seen.
    has_been_clear: bool,
    /// The next activity may be the rest of one that was not seen to begin.
    pub(super) may_be_rest: bool,
}

impl Watch {
    /// Before the first couple: anything may have happened.
    pub(super) fn new(persist_frames: u8) -> Self {
        Self {
            persist_frames: persist_frames.into(),
            hidden_frames: 0,
            gap: 0,
            since_doubt: 0,
            has_been_clear: false,
            may_be_rest: true,
        }
    }

    /// What follows is the beginning of a job, so nothing that was not seen before matters.
    pub(super) fn begin(&mut self) {
        *self = Self {
            since_doubt: u32::MAX,
            may_be_rest: false,
            persist_frames: self.persist_frames,
            ..Self::new(0)
        };
    }

    /// Takes the next couple.
    pub(super) fn observe(&mut self, couple: &Couple) {
        if couple.is_clear {
            self.gap = core::mem::take(&mut self.hidden_frames);
            self.has_been_clear = true;
        } else {
            self.hidden_frames = self.hidden_frames.saturating_add(1);
            self.gap = self.hidden_frames;
        }
        self.since_doubt = if couple.is_doubtful { 0 } else { self.since_doubt.saturating_add(1) };
    }

    /// Where the context changed with the newest couple, it may have changed as many frames before.
    pub(super) fn gap(&self) -> u32 {
        self.gap
    }

    /// How long the hand has been hidden; 0 for a hand that has never been seen, because the bench may be worked at with one hand.
    pub(super) fn hidden_frames(&self) -> u32 {
        if self.has_been_clear { self.gap } else { 0 }
    }

    /// Whether a change of context with the newest couple rests on too little.
    pub(super) fn is_doubtful(&self) -> bool {
        self.since_doubt <= self.persist_frames
    }
}
