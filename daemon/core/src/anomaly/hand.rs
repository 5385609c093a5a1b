//! Algorithm 1 for the activities of one hand.

use super::activity::{Against, OpenActivity, context_reason, members};
use super::conclude::Finding;
use super::progress::{Progress, Set};
use super::trial::{Extent, Memory, Trials};
use crate::capacity::ACTIVITIES;
use crate::couple::{Context, Couple, Motion};
use crate::input::Side;
use crate::job::Job;
use crate::segment::{Iu, Segmenter};
use crate::verdict::{Kind, Reason, Verdict};
use heapless::Vec;

/// An IU that goes on.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenIu {
    pub(super) number: u16,
    pub(super) context: Context,
    pub(super) began_ns: u64,
    extent: Extent,
    /// Its verdict has been given.
    pub(super) concluded: bool,
}

/// Judges the activities of one hand.
#[derive(Clone, Debug)]
pub(super) struct HandJudge<'a, M> {
    pub(super) side: Side,
    trials: Trials<'a, M>,
    pub(super) activity: Option<OpenActivity>,
    pub(super) iu: Option<OpenIu>,
}

impl<'a, M: Memory<'a>> HandJudge<'a, M> {
    pub(super) fn new(side: Side, job: &'a Job<'a>) -> Self {
        Self { side, trials: Trials::new(job, side), activity: None, iu: None }
    }

    pub(super) fn begin_activity(&mut self, context: Context, began_ns: u64, progress: &mut Progress<'a>) {
        self.activity = Some(OpenActivity::new(progress.next_activity(), context, began_ns, progress.job));
    }

    /// An IU begins with `couple`: what its context alone decides is decided at once.
    pub(super) fn begin_iu(
        &mut self,
        couple: &Couple,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let Some(activity) = &mut self.activity else { return };
        let (job, context) = (progress.job, couple.context);
        self.trials.clear();
        self.iu = Some(OpenIu {
            number: activity.next_iu(job, context),
            context,
            began_ns: couple.captured_ns,
            extent: Extent::default(),
            concluded: false,
        });
        match activity.against {
            Against::Candidates(_) => self.begin_with_candidates(couple, progress, emit),
            Against::Following(nominal) => self.begin_following(nominal, couple, progress, emit),
        }
        progress.set_underway(self.side, self.activity.as_ref().map_or(0, OpenActivity::candidates));
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
        if agreeing == 0 {
            let (nominal, comes_later) = activity.nearest_elsewhere(job, context);
            let reason = context_reason(job, activity.candidates(), context);
            activity.follow(nominal);
            // What lies between may have happened while nothing could be seen.
            let skipped_unseen = activity.unknown.is_some() && comes_later;
            self.conclude_context(couple.sighted && !skipped_unseen, reason, nominal, progress, emit);
            return;
        }
        activity.against = Against::Candidates(agreeing);
        if context.is_touch() {
            for nominal in members(agreeing) {
                self.trials.add(nominal, &job.activities[nominal].ius[activity.place]);
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
            Some((nominal, place)) if context.is_touch() => {
                self.trials.add(nominal, &job.activities[nominal].ius[place]);
            }
            // The release state is judged by its context, which is right.
            Some(_) => {}
            None => {
                let among = nominal.map_or(Set::MAX, |nominal| 1 << nominal);
                let reason = context_reason(job, among, context);
                self.conclude_context(couple.sighted, reason, nominal, progress, emit);
            }
        }
    }

    /// Gives the verdict on an IU whose context is wrong, or not `certain`.
    fn conclude_context(
        &mut self,
        certain: bool,
        reason: Reason,
        nominal: Option<usize>,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        if certain {
            self.conclude_iu(
                Finding { kind: Kind::IuAnomaly, reason, nominal, outcome: None, early: true },
                progress,
                emit,
            );
        } else {
            self.give_up(Reason::Blind, progress, emit);
        }
    }

    /// The next filtered motion of the IU.
    pub(super) fn frame(
        &mut self,
        motion: &Motion,
        reversals: u32,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let Some(iu) = self.iu.as_mut().filter(|iu| !iu.concluded) else { return };
        iu.extent.reversals = reversals;
        if self.trials.append(motion).is_err() {
            self.give_up(Reason::Overload, progress, emit);
        }
    }

    /// The IU goes on with `couple`: decides what can be decided before its end.
    pub(super) fn go_on(
        &mut self,
        couple: &Couple,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let Some(iu) = self.iu.as_mut().filter(|iu| !iu.concluded) else { return };
        iu.extent.frames = iu.extent.frames.saturating_add(1);
        let extent = iu.extent;
        if !couple.sighted {
            self.give_up(Reason::Blind, progress, emit);
        } else if iu.context.is_release() {
            // It has no motion of a hand and may last for ever: its context is all there is to it.
            let candidates = self.activity.as_ref().map_or(0, OpenActivity::candidates);
            self.pass(candidates, None, true, progress, emit);
        } else if self.trials.all_lost(extent) {
            self.decide(extent, progress, emit);
        }
    }

    /// The IU has ended.
    pub(super) fn end_iu(&mut self, iu: &Iu, progress: &mut Progress<'a>, emit: &mut impl FnMut(Verdict)) {
        if let Some(activity) = &mut self.activity
            && iu.context.is_touch()
        {
            activity.ended_ns = iu.ended_ns;
        }
        if self.iu.is_some_and(|open| !open.concluded) {
            self.decide(Extent { frames: iu.frames, reversals: iu.reversals, ended: true }, progress, emit);
        }
        self.iu = None;
    }

    /// Decides by motion and bounds.
    fn decide(&mut self, extent: Extent, progress: &mut Progress<'a>, emit: &mut impl FnMut(Verdict)) {
        let Some(nearest) = self.trials.nearest(extent) else {
            self.give_up(Reason::Unknown, progress, emit);
            return;
        };
        let early = !extent.ended;
        if nearest.reason == Reason::None {
            let right = self.trials.outcomes(extent).filter(|outcome| outcome.reason == Reason::None);
            let mut survivors = 0;
            for outcome in right {
                survivors |= 1 << outcome.nominal;
                if let Some(activity) = &mut self.activity {
                    activity.ratios[outcome.nominal] += outcome.ratio();
                }
            }
            self.pass(survivors, Some(nearest), early, progress, emit);
        } else {
            let nominal = Some(nearest.nominal);
            if let Some(activity) = &mut self.activity {
                activity.follow(nominal);
            }
            let finding = Finding {
                kind: Kind::IuAnomaly,
                reason: nearest.reason,
                nominal,
                outcome: Some(nearest),
                early,
            };
            self.conclude_iu(finding, progress, emit);
        }
    }

    /// Says that the activity comes at the wrong time as soon as that holds for every candidate.
    fn check_place(&mut self, progress: &mut Progress<'a>, emit: &mut impl FnMut(Verdict)) {
        let Some(OpenActivity { against: Against::Candidates(candidates), concluded: false, .. }) =
            self.activity
        else {
            return;
        };
        if members(candidates).all(|nominal| progress.is_out_of_place(self.side, nominal)) {
            let nominal = members(candidates).next();
            self.conclude_activity(Kind::ActivityAnomaly, Reason::WrongOrder, nominal, true, progress, emit);
        }
    }

    /// What is to be said after all that one frame brought both hands: that the activity comes at the wrong time, or that it is right,
    /// if nothing can follow any more.
    pub(super) fn settle(
        &mut self,
        segmenter: &mut Segmenter,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        progress.set_waiting(self.side, None);
        self.check_place(progress, emit);
        if !self.is_resting() {
            return;
        }
        let Some(activity) = &self.activity else { return };
        let job = progress.job;
        if activity.is_followed_to_its_end(job) {
            // It has had its verdict; done again at once, it is another activity.
            segmenter.activity_matched(&[]);
        }
        let Some(nominal) = activity.matched(self.side, progress) else { return };
        let goes_on: Vec<Context, ACTIVITIES> = members(activity.candidates())
            .filter_map(|nominal| job.activities[nominal].ius.get(activity.place))
            .map(|iu| iu.context)
            .collect();
        segmenter.activity_matched(&goes_on);
        if goes_on.is_empty() {
            self.conclude_matched(nominal, true, progress, emit);
        } else if !activity.concluded {
            progress.set_waiting(self.side, Some(nominal));
        }
    }

    /// The activity has ended.
    pub(super) fn end_activity(&mut self, progress: &mut Progress<'a>, emit: &mut impl FnMut(Verdict)) {
        let Some(activity) = &self.activity else { return };
        let (nearest, unknown) = (activity.nearest, activity.unknown);
        match activity.matched(self.side, progress) {
            Some(nominal) => self.conclude_matched(nominal, false, progress, emit),
            // What is missing may have happened while nothing could be seen.
            None => match unknown {
                Some(reason) => {
                    self.conclude_activity(Kind::NotJudged, reason, nearest, false, progress, emit);
                }
                None => {
                    let (kind, reason) = (Kind::ActivityAnomaly, Reason::NotCompleted);
                    self.conclude_activity(kind, reason, nearest, false, progress, emit);
                }
            },
        }
        self.activity = None;
        progress.set_waiting(self.side, None);
        progress.set_underway(self.side, 0);
    }

    /// No IU goes on in which the hand acts.
    pub(super) fn is_resting(&self) -> bool {
        self.iu.is_none_or(|iu| iu.concluded && iu.context.is_release())
    }

    /// Nothing is left to be said of what goes on.
    pub(super) fn is_concluded(&self) -> bool {
        self.is_resting() && self.activity.as_ref().is_none_or(|activity| activity.concluded)
    }
}
