//! What of a job was not seen, and why too little is known of it. A step whose part is out of sight looks like another step, or like none: it accuses
//! nobody.

use super::super::occlusion::{Cause, OcclusionLog};
use super::{Phase, Progress};
use crate::couple::Couples;
use crate::set::ActivitySet;
use crate::verdict::Reason;

impl Progress<'_> {
    /// Objects have moved without a hand. In the middle of a job that may be a part of it, or the next piece; before its first step, that step.
    pub(crate) fn set_moved_unseen(&mut self) {
        if !self.is_concluded() && self.state.activities > 0 && !self.is_matched() {
            if self.state.first_step().is_some() {
                self.note_unjudged(self.moved_unseen_cause(), None);
            } else {
                (self.state.is_start_seen, self.state.may_precede) = (false, self.all);
                self.set_doubtful();
            }
        }
    }

    /// The next job may have begun before the first touch that was seen.
    pub(crate) fn doubt_start(&mut self) {
        if self.is_concluded() {
            self.state.carried_over = self.all;
        }
    }

    /// Takes the objects that are out of sight.
    pub(crate) fn set_out_of_sight(&mut self, couples: &Couples) {
        let mut hidden = couples.ids(couples.out_of_sight).map(|id| self.job.object(id)).peekable();
        let object = hidden.peek().map_or(0, |object| object.id);
        let activities = hidden.fold(ActivitySet::EMPTY, |all, object| all | object.used_by);
        let never_seen = self.never_seen.map_or(activities, |before| before & activities);
        (self.never_seen, self.out_of_sight) = (Some(never_seen), activities);
        self.unseen |= never_seen;
        if !never_seen.is_empty() {
            self.overlooked_object = object;
        }
    }

    /// All that was done in the job was done by a hand that was not seen, or was not seen to act.
    pub(crate) fn set_unseen(&mut self) {
        self.state.left = self.all;
        self.set_unjudged(None, self.moved_unseen_cause());
    }

    /// The couples break off: the job may go on unseen, and what has not been done is not missing.
    pub(crate) fn break_off(&mut self) {
        (self.state.left, self.unseen) = (self.all, self.all);
        if !self.is_concluded() {
            self.state.phase = Phase::BrokenOff;
        }
    }

    /// The object never seen in this job that an activity with this `object` may also use: what that looks like is not known. It is 0 where it is not
    /// known which, and `None` where there is none.
    pub(crate) fn never_seen_with(&self, object: u16) -> Option<u16> {
        let never_seen = self.never_seen.unwrap_or_default();
        if never_seen.is_empty() {
            return None;
        }
        let activities = self.using(object) & never_seen;
        (!activities.is_empty()).then(|| self.used_by(self.overlooked_object, activities))
    }

    /// The activities that use this object.
    fn using(&self, object: u16) -> ActivitySet {
        self.activities_with(|ius| ius.iter().any(|iu| iu.context.involves(object)))
    }

    /// The object, if one of these activities uses it; otherwise 0.
    fn used_by(&self, object: u16, activities: ActivitySet) -> u16 {
        let is_used = object != 0 && self.using(object).intersects(activities);
        if is_used { object } else { 0 }
    }

    /// Why an activity that is missing may have been done all the same; or, where none is missing, why the job is not judged.
    pub(super) fn unseen_activity_cause(&self, activity: Option<usize>) -> Cause {
        match activity {
            _ if self.state.phase == Phase::BrokenOff => Reason::BrokenOff.into(),
            Some(activity) if self.used_by(self.overlooked_object, ActivitySet::of(activity)) != 0 => {
                Cause::object_not_seen(self.overlooked_object)
            }
            Some(activity) if !self.state.may_precede.contains(activity) => self.unseen_cause(),
            _ => Reason::BeginningNotSeen.into(),
        }
    }

    /// Why too little is known of the job: what was occluded or never came, or else its beginning.
    pub(crate) fn unseen_cause(&self) -> Cause {
        let beginning = if self.state.is_start_seen { Reason::Blind } else { Reason::BeginningNotSeen };
        self.main_cause().or(self.state.carried_on_cause).unwrap_or(beginning.into())
    }

    /// What was occluded or never came, if that is much.
    pub(super) fn main_cause(&self) -> Option<Cause> {
        OcclusionLog::main_cause(&self.occlusions, self.job.min_captured, self.persist_frames)
    }

    /// Why it is not known who moved objects: what was occluded or never came, or else that no hand was seen at them.
    fn moved_unseen_cause(&self) -> Cause {
        OcclusionLog::cause(&self.occlusions, self.job.min_captured).unwrap_or(Reason::HandNotSeen.into())
    }
}
