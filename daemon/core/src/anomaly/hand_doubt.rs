//! For how many frames something may have come and gone unseen, for one hand.

use super::activity::Remainder;
use crate::config::Method;
use crate::couple::{Context, Couple, Unseen};
use crate::set::Set;

/// After this many times `persist_frames` without contact a hand is certainly empty. The first passes until a contact is known again behind a gap,
/// and the second until it is believed. In the third the hand comes to rest at what it takes.
const IDLE_PERSISTS: u32 = 3;

/// What is so of a hand, or may be because not all was seen.
pub(super) type HandFlags = Set<HandDoubt>;

impl HandFlags {
    /// It was certainly idle in some frame since it last acted.
    const HAS_BEEN_IDLE: Self = Self::of(0);
    /// Which of several objects it acts on was decided when too little was seen, or one had never been seen. It keeps to that until it lets go.
    const HELD_IN_DOUBT: Self = Self::of(1);
    /// The hand may have acted on `o_j` and `o_l` before they were first seen.
    pub(super) const OBJECT_NEW: Self = Self::of(2);
    /// One of them was new in the newest couple.
    const OBJECT_WAS_NEW: Self = Self::of(3);
    /// The start of the job was not seen, so that this matters wherever it begins.
    const MAY_BE_NEW: Self = Self::of(4);
    /// The next activity may be the remainder of one that was not seen to begin.
    pub(super) const REMAINDER: Self = Self::of(5);
    /// It may be so because nothing was watched before it.
    pub(super) const UNWATCHED: Self = Self::of(6);
    /// The couples have broken off, or the other hand has begun the next piece: the open activity is not watched to its end.
    pub(super) const BROKEN_OFF: Self = Self::of(7);
}

/// What was not seen of one hand, as far as a verdict may depend on it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HandDoubt {
    persist_frames: u32,
    /// The context of the newest couple.
    context: Context,
    /// How many frames up to the newest one were not clear.
    hidden_frames: u32,
    /// How many frames up to the newest one were not clear, or up to the one before if the newest is clear.
    gap: u32,
    /// How many frames up to the newest were clear, and more if none before them was known to be unclear; `None` before it was seen.
    clear_frames: Option<u32>,
    /// How many frames were not clear just before those.
    hidden_before_clear: u32,
    /// Clear frames since the newest doubtful couple.
    since_doubt: u32,
    /// The newest context that was certain, and how many frames ago it was so last.
    certain: Option<Context>,
    since_certain: u32,
    /// In how many frames without a doubtful one between them, up to the couple before the newest, the hand was certainly idle.
    idle_frames: u32,
    /// [`hidden_before`](Self::hidden_before) at the newest doubtful couple.
    lately_hidden: u32,
    /// `o_j` of the newest activity that was not judged, or 0.
    pub(super) unjudged: u16,
    pub(super) flags: HandFlags,
}

impl HandDoubt {
    /// Before the first couple: anything may have happened.
    pub(super) fn new(method: &Method) -> Self {
        Self {
            persist_frames: method.persist_frames.into(),
            flags: HandFlags::MAY_BE_NEW | HandFlags::REMAINDER | HandFlags::UNWATCHED,
            ..Self::default()
        }
    }

    /// What follows is the beginning of a job, so nothing that was not seen before matters.
    pub(super) fn begin(&mut self) {
        (self.hidden_frames, self.gap, self.since_doubt, self.unjudged) = (0, 0, u32::MAX, 0);
        self.clear_frames = None;
        (self.certain, self.since_certain) = (Some(Context::IDLE), 0);
        self.flags =
            self.flags & (HandFlags::HAS_BEEN_IDLE | HandFlags::OBJECT_WAS_NEW | HandFlags::BROKEN_OFF);
    }

    /// Nothing is known of what the hand does from now on.
    pub(super) fn lose(&mut self) {
        (self.since_doubt, self.certain) = (0, None);
        self.flags |= HandFlags::MAY_BE_NEW | HandFlags::UNWATCHED;
    }

    /// The encoder has started again: nothing was watched before, so the next activity may be the remainder of one.
    pub(super) fn doubt_beginning(&mut self) {
        self.flags |= HandFlags::REMAINDER | HandFlags::UNWATCHED;
    }

    /// Takes the next couple, which comes as many frames later. Returns in how many of these frames something may have come and gone.
    pub(super) fn observe(&mut self, couple: &Couple, frames: u32) -> u32 {
        let (is_idle, is_certain) = (self.certain == Some(Context::IDLE), self.is_certain());
        // A frame in which nothing can have come and gone interrupts nothing.
        let goes_on = is_idle && !self.is_doubtful();
        self.idle_frames = if goes_on { self.idle_frames.saturating_add(is_certain.into()) } else { 0 };
        let has_been_idle = self.has(HandFlags::HAS_BEEN_IDLE) || self.idle_frames > 0;
        self.flags.put(HandFlags::HAS_BEEN_IDLE, (is_idle || !is_certain) && has_been_idle);
        let is_clear = !couple.lacks(Unseen::CONTEXT);
        let missing = frames - 1;
        self.hidden_frames = self.hidden_frames.saturating_add(missing);
        if is_clear {
            self.gap = core::mem::take(&mut self.hidden_frames);
            self.clear_frames = match self.gap {
                0 => Some(self.clear_frames.map_or(u32::MAX, |frames| frames.saturating_add(1))),
                gap => {
                    self.hidden_before_clear = gap;
                    Some(1)
                }
            };
        } else {
            self.hidden_frames = self.hidden_frames.saturating_add(1);
            self.gap = self.hidden_frames;
        }
        let is_doubtful = couple.lacks(Unseen::CHANGE) || missing >= self.persist_frames;
        // What began before may have been overlooked for as long as a change takes to be believed.
        let before = self.since_doubt.min(self.persist_frames);
        let newly_hidden = if is_doubtful { frames.saturating_add(before) } else { 0 };
        // Only frames that show something make a change believable.
        self.since_doubt = if is_doubtful { 0 } else { self.since_doubt.saturating_add(is_clear.into()) };
        // The part in a hand may already have been at an object that is seen only now, even if the job's start was seen.
        let is_new = couple.lacks(Unseen::ARRIVAL);
        let appears = is_new && !self.has(HandFlags::OBJECT_WAS_NEW) && self.context.is_touch();
        self.flags.put(HandFlags::OBJECT_WAS_NEW, is_new);
        self.observe_held(couple);
        let matters = appears || self.has(HandFlags::MAY_BE_NEW | HandFlags::OBJECT_NEW);
        let is_first_seen = is_new && matters;
        self.flags.put(HandFlags::OBJECT_NEW, is_first_seen || couple.lacks(Unseen::MOVE));
        self.flags |= HandFlags::HELD_IN_DOUBT.when(is_first_seen && couple.lacks(Unseen::TAKING));
        if is_clear && !self.is_doubtful() {
            (self.certain, self.since_certain) = (Some(couple.context), 0);
        } else {
            self.since_certain = self.since_certain.saturating_add(frames);
        }
        if self.is_doubtful() {
            self.lately_hidden = self.hidden_before();
        }
        newly_hidden
    }

    fn observe_held(&mut self, couple: &Couple) {
        let before = core::mem::replace(&mut self.context, couple.context).o_j();
        if ![0, before].contains(&self.context.o_j()) {
            let was_in_doubt = before != 0 && self.has(HandFlags::HELD_IN_DOUBT);
            self.flags.put(HandFlags::HELD_IN_DOUBT, was_in_doubt || self.is_recent());
        }
        self.flags.put(HandFlags::HELD_IN_DOUBT.when(!couple.lacks(Unseen::TAKING)), false);
    }

    /// Whether any of these is so.
    pub(super) fn has(&self, flags: HandFlags) -> bool {
        self.flags.intersects(flags)
    }

    /// Whether the next activity may be the remainder of another one.
    pub(super) fn remainder(&self) -> Remainder {
        match self.has(HandFlags::UNWATCHED) {
            _ if !self.has(HandFlags::REMAINDER) => Remainder::No,
            true => Remainder::Unwatched,
            false => Remainder::Possible,
        }
    }

    /// Where the context changed with the newest couple, it may have changed as many frames before.
    pub(super) fn gap(&self) -> u32 {
        if self.is_doubtful() {
            self.gap.max(self.since_certain)
        } else if self.since_doubt <= 2 * self.persist_frames {
            // Behind a gap, a change is believed as much later as the contact takes to be known again.
            self.gap.max(self.persist_frames)
        } else {
            // Whether two move together is read from as many frames before the change.
            let clear = self.clear_frames.filter(|frames| self.gap == 0 && *frames <= self.persist_frames);
            clear.map_or(self.gap, |frames| self.hidden_before_clear.saturating_add(frames - 1))
        }
    }

    /// The newest couple is certain.
    pub(super) fn is_certain(&self) -> bool {
        self.certain.is_some() && self.since_certain == 0
    }

    /// The newest couple is not doubtful, nor the object new. Before it the hand was idle for longer than it takes to see that it holds something.
    pub(super) fn was_idle(&self) -> bool {
        let is_idle = self.idle_frames > self.min_idle_frames();
        is_idle && !self.is_doubtful() && !self.has(HandFlags::OBJECT_NEW)
    }

    /// An IU begins with the newest couple, in doubt or not. Whether the hand was certainly idle at some time since the one before it.
    pub(super) fn begin_iu(&mut self) -> bool {
        let has_been_idle = self.has(HandFlags::HAS_BEEN_IDLE);
        self.flags.put(HandFlags::HAS_BEEN_IDLE, false);
        has_been_idle
    }

    /// It takes less to see that a hand holds something.
    pub(super) fn min_idle_frames(&self) -> u32 {
        IDLE_PERSISTS * self.persist_frames
    }

    /// In this many hidden frames the hand may have let go of everything. It is idle until that is believed. A gap counts for as many frames more, in
    /// which something before it may have been overlooked.
    pub(super) fn end_frames(&self) -> u32 {
        2 * self.persist_frames
    }

    /// In how many frames something may have come and gone before what begins with the newest couple.
    pub(super) fn hidden_before(&self) -> u32 {
        match self.certain {
            _ if self.has(HandFlags::OBJECT_NEW) => u32::MAX,
            _ if !self.is_doubtful() => 0,
            Some(_) => self.since_certain.saturating_add(self.persist_frames),
            None => u32::MAX,
        }
    }

    /// [`hidden_before`](Self::hidden_before) for an activity that begins with this context. It may be the remainder of one with the same object, or
    /// may have begun before the hand was seen to hold something. Takes note of whether it may be a remainder.
    pub(super) fn begin_activity(&mut self, context: Context) -> u32 {
        let is_same = self.certain.is_some_and(|certain| certain.o_j() == context.0[1]);
        let is_remainder =
            is_same && self.is_doubtful() || self.has(HandFlags::OBJECT_NEW) || self.unjudged == context.0[1];
        let hidden = if is_remainder || self.has(HandFlags::REMAINDER) {
            u32::MAX
        } else if self.since_doubt <= self.min_idle_frames() {
            self.lately_hidden
        } else {
            self.hidden_before()
        };
        self.flags |= HandFlags::REMAINDER.when(hidden == u32::MAX);
        self.unjudged = 0;
        hidden
    }

    /// What begins now is not the remainder of anything.
    pub(super) fn forget_remainder(&mut self) {
        self.flags.put(HandFlags::REMAINDER | HandFlags::UNWATCHED | HandFlags::OBJECT_NEW, false);
        self.unjudged = 0;
    }

    /// The object of the hand's newest activity, if that was not judged and the hand still touches the object.
    pub(super) fn unjudged_in_hand(&self) -> Option<u16> {
        (self.context.is_touch() && self.context.o_j() == self.unjudged).then_some(self.unjudged)
    }

    /// Whether an IU that begins with this context may have begun before. It goes on from before a doubt, or an object was seen for the first time.
    pub(super) fn may_go_on(&self, context: Context) -> bool {
        self.has(HandFlags::OBJECT_NEW)
            || self.is_doubtful() && self.certain.is_none_or(|certain| certain == context)
    }

    /// Whether the hand may still hold another object than the one that it is said to act on.
    pub(super) fn may_hold_another(&self) -> bool {
        self.context.o_j() != 0 && self.has(HandFlags::HELD_IN_DOUBT)
    }

    /// Whether the hand may go on with what it touched before a doubt.
    pub(super) fn may_go_on_touching(&self, context: Context) -> bool {
        context.is_touch() && self.may_go_on(context)
    }

    /// How long the hand has been hidden. It is 0 for a hand that has never been seen, because one hand may do the work alone.
    pub(super) fn hidden_frames(&self) -> u32 {
        self.clear_frames.map_or(0, |_| self.gap)
    }

    /// Whether a change of context with the newest couple depends on too little.
    pub(super) fn is_doubtful(&self) -> bool {
        self.is_recent() || self.may_hold_another()
    }

    /// Whether enough of the frames of a stretch were captured for two changes to be believed.
    pub(super) fn is_believable(&self, captured: u32, frames: u32) -> bool {
        captured >= frames.min(2 * self.persist_frames)
    }

    /// Whether there was a doubtful couple not longer ago than a change takes to be believed.
    fn is_recent(&self) -> bool {
        self.since_doubt <= self.persist_frames
    }
}
