//! The judge of one hand: its open activity and IU, and their verdicts, each given once.

use super::activity::{OpenActivity, Step};
use super::comparison::{ComparisonResult, Comparisons, Memory};
use super::ended::{Held, Interrupted};
use super::grip::LastIu;
use super::hand_doubt::HandDoubt;
use super::observation::IuObservation;
use super::occlusion::{Cause, OcclusionLog};
use super::progress::Progress;
use crate::config::Method;
use crate::couple::{Context, Couple, Unseen};
use crate::input::Side;
use crate::job::Job;
use crate::verdict::{BrokenOrder, Level, Measured, Outcome, Reason, Verdict};

/// An open IU.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenIu {
    /// Its number in the activity, from 0.
    pub(super) number: u16,
    pub(super) context: Context,
    pub(super) began_ns: u64,
    pub(super) ended_ns: Option<u64>,
    /// For how many frames it has been open, with those that are missing.
    pub(super) elapsed: u32,
    pub(super) observation: IuObservation,
    /// The measure that is out of its bounds, once that was decided.
    pub(super) measured: Option<Measured>,
    pub(super) is_certain: bool,
    pub(super) is_concluded: bool,
}

/// Judges the activities of one hand. How it decides on an IU is in `algorithm`, and on an activity in `settle`.
#[derive(Clone, Debug)]
pub(super) struct HandJudge<'a, M> {
    pub(super) side: Side,
    pub(super) doubt: HandDoubt,
    pub(super) comparisons: Comparisons<'a, M>,
    pub(super) activity: Option<OpenActivity<'a>>,
    pub(super) iu: Option<OpenIu>,
    pub(super) interrupted: Option<Interrupted>,
    pub(super) held: Option<Held>,
    /// Of the open activity, and of the doubt before it.
    pub(super) occlusions: OcclusionLog,
    /// The last IU of its newest activity, if that is not wrong and the job goes on.
    pub(super) last_done: Option<LastIu>,
    /// Why its newest activity was not judged, of which the next one may be the remainder.
    pub(super) newest_unjudged: Option<Cause>,
    /// The couples have broken off, or the other hand has begun the next piece: the open activity is not watched to its end.
    pub(super) is_broken_off: bool,
}

/// What was decided on an IU or an activity, and why.
pub(super) struct Finding {
    pub(super) outcome: Outcome,
    pub(super) cause: Cause,
    /// The index of the nearest nominal activity.
    pub(super) nominal: Option<usize>,
    pub(super) result: Option<ComparisonResult>,
}

impl Finding {
    /// It is right, or done otherwise than shown where nothing in it is wrong.
    pub(super) fn right(nominal: Option<usize>) -> Self {
        Self::of(Outcome::Ok, Reason::None, nominal)
    }

    /// Without a comparison.
    pub(super) fn of(outcome: Outcome, cause: impl Into<Cause>, nominal: Option<usize>) -> Self {
        Self { outcome, cause: cause.into(), nominal, result: None }
    }

    /// What is wrong in an activity that accuses nobody is a step that was not shown. It is not judged, where too little of it was seen.
    fn without_accusation(self, activity: &mut OpenActivity<'_>, cannot_accuse: bool) -> Self {
        if self.outcome != Outcome::Anomaly {
            return self;
        }
        if let Some(object) = activity.never_seen {
            Self::of(Outcome::NotJudged, Cause::object_not_seen(object), self.nominal)
        } else if cannot_accuse && activity.broken.is_none() {
            activity.step = Step::Untaught;
            let unjudged = activity.unjudged.map(|cause| Self::of(Outcome::NotJudged, cause, None));
            unjudged.unwrap_or(Self::right(None))
        } else {
            self
        }
    }
}

impl<'a, M: Memory<'a>> HandJudge<'a, M> {
    pub(super) fn new(side: Side, job: &'a Job<'a>, method: &Method) -> Self {
        Self {
            side,
            doubt: HandDoubt::new(method),
            comparisons: Comparisons::new(job, method.rate_hz),
            activity: None,
            iu: None,
            interrupted: None,
            held: None,
            occlusions: OcclusionLog::new(side, method.period_ns()),
            last_done: None,
            newest_unjudged: None,
            is_broken_off: false,
        }
    }

    /// Anything may have come of the open activity unseen. Whether there is one.
    pub(super) fn lose_place(&mut self) -> bool {
        self.activity.as_mut().map(|activity| activity.add_hidden(u32::MAX)).is_some()
    }

    /// The open activity is not watched to its end.
    pub(super) fn break_off(&mut self) {
        self.is_broken_off = true;
        self.lose_place();
    }

    /// No IU is open in which the hand acts. There is none, or only a release state, or one of a step that was not shown.
    pub(super) fn is_resting(&self) -> bool {
        let is_untaught = self.activity.as_ref().is_some_and(|activity| activity.step == Step::Untaught);
        let may_rest = |iu: OpenIu| is_untaught || iu.context.is_release();
        self.held.is_none() && self.iu.is_none_or(|iu| iu.is_concluded && may_rest(iu))
    }

    /// This couple shows the hand at a step of the job.
    pub(super) fn is_seen_at_step(&self, couple: &Couple) -> bool {
        let is_step = self.activity.as_ref().is_some_and(|activity| matches!(activity.step, Step::Shown(_)));
        is_step && couple.context.is_touch() && !couple.lacks(Unseen::CONTEXT)
    }

    /// What the hand does was not shown to be done by it, or may be no step, so nothing in it is wrong.
    pub(super) fn cannot_accuse(&self) -> bool {
        self.activity.as_ref().is_some_and(|activity| match activity.step {
            Step::Shown(side) => side != self.side || activity.may_be_passive,
            Step::Untaught => true,
            Step::Foreign => false,
        })
    }

    pub(super) fn is_iu_certain(&self) -> bool {
        self.iu.is_some_and(|iu| iu.is_certain)
    }

    pub(super) fn is_concluded(&self) -> bool {
        self.is_resting() && self.activity.as_ref().is_none_or(|activity| activity.is_concluded)
    }

    pub(super) fn conclude_right(&mut self, result: Option<ComparisonResult>, progress: &mut Progress<'a>) {
        let Some(activity) = &mut self.activity else { return };
        let nearest = result.map(|result| result.nominal);
        let nominal = nearest.or_else(|| activity.candidates().lowest()).or(activity.nearest);
        activity.nearest = nominal;
        self.conclude_iu(Finding { result, ..Finding::right(nominal) }, progress);
    }

    /// The IU cannot be judged. It remains with all candidates, as if its motion were right.
    pub(super) fn conclude_unjudged(&mut self, cause: impl Into<Cause>, progress: &mut Progress<'a>) {
        let Some(activity) = &mut self.activity else { return };
        let cause = cause.into();
        activity.unjudged = activity.unjudged.or(Some(cause));
        let nominal = activity.candidates().lowest().or(activity.nearest);
        self.conclude_iu(Finding::of(Outcome::NotJudged, cause, nominal), progress);
    }

    /// The IU cannot be judged, because too little of it is known.
    pub(super) fn conclude_unseen(&mut self, progress: &mut Progress<'a>) {
        self.conclude_unjudged(self.unseen_cause(progress), progress);
    }

    /// The activity equals a nominal one, or would if all of it had been judged.
    pub(super) fn conclude_matched(&mut self, nominal: usize, early: bool, progress: &mut Progress<'a>) {
        let unseen = self.unseen_cause(progress);
        let Some(activity) = &mut self.activity else { return };
        if !activity.agreeing.contains(nominal) {
            activity.unjudged = activity.unjudged.or(Some(unseen));
        }
        let is_judged = activity.unjudged.is_none() && activity.never_seen.is_none();
        let is_order_certain = activity.is_order_certain();
        let is_certain =
            |progress: &Progress<'_>, fault: &BrokenOrder| is_order_certain || progress.is_undone(fault);
        let mut broken = progress.order_fault(self.side, nominal);
        while let Some(fault) = broken
            && is_judged
            && is_certain(progress, &fault)
            && progress.blame_part(&fault)
        {
            broken = progress.order_fault(self.side, nominal);
        }
        activity.broken = activity.broken.or(broken);
        let number = activity.number;
        let (outcome, cause) = match (activity.unjudged, broken) {
            (Some(cause), _) => (Outcome::NotJudged, cause),
            (None, None) if !progress.may_be_of_another_job(self.side, nominal) => {
                (Outcome::Ok, Reason::None.into())
            }
            (None, Some(fault)) if is_certain(progress, &fault) => {
                (Outcome::Anomaly, Reason::WrongOrder.into())
            }
            (None, _) => (Outcome::NotJudged, unseen),
        };
        // If it is wrong and has no such verdict yet, it was not certain before. A longer candidate would not have been out of order.
        let early = early && outcome != Outcome::Anomaly;
        self.conclude_activity(Finding::of(outcome, cause, Some(nominal)), early, progress);
        if outcome != Outcome::NotJudged {
            progress.set_done(number, nominal);
        }
    }

    /// Gives the verdict on the IU, once, and if it is wrong the one on the activity.
    pub(super) fn conclude_iu(&mut self, finding: Finding, progress: &mut Progress<'a>) {
        self.end_held(progress);
        let is_wrong = finding.outcome == Outcome::Anomaly;
        let cannot_accuse = self.cannot_accuse();
        let never_seen = self.activity.as_ref().and_then(|activity| activity.never_seen);
        if let Some(object) = never_seen.filter(|_| is_wrong && !cannot_accuse) {
            self.conclude_unjudged(Cause::object_not_seen(object), progress);
            return;
        }
        let (Some(iu), Some(activity)) = (&mut self.iu, &mut self.activity) else { return };
        if iu.is_concluded {
            return;
        }
        iu.is_concluded = true;
        let finding = if is_wrong && cannot_accuse { Finding::right(None) } else { finding };
        let Finding { outcome, cause, nominal, result } = finding;
        let measured = iu.measured.filter(|_| outcome != Outcome::Ok);
        activity.measured = measured.filter(|_| outcome == Outcome::Anomaly);
        progress.tell(Verdict {
            level: Level::Iu,
            outcome,
            reason: cause.reason,
            side: Some(self.side),
            nearest: nominal.and_then(|nominal| progress.number(nominal)),
            activity: activity.number,
            iu: Some(iu.number),
            context: iu.context,
            distance: result.map(|result| result.distance as f32),
            threshold: result.map(|result| result.threshold),
            captured_percent: iu.observation.captured_percent(),
            seen_percent: iu.observation.seen_percent(),
            missing: cause.missing,
            measured,
            early: iu.ended_ns.is_none(),
            began_ns: iu.began_ns,
            ended_ns: iu.ended_ns.unwrap_or(progress.now_ns),
            decided_ns: progress.known_ns,
            ..Verdict::default()
        });
        if is_wrong {
            self.conclude_activity(Finding { outcome: Outcome::Anomaly, ..finding }, true, progress);
        }
    }

    /// Gives the verdict on the activity, once.
    pub(super) fn conclude_activity(&mut self, finding: Finding, early: bool, progress: &mut Progress<'a>) {
        let cannot_accuse = self.cannot_accuse();
        let Some(activity) = self.activity.as_mut().filter(|activity| !activity.is_concluded) else { return };
        let Finding { mut outcome, mut cause, nominal, .. } =
            finding.without_accusation(activity, cannot_accuse);
        let is_no_fault = outcome == Outcome::NotJudged && activity.can_be_no_fault();
        if is_no_fault {
            (outcome, cause) = (Outcome::Ok, Reason::None.into());
        }
        if is_no_fault || activity.step == Step::Untaught {
            progress.set_no_step(activity.number);
        }
        activity.is_concluded = true;
        let cause = self.occlusions.until_now(cause);
        let Cause { reason, missing } = cause;
        let note = activity.note();
        let broken = activity.broken.filter(|_| outcome == Outcome::Anomaly && reason == Reason::WrongOrder);
        let measured = activity.measured.filter(|_| outcome == Outcome::Anomaly);
        progress.set_note(note);
        let done = nominal.filter(|_| outcome != Outcome::Anomaly);
        self.last_done = done.and_then(|nominal| LastIu::of(progress.job, nominal, self.side));
        self.newest_unjudged = (outcome == Outcome::NotJudged).then_some(cause);
        match outcome {
            Outcome::Ok => {}
            Outcome::Anomaly => {
                progress.set_wrong(nominal, Verdict { reason, measured, broken, ..Verdict::default() })
            }
            Outcome::NotJudged => {
                // Otherwise what comes next with the same object may be the remainder of it.
                if !activity.has_certainly_ended() {
                    self.doubt.unjudged = activity.context.0[1];
                }
                progress.set_unjudged(nominal, cause);
            }
        }
        progress.tell(Verdict {
            level: Level::Activity,
            outcome,
            reason,
            side: Some(self.side),
            nearest: nominal.and_then(|nominal| progress.number(nominal)),
            activity: activity.number,
            context: activity.context,
            missing,
            measured,
            broken,
            note,
            early,
            began_ns: activity.began_ns,
            // After an early anomaly the activity still continues.
            ended_ns: if early && outcome == Outcome::Anomaly { progress.now_ns } else { activity.ended_ns },
            decided_ns: progress.known_ns,
            ..Verdict::default()
        });
    }
}
