//! The job level: which nominal activities are done, which are missing, and in which order they came.

use super::set::ActivitySet;
use crate::capacity::HANDS;
use crate::couple::Context;
use crate::input::Side;
use crate::job::Job;
use crate::verdict::{Level, Outcome, Reason, Verdict};

/// The progress of the open job, and the time.
///
/// Several nominal activities may be variants of the same activity. The sets here hold the first variant for all of them.
#[derive(Clone, Debug)]
pub(super) struct Progress<'a> {
    pub(super) job: &'a Job<'a>,
    /// The time of the newest couples.
    pub(super) now_ns: u64,
    /// The time of the newest frame that they rest on.
    pub(super) known_ns: u64,
    began_ns: u64,
    /// How many activities have begun.
    activities: u16,
    /// Activities that were done right.
    done: ActivitySet,
    /// Activities that were done but not judged.
    unjudged: ActivitySet,
    /// Activities that were tried and done wrong.
    wrong: ActivitySet,
    /// For each hand, the activity that it has matched to its last IU while a longer candidate may still go on.
    waiting: [ActivitySet; HANDS],
    /// For each hand, the candidates of its open activity.
    underway: [ActivitySet; HANDS],
    /// The reason of the first fault, and the number of the nominal activity that is nearest to it.
    fault: Option<(Reason, Option<u16>)>,
    /// The first reason why something was not judged.
    unjudged_reason: Option<Reason>,
    /// A job has begun and has no verdict yet.
    is_open: bool,
}

impl<'a> Progress<'a> {
    pub(super) fn new(job: &'a Job<'a>) -> Self {
        Self {
            job,
            now_ns: 0,
            known_ns: 0,
            began_ns: 0,
            activities: 0,
            done: ActivitySet::EMPTY,
            unjudged: ActivitySet::EMPTY,
            wrong: ActivitySet::EMPTY,
            waiting: [ActivitySet::EMPTY; HANDS],
            underway: [ActivitySet::EMPTY; HANDS],
            fault: None,
            unjudged_reason: None,
            is_open: false,
        }
    }

    pub(super) fn begin(&mut self, began_ns: u64) {
        let (now_ns, known_ns) = (self.now_ns, self.known_ns);
        *self = Self { began_ns, now_ns, known_ns, is_open: true, ..Self::new(self.job) };
    }

    /// The number in this job of an activity that begins.
    pub(super) fn next_activity(&mut self) -> u16 {
        let number = self.activities;
        self.activities = number.saturating_add(1);
        number
    }

    /// The number of the activity that a nominal activity fulfils.
    pub(super) fn number(&self, nominal: usize) -> Option<u16> {
        self.job.activities.get(nominal).map(|nominal| nominal.activity)
    }

    /// The first variant of the activity that this nominal activity fulfils.
    fn first_variant(&self, nominal: usize) -> ActivitySet {
        let number = self.number(nominal);
        self.job.activities.iter().position(|other| Some(other.activity) == number).into_iter().collect()
    }

    /// The first variants of all these nominal activities.
    fn first_variants(&self, nominal: impl IntoIterator<Item = usize>) -> ActivitySet {
        nominal.into_iter().fold(ActivitySet::EMPTY, |set, nominal| set | self.first_variant(nominal))
    }

    /// All activities of the job.
    fn all(&self) -> ActivitySet {
        self.first_variants(0..self.job.activities.len())
    }

    /// The activities that were tried, with whatever outcome.
    fn tried(&self) -> ActivitySet {
        self.done | self.unjudged | self.wrong
    }

    /// The first activity that has not been tried, if the order matters.
    fn next_in_order(&self) -> Option<usize> {
        let underway = self.underway.iter().fold(ActivitySet::EMPTY, |set, hand| set | *hand);
        self.all().without(self.tried() | underway).lowest().filter(|_| self.job.order_matters)
    }

    /// Whether this hand may not do a nominal activity now: it was done already, or an activity that must come before it has not been
    /// tried and is not what the other hand may be doing.
    pub(super) fn is_out_of_order(&self, side: Side, nominal: usize) -> bool {
        let others = Side::ALL.into_iter().filter(|other| *other != side);
        let came = others.fold(self.tried(), |came, other| came | self.underway[other.index()]);
        let number = self.number(nominal);
        let earlier =
            self.job.activities.iter().enumerate().filter(|(_, other)| Some(other.activity) < number);
        let is_overtaking = !self.first_variants(earlier.map(|(index, _)| index)).without(came).is_empty();
        let is_done = self.first_variant(nominal).without(self.done).is_empty();
        is_done || self.job.order_matters && is_overtaking
    }

    /// Sets the activity that a hand has matched to its last IU while a longer candidate may still go on.
    pub(super) fn set_waiting(&mut self, side: Side, nominal: Option<usize>) {
        self.waiting[side.index()] = self.first_variants(nominal);
    }

    /// Sets the candidates of the open activity of a hand.
    pub(super) fn set_underway(&mut self, side: Side, candidates: ActivitySet) {
        self.underway[side.index()] = self.first_variants(candidates.iter());
    }

    pub(super) fn set_done(&mut self, nominal: usize) {
        self.done |= self.first_variant(nominal);
    }

    pub(super) fn set_unjudged(&mut self, nominal: Option<usize>, reason: Reason) {
        self.unjudged |= self.first_variants(nominal);
        self.unjudged_reason = self.unjudged_reason.or(Some(reason));
    }

    /// If no nominal activity is near a wrong one and the order matters, the wrong one came instead of the next in order.
    pub(super) fn set_wrong(&mut self, nominal: Option<usize>, reason: Reason) {
        self.wrong |= self.first_variants(nominal.or_else(|| self.next_in_order()));
        let number = nominal.and_then(|nominal| self.number(nominal));
        self.fault = self.fault.or(Some((reason, number)));
    }

    /// Whether all activities are done, those included that wait because a longer candidate may go on.
    pub(super) fn is_matched(&self) -> bool {
        let waiting = self.waiting.iter().fold(ActivitySet::EMPTY, |set, hand| set | *hand);
        self.all().without(self.done | self.unjudged | waiting).is_empty()
    }

    /// Gives the verdict on the job once all activities are done, or when it has `ended`.
    pub(super) fn conclude(&mut self, ended: bool, emit: &mut impl FnMut(Verdict)) {
        let missing = self.all().without(self.done | self.unjudged).lowest();
        if !self.is_open || missing.is_some() && !ended {
            return;
        }
        self.is_open = false;
        let (outcome, reason, nearest) = match (self.fault, self.unjudged_reason, missing) {
            (Some((reason, nearest)), ..) => (Outcome::Anomaly, reason, nearest),
            // The missing activity may have been done while it could not be judged.
            (None, Some(reason), _) => (Outcome::NotJudged, reason, None),
            (None, None, None) => (Outcome::Ok, Reason::None, None),
            (None, None, Some(missing)) => (Outcome::Anomaly, Reason::NotCompleted, self.number(missing)),
        };
        emit(Verdict {
            level: Level::Job,
            outcome,
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
            // A job that began on command may end before the frame that it was to begin with.
            ended_ns: self.now_ns.max(self.began_ns),
            decided_ns: self.known_ns,
        });
    }
}
