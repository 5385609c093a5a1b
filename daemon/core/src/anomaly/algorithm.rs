//! Algorithm 1 of the paper (III-D) for the IUs of one hand.

use super::activity::{Against, OpenActivity, Remainder, Step, context_reason};
use super::comparison::Memory;
use super::ended::Interrupted;
use super::hand::{Finding, HandJudge, OpenIu};
use super::observation::IuObservation;
use super::occlusion::{Cause, OcclusionLog, too_few_frames};
use super::progress::Progress;
use crate::capacity::ACTIVITIES;
use crate::couple::{Context, Couple, Motion, Unseen};
use crate::segment::{HandEvent, Iu, Measures, WORLDS};
use crate::set::ActivitySet;
use crate::verdict::{Outcome, Reason};

impl<'a, M: Memory<'a>> HandJudge<'a, M> {
    /// Takes an event of the segmentation of this hand, which comes from `couple` or from a command.
    pub(super) fn take(&mut self, event: HandEvent, couple: Option<&Couple>, progress: &mut Progress<'a>) {
        match (event, couple) {
            (HandEvent::ActivityBegan { context, began_ns }, _) => {
                self.begin_activity(context, began_ns, progress);
            }
            (HandEvent::IuBegan { .. }, Some(couple)) => self.begin_iu(couple, progress),
            (HandEvent::IuResumed, _) => {
                let resumed = |it: Interrupted| OpenIu { ended_ns: None, ..it.open };
                self.iu = self.interrupted.take().map(resumed);
            }
            (HandEvent::IuFrame { motion, .. }, _) => self.push_motion(&motion, progress),
            (HandEvent::IuUnmeasured(_), _) => self.skip_motion(),
            (HandEvent::IuEnded(iu), _) => self.end_iu(&iu, couple.map(|couple| couple.context), progress),
            (HandEvent::ActivityEnded { .. }, _) => self.end_activity(progress),
            (HandEvent::IuBegan { .. }, None) | (HandEvent::Eru { .. }, _) => {}
        }
    }

    fn begin_activity(&mut self, context: Context, began_ns: u64, progress: &mut Progress<'a>) {
        if progress.begins_undone(context) {
            self.doubt.forget_remainder();
        }
        let hidden = self.doubt.begin_activity(context);
        let step = match progress.shown_hand(self.side, context) {
            Some(side) => Step::Shown(side),
            None if progress.has_parts_of(context) => Step::Untaught,
            None => Step::Foreign,
        };
        let number = progress.next_activity(self.side, began_ns, hidden == 0, matches!(step, Step::Shown(_)));
        let (whose, begin) = ((progress.job, self.side), (context, began_ns));
        let mut activity = OpenActivity::new(whose, number, step, begin, hidden, &self.doubt);
        let shown = activity.as_shown(context);
        if activity.is_beginning_seen() {
            progress.begin_seen_with(number, progress.opening(shown));
        }
        activity.may_be_passive = progress.may_be_passive(shown, hidden == 0 || self.doubt.was_idle());
        self.activity = Some(activity);
        self.note_never_seen(progress);
    }

    /// Takes note of whether the open activity may use an object that has not been seen.
    fn note_never_seen(&mut self, progress: &Progress<'a>) {
        if let Some(activity) = &mut self.activity {
            activity.never_seen = progress.never_seen_with(activity.context.0[1]).or(activity.never_seen);
        }
    }

    /// Notes how well the hand is seen in the next couple, this many frames after the last, before anything is decided on it.
    pub(super) fn observe(&mut self, couple: &Couple, frames: u32, progress: &mut Progress<'a>) {
        self.doubt.observe(couple, frames);
        self.occlusions.skip(frames, couple);
        let hidden = self.doubt.hidden_frames();
        progress.set_hidden(self.side, hidden, hidden > 0 || self.doubt.is_doubtful());
        progress.count_occluded(couple, frames, hidden > 0);
        self.note_never_seen(progress);
        if let Some(iu) = &mut self.iu {
            iu.elapsed = iu.elapsed.saturating_add(frames);
        }
        // An IU that began in doubt is confirmed elsewhere.
        let is_certain = self.doubt.is_certain() && self.iu.is_none_or(|iu| iu.is_certain);
        if let Some(activity) = &mut self.activity {
            activity.add_hidden(self.doubt.hidden_lately());
            if is_certain {
                // What begins with this couple is not what went on unseen.
                let context = if self.iu.is_some() { couple.context } else { Context::IDLE };
                activity.resume(context, progress);
            }
        }
    }

    /// An IU begins with `couple`. Everything that its context alone decides is decided at once, or once it is certain.
    fn begin_iu(&mut self, couple: &Couple, progress: &mut Progress<'a>) {
        self.end_interrupted(progress);
        let Some(activity) = &mut self.activity else { return };
        let context = couple.context;
        self.comparisons.clear();
        activity.may_be_passive &= progress.has_parts_of(context);
        let (is_doubtful, was_idle) = (self.doubt.is_doubtful(), self.doubt.was_idle());
        let (hidden, has_been_idle) = (self.doubt.hidden_before(), self.doubt.begin_iu());
        let number = activity.next_iu(context, !is_doubtful, hidden, has_been_idle);
        // With what goes on although all may have come, the next piece may have begun.
        if number > 0 && progress.may_be_matched() {
            progress.set_goes_on_in_next(self.side);
        }
        let may_be_remainder = number == 0 && self.doubt.may_be_remainder && !was_idle;
        // A step that was not shown may come between two parts of one activity, so the doubt outlasts it.
        self.doubt.may_be_remainder &= activity.step == Step::Untaught;
        self.doubt.is_begun_late &= self.doubt.may_be_remainder;
        let may_be_part = may_be_remainder || self.doubt.may_go_on(context);
        self.iu = Some(OpenIu {
            number,
            context,
            began_ns: couple.captured_ns,
            ended_ns: None,
            elapsed: 0,
            observation: IuObservation {
                gap_before: self.doubt.gap(),
                may_be_part,
                has_rested: !context.is_pair(),
                ..IuObservation::default()
            },
            measured: None,
            is_certain: !is_doubtful,
            is_concluded: false,
        });
        self.judge_context(couple, progress);
    }

    /// The open IU began in doubt. Once it is certain that it has happened, its context is judged.
    fn confirm_iu(&mut self, couple: &Couple, progress: &mut Progress<'a>) {
        let (Some(iu), Some(activity)) = (&mut self.iu, &mut self.activity) else { return };
        iu.is_certain = true;
        activity.confirm_iu(iu.elapsed, progress);
        if self.comparisons.is_empty() && iu.context.is_touch() && !iu.is_concluded {
            self.judge_context(couple, progress);
        }
    }

    /// Compares the open IU with the nominal IUs that it can be, or gives its verdict where there is none.
    fn judge_context(&mut self, couple: &Couple, progress: &mut Progress<'a>) {
        let Some(activity) = &self.activity else { return };
        match activity.against {
            _ if activity.step == Step::Untaught && couple.is_in_sight() => {
                return self.conclude_iu(Finding::of(Outcome::Anomaly, Reason::None, None), progress);
            }
            _ if activity.step == Step::Untaught => return self.conclude_unseen(progress),
            Against::Candidates => self.begin_with_candidates(couple, progress),
            Against::Following(nominal, _) => self.begin_following(nominal, couple, progress),
        }
        if let Some(activity) = &self.activity {
            let may_be = (!activity.is_out_of_sequence()).then(|| activity.candidates());
            progress.set_underway(self.side, activity.candidates_as_seen(), may_be);
        }
    }

    fn begin_with_candidates(&mut self, couple: &Couple, progress: &mut Progress<'a>) {
        let Some(activity) = &mut self.activity else { return };
        let (job, context) = (progress.job, activity.as_shown(couple.context));
        let newest = activity.newest_ius();
        let agreeing: ActivitySet = newest.clone().map(|(nominal, _)| nominal).collect();
        let is_inserted = activity.agree(progress.has_parts_of(context));
        // An IU that has certainly happened agrees with no other.
        if self.iu.is_some_and(|iu| iu.is_certain) {
            activity.keep(agreeing | activity.agreeing);
        }
        if is_inserted {
            let nominal = activity.candidates().lowest();
            self.conclude_iu(Finding::right(nominal), progress);
            return;
        }
        if agreeing.is_empty() {
            let reason = context_reason(job, activity.candidates_before(), context);
            self.conclude_context(couple, reason, progress);
            return;
        }
        let come = newest.clone().map(|(_, index)| index).min().unwrap_or(0);
        progress.note_another_piece(self.side, agreeing, come);
        if context.is_touch() {
            for (nominal, index) in newest {
                self.comparisons.add(nominal, index);
            }
            if self.doubt.gap() > 0 {
                self.comparisons.append_unknown();
            }
        }
    }

    fn begin_following(&mut self, nominal: Option<usize>, couple: &Couple, progress: &mut Progress<'a>) {
        let Some(activity) = &mut self.activity else { return };
        let (job, context) = (progress.job, activity.as_shown(couple.context));
        let found = activity
            .follow_on(couple.context)
            .filter(|_| !(activity.is_out_of_sequence() && activity.may_be_right()));
        match found {
            Some((nominal, index)) if context.is_touch() => {
                self.comparisons.add(nominal, index);
            }
            // A release state is judged by its context alone, which is right.
            Some(_) => {}
            None => {
                let among = nominal.map_or(ActivitySet::first(ACTIVITIES), ActivitySet::of);
                let reason = context_reason(job, among, context);
                self.conclude_context(couple, reason, progress);
            }
        }
    }

    /// Gives the verdict on an IU whose context is wrong, as soon as it is certain that the IU has happened.
    fn conclude_context(&mut self, couple: &Couple, reason: Reason, progress: &mut Progress<'a>) {
        let is_certain = self.is_iu_certain();
        let Some(activity) = &mut self.activity else { return };
        // What else lies there has not been seen for long enough either.
        let may_be_right = self.doubt.is_object_new() || activity.may_be_right();
        if (is_certain || !couple.is_in_sight()) && activity.against == Against::Candidates {
            activity.follow_nearest(couple.context);
        }
        let nominal = activity.nearest;
        if couple.is_in_sight() && !may_be_right {
            self.conclude_iu(Finding::of(Outcome::Anomaly, reason, nominal), progress);
        } else if is_certain || !couple.is_in_sight() {
            self.conclude_unseen(progress);
        }
    }

    /// Takes the next filtered motion of the open IU.
    fn push_motion(&mut self, motion: &Motion, progress: &mut Progress<'a>) {
        if self.iu.is_some_and(|iu| !iu.is_concluded) && self.comparisons.append(motion).is_err() {
            self.conclude_unjudged(Reason::Overload, progress);
        }
    }

    /// The motion of the next frames of the open IU is not known.
    fn skip_motion(&mut self) {
        if self.iu.is_some_and(|iu| !iu.is_concluded) {
            self.comparisons.append_unknown();
        }
    }

    /// The open IU continues with `couple`. Decides what can be decided before its end.
    pub(super) fn continue_iu(
        &mut self,
        couple: &Couple,
        measures: [Measures; WORLDS],
        progress: &mut Progress<'a>,
    ) {
        self.watch_held(couple, progress);
        let is_forgotten = self.activity.is_none() && self.doubt.is_certain() && !self.doubt.may_be_remainder;
        if is_forgotten {
            self.occlusions.forget();
        } else {
            self.occlusions.count(couple);
        }
        if !self.doubt.is_doubtful() && self.iu.is_some_and(|iu| !iu.is_certain) {
            self.confirm_iu(couple, progress);
        }
        let Some(iu) = self.iu.as_mut().filter(|iu| !iu.is_concluded) else { return };
        // Where the other hand was not shown to act, there is nothing to wait for.
        iu.observation.push(couple, measures, progress.job.is_done_by(self.side.other()));
        // While the hand is hidden, the IU may have ended already.
        iu.observation.gap_after = if couple.lacks(Unseen::CONTEXT) { self.doubt.gap() } else { 0 };
        let Some(iu) = self.iu.filter(|_| self.held.is_none()) else { return };
        let candidates = self.activity.as_ref().map_or(ActivitySet::EMPTY, OpenActivity::candidates);
        if !couple.is_in_sight() {
            self.conclude_unseen(progress);
        } else if iu.context.is_release() && (iu.is_certain || !candidates.is_empty()) {
            // It has no motion of a hand and may last for any time, so its context decides.
            self.conclude_right(None, progress);
        } else if iu.is_certain && !self.doubt.is_doubtful() && self.is_certainly_wrong(iu.observation) {
            self.decide_by_motion(iu.observation, progress);
        }
    }

    /// Whether the open IU fits no nominal IU any more, whatever comes and whatever was not seen.
    fn is_certainly_wrong(&mut self, observation: IuObservation) -> bool {
        let is_place_certain = self.activity.as_ref().is_some_and(OpenActivity::is_place_certain);
        let is_lost = self.comparisons.all_lost(observation);
        is_lost
            && is_place_certain
            && !self.may_give_up()
            && !self.may_pass(observation)
            && self.comparisons.nearest(observation).is_none_or(|nearest| !nearest.is_doubtful)
    }

    /// Whether the two parts of the open IU were shown to rest beside each other, and have only moved so far.
    fn may_pass(&self, observation: IuObservation) -> bool {
        self.iu.is_some_and(|iu| !iu.observation.has_rested)
            && observation.measures.reversals == 0
            && self.comparisons.were_shown_at_rest()
    }

    /// The IU has ended, and the hand goes on in the `next` context, if any comes.
    fn end_iu(&mut self, iu: &Iu, next: Option<Context>, progress: &mut Progress<'a>) {
        if let Some(activity) = &mut self.activity
            && iu.context.is_touch()
        {
            activity.ended_ns = iu.ended_ns;
            // Where frames are missing, a contact that came and went soon may only have seemed to.
            let believable = |iu: OpenIu| iu.observation.frames.min(self.doubt.end_frames());
            if self.iu.is_some_and(|iu| iu.observation.captured < believable(iu)) {
                activity.doubt_newest_iu();
            }
        }
        if let Some(open) = &mut self.iu {
            open.ended_ns = Some(iu.ended_ns);
            let open = *open;
            let is_certain = open.is_certain && !self.doubt.is_doubtful();
            let observation = IuObservation {
                frames: iu.frames,
                measured: iu.measured,
                measures: iu.measures,
                measures_at_pace: iu.measures_at_pace,
                gap_after: self.doubt.gap(),
                ended: true,
                may_be_part: open.observation.may_be_part || self.is_broken_off || !is_certain,
                ..open.observation
            };
            if observation.gap_after > 0 && !open.is_concluded {
                self.comparisons.append_unknown();
            }
            if self.gives_up(observation, next, progress) || open.is_concluded {
                // It was no IU, or has its verdict.
            } else if next == Some(Context::IDLE) && self.may_be_interrupted(progress) {
                self.interrupted = Some(Interrupted { open, observation, iu: *iu });
                self.iu = None;
                return;
            } else {
                self.decide_at_end(observation, next, progress);
            }
        }
        self.close_iu(iu, progress);
    }

    /// Gives the verdict on the IU, which has ended before the `next` context.
    pub(super) fn decide_at_end(
        &mut self,
        observation: IuObservation,
        next: Option<Context>,
        progress: &mut Progress<'a>,
    ) {
        let activity = self.activity.as_ref();
        let goes_on = |next| activity.is_some_and(|activity| activity.goes_on_with(next));
        let may_pass = self.may_pass(observation) && next.is_some_and(|next| !goes_on(next));
        if self.comparisons.end().is_err() {
            self.conclude_unjudged(Reason::Overload, progress);
        } else if may_pass {
            // The runs show the two parts at rest side by side. Here they passed, and no candidate goes on so: whether they touched is not known.
            if let Some(activity) = &mut self.activity {
                activity.doubt_newest_iu();
            }
            self.conclude_unjudged(Reason::Passing, progress);
        } else if observation.may_be_part && self.hold_back(observation, progress) {
            // It has its verdict once it is certain that it has ended.
        } else {
            self.decide_by_motion(observation, progress);
        }
    }

    /// The IU is over, and has its verdict.
    pub(super) fn close_iu(&mut self, iu: &Iu, progress: &mut Progress<'a>) {
        if self.is_iu_certain() {
            self.compare_but_for_part(iu, progress);
        }
        self.iu = None;
    }

    /// Gives the verdict on the IU by its motion and bounds.
    fn decide_by_motion(&mut self, observation: IuObservation, progress: &mut Progress<'a>) {
        let min_captured = progress.job.min_captured;
        if let Some(iu) = self.iu.filter(|iu| !iu.observation.is_captured(min_captured)) {
            let cause = too_few_frames(iu.observation.captured, iu.observation.frames, min_captured);
            self.conclude_unjudged(cause, progress);
            return;
        }
        let Some(nearest) = self.comparisons.nearest(observation) else {
            self.conclude_unseen(progress);
            return;
        };
        if let Some(iu) = &mut self.iu {
            iu.measured = nearest.measured;
        }
        let is_place_certain = self.activity.as_ref().is_some_and(OpenActivity::is_place_certain);
        let is_right = nearest.reason == Reason::None;
        if is_right && !observation.is_known() || !is_right && (nearest.is_doubtful || !is_place_certain) {
            self.conclude_unseen(progress);
        } else if is_right {
            self.keep_right(observation);
            self.conclude_right(Some(nearest), progress);
        } else {
            self.conclude_wrong(nearest, progress);
        }
    }

    /// The open IU is right: nominal activities of which it is certainly no IU are no candidates any more. It rules out no places in the others.
    /// Bounds are those of few people, and without a place the next context would be wrong.
    fn keep_right(&mut self, observation: IuObservation) {
        let is_certain = self.is_iu_certain();
        let Some(activity) = self.activity.as_mut().filter(|activity| !activity.candidates().is_empty())
        else {
            return;
        };
        let mut possible = ActivitySet::EMPTY;
        for result in self.comparisons.results(observation) {
            let is_right = result.reason == Reason::None;
            if is_right {
                activity.ratios[result.nominal] += result.ratio();
            } else {
                activity.disagree(result.nominal, result.index);
            }
            if is_right || result.is_doubtful || !is_certain {
                possible |= ActivitySet::of(result.nominal);
            }
        }
        activity.keep(possible);
    }

    /// Why too little is known of the open IU or activity: of itself, or else of something before it.
    pub(super) fn unseen_cause(&self, progress: &Progress<'a>) -> Cause {
        let min_captured = progress.job.min_captured;
        let is_uncaptured = |iu: OpenIu| 2 * iu.observation.captured < iu.observation.frames;
        // Where something of the open IU was hidden, that is the reason.
        let is_seen = self.iu.is_none_or(|iu| iu.observation.assumed == 0);
        let is_begun_late = is_seen
            && self.activity.as_ref().is_some_and(|activity| activity.remainder == Remainder::Unwatched);
        if self.is_broken_off {
            Reason::BrokenOff.into()
        } else if self.iu.is_some_and(is_uncaptured) {
            self.occlusions.frames_missing(min_captured)
        } else if is_begun_late && self.occlusions.is_within(self.doubt.min_idle_frames()) {
            Reason::BeginningNotSeen.into()
        } else {
            let own = [self.occlusions];
            OcclusionLog::main_cause(&own, min_captured, progress.persist_frames)
                .or(self.newest_unjudged)
                .or(OcclusionLog::cause(&own, min_captured))
                .unwrap_or_else(|| progress.unseen_cause())
        }
    }
}
