//! The verdict on the job, and why.

use super::{Phase, Progress, not_judged, wrong};
use crate::set::ActivitySet;
use crate::verdict::{Outcome, Reason, Verdict};

impl Progress<'_> {
    /// Gives the verdict on the job once all activities have come that may come, or when it has `ended`. One that has not begun has none.
    pub(crate) fn conclude(&mut self, ended: bool) {
        let is_complete = (self.state.required | self.may_follow()).without(self.tried()).is_empty();
        if self.is_concluded() || !is_complete && !ended {
            return;
        }
        let (is_given_up, decided) = (self.is_given_up(), self.outcome());
        self.state.phase = Phase::Over;
        let is_right = decided.outcome == Outcome::Ok;
        self.undone_first = ActivitySet::EMPTY;
        let may_go_on = self.tried() | self.possibly();
        // What may have come unseen before it was seen to come may then have been that of the next piece.
        let may_be_next = self.state.may_be_of_next | self.state.done & self.possibly();
        self.state.carried_over = if is_right { may_be_next } else { may_go_on };
        self.forget_hidden();
        self.never_seen = Some(self.out_of_sight);
        if is_given_up {
            return;
        }
        let verdict = Verdict {
            activity: self.state.activities,
            note: self.state.note,
            began_ns: self.state.began_ns,
            // A job that began on command may end before the frame that it was to begin with.
            ended_ns: self.now_ns.max(self.state.began_ns),
            decided_ns: self.known_ns,
            ..decided
        };
        if let Some(began_ns) = self.state.unseen_since_ns.take_if(|_| is_right) {
            let (outcome, reason) = (Outcome::NotJudged, Reason::HandNotSeen);
            let ended_ns = self.state.began_ns;
            self.tell(Verdict { outcome, reason, activity: 0, note: None, began_ns, ended_ns, ..verdict });
        }
        self.tell(verdict);
    }

    /// How the job came out, and why.
    fn outcome(&self) -> Verdict {
        let not_completed = |lowest: usize| {
            let is_instead = self.state.instead.contains(lowest);
            let reason = if is_instead { Reason::WrongObject } else { Reason::NotCompleted };
            Verdict { nearest: Some(lowest as u16), ..wrong(reason) }
        };
        let missing = self.state.required.without(self.state.done | self.state.unjudged);
        let is_end_certain = !self.is_end_assumed();
        let certainly_missing =
            missing.lowest().filter(|_| is_end_certain && !missing.intersects(self.possibly()));
        // A hand that has touched something and begun no step has not begun the job.
        let is_begun = self.state.first_step().is_some() || !self.state.instead.is_empty();
        let undone = (missing & self.undone()).lowest().filter(|_| is_end_certain && is_begun);
        let fault = self.state.fault.or(undone.map(not_completed));
        // What is missing may have been done while it could not be judged.
        if let Some(decided) = fault.or(self.state.first_unjudged) {
            return decided;
        }
        match certainly_missing {
            _ if self.state.first_step().is_none() && self.state.activities > 0 => Verdict::default(),
            Some(lowest) => not_completed(lowest),
            None if missing.is_empty() && self.state.is_start_seen => {
                let right = Verdict { outcome: Outcome::Ok, reason: Reason::None, ..Verdict::default() };
                // Where what was done is undone again, as the bench shows, and not all was seen, what came may belong to two jobs.
                let mixed = self.main_cause().filter(|_| self.seen_undone.intersects(self.state.done));
                mixed.map_or(right, |cause| not_judged(cause, None))
            }
            None => {
                let unseen = (missing & self.possibly()).lowest().or(missing.lowest());
                let cause = self.unseen_activity_cause(unseen);
                let is_of_job = matches!(cause.reason, Reason::BeginningNotSeen | Reason::BrokenOff);
                let is_named = |activity: &usize| !is_of_job || self.state.instead.contains(*activity);
                not_judged(cause, unseen.filter(is_named).map(|activity| activity as u16))
            }
        }
    }
}
