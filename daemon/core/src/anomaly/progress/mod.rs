//! The job level: which activities have come, which are missing, and in which order they came.

mod another_piece;
mod next_job;
mod order;
mod outcome;
mod unseen;

use super::Event;
use super::occlusion::{Cause, OcclusionLog};
use crate::capacity::{EVENTS, HANDS};
use crate::couple::{Context, Couple, Couples, Unseen};
use crate::input::Side;
use crate::job::{Job, NominalIu};
use crate::segment::Start;
use crate::set::{ActivitySet, ObjectSet};
use crate::verdict::{Note, Outcome, Reason, Verdict};
pub(super) use another_piece::quickest;
use heapless::Vec;

/// Two unrelated steps come in one order in as many runs by chance in 3 of 100 jobs (2^-5).
const MIN_USUAL_RUNS: u16 = 6;

/// What was known when a hand began its newest activity.
#[derive(Clone, Copy, Debug, Default)]
struct Begin {
    ns: u64,
    /// The same, or 0 if it may have begun earlier.
    seen_ns: u64,
    /// What had come for certain.
    came: ActivitySet,
    /// That, and what the other hand had begun for certain.
    begun: ActivitySet,
    /// What had begun, or may have.
    may_have_begun: ActivitySet,
    /// What the other hand had come to the end of, or may have.
    may_have_ended: ActivitySet,
}

/// How far a job is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    /// It has its verdict, or none has begun.
    #[default]
    Over,
    /// It has begun and has no verdict yet.
    Open,
    /// It ends only because a touch may have begun the next one, or in a pause: that is assumed, not seen.
    EndAssumed,
    /// It ends because the couples break off.
    BrokenOff,
}

/// What is known of the open job, or of the one before if none is open. Its sets have the numbers of activities, not those of nominal ones.
#[derive(Clone, Debug, Default)]
struct JobState {
    /// The activities without which the job is not complete, as it has been done so far.
    required: ActivitySet,
    began_ns: u64,
    /// Since when a hand that was not seen had worked before it. If the job is right, that was another piece.
    unseen_since_ns: Option<u64>,
    start: Start,
    /// How many activities have begun, and how many of them were none: the hand moved nothing, or put right what was done.
    activities: u16,
    given_up: u16,
    /// For each hand, the number of the first of them that is a step of the job, as far as its first IU shows.
    first_steps: [Option<u16>; HANDS],
    /// The activities that were done right, done but not judged, and done wrong.
    done: ActivitySet,
    unjudged: ActivitySet,
    wrong: ActivitySet,
    /// Activities whose work may have been done with another part. If one of them turns out not to have come, that part was wrong.
    instead: ActivitySet,
    /// For each hand, the activity that it has matched to its last IU while a longer candidate may still go on.
    waiting: [ActivitySet; HANDS],
    /// For each hand, what its open activity may be if that has come to its end, though nothing says so.
    may_have_ended: [ActivitySet; HANDS],
    /// For each hand, the candidates of its open activity as it was seen, and with what was not seen of it.
    underway: [ActivitySet; HANDS],
    may_be_underway: [ActivitySet; HANDS],
    begins: [Begin; HANDS],
    /// For each hand, whether what it does now is not seen.
    is_hidden: [bool; HANDS],
    /// Nothing of the job can have happened before what was seen of it, or its first activity was one with which a job begins.
    is_start_seen: bool,
    /// The activities that may have come before the first one that was seen.
    may_precede: ActivitySet,
    /// The activities whose part has been away from where the job begins in some frame of this job.
    left: ActivitySet,
    /// What came, or may have, and may belong to the next job: nothing after a job that was right.
    carried_over: ActivitySet,
    /// What came again, or may have come unseen since all came that the open job requires: it may be of the next job.
    may_be_of_next: ActivitySet,
    /// Why what a hand goes on with from the job before was not judged.
    carried_on_cause: Option<Cause>,
    /// What of the verdict is known by the first fault, by the first that was not judged, and by the first note.
    fault: Option<Verdict>,
    first_unjudged: Option<Verdict>,
    note: Option<Note>,
    phase: Phase,
}

impl JobState {
    fn new(job: &Job<'_>) -> Self {
        let required = job.whose_law(|law| law.is_required);
        Self { required, carried_over: job.numbers(), ..Self::default() }
    }

    /// The number of the first activity that is a step of the job, as far as its first IU shows.
    fn first_step(&self) -> Option<u16> {
        self.first_steps.into_iter().flatten().min()
    }
}

/// The progress of the open job, and the time.
#[derive(Clone, Debug)]
pub(super) struct Progress<'a> {
    pub(super) job: &'a Job<'a>,
    /// All activities of the job.
    all: ActivitySet,
    pub(super) persist_frames: u32,
    /// The time of the newest couples, and of the newest frame that they depend on.
    pub(super) now_ns: u64,
    pub(super) known_ns: u64,
    state: JobState,
    /// The activities that may have come unseen since the last job ended.
    unseen: ActivitySet,
    /// Activities that the newest frame shows not to have been done. Then those that one before the first touch of this job has shown so.
    seen_undone: ActivitySet,
    undone_first: ActivitySet,
    /// The activities that use an object which has not been seen since the last job ended or the encoder started. `None` before the first frame.
    pub(super) never_seen: Option<ActivitySet>,
    /// The activities that use an object which is out of sight in the newest couples.
    out_of_sight: ActivitySet,
    /// The id of such an object while activities may have been done with it unseen, or 0.
    overlooked_object: u16,
    /// For how many frames nobody has watched since a hand was last seen to act.
    pub(super) unwatched: u32,
    /// For each hand, what has been missed since then.
    occlusions: [OcclusionLog; HANDS],
    /// What the newest frame has brought, in its order, until the judge tells it.
    pub(super) told: Vec<Event, EVENTS>,
}

impl<'a> Progress<'a> {
    pub(super) fn new(job: &'a Job<'a>, persist_frames: u32, occlusions: [OcclusionLog; HANDS]) -> Self {
        Self {
            job,
            all: job.numbers(),
            persist_frames,
            now_ns: 0,
            known_ns: 0,
            state: JobState::new(job),
            unseen: ActivitySet::EMPTY,
            seen_undone: ActivitySet::EMPTY,
            undone_first: ActivitySet::EMPTY,
            never_seen: None,
            out_of_sight: ActivitySet::EMPTY,
            overlooked_object: 0,
            unwatched: 0,
            occlusions,
            told: Vec::new(),
        }
    }

    pub(super) fn tell(&mut self, verdict: Verdict) {
        self.push(Event::Verdict(verdict));
    }

    fn push(&mut self, event: Event) {
        let is_told = self.told.push(event).is_ok();
        debug_assert!(is_told, "there is room for all events of a frame");
    }

    /// A job begins, and since when a hand that was not seen had worked before it.
    pub(super) fn begin(&mut self, began_ns: u64, start: Start, unseen_since_ns: Option<u64>) {
        let is_start_seen = start != Start::Unseen;
        // Before a start that was seen, nothing of the job was hidden.
        if is_start_seen {
            self.forget_hidden();
        }
        let may_precede = match self.may_have_begun_unwatched() {
            _ if is_start_seen => ActivitySet::EMPTY,
            true => self.all,
            false => self.state.carried_over,
        };
        self.undone_first |= self.seen_undone;
        self.unseen = self.unseen.without(self.seen_undone);
        let may_precede = may_precede.without(self.undone_first | self.behind(self.undone_first));
        self.state = JobState {
            began_ns,
            start,
            unseen_since_ns,
            is_start_seen: may_precede.is_empty(),
            may_precede,
            left: self.all.without(self.seen_undone),
            phase: Phase::Open,
            ..JobState::new(self.job)
        };
        self.push(Event::JobBegan { began_ns });
    }

    /// The same couples, in which only objects count that the job uses.
    pub(super) fn of_job(&self, couples: &Couples) -> Couples {
        let is_used = |index: &usize| !self.job.object(couples.objects[*index]).used_by.is_empty();
        let used = |objects: ObjectSet| objects.iter().filter(is_used).collect();
        Couples { out_of_sight: used(couples.out_of_sight), twice: used(couples.twice), ..*couples }
    }

    /// The activities that move what lies where the job begins have not been done. What has been away from there may have been brought back.
    pub(super) fn set_at_start(&mut self, couples: &Couples) {
        let undone = couples.ids(couples.at_start).map(|id| self.job.object(id).moved_by);
        let undone = undone.fold(ActivitySet::EMPTY, |all, moved| all | moved);
        self.state.left |= self.seen_undone.without(undone);
        self.seen_undone = undone;
        let undone = self.undone();
        (self.unseen, self.state.may_precede) =
            (self.unseen.without(undone), self.state.may_precede.without(undone));
        if self.is_concluded() {
            self.undone_first |= undone;
        }
    }

    /// The activities that the bench shows not to have come in this job. What they move for good lies where it lay, and has not been away.
    fn undone(&self) -> ActivitySet {
        self.seen_undone.without(self.state.left)
    }

    /// Whether the bench has been set for the next piece. A part that a judged activity moves for good lies again where the job began, and so does all
    /// that lay there then.
    pub(super) fn is_reset(&self) -> bool {
        let is_back = self.seen_undone & self.state.left;
        !self.is_concluded()
            && is_back.intersects(self.state.done | self.state.wrong)
            && self.undone_first.without(self.seen_undone).is_empty()
    }

    /// Whether no activity that begins with this context has been done since the job began.
    pub(super) fn begins_undone(&self, context: Context) -> bool {
        let opening = self.opening(context);
        !opening.is_empty() && opening.without(self.undone()).is_empty()
    }

    /// The next touch is the first one of a job.
    pub(super) fn expect_start(&mut self) {
        self.state.carried_over = ActivitySet::EMPTY;
    }

    /// A hand is hidden or not, and has been for this long up to now.
    pub(super) fn set_hidden(&mut self, side: Side, frames: u32, is_hidden: bool) {
        if frames > 0 {
            // What shows less than half of itself may have been taken for another one. With a quarter 53 of 3,700 drawn streams differ, and 90 with all.
            let may_have_come = self.activities_with(|ius| frames >= quickest(ius) / 2);
            self.unseen |= may_have_come;
            if self.is_matched() {
                self.state.may_be_of_next |= may_have_come;
            }
        }
        self.state.is_hidden[side.index()] = is_hidden;
    }

    /// Takes how well the next couple of a hand, as many frames later, shows what it does.
    pub(super) fn count_occluded(&mut self, couple: &Couple, frames: u32, is_hidden: bool) {
        let log = &mut self.occlusions[couple.side.index()];
        log.skip(frames, couple);
        if is_hidden || couple.lacks(Unseen::FRAME) {
            log.count(couple);
        }
    }

    fn forget_hidden(&mut self) {
        self.unseen = ActivitySet::EMPTY;
        if self.never_seen.is_none_or(ActivitySet::is_empty) {
            self.overlooked_object = 0;
        }
        self.unwatched = 0;
        self.occlusions.iter_mut().for_each(OcclusionLog::forget);
    }

    /// An activity came that was not seen well enough to say which one it is.
    pub(super) fn set_doubtful(&mut self) {
        self.unseen = self.all.without(self.undone());
    }

    /// A hand goes on with this object, with which it began in the job before; why that was not judged.
    pub(super) fn set_carried_on(&mut self, object: u16, cause: Option<Cause>) {
        self.state.carried_on_cause = self.state.carried_on_cause.or(cause);
        self.unseen |= self.activities_with(|ius| ius.iter().any(|iu| iu.context.0[1] == object));
    }

    /// The activity with this number, which was seen to begin or to its end, is one of these. If it is the first that came, and one with which a job
    /// begins, the start was seen.
    pub(super) fn begin_seen_with(&mut self, number: u16, activities: ActivitySet) {
        if self.state.first_step() == Some(number)
            && activities.intersects(self.first())
            && !self.state.is_start_seen
        {
            let behind = activities | self.behind(activities) | self.usually_behind(activities);
            self.state.is_start_seen = true;
            self.state.may_precede = self.state.may_precede.without(behind);
        }
    }

    /// The activities that begin with the hand and object of this context.
    pub(super) fn opening(&self, context: Context) -> ActivitySet {
        let opening = |context: Context| [context.0[0], context.0[1]];
        self.activities_with(|ius| ius.first().map(|iu| opening(iu.context)) == Some(opening(context)))
    }

    /// The activities of which a nominal one has such IUs.
    fn activities_with(&self, has: impl Fn(&[NominalIu<'_>]) -> bool) -> ActivitySet {
        let all = self.job.activities.iter().filter(|nominal| has(nominal.ius));
        all.map(|nominal| usize::from(nominal.activity)).collect()
    }

    /// The hand that was shown to begin an activity with this context. It is this one, or the other one if its activity there is still to come.
    pub(super) fn shown_hand(&self, side: Side, context: Context) -> Option<Side> {
        let other = side.other();
        let of_other = self.opening(context.by_hand(other));
        if !self.opening(context).is_empty() {
            Some(side)
        } else if !of_other.without(self.tried() | self.state.underway[other.index()]).is_empty() {
            Some(other)
        } else {
            None
        }
    }

    /// Whether a touch in this context may be a passive contact, as the runs have with its part, and no required activity begins so. A hand that was
    /// not seen to come may touch the other part.
    pub(super) fn may_be_passive(&self, context: Context, has_been_seen_to_come: bool) -> bool {
        let opening = self.opening(context);
        let parts = if has_been_seen_to_come { &context.0[1..2] } else { &context.0[1..] };
        parts.iter().any(|part| self.job.passive_contacts.contains(part))
            && !opening.is_empty()
            && !opening.intersects(self.state.required)
    }

    /// Whether all objects of this context belong to the job.
    pub(super) fn has_parts_of(&self, context: Context) -> bool {
        let has = |id: u16| {
            let mut ius = self.job.activities.iter().flat_map(|nominal| nominal.ius);
            ius.any(|iu| iu.context.involves(id))
        };
        context.0[1..].iter().all(|id| *id == 0 || self.job.passive_contacts.contains(id) || has(*id))
    }

    /// The activities with which a job may begin: those that no law puts behind another one.
    fn first(&self) -> ActivitySet {
        self.job.whose_law(|law| law.after().is_empty())
    }

    fn once(&self) -> ActivitySet {
        self.job.whose_law(|law| law.is_once)
    }

    /// The activities that laws put behind one of these, directly or by others between them.
    fn behind(&self, activities: ActivitySet) -> ActivitySet {
        let step =
            |set: ActivitySet| set | self.job.whose_law(|law| law.after().intersects(set | activities));
        self.all.iter().fold(ActivitySet::EMPTY, |set, _| step(set))
    }

    /// The activities that came behind one of these in all runs, too many for chance. What was not seen is assumed to keep to that.
    fn usually_behind(&self, activities: ActivitySet) -> ActivitySet {
        self.job.whose_law(|law| law.runs >= MIN_USUAL_RUNS && law.usually_after.intersects(activities))
    }

    fn has_order(&self) -> bool {
        self.first() != self.all
    }

    /// The activities that may have come although nobody has seen them. Less that is observed makes it larger, never smaller.
    fn possibly(&self) -> ActivitySet {
        self.unseen | self.state.may_precede
    }

    /// The number in this job of an activity that this hand begins, whether it is seen to begin, and whether it is a step.
    pub(super) fn next_activity(&mut self, side: Side, began_ns: u64, is_seen: bool, is_step: bool) -> u16 {
        let other = side.other();
        let came = self.state.done | self.state.wrong;
        let [as_seen, may_be] =
            [&self.state.underway, &self.state.may_be_underway].map(|all| all[other.index()]);
        self.state.begins[side.index()] = Begin {
            ns: began_ns,
            seen_ns: if is_seen { began_ns } else { 0 },
            came,
            begun: came | may_be.when(may_be.iter().count() == 1 && as_seen == may_be),
            may_have_begun: self.begun(other),
            may_have_ended: self.state.may_have_ended[other.index()],
        };
        let number = self.state.activities;
        self.state.activities = number.saturating_add(1);
        let first = &mut self.state.first_steps[side.index()];
        *first = first.or(is_step.then_some(number));
        number
    }

    pub(super) fn set_no_step(&mut self, number: u16) {
        self.state.first_steps = self.state.first_steps.map(|first| first.filter(|first| *first != number));
    }

    pub(super) fn give_up(&mut self, number: u16) {
        self.set_no_step(number);
        self.state.given_up = self.state.given_up.saturating_add(1);
    }

    /// Whether the open job has not begun after all. The touch with which it began was no activity, and nothing else has come or may have.
    fn is_given_up(&self) -> bool {
        let state = &self.state;
        let has_come = state.fault.is_some() || state.first_unjudged.is_some();
        let is_none = state.given_up > 0 && state.given_up == state.activities && self.possibly().is_empty();
        is_none && !has_come && state.start != Start::Commanded
    }

    pub(super) fn number(&self, nominal: usize) -> Option<u16> {
        self.job.activities.get(nominal).map(|nominal| nominal.activity)
    }

    /// The activities that these nominal activities fulfil.
    fn activities_of(&self, nominal: impl IntoIterator<Item = usize>) -> ActivitySet {
        nominal.into_iter().filter_map(|nominal| self.number(nominal)).map(usize::from).collect()
    }

    pub(super) fn wrong(&self) -> ActivitySet {
        self.state.wrong
    }

    /// The activities that were tried, with whatever outcome.
    fn tried(&self) -> ActivitySet {
        self.state.done | self.state.unjudged | self.state.wrong
    }

    /// Sets the activity that a hand has matched to its last IU while a longer candidate may still go on.
    pub(super) fn set_waiting(&mut self, side: Side, nominal: Option<usize>) {
        self.state.waiting[side.index()] = self.activities_of(nominal);
    }

    /// Sets the nominal activities of which the open activity of a hand may be all.
    pub(super) fn set_may_have_ended(&mut self, side: Side, nominal: ActivitySet) {
        self.state.may_have_ended[side.index()] = self.activities_of(nominal.iter());
    }

    /// What a hand goes on with, whatever that may be, may be of the next job.
    pub(super) fn set_goes_on_in_next(&mut self, side: Side) {
        self.state.may_be_of_next |= self.state.may_be_underway[side.index()];
    }

    /// What was tried, and what this hand has begun or may have begun.
    fn begun(&self, side: Side) -> ActivitySet {
        self.tried() | self.state.may_be_underway[side.index()]
    }

    /// Sets what the open activity of a hand is as it was seen, and what it may be. `None`: something did not fit and was not seen well enough to be
    /// wrong, so that may be what it was before.
    pub(super) fn set_underway(&mut self, side: Side, as_seen: ActivitySet, may_be: Option<ActivitySet>) {
        self.state.underway[side.index()] = self.activities_of(as_seen.iter());
        if let Some(may_be) = may_be {
            self.state.may_be_underway[side.index()] = self.activities_of(may_be.iter());
        }
    }

    pub(super) fn set_done(&mut self, number: u16, nominal: usize) {
        let activity = self.activities_of([nominal]);
        self.state.may_be_of_next |= self.state.done & activity;
        self.state.done |= activity;
        if activity.intersects(self.once()) {
            // What must come behind it has not come before what was seen.
            self.state.may_precede = self.state.may_precede.without(activity | self.behind(activity));
        }
        self.require_rest_of(nominal);
        self.begin_seen_with(number, activity);
    }

    /// What completes a nominal activity that does only a part is required now.
    fn require_rest_of(&mut self, nominal: usize) {
        self.state.required |= self.job.whose_law(|law| law.completes.contains(nominal));
    }

    /// An activity that is nearest to this nominal one was not judged.
    pub(super) fn set_unjudged(&mut self, nominal: Option<usize>, cause: Cause) {
        self.state.unjudged |= self.activities_of(nominal);
        nominal.into_iter().for_each(|nominal| self.require_rest_of(nominal));
        self.note_unjudged(cause, nominal.and_then(|nominal| self.number(nominal)));
    }

    /// Something was not judged, of which the activity with this number is the nearest.
    fn note_unjudged(&mut self, cause: Cause, nearest: Option<u16>) {
        self.state.first_unjudged = self.state.first_unjudged.or(Some(not_judged(cause, nearest)));
    }

    /// If no nominal activity is near a wrong one, and only one could come next, the wrong one came instead of that.
    pub(super) fn set_wrong(&mut self, nominal: Option<usize>, why: Verdict) {
        let nearest = nominal.and_then(|nominal| self.number(nominal));
        self.state.wrong |= nearest.map(usize::from).or_else(|| self.next_in_order()).into_iter().collect();
        let fault = Verdict { outcome: Outcome::Anomaly, nearest, ..why };
        self.state.fault = self.state.fault.or(Some(fault));
    }

    pub(super) fn set_note(&mut self, note: Option<Note>) {
        self.state.note = self.state.note.or(note);
    }

    /// Whether all that the job requires has come, what waits because a longer candidate may go on included.
    pub(super) fn is_matched(&self) -> bool {
        self.is_matched_with(self.state.wrong)
    }

    /// Whether all that the job requires may have come.
    pub(super) fn may_be_matched(&self) -> bool {
        self.state.required.without(self.tried() | of_both(self.state.may_have_ended)).is_empty()
    }

    /// The same, but of the activities that were done wrong only these count.
    pub(super) fn is_matched_with(&self, wrong: ActivitySet) -> bool {
        let came = self.state.done | self.state.unjudged | wrong | of_both(self.state.waiting);
        self.state.required.without(came).is_empty()
    }

    pub(super) fn is_concluded(&self) -> bool {
        self.state.phase == Phase::Over
    }
}

/// Of a verdict: it is not judged, for this cause, and the activity with this number is the nearest.
fn not_judged(Cause { reason, missing }: Cause, nearest: Option<u16>) -> Verdict {
    Verdict { outcome: Outcome::NotJudged, reason, missing, nearest, ..Verdict::default() }
}

/// Of a verdict: this is wrong.
fn wrong(reason: Reason) -> Verdict {
    Verdict { outcome: Outcome::Anomaly, reason, ..Verdict::default() }
}

/// What either hand has of these.
fn of_both([right, left]: [ActivitySet; HANDS]) -> ActivitySet {
    right | left
}
