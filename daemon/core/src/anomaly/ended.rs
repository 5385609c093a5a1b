//! IUs that have ended, or seem to have, and wait for their verdict.
//!
//! A hand corrects its grip if it lets go in the middle of an activity and takes the same part again, in that context. The IU goes on, and has its
//! verdict only when something else begins, unless it is certainly wrong before. Where the job has the same IU twice, it counts twice.
//!
//! An IU may seem to end where something was not seen. Where it would be wrong if it has, its verdict waits until it is certain that it has. Until then
//! what comes is not decided either.

use super::activity::{Against, Step};
use super::comparison::{ComparisonResult, Memory};
use super::hand::{Finding, HandJudge, OpenIu};
use super::observation::IuObservation;
use super::progress::Progress;
use crate::couple::{Context, Couple, Unseen};
use crate::segment::Iu;
use crate::verdict::{Outcome, Reason};

/// An IU of which the hand has let go in the middle of its activity.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interrupted {
    pub(super) open: OpenIu,
    /// What is known of it if it is over.
    pub(super) observation: IuObservation,
    pub(super) iu: Iu,
}

/// An IU that is wrong if it has ended, and why.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    open: OpenIu,
    wrong: ComparisonResult,
    /// If it ends up to as many frames later than it seemed to, it is wrong all the same.
    remaining: u32,
}

impl<'a, M: Memory<'a>> HandJudge<'a, M> {
    /// Whether the hand, which lets go, is certainly not at the end of its activity, and no IU in the same context comes next.
    pub(super) fn may_be_interrupted(&self, progress: &Progress<'a>) -> bool {
        let Some((open, activity)) = self.iu.zip(self.activity.as_ref()) else { return false };
        let is_of_step = matches!(activity.step, Step::Shown(_)) && activity.against == Against::Candidates;
        let is_at_end = !activity.may_have_come().is_empty() || activity.matched(progress).is_some();
        is_of_step
            && open.is_certain
            && open.context.is_touch()
            && !activity.is_concluded
            && !is_at_end
            && !activity.goes_on_with(open.context)
    }

    /// Something else begins than the IU of which the hand has let go, so that one is over.
    pub(super) fn end_interrupted(&mut self, progress: &mut Progress<'a>) {
        let Some(Interrupted { open, observation, iu }) = self.interrupted.take() else { return };
        self.iu = Some(open);
        self.decide_at_end(observation, Some(Context::IDLE), progress);
        self.close_iu(&iu, progress);
    }

    /// The IU has ended in doubt. Holds it back if it is wrong unless it goes on. Returns whether it does.
    pub(super) fn hold_back(&mut self, observation: IuObservation, progress: &Progress<'a>) -> bool {
        let Some(open) = self.iu.filter(|iu| iu.is_certain && !iu.observation.may_be_part) else {
            return false;
        };
        let is_place_certain = self.activity.as_ref().is_some_and(|activity| activity.is_place_certain());
        if self.is_broken_off || !is_place_certain || !open.observation.is_captured(progress.job.min_captured)
        {
            return false;
        }
        let if_ended_after = |frames| {
            let observation = IuObservation { may_be_part: false, may_go_on: frames, ..observation };
            self.comparisons
                .nearest(observation)
                .filter(|nearest| nearest.is_certainly_wrong() && nearest.reason != Reason::TooLong)
        };
        let results =
            (0..=self.doubt.end_frames()).map_while(|frames| Some((if_ended_after(frames)?, frames)));
        self.held = results.last().map(|(wrong, remaining)| {
            let open = OpenIu { measured: wrong.measured, ..open };
            Held { open, wrong, remaining }
        });
        self.held.is_some()
    }

    /// Takes the next couple. It decides on what was held back, or shows that it may have gone on for too long.
    pub(super) fn watch_held(&mut self, couple: &Couple, progress: &mut Progress<'a>) {
        let Some(held) = &mut self.held else { return };
        if !self.doubt.is_doubtful() {
            self.end_held(progress);
        } else if couple.lacks(Unseen::CHANGE) {
            match held.remaining.checked_sub(1) {
                Some(remaining) => held.remaining = remaining,
                None => self.end_held(progress),
            }
        }
    }

    /// Gives the verdict on what was held back: that it is wrong only if it has certainly ended.
    pub(super) fn end_held(&mut self, progress: &mut Progress<'a>) {
        let Some(Held { open, wrong, .. }) = self.held.take() else { return };
        let next = self.iu.replace(open);
        if self.doubt.is_doubtful() {
            self.conclude_unseen(progress);
        } else {
            self.conclude_wrong(wrong, progress);
        }
        self.iu = next;
    }

    /// The motion of the open IU is wrong.
    pub(super) fn conclude_wrong(&mut self, result: ComparisonResult, progress: &mut Progress<'a>) {
        let nominal = Some(result.nominal);
        if let Some(activity) = &mut self.activity {
            activity.follow(nominal, result.index + 1);
        }
        let wrong = Finding::of(Outcome::Anomaly, result.reason, nominal);
        self.conclude_iu(Finding { result: Some(result), ..wrong }, progress);
    }
}
