//! The job level: which nominal activities are done, which are missing, and in what order they came.

use crate::capacity::HANDS;
use crate::couple::Context;
use crate::input::Side;
use crate::job::Job;
use crate::verdict::{Kind, Reason, Verdict};

/// A set of nominal activities, as bits by their place in the job ([`crate::capacity::ACTIVITIES`] are 32).
pub(super) type Set = u32;

/// How far the job is, and what time it is.
#[derive(Clone, Debug)]
pub(super) struct Progress<'a> {
    pub(super) job: &'a Job<'a>,
    /// The time of the newest couples.
    pub(super) now_ns: u64,
    /// The time of the newest frame that they rest on.
    pub(super) known_ns: u64,
    began_ns: u64,
    /// Activities that have begun.
    activities: u16,
    /// Done right.
    done: Set,
    /// Done, but not judged.
    unjudged: Set,
    /// Tried, and wrong.
    wrong: Set,
    /// Of each hand: matched to its end, but a longer nominal activity may go on.
    waiting: [Set; HANDS],
    /// Of each hand: what the activity that goes on can be.
    underway: [Set; HANDS],
    /// The first fault, and the number of the nominal activity near it.
    fault: Option<(Reason, Option<u16>)>,
    /// Why something was not judged.
    unknown: Option<Reason>,
    /// A job goes on that has no verdict yet.
    open: bool,
}

impl<'a> Progress<'a> {
    pub(super) fn new(job: &'a Job<'a>) -> Self {
        Self {
            job,
            now_ns: 0,
            known_ns: 0,
            began_ns: 0,
            activities: 0,
            done: 0,
            unjudged: 0,
            wrong: 0,
            waiting: [0; HANDS],
            underway: [0; HANDS],
            fault: None,
            unknown: None,
            open: false,
        }
    }

    pub(super) fn begin(&mut self, began_ns: u64) {
        let (now_ns, known_ns) = (self.now_ns, self.known_ns);
        *self = Self { began_ns, now_ns, known_ns, open: true, ..Self::new(self.job) };
    }

    /// The number of an activity that begins.
    pub(super) fn next_activity(&mut self) -> u16 {
        let number = self.activities;
        self.activities = number.saturating_add(1);
        number
    }

    /// The number that a nominal activity has in its job.
    pub(super) fn number(&self, nominal: usize) -> Option<u16> {
        self.job.activities.get(nominal).map(|nominal| nominal.activity)
    }

    /// Several sequences may fulfil the same activity: the bit of the first of them.
    fn bit(&self, nominal: usize) -> Set {
        let number = self.number(nominal);
        let first = self.job.activities.iter().position(|other| Some(other.activity) == number);
        first.map_or(0, |first| 1 << first)
    }

    /// The bits of all activities of the job.
    fn all(&self) -> Set {
        (0..self.job.activities.len()).fold(0, |set, nominal| set | self.bit(nominal))
    }

    /// The activities that have been tried, however that ended.
    fn came(&self) -> Set {
        self.done | self.unjudged | self.wrong
    }

    /// The bit of the first activity that has not come, where the order matters.
    fn next_in_order(&self) -> Set {
        let underway = self.underway.iter().fold(0, |set, hand| set | hand);
        let missing = self.all() & !(self.came() | underway);
        if self.job.order_matters { missing & missing.wrapping_neg() } else { 0 }
    }

    /// Whether a nominal activity of this hand may not come now: it was done already, or one that must come before has not come and
    /// cannot be what the other hand is doing.
    pub(super) fn is_out_of_place(&self, side: Side, nominal: usize) -> bool {
        let others = Side::ALL.into_iter().filter(|other| *other != side);
        let came = others.fold(self.came(), |came, other| came | self.underway[other.place()]);
        let number = self.number(nominal);
        let earlier =
            self.job.activities.iter().enumerate().filter(|(_, other)| Some(other.activity) < number);
        let overtaken = earlier.map(|(place, _)| self.bit(place)).any(|bit| came & bit == 0);
        self.done & self.bit(nominal) != 0 || self.job.order_matters && overtaken
    }

    /// The nominal activity that a hand has matched to its end, where a longer one may go on.
    pub(super) fn set_waiting(&mut self, side: Side, nominal: Option<usize>) {
        self.waiting[side.place()] = nominal.map_or(0, |nominal| self.bit(nominal));
    }

    /// What the activity of a hand that goes on can be.
    pub(super) fn set_underway(&mut self, side: Side, candidates: Set) {
        self.underway[side.place()] =
            super::activity::members(candidates).fold(0, |set, nominal| set | self.bit(nominal));
    }

    pub(super) fn set_done(&mut self, nominal: usize) {
        self.done |= self.bit(nominal);
    }

    pub(super) fn set_unjudged(&mut self, nominal: Option<usize>, reason: Reason) {
        self.unjudged |= nominal.map_or(0, |nominal| self.bit(nominal));
        self.unknown = self.unknown.or(Some(reason));
    }

    /// Where nothing says what a wrong activity should have been and the order matters, it stood in the place of the next.
    pub(super) fn set_wrong(&mut self, nominal: Option<usize>, reason: Reason) {
        self.wrong |= nominal.map_or_else(|| self.next_in_order(), |nominal| self.bit(nominal));
        let number = nominal.and_then(|nominal| self.number(nominal));
        self.fault = self.fault.or(Some((reason, number)));
    }

    /// Whether all nominal activities are done, those included that wait for a longer one that may go on.
    pub(super) fn is_matched(&self) -> bool {
        let waiting = self.waiting.iter().fold(0, |set, hand| set | hand);
        self.all() & !(self.done | self.unjudged | waiting) == 0
    }

    /// Gives the verdict on the job once all is done, or at its end.
    pub(super) fn conclude(&mut self, ended: bool, emit: &mut impl FnMut(Verdict)) {
        let missing = self.all() & !(self.done | self.unjudged);
        if !self.open || missing != 0 && !ended {
            return;
        }
        self.open = false;
        let (kind, reason, nearest) = match (self.fault, self.unknown) {
            (Some((reason, nearest)), _) => (Kind::JobAnomaly, reason, nearest),
            // What is missing may have been done while it could not be judged.
            (None, Some(reason)) => (Kind::NotJudged, reason, None),
            (None, None) if missing == 0 => (Kind::JobOk, Reason::None, None),
            // The bit of an activity is the place of its first sequence.
            (None, None) => {
                (Kind::JobAnomaly, Reason::NotCompleted, self.number(missing.trailing_zeros() as usize))
            }
        };
        emit(Verdict {
            kind,
            reason,
            side: None,
            nearest,
            activity: self.activities,
            iu: None,
            context: Context::IDLE,
            distance: None,
            threshold: None,
            early: false,
            began_ns: self.began_ns,
            // A job that a command began may end before the frame that it was to begin with.
            ended_ns: self.now_ns.max(self.began_ns),
            decided_ns: self.known_ns,
        });
    }
}
