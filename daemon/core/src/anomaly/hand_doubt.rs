//! The contexts that are possible for one hand, and for how many frames something may have come and gone unseen. A couple leaves one context, which is
//! *certain*, or several: any that can be reached from the one that was certain last.

use super::activity::Remainder;
use crate::config::Method;
use crate::couple::{Context, Couple, Unseen};

/// After this many times `persist_frames` without contact a hand is certainly empty. The first passes until a contact is known again behind a gap,
/// and the second until it is believed. In the third the hand comes to rest at what it takes.
const IDLE_PERSISTS: u32 = 3;

/// What was not seen of one hand, as far as a verdict may depend on it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HandDoubt {
    persist_frames: u32,
    /// The context of the newest couple, and what was not seen of it.
    context: Context,
    unseen: Unseen,
    /// In how many frames in a row the hand was hidden last, or what it acts on.
    gap: u32,
    /// For how many frames it has not been so, and more if it never was before; `None` if the hand has not been seen.
    clear_frames: Option<u32>,
    /// Clear frames since the newest couple that leaves several contexts.
    since_doubt: u32,
    /// The context that was certain last, and how many frames ago.
    certain: Option<Context>,
    since_certain: u32,
    /// In how many frames something may have come and gone up to the newest couple that leaves several contexts.
    hidden: u32,
    /// In how many frames without a doubtful one between them, up to the couple before the newest, the hand was certainly idle.
    idle_frames: u32,
    /// It was so in some frame since it last acted.
    has_been_idle: bool,
    /// Which of several objects the hand acts on was decided when too little was seen, or before one of them was first seen.
    is_held_doubtful: bool,
    /// `o_j` or `o_l` is first seen, and the hand may have acted on it before.
    is_first_seen: bool,
    /// The start of the job was not seen, so that this matters wherever it begins.
    may_be_new: bool,
    /// `o_j` of the newest activity that was not judged, or 0.
    pub(super) unjudged: u16,
    /// The next activity may be the remainder of one that was not seen to begin.
    pub(super) may_be_remainder: bool,
    /// It may be so because nothing was watched before it.
    pub(super) is_begun_late: bool,
}

impl HandDoubt {
    /// Before the first couple: anything may have happened.
    pub(super) fn new(method: &Method) -> Self {
        Self {
            persist_frames: method.persist_frames.into(),
            may_be_new: true,
            may_be_remainder: true,
            is_begun_late: true,
            ..Self::default()
        }
    }

    /// What follows is the beginning of a job, so nothing that was not seen before matters.
    pub(super) fn begin(&mut self) {
        *self = Self {
            persist_frames: self.persist_frames,
            context: self.context,
            unseen: self.unseen.without(Unseen::MOVE),
            since_doubt: u32::MAX,
            certain: Some(Context::IDLE),
            idle_frames: self.idle_frames,
            has_been_idle: self.has_been_idle,
            ..Self::default()
        };
    }

    /// Nothing is known of what the hand does from now on.
    pub(super) fn lose(&mut self) {
        (self.since_doubt, self.certain) = (0, None);
        (self.may_be_new, self.is_begun_late) = (true, true);
    }

    /// Takes the next couple, which comes as many frames after the one before: of a long gap, not all have one.
    pub(super) fn observe(&mut self, couple: &Couple, frames: u32) {
        self.count_idle();
        let is_clear = !couple.lacks(Unseen::CONTEXT);
        self.count_hidden(is_clear, frames - 1);
        let is_doubtful = couple.lacks(Unseen::CHANGE) || frames > self.persist_frames;
        // Only frames that show something make a change believable.
        self.since_doubt = if is_doubtful { 0 } else { self.since_doubt.saturating_add(is_clear.into()) };
        self.observe_objects(couple);
        if is_clear && !self.is_doubtful() {
            (self.certain, self.since_certain) = (Some(couple.context), 0);
        } else {
            self.since_certain = self.since_certain.saturating_add(frames);
        }
        if is_doubtful {
            self.hidden = self.hidden_since();
        }
    }

    fn observe_objects(&mut self, couple: &Couple) {
        // The part in a hand may already have been at an object that is seen only now, even if the job's start was seen.
        let appears = self.context.is_touch() && !self.unseen.intersects(Unseen::ARRIVAL);
        let matters = self.may_be_new || appears || self.is_object_new();
        self.is_first_seen = matters && couple.lacks(Unseen::ARRIVAL);
        let takes = ![0, self.context.o_j()].contains(&couple.context.o_j());
        let is_taken_doubtful = self.is_held_doubtful || takes && self.is_recent() || self.is_first_seen;
        self.is_held_doubtful = couple.lacks(Unseen::TAKING) && is_taken_doubtful;
        (self.context, self.unseen) = (couple.context, couple.unseen);
    }

    /// A frame in which nothing can have come and gone interrupts nothing.
    fn count_idle(&mut self) {
        let (is_idle, is_certain) = (self.certain == Some(Context::IDLE), self.is_certain());
        let goes_on = is_idle && !self.is_doubtful();
        self.idle_frames = if goes_on { self.idle_frames.saturating_add(is_certain.into()) } else { 0 };
        self.has_been_idle = (is_idle || !is_certain) && (self.has_been_idle || self.idle_frames > 0);
    }

    fn count_hidden(&mut self, is_clear: bool, missing: u32) {
        let hidden = missing + u32::from(!is_clear);
        if hidden == 0 {
            let never = if self.gap == 0 { u32::MAX } else { 1 };
            self.clear_frames = Some(self.clear_frames.map_or(never, |frames| frames.saturating_add(1)));
        } else {
            let goes_on = self.clear_frames.is_none_or(|frames| frames == 0);
            self.gap = if goes_on { self.gap.saturating_add(hidden) } else { hidden };
            self.clear_frames = if is_clear { Some(1) } else { self.clear_frames.map(|_| 0) };
        }
    }

    /// Whether the next activity may be the remainder of another one.
    pub(super) fn remainder(&self) -> Remainder {
        match self.is_begun_late {
            _ if !self.may_be_remainder => Remainder::No,
            true => Remainder::Unwatched,
            false => Remainder::Possible,
        }
    }

    /// Where the context changed with the newest couple, it may have changed as many frames before. Behind a gap a change is believed as much later as
    /// the contact takes to be known again. That is two windows: with one or three 11 or 5 of 3,700 drawn streams differ.
    pub(super) fn gap(&self) -> u32 {
        let clear = self.clear_frames.unwrap_or(0);
        let is_behind = clear <= self.persist_frames;
        let gap = if is_behind { self.gap.saturating_add(clear.saturating_sub(1)) } else { 0 };
        if self.is_doubtful() {
            gap.max(self.since_certain)
        } else if self.since_doubt <= 2 * self.persist_frames {
            gap.max(self.persist_frames)
        } else {
            gap
        }
    }

    /// The newest couple is certain.
    pub(super) fn is_certain(&self) -> bool {
        self.certain.is_some() && self.since_certain == 0
    }

    /// The newest couple is not doubtful, and the hand acts on nothing new. Before it the hand was certainly idle, for longer than it takes to see
    /// that it holds something.
    pub(super) fn was_idle(&self) -> bool {
        self.idle_frames > self.min_idle_frames() && !self.is_doubtful() && !self.is_object_new()
    }

    /// An IU begins with the newest couple, in doubt or not. Whether the hand was certainly idle at some time since the one before it.
    pub(super) fn begin_iu(&mut self) -> bool {
        core::mem::take(&mut self.has_been_idle)
    }

    /// It takes less to see that a hand holds something.
    pub(super) fn min_idle_frames(&self) -> u32 {
        IDLE_PERSISTS * self.persist_frames
    }

    /// In this many hidden frames the hand may have let go of everything. They are those until that is believed, and as many before it.
    pub(super) fn end_frames(&self) -> u32 {
        2 * self.persist_frames
    }

    /// The hand may have acted on what it acts on before that was first seen.
    pub(super) fn is_object_new(&self) -> bool {
        self.is_first_seen || self.unseen.intersects(Unseen::MOVE)
    }

    /// In how many frames up to the newest couple that leaves several contexts something may have come and gone, if there was one lately.
    pub(super) fn hidden_lately(&self) -> u32 {
        if self.is_recent() { self.hidden } else { 0 }
    }

    /// In how many frames something may have come and gone before what begins with the newest couple.
    pub(super) fn hidden_before(&self) -> u32 {
        if self.is_object_new() {
            u32::MAX
        } else if self.is_doubtful() {
            self.hidden_since()
        } else {
            0
        }
    }

    /// In how many frames something may have come and gone since a context was certain, which takes as long to be believed.
    fn hidden_since(&self) -> u32 {
        self.certain.map_or(u32::MAX, |_| self.since_certain.saturating_add(self.persist_frames))
    }

    /// [`hidden_before`](Self::hidden_before) for an activity that begins with this context. It may have begun before the hand was seen to hold
    /// something. Takes note of whether it may be the remainder of one with the same object.
    pub(super) fn begin_activity(&mut self, context: Context) -> u32 {
        let is_same = self.certain.is_some_and(|certain| certain.o_j() == context.0[1]);
        let is_remainder =
            is_same && self.is_doubtful() || self.is_object_new() || self.unjudged == context.0[1];
        let hidden = if self.may_be_remainder || is_remainder {
            u32::MAX
        } else if self.since_doubt <= self.min_idle_frames() {
            self.hidden.saturating_add(self.persist_frames)
        } else {
            self.hidden_before()
        };
        self.may_be_remainder |= hidden == u32::MAX;
        self.unjudged = 0;
        hidden
    }

    /// What begins now is not the remainder of anything.
    pub(super) fn forget_remainder(&mut self) {
        (self.may_be_remainder, self.is_begun_late, self.unjudged) = (false, false, 0);
        (self.is_first_seen, self.unseen) = (false, self.unseen.without(Unseen::MOVE));
    }

    /// The object of the hand's newest activity, if that was not judged and the hand still touches the object.
    pub(super) fn unjudged_in_hand(&self) -> Option<u16> {
        (self.context.is_touch() && self.context.o_j() == self.unjudged).then_some(self.unjudged)
    }

    /// Whether an IU that begins with this context may have begun before a doubt, or before an object was first seen.
    pub(super) fn may_go_on(&self, context: Context) -> bool {
        self.is_object_new() || self.is_doubtful() && self.certain.is_none_or(|certain| certain == context)
    }

    /// Whether the hand may still hold another object than the one that it is said to act on.
    pub(super) fn may_hold_another(&self) -> bool {
        self.context.o_j() != 0 && self.is_held_doubtful
    }

    /// How long the hand has been hidden. It is 0 for a hand that has never been seen, because one hand may do the work alone.
    pub(super) fn hidden_frames(&self) -> u32 {
        if self.clear_frames.is_some_and(|frames| frames <= 1) { self.gap } else { 0 }
    }

    /// Whether the newest couple leaves several contexts, or one did not longer ago than a change takes to be believed.
    pub(super) fn is_doubtful(&self) -> bool {
        self.is_recent() || self.may_hold_another()
    }

    fn is_recent(&self) -> bool {
        self.since_doubt <= self.persist_frames
    }
}
