//! What is decided on an activity of one hand rather than on an IU: its order, that it is right, its end and part.

use super::comparison::Memory;
use super::hand::{Finding, HandJudge};
use super::progress::{Progress, quickest};
use crate::segment::{Iu, Segmenter};
use crate::set::ActivitySet;
use crate::verdict::{Outcome, Reason};

impl<'a, M: Memory<'a>> HandJudge<'a, M> {
    /// Concludes that the activity is out of order, as soon as every candidate is. All events of one frame for both hands are known then.
    pub(super) fn check_order(&mut self, progress: &mut Progress<'a>) {
        let (cannot_accuse, may_give_up) = (self.cannot_accuse(), self.may_give_up());
        let Some(activity) = &mut self.activity else { return };
        let candidates = activity.candidates();
        let is_order_certain = activity.is_order_certain();
        let is_certain = is_order_certain || self.iu.is_some_and(|iu| iu.is_certain);
        // A hand that was not shown to do it may only rest there. What may be no step has its place in the order all the same.
        let has_no_place = cannot_accuse && !activity.may_be_passive || candidates.is_empty();
        if activity.is_concluded || has_no_place || !is_certain || may_give_up {
            return;
        }
        // While the bench shows that an earlier activity has not been done, it is too early for any place in this one.
        let side = self.side;
        let fault_of_all = |progress: &Progress<'a>| {
            let mut faults = candidates.iter().map(|nominal| {
                let fault = progress.order_fault(side, nominal);
                fault.filter(|broken| is_order_certain || progress.is_undone(broken))
            });
            faults.try_fold(None, |first, fault| Some(first.or(Some(fault?)))).flatten()
        };
        let mut broken = fault_of_all(progress);
        // What is not judged blames nothing.
        while activity.never_seen.is_none() && broken.is_some_and(|broken| progress.blame_part(&broken)) {
            broken = fault_of_all(progress);
        }
        if broken.is_some() {
            activity.broken = broken;
            let finding = Finding::of(Outcome::Anomaly, Reason::WrongOrder, candidates.lowest());
            self.conclude_activity(finding, true, progress);
            return;
        }
        if !is_order_certain {
            return;
        }
        let mut notes = candidates.iter().map(|nominal| progress.order_note(self.side, nominal));
        let note = notes.try_fold(None, |first, note| Some(first.or(Some(note?)))).flatten();
        activity.order_note = activity.order_note.or(note);
    }

    /// Decides on the activity after all events of one frame for both hands: that it is right, if no candidate can go on.
    pub(super) fn settle(&mut self, segmenter: &mut Segmenter, progress: &mut Progress<'a>) {
        progress.set_waiting(self.side, None);
        if self.interrupted.is_some() {
            segmenter.interrupt();
        }
        let job = progress.job;
        let may_have_let_go = self.iu.is_none() || self.doubt.is_doubtful() || self.doubt.hidden_frames() > 0;
        let activity = self.activity.as_ref().filter(|activity| may_have_let_go || activity.may_have_ended());
        let may_have_ended = activity.map_or(ActivitySet::EMPTY, |activity| activity.may_have_come());
        progress.set_may_have_ended(self.side, may_have_ended);
        if !self.is_resting() {
            return;
        }
        let Some(activity) = &self.activity else {
            // What it goes on with began in the job before, and may be a part of this one.
            if let Some(object) = self.doubt.unjudged_in_hand() {
                progress.set_carried_on(object, self.newest_unjudged);
            }
            return;
        };
        if activity.is_given_up() {
            segmenter.activity_matched(&[]);
            return;
        }
        if activity.is_followed_to_its_end() {
            // If it is done again at once, that is another activity, unless a longer one may go on so.
            let mut continuations = activity.continuations();
            // The job has its verdict, so a touch begins another activity, which may be the remainder of this one.
            if progress.is_concluded() {
                self.doubt.may_be_remainder |= !continuations.is_empty();
                continuations.clear();
            }
            segmenter.activity_matched(&continuations);
            if activity.is_out_of_sequence() {
                let cause = activity.unjudged.unwrap_or_else(|| self.unseen_cause(progress));
                let nearest = activity.nearest;
                self.conclude_activity(Finding::of(Outcome::NotJudged, cause, nearest), false, progress);
                return;
            }
        }
        let Some(nominal) = activity.matched(progress) else {
            // What the hand does after it has been idle is another activity, unless it is idle in the middle of this one.
            if self.doubt.was_idle() && activity.has_ended_if_idle() || activity.must_have_ended() {
                segmenter.activity_matched(&[]);
            }
            return;
        };
        if job.allows_insertions(nominal) {
            // Whatever the hand goes on to do with the same object belongs to it.
            progress.set_waiting(self.side, Some(nominal).filter(|_| !activity.is_concluded));
            return;
        }
        let continuations = activity.continuations();
        segmenter.activity_matched(&continuations);
        if continuations.is_empty() {
            self.conclude_matched(nominal, true, progress);
        } else if !activity.is_concluded {
            progress.set_waiting(self.side, Some(nominal));
        }
    }

    /// The activity has ended.
    pub(super) fn end_activity(&mut self, progress: &mut Progress<'a>) {
        self.end_interrupted(progress);
        self.end_held(progress);
        let Some(activity) = &self.activity else { return };
        let nearest = activity.nearest.or(activity.candidates().lowest());
        let may_go_on = progress.is_end_assumed()
            || self.doubt.may_hold_another()
            || !activity.may_have_come().is_empty()
            || activity.is_out_of_sequence();
        let cause = activity.unjudged.unwrap_or_else(|| self.unseen_cause(progress));
        match activity.matched(progress) {
            Some(nominal) => self.conclude_matched(nominal, false, progress),
            // What is missing may have happened unseen, and the activity may have been another one, or may still go on.
            None if may_go_on && !activity.is_concluded => {
                self.doubt.may_be_remainder = true;
                progress.set_doubtful();
                self.conclude_activity(Finding::of(Outcome::NotJudged, cause, nearest), false, progress);
            }
            None => {
                let finding = Finding::of(Outcome::Anomaly, Reason::NotCompleted, nearest);
                self.conclude_activity(finding, false, progress);
            }
        }
        self.activity = None;
        self.is_broken_off = false;
        progress.set_waiting(self.side, None);
        progress.set_underway(self.side, ActivitySet::EMPTY, Some(ActivitySet::EMPTY));
    }

    /// An IU has ended that was seen well. Where it does the work of a step that must come now, its part is wrong. Only strokes tell such work from a
    /// part that is held or put aside; without them it shows when the step is missed.
    pub(super) fn compare_but_for_part(&mut self, iu: &Iu, progress: &mut Progress<'a>) {
        let Some((open, activity)) = self.iu.zip(self.activity.as_mut()) else { return };
        let (job, number) = (progress.job, usize::from(open.number));
        activity.compare_but_for_part(number, iu.context);
        let shown = |nominal: usize| &job.activities[nominal].ius[number];
        let has_worked = |nominal: &usize| {
            let ius = job.activities[*nominal].ius;
            // The runs do not show how the other part would meet what the step's own one meets.
            let is_all = !iu.context.is_pair() && number == 0;
            let is_partner = ius.iter().any(|shown| shown.context.involves(iu.context.0[1]));
            let frames = if is_all { quickest(ius) } else { ius[number].quickest() };
            (iu.context.is_pair() || is_all && !is_partner) && iu.frames >= frames
        };
        for nominal in activity.like.iter().filter(has_worked) {
            progress.note_instead(nominal);
        }
        let has_stroked = |nominal: &usize| {
            let strokes = shown(*nominal).reversals.min;
            strokes > 0 && iu.measures.reversals >= strokes && iu.frames >= shown(*nominal).quickest()
        };
        if let Some(nominal) = activity.like.iter().find(has_stroked) {
            progress.set_done_instead(self.side, activity.number, nominal);
        }
    }
}
