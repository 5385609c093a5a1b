//! What is known of an IU so far, and what of it may have happened unseen.

use super::occlusion::percent;
use crate::couple::{Couple, Unseen, Visibility, Waiting};
use crate::segment::{FRAMES_PER_REVERSAL, Measures, WORLDS};
use crate::verdict::Reason;

/// How long the IU is, what it measures, and what was not seen of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct IuObservation {
    pub(super) frames: u32,
    /// How many of them were captured.
    pub(super) captured: u32,
    /// In how many of them the hand waited for the other one.
    pub(super) waited: u32,
    /// In how many it may have, because either hand was not seen.
    pub(super) may_have_waited: u32,
    /// In how many frames its motion was measured.
    pub(super) measured: u32,
    /// In how many frames a part of it was not seen, even where it was assumed.
    pub(super) assumed: u32,
    pub(super) measures: Measures,
    /// The same if in each gap its motion went on at its pace before it came back.
    pub(super) measures_at_pace: Measures,
    /// It has ended.
    pub(super) ended: bool,
    /// It may have begun as many frames earlier.
    pub(super) gap_before: u32,
    /// It may have ended as many frames earlier.
    pub(super) gap_after: u32,
    /// It may end as many frames later.
    pub(super) may_go_on: u32,
    /// Its beginning or its end may be that of another stretch: the IU may be a part of one.
    pub(super) may_be_part: bool,
    /// What was not seen of it may have been something else.
    pub(super) is_doubtful: bool,
    /// Its first part was at rest in some frame, or it has no two parts.
    pub(super) has_rested: bool,
}

/// The ends of an IU, and of a way: its beginning and its end.
pub(super) const ENDS: u32 = 2;

/// The share of an IU up to which hidden motion is assumed to have gone on like seen motion. Short gaps hide no reversal, so beyond it half of the
/// strokes could seem to be all of them. Halved or doubled, 2 or 6 of 3,700 drawn streams differ.
const MAX_ASSUMED: f32 = 0.25;

impl IuObservation {
    /// One frame more, with the measures so far; `has_other` is whether there is another hand to wait for.
    pub(super) fn push(&mut self, couple: &Couple, measures: [Measures; WORLDS], has_other: bool) {
        let waits = |waiting: Waiting| has_other && couple.waiting == waiting;
        let is_assumed = couple.worst_visibility() != Visibility::Seen;
        self.frames = self.frames.saturating_add(1);
        self.captured = self.captured.saturating_add((!couple.lacks(Unseen::FRAME)).into());
        self.waited = self.waited.saturating_add(waits(Waiting::Yes).into());
        self.may_have_waited = self.may_have_waited.saturating_add(waits(Waiting::Unknown).into());
        self.measured = self.measured.saturating_add(couple.motion.is_some().into());
        self.assumed = self.assumed.saturating_add(is_assumed.into());
        [self.measures, self.measures_at_pace] = measures;
        self.has_rested |= couple.motion.is_some_and(|motion| motion.is_pair_at_rest());
        self.is_doubtful |= couple.lacks(Unseen::CHANGE);
    }

    /// How many of a hundred frames were captured; `None` before the first.
    pub(super) fn captured_percent(&self) -> Option<u8> {
        percent(self.captured, self.frames)
    }

    /// In how many of a hundred frames the hand and each object that it acts on were seen; `None` before the first.
    pub(super) fn seen_percent(&self) -> Option<u8> {
        percent(self.frames.saturating_sub(self.assumed), self.frames)
    }

    /// Whether enough frames were captured for the motion to be known as well as the job needs. One frame more or less is no difference.
    pub(super) fn is_captured(&self, min_share: f32) -> bool {
        (self.captured + 1) as f32 >= min_share * self.frames as f32
    }

    /// How many frames the IU lasts without those in which the hand waited for the other one. A hand may wait for any time.
    pub(super) fn worked_frames(&self) -> u32 {
        self.frames.saturating_sub(self.waited)
    }

    /// The minimum of frames in which the hand may have worked, and the maximum of the IU. A frame that was not seen may shift either end by one.
    pub(super) fn possible_frames(&self) -> [u32; 2] {
        let shift = self.assumed.min(ENDS);
        let not_work = self.gap_after.saturating_add(shift).saturating_add(self.may_have_waited);
        [
            self.worked_frames().saturating_sub(not_work),
            self.frames.saturating_add(self.gap_before).saturating_add(self.may_go_on).saturating_add(shift),
        ]
    }

    /// How often a motion with these measures may have reversed in addition, in frames that were not seen.
    pub(super) fn possible_reversals(&self, measures: &Measures) -> u32 {
        let around = self.gap_before.saturating_add(self.may_go_on) / FRAMES_PER_REVERSAL;
        measures.hidden_reversals.saturating_add(around.max(self.doubtful_turns()))
    }

    /// Where its beginning was not seen, the first stroke may have turned back elsewhere: one turn more, or less. It may have been too near to where it
    /// was first seen to count.
    pub(super) fn doubtful_turns(&self) -> u32 {
        self.gap_before.min(1)
    }

    /// How many reversals were hidden within the IU, if the hand went on at the pace at which it was seen. None where too much was hidden to know.
    /// What happened before it or after it is not known.
    pub(super) fn assumed_reversals(&self) -> u32 {
        if self.measures.hidden > MAX_ASSUMED { 0 } else { self.measures.hidden_reversals_at_pace() }
    }

    /// The share of the IU's frames in which something may have happened unseen; more than 1 if most of it lies in a gap.
    pub(super) fn hidden(&self) -> f32 {
        let gaps = self.gap_before.saturating_add(self.gap_after).saturating_add(self.may_go_on);
        self.measures.hidden + gaps as f32 / self.frames.max(1) as f32
    }

    /// Whether so much of the IU was measured that it can be right: half of it. With a quarter 46 of 3,700 drawn streams differ, and 389 with all of it.
    pub(super) fn is_known(&self) -> bool {
        2 * self.measured.saturating_sub(self.waited) >= self.worked_frames()
    }

    /// Whether what was not seen may explain this reason. A part of an IU may be too short, or another motion. Frames that were hidden in the middle
    /// were counted as if they were right. But two IUs in the same context may seem to be one if the one between them was hidden.
    pub(super) fn explains(&self, reason: Reason, is_unique: bool) -> bool {
        match reason {
            Reason::None => false,
            Reason::TooShort => self.may_be_part,
            _ => self.may_be_part || self.is_doubtful && !is_unique,
        }
    }
}
