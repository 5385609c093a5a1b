//! The open activity of a hand, and what its IUs are judged against.
//!
//! A part of an optional step may be touched in other ways as well, because runs without that step were shown as right. What begins like
//! the step and is not like it gets a note. It is an anomaly only with a part that the job does not know, or out of order.

use super::hand_doubt::HandDoubt;
use super::occlusion::Cause;
use super::places::Places;
use super::progress::Progress;
use crate::capacity::ACTIVITIES;
use crate::couple::Context;
use crate::input::Side;
use crate::job::{Job, NominalActivity};
use crate::set::ActivitySet;
use crate::verdict::{BrokenOrder, Measured, Note, Reason};
use heapless::Vec;

/// What the IUs of an activity are judged against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Against {
    /// `J \ L`: the nominal activities with which all IUs so far agree, where unseen ones may have been.
    Candidates,
    /// After a fault: the nearest nominal activity, and the index of the IU in it that comes next.
    Following(Option<usize>, usize),
}

/// Whose work an activity is, as far as its first IU shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// The job has it, by this hand. What the other hand does otherwise than this one was shown is a step that was not shown.
    Shown(Side),
    /// No activity of the job begins so, and all its parts are the job's: a hand that rests, steadies or helps. It is judged against nothing.
    Untaught,
    /// The job has nothing to do with its parts.
    Foreign,
}

/// Whether an activity may be the remainder of one that was done before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Remainder {
    /// All of it comes now.
    No,
    /// Not all was seen before it.
    Possible,
    /// Nothing was watched before it.
    Unwatched,
}

/// An open activity.
#[derive(Clone, Debug)]
pub(super) struct OpenActivity<'a> {
    job: &'a Job<'a>,
    /// Whose it is.
    side: Side,
    /// Its number in the job, from 0.
    pub(super) number: u16,
    pub(super) step: Step,
    /// [`Progress::may_be_passive`]: a touch that is unlike the steps is then no step.
    pub(super) may_be_passive: bool,
    /// The nominal activities that it is like so far, but for the part that the hand took.
    pub(super) like: ActivitySet,
    /// What was not shown before in that it comes now.
    pub(super) order_note: Option<Note>,
    /// The relation to another activity that it breaks.
    pub(super) broken: Option<BrokenOrder>,
    /// The measure of its newest IU that is why it is wrong.
    pub(super) measured: Option<Measured>,
    /// The context of its first IU.
    pub(super) context: Context,
    pub(super) began_ns: u64,
    /// When the last IU with a touch ended.
    pub(super) ended_ns: u64,
    pub(super) against: Against,
    /// The nominal activities with which all IUs agree as they were seen, index by index.
    pub(super) agreeing: ActivitySet,
    /// How many IUs have begun, and how many of them came between those of every candidate, which allows that.
    pub(super) ius: u16,
    inserted: u16,
    /// The nominal activity nearest to the newest IU.
    pub(super) nearest: Option<usize>,
    /// For each nominal activity, the sum of its distances as multiples of the thresholds.
    pub(super) ratios: [f64; ACTIVITIES],
    /// Why one of its IUs was not judged.
    pub(super) unjudged: Option<Cause>,
    /// For each nominal activity, where in it the activity may be, now and before the newest IU. It is `i` of Algorithm 1, or several.
    places: [Places; ACTIVITIES],
    places_before: [Places; ACTIVITIES],
    /// The context of the newest IU.
    newest: Context,
    /// For how many frames IUs may have come and gone unseen since the newest one that has certainly happened began.
    hidden: u32,
    pub(super) remainder: Remainder,
    /// An end of all of it fits into as many hidden frames.
    end_frames: u32,
    /// The nominal activities all of whose IUs may have come before the newest one, which then belongs to another activity with the same part.
    possibly_ended: ActivitySet,
    /// [`Progress::never_seen_with`] its part, at some time in it.
    pub(super) never_seen: Option<u16>,
    pub(super) is_concluded: bool,
}

impl<'a> OpenActivity<'a> {
    /// Before its first IU: `C`, `L` and `i` of Algorithm 1 start again with every activity. It may have begun `hidden` frames earlier.
    pub(super) fn new(
        (job, side): (&'a Job<'a>, Side),
        number: u16,
        step: Step,
        (context, began_ns): (Context, u64),
        hidden: u32,
        doubt: &HandDoubt,
    ) -> Self {
        let (is_taught, remainder) = (step != Step::Untaught, doubt.remainder());
        let places = core::array::from_fn(|index| {
            let nominal = job.activities.get(index).filter(|_| is_taught);
            let Some(NominalActivity { ius, .. }) = nominal else { return Places::NONE };
            let places = Places::new(hidden, ius);
            match doubt.was_idle() {
                // The first step that is seen begins its piece, so it does not come once more after all of it.
                true if remainder == Remainder::Unwatched => places.after_idle(ius).before_end(ius),
                true if !job.allows_insertions(index) => places.after_idle(ius),
                _ => places,
            }
        });
        Self {
            job,
            side,
            number,
            step,
            may_be_passive: false,
            like: ActivitySet::first(job.activities.len()).when(!is_taught),
            order_note: None,
            broken: None,
            measured: None,
            context,
            began_ns,
            ended_ns: began_ns,
            against: Against::Candidates,
            agreeing: ActivitySet::first(job.activities.len()),
            ius: 0,
            inserted: 0,
            nearest: None,
            ratios: [0.0; ACTIVITIES],
            unjudged: None,
            places,
            places_before: places,
            newest: context,
            hidden: 0,
            remainder,
            end_frames: doubt.end_frames(),
            possibly_ended: ActivitySet::EMPTY,
            never_seen: None,
            is_concluded: false,
        }
    }

    /// The next IU begins in this context, and moves the places on if it has certainly happened. Something may have come and gone in `hidden` frames
    /// before it. With `was_idle` the hand was certainly idle since the one before. Returns its number.
    pub(super) fn next_iu(&mut self, context: Context, is_certain: bool, hidden: u32, was_idle: bool) -> u16 {
        if self.ius > 0 && (was_idle || self.hidden >= self.end_frames) {
            self.note_possible_end();
        }
        self.add_hidden(hidden);
        (self.places_before, self.newest) = (self.places, self.as_shown(context));
        if is_certain {
            self.places = self.places_after();
            self.hidden = 0;
        }
        let number = self.ius;
        self.ius = number.saturating_add(1);
        number
    }

    /// For each nominal activity, where in it the activity may be after the newest IU, if that has happened.
    fn places_after(&self) -> [Places; ACTIVITIES] {
        let mut places = self.places_before;
        for (index, (places, nominal)) in places.iter_mut().zip(self.job.activities).enumerate() {
            *places = places.step(nominal.ius, self.job.allows_insertions(index), self.newest, self.hidden);
        }
        places
    }

    /// The nominal IUs that the newest one may be, if it has happened. They are indices of the nominal activity and of the IU in it.
    pub(super) fn newest_ius(&self) -> impl Iterator<Item = (usize, usize)> + Clone + use<'a> {
        let context = self.newest;
        // What was hidden before it counts until it is certain.
        let places = if self.hidden == 0 { self.places } else { self.places_after() };
        let all = self.job.activities.iter().enumerate();
        all.flat_map(move |(nominal, activity)| {
            let indices = places[nominal].iter().filter_map(|ius| ius.checked_sub(1));
            let newest = indices.filter(move |index| activity.ius[*index].context == context);
            newest.map(move |index| (nominal, index))
        })
    }

    /// The newest IU began in doubt as many frames ago, and it is certain now that it has happened. What was not seen lies before it, or between two IUs
    /// in this context, of which the second may be that of another activity.
    pub(super) fn confirm_iu(&mut self, frames: u32, progress: &Progress<'_>) {
        let with_it = self.places_after();
        let hidden = core::mem::take(&mut self.hidden).min(frames);
        if hidden >= self.end_frames {
            self.note_possible_repeat(&with_it, self.newest, hidden, progress);
        }
        for ((places, with_it), nominal) in self.places.iter_mut().zip(with_it).zip(self.job.activities) {
            if !places.is_empty() {
                *places = with_it.resume(hidden, nominal.ius, self.newest);
            }
        }
    }

    /// The newest IU may not have happened.
    pub(super) fn doubt_newest_iu(&mut self) {
        self.add_hidden(1);
        for (places, before) in self.places.iter_mut().zip(self.places_before) {
            *places = places.or(before);
        }
    }

    /// `J \ L`; empty after a fault.
    pub(super) fn candidates(&self) -> ActivitySet {
        match self.against {
            Against::Candidates => candidates_at(&self.places),
            Against::Following(..) => ActivitySet::EMPTY,
        }
    }

    /// The candidates as the activity was seen, or all of them if it agrees with none so.
    pub(super) fn candidates_as_seen(&self) -> ActivitySet {
        match self.candidates() & self.agreeing {
            ActivitySet::EMPTY => self.candidates(),
            agreeing => agreeing,
        }
    }

    /// The candidates before the newest IU.
    pub(super) fn candidates_before(&self) -> ActivitySet {
        candidates_at(&self.places_before)
    }

    /// Something may have happened unseen in as many frames up to now.
    pub(super) fn add_hidden(&mut self, frames: u32) {
        self.hidden = self.hidden.max(frames);
    }

    /// What was not seen for a while is seen again in this context.
    pub(super) fn resume(&mut self, context: Context, progress: &Progress<'_>) {
        let context = self.as_shown(context);
        let is_same = context == Context::IDLE || context == self.newest;
        if self.hidden > 0 && is_same {
            let hidden = self.hidden;
            // The hand may have let go meanwhile.
            if context != Context::IDLE {
                self.note_possible_repeat(&{ self.places }, context, hidden, progress);
            } else if hidden >= self.end_frames {
                self.note_possible_end();
            }
            for (places, nominal) in self.places.iter_mut().zip(self.job.activities) {
                *places = places.resume(hidden, nominal.ius, context);
            }
            self.hidden = 0;
        }
    }

    /// From these places the hand may have ended all of it in as many hidden frames, and begun again in this context, if that may come again.
    fn note_possible_repeat(
        &mut self,
        places: &[Places; ACTIVITIES],
        context: Context,
        hidden: u32,
        progress: &Progress<'_>,
    ) {
        let all = places.iter().zip(self.job.activities).enumerate();
        let is_again = |(index, (places, nominal)): &(usize, (&Places, &NominalActivity<'_>))| {
            places.may_be_again(nominal.ius, hidden, context) && progress.may_come_again(self.side, *index)
        };
        self.possibly_ended |= all.filter(is_again).map(|(index, _)| index).collect();
    }

    /// The hand was idle, or may have been: what was not judged or not seen may have been all of it.
    fn note_possible_end(&mut self) {
        let is_doubtful = self.unjudged.is_some() || !self.has_certainly_ended();
        self.possibly_ended |= self.may_have_come().when(is_doubtful);
    }

    /// Whether what was seen of the activity may be a part of a nominal one, with what may have happened unseen.
    pub(super) fn may_be_right(&self) -> bool {
        self.may_have_ended() || self.places.iter().any(|places| !places.is_empty())
    }

    /// The nominal activities that may have come to their end, some of it unseen. What comes after that may be any that still has a place.
    pub(super) fn may_have_come(&self) -> ActivitySet {
        let all = self.places.iter().zip(self.job.activities).enumerate();
        let complete = all.filter(|(_, (places, nominal))| places.may_be_complete(nominal.ius, self.hidden));
        let complete: ActivitySet = complete.map(|(nominal, _)| nominal).collect();
        self.possibly_ended | candidates_at(&self.places).when(self.may_have_ended()) | complete
    }

    /// Whether all its IUs may have come before the newest one.
    pub(super) fn may_have_ended(&self) -> bool {
        !self.possibly_ended.is_empty()
    }

    /// Whether it must have ended unseen: what has come since then is no part of it.
    pub(super) fn must_have_ended(&self) -> bool {
        self.may_have_ended() && self.places.iter().all(|places| places.is_empty())
    }

    /// Whether all of it has come, some of it unseen, if the hand is idle now.
    pub(super) fn has_ended_if_idle(&self) -> bool {
        let mut all = candidates_at(&self.places).iter().peekable();
        let has_ended = |nominal: usize| {
            // Where other IUs may come, the hand may let go and take the part again.
            let ius = self.job.activities[nominal].ius;
            !self.job.allows_insertions(nominal) && self.places[nominal].has_ended_if_idle(ius, self.hidden)
        };
        all.peek().is_some() && all.all(has_ended)
    }

    /// Whether it is certain that all of it has come, as whichever nominal activity it may be: nothing that comes next belongs to it.
    pub(super) fn has_certainly_ended(&self) -> bool {
        let all = self.places.iter().zip(self.job.activities).filter(|(places, _)| !places.is_empty());
        let ended = all.map(|(places, nominal)| places.is_certainly(nominal.ius.len()));
        let is_seen = self.hidden == 0 && !self.may_have_ended();
        is_seen && ended.reduce(|one, other| one && other) == Some(true)
    }

    /// The contexts with which a nominal activity would go on that it may be.
    pub(super) fn continuations(&self) -> Vec<Context, ACTIVITIES> {
        let all = self.places_as_seen().into_iter().zip(self.job.activities);
        all.flat_map(|(places, nominal)| places.iter().filter_map(|ius| nominal.ius.get(ius)))
            .map(|iu| iu.context)
            .take(ACTIVITIES)
            .collect()
    }

    /// Before its first IU: whether that is the first of a nominal activity.
    pub(super) fn is_beginning_seen(&self) -> bool {
        let mut all = self.places.iter().zip(self.job.activities);
        all.all(|(places, _)| places.is_certainly(0))
    }

    /// Whether it is certain which IUs of its candidates have come, and each was seen; after a fault, whether all before was judged. Behind an IU that
    /// was not seen measures accuse nobody: what comes may have begun elsewhere.
    pub(super) fn is_place_certain(&self) -> bool {
        let is_certain = match self.against {
            Against::Candidates => {
                let all_seen = self.as_seen();
                self.candidates().iter().all(|nominal| self.places[nominal].is_certainly(all_seen))
            }
            Against::Following(..) => self.unjudged.is_none(),
        };
        is_certain && !self.may_have_ended()
    }

    /// How many nominal IUs have come if each was seen, and each that was seen has happened.
    fn as_seen(&self) -> usize {
        usize::from(self.ius - self.inserted)
    }

    /// For each nominal activity, where in it the activity is: as it was seen, unless it agrees with none so.
    fn places_as_seen(&self) -> [Places; ACTIVITIES] {
        let as_seen = self.candidates_as_seen();
        core::array::from_fn(|nominal| match self.agreeing.contains(nominal) {
            _ if !as_seen.contains(nominal) => Places::NONE,
            true => Places::at(self.as_seen()),
            false => self.places[nominal],
        })
    }

    /// Whether it is also certain that all of it comes now, and not only the remainder.
    pub(super) fn is_order_certain(&self) -> bool {
        self.is_place_certain() && self.remainder == Remainder::No
    }

    /// Its only IU did not count: it has no verdict.
    pub(super) fn give_up(&mut self) {
        (self.ius, self.inserted) = (0, 0);
        self.is_concluded = true;
    }

    /// Whether its only IU did not count.
    pub(super) fn is_given_up(&self) -> bool {
        self.is_concluded && self.ius == 0
    }

    /// Something did not fit, and was not judged because something else may have happened unseen.
    pub(super) fn is_out_of_sequence(&self) -> bool {
        matches!(self.against, Against::Following(..)) && !self.is_concluded
    }

    /// Finds with which nominal activities the context of the newest IU agrees as it was seen. Returns whether it, with parts of the job, came between
    /// those of nominal activities that allow that.
    pub(super) fn agree(&mut self, has_parts: bool) -> bool {
        let context = self.newest;
        let newest = self.as_seen().wrapping_sub(1);
        let is_newest = |nominal: &usize| {
            self.job.activities[*nominal].ius.get(newest).is_some_and(|iu| iu.context == context)
        };
        let agreeing: ActivitySet = self.agreeing.iter().filter(is_newest).collect();
        let allows = |nominal: &usize| has_parts && self.job.allows_insertions(*nominal);
        let allowing = self.agreeing.iter().filter(allows).collect();
        let is_inserted = agreeing.is_empty() && allowing != ActivitySet::EMPTY;
        if is_inserted {
            self.inserted = self.inserted.saturating_add(1);
        }
        self.agreeing = if is_inserted { allowing } else { agreeing };
        is_inserted
    }

    /// The motion of the newest IU is not that of this one of a nominal activity, as it was seen.
    pub(super) fn disagree(&mut self, nominal: usize, index: usize) {
        if index + 1 == self.as_seen() {
            self.agreeing = self.agreeing.without(ActivitySet::of(nominal));
        }
    }

    /// Only these nominal activities have a place.
    pub(super) fn keep(&mut self, candidates: ActivitySet) {
        let others = self.places.iter_mut().enumerate().filter(|(nominal, _)| !candidates.contains(*nominal));
        others.for_each(|(_, places)| *places = Places::NONE);
    }

    /// From now on its IUs are judged against this nominal activity, if any is near, from the IU with this index on.
    pub(super) fn follow(&mut self, nominal: Option<usize>, next: usize) {
        self.against = Against::Following(nominal, next);
        self.nearest = nominal.or(self.nearest);
    }

    /// After a fault: the nominal activity that is followed, and its next IU with this context or else any before that, as indices. If there is none,
    /// another nominal activity that has one is followed.
    pub(super) fn follow_on(&mut self, context: Context) -> Option<(usize, usize)> {
        let Against::Following(nominal, next) = self.against else { return None };
        let context = self.as_shown(context);
        let index = |nominal: usize, next| Some((nominal, self.index_from(nominal, next, context)?));
        let others = || (0..self.job.activities.len()).find_map(|nominal| index(nominal, 0));
        let (nominal, index) = nominal.and_then(|nominal| index(nominal, next)).or_else(others)?;
        self.follow(Some(nominal), index + 1);
        Some((nominal, index))
    }

    /// Whether the hand only rests or steadies, where it was shown to.
    pub(super) fn is_passive(&self) -> bool {
        self.step == Step::Untaught && self.job.passive_contacts.contains(&self.context.0[1])
    }

    /// Whether nothing in it is a fault: it rests where it was shown to, or does what the job can do without, in order.
    pub(super) fn can_be_no_fault(&self) -> bool {
        self.is_passive() || self.may_be_passive && self.broken.is_none()
    }

    /// What was not shown before in this activity of a hand.
    pub(super) fn note(&self) -> Option<Note> {
        match self.step {
            Step::Untaught => (self.may_be_passive || !self.is_passive()).then_some(Note::Step),
            Step::Shown(shown) if shown != self.side => Some(Note::OtherHand),
            _ => self.order_note,
        }
    }

    /// The context as if the hand that was shown had done it.
    pub(super) fn as_shown(&self, context: Context) -> Context {
        match self.step {
            Step::Shown(side) => context.by_hand(side),
            Step::Untaught | Step::Foreign => context,
        }
    }

    /// The candidate whose last IU has come, but for a release state, which leaves nothing to do. One in order comes before others, then the nearest.
    pub(super) fn matched(&self, progress: &Progress<'_>) -> Option<usize> {
        let places = self.places_as_seen();
        let has_ended = |nominal: &usize| places[*nominal].is_at_end(self.job.activities[*nominal].ius);
        self.candidates().iter().filter(has_ended).min_by(|one, other| {
            let is_out_of_order = |nominal: &usize| progress.order_fault(self.side, *nominal).is_some();
            is_out_of_order(one)
                .cmp(&is_out_of_order(other))
                .then(self.ratios[*one].total_cmp(&self.ratios[*other]))
        })
    }

    /// An IU with this number and context has ended. Keeps the nominal activities that have it there, but for the part that the hand took.
    pub(super) fn compare_but_for_part(&mut self, iu: usize, context: Context) {
        let taken = self.context.0[1];
        let is_like = |nominal: &usize| {
            let ius = self.job.activities[*nominal].ius;
            let part = ius[0].context.0[1];
            ius.get(iu).is_some_and(|shown| part != taken && shown.context == context.with_part(taken, part))
        };
        self.like = self.like.iter().filter(is_like).collect();
    }

    /// Whether a candidate has this context after the newest IU.
    pub(super) fn goes_on_with(&self, context: Context) -> bool {
        self.continuations().contains(&self.as_shown(context))
    }

    /// After a fault: whether the newest IU is the last one of the nominal activity that is followed.
    pub(super) fn is_followed_to_its_end(&self) -> bool {
        match self.against {
            Against::Following(Some(nominal), next) => next == self.job.activities[nominal].ius.len(),
            _ => false,
        }
    }

    /// No candidate has `context` where it was before the newest IU. Follows the one that has it soonest after that, or else before, or the nearest.
    pub(super) fn follow_nearest(&mut self, context: Context) {
        let context = self.as_shown(context);
        let candidates = self.candidates_before();
        let come = |nominal: usize| self.places_before[nominal].iter().next().unwrap_or(0);
        let found = candidates.iter().filter_map(|nominal| {
            let index = self.index_from(nominal, come(nominal), context)?;
            Some((index < come(nominal), index, nominal))
        });
        let (nominal, next) = match found.min() {
            Some((_, index, nominal)) => (Some(nominal), index + 1),
            None => (self.nearest, self.nearest.map_or(0, come)),
        };
        self.follow(nominal, next);
    }

    /// The first index of this context in a nominal activity from `next` on, or else before that.
    fn index_from(&self, nominal: usize, next: usize, context: Context) -> Option<usize> {
        let ius = self.job.activities[nominal].ius;
        let has_context = |index: &usize| ius[*index].context == context;
        (next..ius.len()).find(has_context).or_else(|| (0..ius.len()).find(has_context))
    }
}

/// The nominal activities that have a place.
fn candidates_at(places: &[Places; ACTIVITIES]) -> ActivitySet {
    let all = places.iter().enumerate().filter(|(_, places)| !places.is_empty());
    all.map(|(nominal, _)| nominal).collect()
}

/// Why a context is wrong here: whether any of these nominal activities has it.
pub(super) fn context_reason(job: &Job<'_>, among: ActivitySet, context: Context) -> Reason {
    let has_context = |nominal: usize| {
        let activity = job.activities.get(nominal);
        activity.is_some_and(|activity| activity.ius.iter().any(|iu| iu.context == context))
    };
    if among.iter().any(has_context) { Reason::WrongOrder } else { Reason::WrongObject }
}
