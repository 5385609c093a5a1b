//! The order of the job: what an activity breaks, and what it may break unseen.
//!
//! In an ordered job a wrong activity takes the place of the one that must come next. One fault is reported once: what follows in order is
//! not accused as well.

use super::{Progress, of_both, wrong};
use crate::input::Side;
use crate::job::Law;
use crate::set::ActivitySet;
use crate::verdict::{BrokenOrder, Note, OrderFault, Reason};

impl Progress<'_> {
    /// The activity that must come next, if that is only one.
    pub(super) fn next_in_order(&self) -> Option<usize> {
        let underway = of_both(self.state.underway);
        let left = self.state.required.without(self.tried() | underway);
        let is_next = |activity: &usize| !self.job.law(*activity).after().intersects(left);
        let mut next = left.iter().filter(is_next);
        next.next().filter(|_| self.has_order() && next.next().is_none())
    }

    /// Why this hand may not do a nominal activity now. It was done already, or must come behind one that has not come, even unseen.
    pub(crate) fn order_fault(&self, side: Side, nominal: usize) -> Option<BrokenOrder> {
        let activity = usize::from(self.number(nominal)?);
        let law = self.job.law(activity);
        let broken = |fault, other| self.broken(fault, activity, other);
        let is_of_this_job = law.is_once && !self.may_be_next_job(side);
        if is_of_this_job && self.state.done.contains(activity) {
            return Some(broken(OrderFault::Again, activity));
        }
        let came = self.begun(side.other()).without(self.begun_after(side, &law));
        let not_begun = (law.after() & self.state.required).without(came | self.possibly()).lowest();
        let underway = self.underway_before(side);
        let not_ended = (law.after_end & underway).lowest();
        let others = (self.tried() | underway).without(ActivitySet::of(activity));
        // If what must come behind it came before it, it is too late or comes again. Where it is required and had certainly not come, the other one
        // was accused.
        let came_before = if is_of_this_job {
            self.tried().without(self.state.wrong) & self.state.begins[side.index()].begun
        } else if law.is_required || self.possibly().contains(activity) {
            ActivitySet::EMPTY
        } else {
            others
        };
        let too_late = came_before.iter().find(|other| self.job.law(*other).after().contains(activity));
        not_begun
            .map(|other| broken(OrderFault::NotBegun, other))
            .or_else(|| not_ended.map(|other| broken(OrderFault::NotEnded, other)))
            .or_else(|| too_late.map(|other| broken(OrderFault::TooLate, other)))
    }

    /// An activity of this hand, with this number, has done the work of a nominal one with another part. If that must come now and has not come, the
    /// part is wrong; the job may have begun with it.
    pub(crate) fn set_done_instead(&mut self, side: Side, number: u16, nominal: usize) {
        let activities = self.activities_of([nominal]);
        self.state.first_steps[side.index()].get_or_insert(number);
        self.begin_seen_with(number, activities);
        let came = self.tried() | of_both(self.state.underway);
        let is_next = |activity: &usize| {
            let must_come = self.state.required.contains(*activity) && !came.contains(*activity);
            must_come && self.job.law(*activity).after().without(self.tried()).is_empty()
        };
        if activities.without(self.possibly()).iter().any(|activity| is_next(&activity)) {
            self.set_wrong(Some(nominal), wrong(Reason::WrongObject));
        }
    }

    /// The work of a nominal activity may have been done with another part. Nothing tells that from a part that is held or put aside.
    pub(crate) fn note_instead(&mut self, nominal: usize) {
        self.state.instead |= self.activities_of([nominal]);
    }

    /// An activity has come too early because this one has not come. If its work may have been done with another part, that part is wrong and not the
    /// order. Returns whether it is.
    pub(crate) fn blame_part(&mut self, broken: &BrokenOrder) -> bool {
        let other = usize::from(broken.activity);
        let is_instead = broken.fault == OrderFault::NotBegun
            && self.state.instead.contains(other)
            && !self.state.wrong.contains(other);
        let mut all = self.job.activities.iter();
        let nominal = all.position(|nominal| nominal.activity == broken.activity).filter(|_| is_instead);
        if nominal.is_some() {
            self.set_wrong(nominal, wrong(Reason::WrongObject));
        }
        nominal.is_some()
    }

    /// Whether the bench has shown in this job that what must come before had not been done.
    pub(crate) fn is_undone(&self, broken: &BrokenOrder) -> bool {
        broken.fault == OrderFault::NotBegun && self.undone_first.contains(broken.activity.into())
    }

    /// Whether a nominal activity of this hand that is in order may belong to another job than the open one. It comes again although it must not. Or
    /// one that must come behind it was right, because this one may have come unseen. If it was not the other job's, the order was wrong.
    pub(crate) fn may_be_of_another_job(&self, side: Side, nominal: usize) -> bool {
        self.number(nominal).map(usize::from).is_some_and(|activity| {
            let comes_again = self.job.law(activity).is_once && self.state.done.contains(activity);
            let mut right = self.state.done.without(self.state.wrong).iter();
            let is_new = !self.tried().contains(activity);
            // A law that asks only for the beginning is kept by what began after it.
            let came_too_early = |other: usize| {
                let law = self.job.law(other);
                law.after_end.contains(activity)
                    || law.after_begin.contains(activity)
                        && self.state.begins[side.index()].may_have_begun.contains(other)
            };
            comes_again || is_new && right.any(came_too_early)
        })
    }

    /// What the other hand was seen to begin after this one had begun its activity. What has to have begun may have done so as much earlier as it takes
    /// to believe a change.
    fn begun_after(&self, side: Side, law: &Law) -> ActivitySet {
        let other = side.other().index();
        let [ns, other_ns] = [self.state.begins[side.index()].ns, self.state.begins[other].seen_ns];
        let begun_later =
            self.state.underway[other].without(self.tried() | self.state.begins[side.index()].may_have_begun);
        let delay_ns = self.known_ns.saturating_sub(self.now_ns);
        begun_later.when(other_ns > ns.saturating_add(delay_ns))
            | (begun_later & law.after_end).when(other_ns > ns)
    }

    /// What the other hand was in the middle of when this one began, and still is, if that is certain.
    fn underway_before(&self, side: Side) -> ActivitySet {
        let hand = side.other().index();
        let underway = self.underway_when_begun(side);
        if underway.iter().count() == 1 && !self.state.is_hidden[hand] {
            let may_have_ended =
                self.state.may_have_ended[hand] | self.state.begins[side.index()].may_have_ended;
            underway.without(self.tried() | self.state.waiting[hand] | may_have_ended)
        } else {
            ActivitySet::EMPTY
        }
    }

    /// What the other hand is doing, if it has begun no later than this one.
    fn underway_when_begun(&self, side: Side) -> ActivitySet {
        let other = side.other().index();
        let is_before = self.state.begins[other].ns <= self.state.begins[side.index()].ns;
        if is_before { self.state.underway[other] } else { ActivitySet::EMPTY }
    }

    fn broken(&self, fault: OrderFault, activity: usize, other: usize) -> BrokenOrder {
        let runs = self.job.law(activity).runs.min(self.job.law(other).runs);
        BrokenOrder { fault, activity: other as u16, runs }
    }

    /// Whether all that is left may have come unseen, so that what comes again, or late, belongs to the next job. It is assumed that a job began with the
    /// first activity that was seen, if one may. Both hands are assumed to be at the same piece. So 17 of 19 faults of real people are found, and else 15.
    fn may_be_next_job(&self, side: Side) -> bool {
        let left = self.state.required.without(self.state.begins[side.index()].came);
        let possibly = if self.state.is_start_seen { self.unseen } else { self.possibly() };
        let possibly =
            possibly.without(self.underway_when_begun(side) & self.once()) | self.may_have_come(side);
        !left.is_empty() && left.without(possibly).is_empty()
    }

    /// What was done and not judged, and what the other hand may have come to the end of.
    fn may_have_come(&self, side: Side) -> ActivitySet {
        self.state.unjudged | self.state.may_have_ended[side.other().index()]
    }

    /// Whether a nominal activity of this hand that has just come may come again, as a repeatable step or in the next job.
    pub(crate) fn may_come_again(&self, side: Side, nominal: usize) -> bool {
        let Some(activity) = self.number(nominal).map(usize::from) else { return false };
        let came = self.state.done | self.state.wrong | ActivitySet::of(activity);
        let possibly = self.possibly() | self.may_have_come(side);
        !self.job.law(activity).is_once || self.state.required.without(came | possibly).is_empty()
    }

    /// What was not shown before in that a nominal activity comes now.
    pub(crate) fn order_note(&self, side: Side, nominal: usize) -> Option<Note> {
        let activity = usize::from(self.number(nominal)?);
        let came = self.begun(side.other());
        let usual = self.job.law(activity).usually_after & self.state.required;
        let is_early = !usual.without(came | self.possibly()).is_empty();
        let is_repeated = self.state.done.contains(activity) && !self.may_be_next_job(side);
        if is_repeated { Some(Note::Again) } else { is_early.then_some(Note::Order) }
    }
}
