//! The verdict on the job, and why.

use super::super::occlusion::Cause;
use super::{Fault, Progress};
use crate::set::ActivitySet;
use crate::verdict::{Outcome, Reason, Verdict};

impl Progress<'_> {
    /// Gives the verdict on the job once all activities have come that may come, or when it has `ended`. One that has not begun has none.
    pub(in crate::anomaly) fn conclude(&mut self, ended: bool) {
        let is_complete = (self.state.required | self.may_follow()).without(self.tried()).is_empty();
        if !self.state.is_open || !is_complete && !ended {
            return;
        }
        self.state.is_open = false;
        let is_given_up = self.is_given_up();
        let (outcome, fault) = self.outcome();
        self.undone_first = ActivitySet::EMPTY;
        let may_go_on = self.tried() | self.possibly();
        // What may have come unseen before it was seen to come may then have been that of the next piece.
        let may_be_next = self.state.may_be_of_next | self.state.done & self.possibly();
        self.state.carried_over = if outcome == Outcome::Ok { may_be_next } else { may_go_on };
        self.forget_hidden();
        self.never_seen = Some(self.out_of_sight);
        if is_given_up {
            return;
        }
        let verdict = Verdict {
            outcome,
            reason: fault.reason,
            nearest: fault.nearest,
            activity: self.state.activities,
            missing: fault.missing,
            measured: fault.measured,
            broken: fault.broken,
            note: self.state.note,
            began_ns: self.state.began_ns,
            // A job that began on command may end before the frame that it was to begin with.
            ended_ns: self.now_ns.max(self.state.began_ns),
            decided_ns: self.known_ns,
            ..Verdict::default()
        };
        if let Some(began_ns) = self.state.unseen_since_ns.take_if(|_| outcome == Outcome::Ok) {
            let (outcome, reason) = (Outcome::NotJudged, Reason::HandNotSeen);
            let ended_ns = self.state.began_ns;
            self.tell(Verdict { outcome, reason, activity: 0, note: None, began_ns, ended_ns, ..verdict });
        }
        self.tell(verdict);
    }

    /// How the job came out, and why.
    fn outcome(&self) -> (Outcome, Fault) {
        let because = |cause: Cause, nearest| {
            let Cause { reason, missing } = cause;
            Fault { reason, missing, nearest, measured: None, broken: None }
        };
        let not_completed = |lowest: usize| {
            let is_instead = self.state.instead.contains(lowest);
            let reason = if is_instead { Reason::WrongObject } else { Reason::NotCompleted };
            because(reason.into(), Some(lowest as u16))
        };
        let missing = self.state.required.without(self.state.done | self.state.unjudged);
        let is_end_certain = !self.state.is_end_assumed;
        let certainly_missing =
            missing.lowest().filter(|_| is_end_certain && !missing.intersects(self.possibly()));
        // A hand that has touched something and begun no step has not begun the job.
        let is_begun = self.state.first_step.is_some() || !self.state.instead.is_empty();
        let undone = (missing & self.undone()).lowest().filter(|_| is_end_certain && is_begun);
        match (self.state.fault.or(undone.map(not_completed)), self.state.first_unjudged) {
            (Some(fault), _) => (Outcome::Anomaly, fault),
            // The missing activity may have been done while it could not be judged.
            (None, Some((cause, nearest))) => (Outcome::NotJudged, because(cause, nearest)),
            (None, None) if self.state.first_step.is_none() && self.state.activities > 0 => {
                (Outcome::NotJudged, because(Reason::Unknown.into(), None))
            }
            (None, None) => match certainly_missing {
                Some(lowest) => (Outcome::Anomaly, not_completed(lowest)),
                None if missing.is_empty() && self.state.is_start_seen => match self.mixed_cause() {
                    Some(cause) => (Outcome::NotJudged, because(cause, None)),
                    None => (Outcome::Ok, because(Reason::None.into(), None)),
                },
                None => {
                    let unseen = (missing & self.possibly()).lowest().or(missing.lowest());
                    let cause = self.unseen_activity_cause(unseen);
                    let is_of_job = matches!(cause.reason, Reason::BeginningNotSeen | Reason::BrokenOff);
                    let is_named = |activity: &usize| !is_of_job || self.state.instead.contains(*activity);
                    let nearest = unseen.filter(is_named).map(|activity| activity as u16);
                    (Outcome::NotJudged, because(cause, nearest))
                }
            },
        }
    }
}
