//! What a hand's judge says, once for each IU and each activity.

use super::activity::members;
use super::hand::HandJudge;
use super::progress::{Progress, Set};
use super::trial::{Memory, Outcome};
use crate::verdict::{Kind, Reason, Verdict};

/// What is said of an IU or an activity.
pub(super) struct Finding {
    pub(super) kind: Kind,
    pub(super) reason: Reason,
    pub(super) nominal: Option<usize>,
    pub(super) outcome: Option<Outcome>,
    pub(super) early: bool,
}

impl<'a, M: Memory<'a>> HandJudge<'a, M> {
    /// The IU is right; `survivors` are the nominal activities that agree with it.
    pub(super) fn pass(
        &mut self,
        survivors: Set,
        outcome: Option<Outcome>,
        early: bool,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let nominal = outcome.map(|outcome| outcome.nominal).or_else(|| members(survivors).next());
        let Some(activity) = &mut self.activity else { return };
        let nominal = nominal.or(activity.nearest);
        activity.agree(survivors);
        activity.nearest = nominal;
        self.conclude_iu(
            Finding { kind: Kind::IuOk, reason: Reason::None, nominal, outcome, early },
            progress,
            emit,
        );
    }

    /// The IU cannot be judged. Its context is taken as it is, its motion as right.
    pub(super) fn give_up(
        &mut self,
        reason: Reason,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let Some(activity) = &mut self.activity else { return };
        let agreeing = activity.candidates();
        activity.agree(agreeing);
        activity.unknown = activity.unknown.or(Some(reason));
        let nominal = members(agreeing).next().or(activity.nearest);
        self.conclude_iu(
            Finding { kind: Kind::NotJudged, reason, nominal, outcome: None, early: true },
            progress,
            emit,
        );
    }

    /// The activity equals a nominal one.
    pub(super) fn conclude_matched(
        &mut self,
        nominal: usize,
        early: bool,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let Some(activity) = &self.activity else { return };
        let unknown = activity.unknown;
        let (kind, reason, early) = match unknown {
            // Said before, or now: then it was not certain, because a longer candidate would have been in place.
            _ if progress.is_out_of_place(self.side, nominal) => {
                (Kind::ActivityAnomaly, Reason::WrongOrder, false)
            }
            Some(reason) => (Kind::NotJudged, reason, early),
            None => (Kind::ActivityOk, Reason::None, early),
        };
        self.conclude_activity(kind, reason, Some(nominal), early, progress, emit);
        match unknown {
            Some(reason) => progress.set_unjudged(Some(nominal), reason),
            None => progress.set_done(nominal),
        }
    }

    /// Gives the verdict on the IU, and on the activity where it is wrong.
    pub(super) fn conclude_iu(
        &mut self,
        finding: Finding,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let (Some(iu), Some(activity)) = (&mut self.iu, &self.activity) else { return };
        if iu.concluded {
            return;
        }
        iu.concluded = true;
        let Finding { kind, reason, nominal, outcome, early } = finding;
        emit(Verdict {
            kind,
            reason,
            side: Some(self.side),
            nearest: nominal.and_then(|nominal| progress.number(nominal)),
            activity: activity.number,
            iu: Some(iu.number),
            context: iu.context,
            distance: outcome.map(|outcome| outcome.distance as f32),
            threshold: outcome.map(|outcome| outcome.threshold),
            early,
            began_ns: iu.began_ns,
            ended_ns: progress.now_ns,
            decided_ns: progress.known_ns,
        });
        if kind == Kind::IuAnomaly {
            self.conclude_activity(Kind::ActivityAnomaly, reason, nominal, true, progress, emit);
        }
    }

    /// Gives the verdict on the activity, once.
    pub(super) fn conclude_activity(
        &mut self,
        kind: Kind,
        reason: Reason,
        nominal: Option<usize>,
        early: bool,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let Some(activity) = self.activity.as_mut().filter(|activity| !activity.concluded) else { return };
        activity.concluded = true;
        match kind {
            Kind::ActivityAnomaly => progress.set_wrong(nominal, reason),
            Kind::NotJudged => progress.set_unjudged(nominal, reason),
            _ => {}
        }
        let wrong_early = early && kind == Kind::ActivityAnomaly;
        emit(Verdict {
            kind,
            reason,
            side: Some(self.side),
            nearest: nominal.and_then(|nominal| progress.number(nominal)),
            activity: activity.number,
            iu: None,
            context: activity.context,
            distance: None,
            threshold: None,
            early,
            began_ns: activity.began_ns,
            ended_ns: if wrong_early { progress.now_ns } else { activity.ended_ns },
            decided_ns: progress.known_ns,
        });
    }
}
