//! Where one job ends and the next one begins.
//!
//! A job that breaks off, as where `enable` is switched off, accuses nobody of what is missing: the piece may be completed.
//! In a job without any order a repeated activity begins the next job. If it were a fault, the next correct piece would be accused after one that was
//! not completed.

use super::{Phase, Progress};
use crate::couple::{Context, Couple};
use crate::input::Side;
use crate::set::ActivitySet;

impl Progress<'_> {
    /// Whether an activity that begins with this couple belongs to the next job. It has been done already, and none that is left begins like it.
    /// Where the job has an order, only one of its first activities begins a job. Others have come before, or the bench was rearranged; else it is done
    /// twice. A bench that is set as it was at first is that of the next piece. A job whose start was not seen ends wherever a first activity begins
    /// that may have come before. One with a fault also ends where the bench is rearranged. Where something was done instead, its end has no other sign.
    /// Takes note of an end that is only assumed, as where the hand may only go on with what it did before a doubt.
    pub(crate) fn begins_next_job(&mut self, couple: &Couple, is_disturbed: bool, may_go_on: bool) -> bool {
        let Couple { side, context, .. } = *couple;
        if self.is_concluded() || self.state.activities == 0 || self.is_unfinished_by_others(side) {
            return false;
        }
        if is_disturbed && self.state.fault.is_some() {
            return true;
        }
        if self.is_reset() {
            self.state.phase = if may_go_on { Phase::EndAssumed } else { Phase::Open };
            return true;
        }
        let (opening, came, first) =
            (self.opening(context), self.state.done | self.state.unjudged, self.first());
        let is_left = !opening.without(self.tried()).is_empty();
        let (begins, may_begin) = if self.has_order() {
            let others_came = !(self.tried() | self.state.underway[side.index()]).without(first).is_empty();
            let first = opening & first;
            let first_came = first.intersects(self.tried()) && (others_came || is_disturbed);
            let may_have_come = !self.state.is_start_seen && !first.intersects(self.undone());
            (first_came && !is_left, !first.is_empty() && may_have_come)
        } else {
            // What the job can do without may come more than once.
            ((opening & self.state.required).intersects(came) && !is_left, false)
        };
        // What was not judged may only go on now.
        let is_certain = begins && !may_go_on && !opening.intersects(self.state.unjudged);
        let is_assumed = (begins || may_begin) && !is_certain;
        self.state.phase = if is_assumed { Phase::EndAssumed } else { Phase::Open };
        begins || may_begin
    }

    /// The job ends with a pause, so that its end is only assumed.
    pub(crate) fn assume_end(&mut self) {
        if !self.is_concluded() {
            self.state.phase = Phase::EndAssumed;
        }
    }

    /// Whether the end of the job is only assumed.
    pub(crate) fn is_end_assumed(&self) -> bool {
        self.state.phase == Phase::EndAssumed
    }

    /// Whether a touch belongs to the job after all that it requires has come: it is optional and may still come, or no step.
    pub(crate) fn goes_on_with(&self, context: Context, is_disturbed: bool) -> bool {
        let opening =
            Side::ALL.iter().fold(ActivitySet::EMPTY, |all, side| all | self.opening(context.by_hand(*side)));
        let is_none = opening.is_empty() && self.has_parts_of(context);
        // Without an order, what the job can do without may come more than once.
        let is_optional =
            !self.has_order() && !opening.is_empty() && !opening.intersects(self.state.required);
        !is_disturbed && (is_none || is_optional || self.opening(context).intersects(self.may_follow()))
    }

    /// The optional activities that may still come.
    pub(super) fn may_follow(&self) -> ActivitySet {
        let came = self
            .tried()
            .iter()
            .fold(ActivitySet::EMPTY, |all, activity| all | self.job.law(activity).after());
        self.all.without(self.state.required | self.tried() | came)
    }

    /// Whether the other hand is in the middle of an activity that may still come out right.
    fn is_unfinished_by_others(&self, side: Side) -> bool {
        let hand = side.other().index();
        let underway = self.state.underway[hand];
        !underway.is_empty() && self.state.waiting[hand].is_empty() && !underway.intersects(self.tried())
    }
}
