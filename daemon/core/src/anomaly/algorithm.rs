//! Algorithm 1 of the paper (III-D) for the activities of one hand.

use super::activity::{Against, OpenActivity, context_reason};
use super::comparison::{Extent, Memory};
use super::hand::{Finding, HandJudge, OpenIu};
use super::progress::Progress;
use super::set::ActivitySet;
use crate::capacity::ACTIVITIES;
use crate::couple::{Context, Couple, Motion};
use crate::segment::{Iu, Segmenter};
use crate::verdict::{Outcome, Reason, Verdict};
use heapless::Vec;

impl<'a, M: Memory<'a>> HandJudge<'a, M> {
    pub(super) fn begin_activity(&mut self, context: Context, began_ns: u64, progress: &mut Progress<'a>) {
        self.activity = Some(OpenActivity::new(progress.next_activity(), context, began_ns, progress.job));
    }

    /// An IU begins with `couple`. Everything that its context alone decides is decided at once.
    pub(super) fn begin_iu(
        &mut self,
        couple: &Couple,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let Some(activity) = &mut self.activity else { return };
        let (job, context) = (progress.job, couple.context);
        self.comparisons.clear();
        self.iu = Some(OpenIu {
            number: activity.next_iu(job, context),
            context,
            began_ns: couple.captured_ns,
            extent: Extent::default(),
            is_concluded: false,
        });
        match activity.against {
            Against::Candidates(_) => self.begin_with_candidates(couple, progress, emit),
            Against::Following(nominal) => self.begin_following(nominal, couple, progress, emit),
        }
        progress.set_underway(
            self.side,
            self.activity.as_ref().map_or(ActivitySet::EMPTY, OpenActivity::candidates),
        );
    }

    fn begin_with_candidates(
        &mut self,
        couple: &Couple,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let Some(activity) = &mut self.activity else { return };
        let (job, context) = (progress.job, couple.context);
        let agreeing = activity.agreeing(job, context);
        if agreeing.is_empty() {
            let (nominal, comes_later) = activity.nearest_elsewhere(job, context);
            let reason = context_reason(job, activity.candidates(), context);
            activity.follow(nominal);
            // The IUs in between may have happened while the hand or an object was out of sight.
            let may_have_been_unseen = activity.unjudged_reason.is_some() && comes_later;
            self.conclude_context(couple.sighted && !may_have_been_unseen, reason, nominal, progress, emit);
            return;
        }
        activity.against = Against::Candidates(agreeing);
        if context.is_touch() {
            for nominal in agreeing.iter() {
                self.comparisons.add(nominal, &job.activities[nominal].ius[activity.index]);
            }
        }
    }

    fn begin_following(
        &mut self,
        nominal: Option<usize>,
        couple: &Couple,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let Some(activity) = &mut self.activity else { return };
        let (job, context) = (progress.job, couple.context);
        let nominal = activity.nearest_by_context(job, nominal);
        activity.follow(nominal);
        match nominal.and_then(|nominal| Some((nominal, activity.aligned[nominal]?))) {
            Some((nominal, index)) if context.is_touch() => {
                self.comparisons.add(nominal, &job.activities[nominal].ius[index]);
            }
            // A release state is judged by its context alone, which is right.
            Some(_) => {}
            None => {
                let among = nominal.map_or(ActivitySet::first(ACTIVITIES), ActivitySet::of);
                let reason = context_reason(job, among, context);
                self.conclude_context(couple.sighted, reason, nominal, progress, emit);
            }
        }
    }

    /// Gives the verdict on an IU whose context is wrong, if that is certain.
    fn conclude_context(
        &mut self,
        is_certain: bool,
        reason: Reason,
        nominal: Option<usize>,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        if is_certain {
            self.conclude_iu(
                Finding { outcome: Outcome::Anomaly, reason, nominal, result: None, early: true },
                progress,
                emit,
            );
        } else {
            self.conclude_unjudged(Reason::Blind, progress, emit);
        }
    }

    /// Takes the next filtered motion of the open IU.
    pub(super) fn push_motion(
        &mut self,
        motion: &Motion,
        reversals: u32,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let Some(iu) = self.iu.as_mut().filter(|iu| !iu.is_concluded) else { return };
        iu.extent.reversals = reversals;
        if self.comparisons.append(motion).is_err() {
            self.conclude_unjudged(Reason::Overload, progress, emit);
        }
    }

    /// The open IU continues with `couple`. Decides what can be decided before its end.
    pub(super) fn continue_iu(
        &mut self,
        couple: &Couple,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let Some(iu) = self.iu.as_mut().filter(|iu| !iu.is_concluded) else { return };
        iu.extent.frames = iu.extent.frames.saturating_add(1);
        let extent = iu.extent;
        if !couple.sighted {
            self.conclude_unjudged(Reason::Blind, progress, emit);
        } else if iu.context.is_release() {
            // It has no motion of a hand and may last for any time, so its context decides.
            let candidates = self.activity.as_ref().map_or(ActivitySet::EMPTY, OpenActivity::candidates);
            self.conclude_right(candidates, None, true, progress, emit);
        } else if self.comparisons.all_lost(extent) {
            self.decide_by_motion(extent, progress, emit);
        }
    }

    /// The IU has ended.
    pub(super) fn end_iu(&mut self, iu: &Iu, progress: &mut Progress<'a>, emit: &mut impl FnMut(Verdict)) {
        if let Some(activity) = &mut self.activity
            && iu.context.is_touch()
        {
            activity.ended_ns = iu.ended_ns;
        }
        if self.iu.is_some_and(|open| !open.is_concluded) {
            self.decide_by_motion(
                Extent { frames: iu.frames, reversals: iu.reversals, ended: true },
                progress,
                emit,
            );
        }
        self.iu = None;
    }

    /// Gives the verdict on the IU by its motion and bounds.
    fn decide_by_motion(
        &mut self,
        extent: Extent,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let Some(nearest) = self.comparisons.nearest(extent) else {
            self.conclude_unjudged(Reason::Unknown, progress, emit);
            return;
        };
        let early = !extent.ended;
        if nearest.reason == Reason::None {
            let right = self.comparisons.results(extent).filter(|result| result.reason == Reason::None);
            let mut survivors = ActivitySet::EMPTY;
            for result in right {
                survivors |= ActivitySet::of(result.nominal);
                if let Some(activity) = &mut self.activity {
                    activity.ratios[result.nominal] += result.ratio();
                }
            }
            self.conclude_right(survivors, Some(nearest), early, progress, emit);
        } else {
            let nominal = Some(nearest.nominal);
            if let Some(activity) = &mut self.activity {
                activity.follow(nominal);
            }
            let finding = Finding {
                outcome: Outcome::Anomaly,
                reason: nearest.reason,
                nominal,
                result: Some(nearest),
                early,
            };
            self.conclude_iu(finding, progress, emit);
        }
    }

    /// Concludes that the activity is out of order, as soon as every candidate is.
    fn check_order(&mut self, progress: &mut Progress<'a>, emit: &mut impl FnMut(Verdict)) {
        let Some(OpenActivity { against: Against::Candidates(candidates), is_concluded: false, .. }) =
            self.activity
        else {
            return;
        };
        if candidates.iter().all(|nominal| progress.is_out_of_order(self.side, nominal)) {
            let nominal = candidates.lowest();
            self.conclude_activity(Outcome::Anomaly, Reason::WrongOrder, nominal, true, progress, emit);
        }
    }

    /// Decides on the activity after all events of one frame for both hands: that it is out of order, or, if no candidate can go
    /// on, that it is right.
    pub(super) fn settle(
        &mut self,
        segmenter: &mut Segmenter,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        progress.set_waiting(self.side, None);
        self.check_order(progress, emit);
        if !self.is_resting() {
            return;
        }
        let Some(activity) = &self.activity else { return };
        let job = progress.job;
        if activity.is_followed_to_its_end(job) {
            // It has its verdict. If it is done again at once, that is another activity.
            segmenter.activity_matched(&[]);
        }
        let Some(nominal) = activity.matched(self.side, progress) else { return };
        let continuations: Vec<Context, ACTIVITIES> = activity
            .candidates()
            .iter()
            .filter_map(|nominal| job.activities[nominal].ius.get(activity.index))
            .map(|iu| iu.context)
            .collect();
        segmenter.activity_matched(&continuations);
        if continuations.is_empty() {
            self.conclude_matched(nominal, true, progress, emit);
        } else if !activity.is_concluded {
            progress.set_waiting(self.side, Some(nominal));
        }
    }

    /// The activity has ended.
    pub(super) fn end_activity(&mut self, progress: &mut Progress<'a>, emit: &mut impl FnMut(Verdict)) {
        let Some(activity) = &self.activity else { return };
        let (nearest, unjudged_reason) = (activity.nearest, activity.unjudged_reason);
        match activity.matched(self.side, progress) {
            Some(nominal) => self.conclude_matched(nominal, false, progress, emit),
            // The missing IUs may have happened while the hand or an object was out of sight.
            None => match unjudged_reason {
                Some(reason) => {
                    self.conclude_activity(Outcome::NotJudged, reason, nearest, false, progress, emit);
                }
                None => {
                    let (outcome, reason) = (Outcome::Anomaly, Reason::NotCompleted);
                    self.conclude_activity(outcome, reason, nearest, false, progress, emit);
                }
            },
        }
        self.activity = None;
        progress.set_waiting(self.side, None);
        progress.set_underway(self.side, ActivitySet::EMPTY);
    }
}
