//! The job level: which nominal activities are done, which are missing, and in which order they came.

use super::set::ActivitySet;
use crate::capacity::HANDS;
use crate::couple::Context;
use crate::input::Side;
use crate::job::{Job, NominalIu};
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
    /// Whether nothing of the job can have happened before what was seen of it.
    is_start_seen: bool,
    /// The next touch is the first one of a job: the last job was right, or the recording begins with one.
    is_start_expected: bool,
    /// For how many frames a hand has been hidden at most since the last job ended.
    hidden_frames: u32,
    /// An activity was not seen well enough to say which one it is.
    is_doubtful: bool,
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
            is_start_seen: false,
            is_start_expected: false,
            hidden_frames: 0,
            is_doubtful: false,
            fault: None,
            unjudged_reason: None,
            is_open: false,
        }
    }

    pub(super) fn begin(&mut self, began_ns: u64, is_start_seen: bool) {
        *self = Self {
            began_ns,
            now_ns: self.now_ns,
            known_ns: self.known_ns,
            is_start_seen: is_start_seen || self.is_start_expected,
            hidden_frames: self.hidden_frames,
            is_open: true,
            ..Self::new(self.job)
        };
    }

    /// Objects have moved without a hand. In the middle of a job that may be a part of it, or the next piece.
    pub(super) fn set_moved_unseen(&mut self) {
        if self.is_open && self.activities > 0 && !self.is_matched() {
            self.unjudged_reason = self.unjudged_reason.or(Some(Reason::Blind));
        }
    }

    /// The next touch is the first one of a job.
    pub(super) fn expect_start(&mut self) {
        self.is_start_expected = true;
    }

    /// A hand has been hidden for this long.
    pub(super) fn set_hidden(&mut self, frames: u32) {
        self.hidden_frames = self.hidden_frames.max(frames);
    }

    /// An activity came that was not seen well enough to say which one it is.
    pub(super) fn set_doubtful(&mut self) {
        self.is_doubtful = true;
    }

    /// An activity was seen to begin with this context, or from there to its end. The job has begun with it if it is the job's first.
    pub(super) fn set_start_seen(&mut self, context: Context) {
        self.begin_seen_with(self.opening(context));
    }

    /// The newest activity is one of these. If it is the first that came, and one with which a job begins, the start was seen.
    fn begin_seen_with(&mut self, activities: ActivitySet) {
        let is_first = !self.job.order_matters || activities.intersects(self.first());
        self.is_start_seen |= is_first && self.activities == 1;
    }

    /// The activities that begin with the hand and object of this context.
    fn opening(&self, context: Context) -> ActivitySet {
        let opening = |context: Context| [context.0[0], context.0[1]];
        let opens =
            |ius: &[NominalIu<'_>]| ius.first().map(|iu| opening(iu.context)) == Some(opening(context));
        let all = self.job.activities.iter().enumerate();
        self.first_variants(all.filter(|(_, nominal)| opens(nominal.ius)).map(|(index, _)| index))
    }

    /// The first activity of the job.
    fn first(&self) -> ActivitySet {
        self.all().iter().filter(|index| self.number(*index) == Some(0)).collect()
    }

    /// Whether an activity that begins with this context belongs to the next job: one that has been done comes again, and none that is
    /// left begins like it. Where the order matters, only the first activity begins a job, and only if others came after it or if the
    /// bench was rearranged; else it is done twice. A job whose start was not seen ends wherever the first activity begins. A job with a
    /// fault also ends where the bench is rearranged: there is no other sign of its end if something was done instead of an activity.
    pub(super) fn begins_next_job(&self, side: Side, context: Context, is_disturbed: bool) -> bool {
        if !self.is_open || self.activities == 0 || self.is_unfinished_by_others(side) {
            return false;
        }
        if is_disturbed && self.fault.is_some() {
            return true;
        }
        let (opening, came, first) = (self.opening(context), self.done | self.unjudged, self.first());
        let is_left = !opening.without(self.tried()).is_empty();
        if !self.job.order_matters {
            return opening.intersects(came) && !is_left;
        }
        let others_came = !(self.tried() | self.underway[side.index()]).without(first).is_empty();
        let first_came = first.intersects(came) && (others_came || is_disturbed)
            || first.intersects(self.wrong) && others_came;
        opening.intersects(first) && (!self.is_start_seen || first_came && !is_left)
    }

    /// Whether the other hand is in the middle of an activity that may still come out right.
    fn is_unfinished_by_others(&self, side: Side) -> bool {
        let is_unfinished = |hand: usize| {
            let underway = self.underway[hand];
            !underway.is_empty()
                && self.waiting[hand].is_empty()
                && underway.without(self.tried()) == underway
        };
        (0..HANDS).any(|hand| hand != side.index() && is_unfinished(hand))
    }

    /// Whether these activities may have happened without being seen.
    fn may_be_unseen(&self, missing: ActivitySet) -> bool {
        let frames = |nominal: usize| -> u32 {
            let touches = self.job.activities[nominal].ius.iter().filter(|iu| iu.context.is_touch());
            touches.map(|iu| iu.frames.min).fold(0, u32::saturating_add)
        };
        // What shows less than half of itself may have been taken for another activity.
        let may_be_hidden = |nominal: usize| self.hidden_frames >= frames(nominal) / 2;
        !self.is_start_seen || self.is_doubtful || missing.iter().any(may_be_hidden)
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
        let overtaken = self.first_variants(earlier.map(|(index, _)| index)).without(came);
        let is_overtaking = !overtaken.is_empty() && !self.may_be_unseen(overtaken);
        // What comes a second time may be that of the next job, if all between them was hidden.
        let others = self.all().without(self.tried());
        let is_repeated = self.first_variant(nominal).without(self.done).is_empty()
            && (others.is_empty() || !self.may_be_unseen(others));
        is_repeated || self.job.order_matters && is_overtaking
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
        self.begin_seen_with(self.first_variant(nominal));
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

    /// Whether all activities have come, those included that wait because a longer candidate may go on.
    pub(super) fn is_matched(&self) -> bool {
        let waiting = self.waiting.iter().fold(ActivitySet::EMPTY, |set, hand| set | *hand);
        self.all().without(self.tried() | waiting).is_empty()
    }

    /// Gives the verdict on the job once all activities have come, or when it has `ended`.
    pub(super) fn conclude(&mut self, ended: bool, emit: &mut impl FnMut(Verdict)) {
        let is_complete = self.all().without(self.tried()).is_empty();
        if !self.is_open || !is_complete && !ended {
            return;
        }
        self.is_open = false;
        let missing = self.all().without(self.done | self.unjudged);
        let (outcome, reason, nearest) = match (self.fault, self.unjudged_reason, missing.lowest()) {
            (Some((reason, nearest)), ..) => (Outcome::Anomaly, reason, nearest),
            // The missing activity may have been done while it could not be judged.
            (None, Some(reason), _) => (Outcome::NotJudged, reason, None),
            (None, None, _) if !self.is_start_seen => (Outcome::NotJudged, Reason::Blind, None),
            (None, None, None) => (Outcome::Ok, Reason::None, None),
            (None, None, Some(_)) if self.may_be_unseen(missing) => (Outcome::NotJudged, Reason::Blind, None),
            (None, None, Some(lowest)) => (Outcome::Anomaly, Reason::NotCompleted, self.number(lowest)),
        };
        self.is_start_expected = outcome == Outcome::Ok;
        self.hidden_frames = 0;
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
            captured_percent: None,
            early: false,
            began_ns: self.began_ns,
            // A job that began on command may end before the frame that it was to begin with.
            ended_ns: self.now_ns.max(self.began_ns),
            decided_ns: self.known_ns,
        });
    }
}
