//! A hand that touches what a step moves, moves nothing and lets go has not begun that step. It corrects its grip, or has thought better of it. One
//! that takes again what it has just put down, and lets go of it, puts it right. It goes on with the last IU of what it has done.
//!
//! While a touch that moves nothing was a step, 9 of 60 right runs by feel were accused. Before what was done could be put right, it was 9 of 90. Now
//! it is 2 of 45, and 3 of 90 with a hand that is lost for two seconds.

use super::comparison::Memory;
use super::hand::{Finding, HandJudge};
use super::observation::IuObservation;
use super::progress::Progress;
use crate::couple::Context;
use crate::input::Side;
use crate::job::Job;
use crate::set::ActivitySet;
use crate::verdict::Outcome;

/// The last IU of what a hand has done, which goes on where the hand puts that right.
#[derive(Clone, Copy, Debug)]
pub(super) struct LastIu {
    pub(super) context: Context,
    /// How far it moves at most, in metres.
    max_path_m: f32,
}

impl LastIu {
    /// That of a nominal activity which this hand has done. `None` where a touch in the same context may be a whole activity.
    pub(super) fn of(job: &Job<'_>, nominal: usize, side: Side) -> Option<Self> {
        let last = job.activities.get(nominal)?.ius.last()?;
        let is_alone = |ius: &[_]| ius.len() == 1;
        let mut activities = job.activities.iter().map(|activity| activity.ius);
        let is_whole = activities.any(|ius| is_alone(ius) && ius[0].context == last.context);
        let context = last.context.by_hand(side);
        (!is_whole).then_some(Self { context, max_path_m: last.measures.path_m.max })
    }

    fn goes_on(self, context: Context, observation: IuObservation) -> bool {
        self.context == context && observation.measures.path_m <= self.max_path_m
    }
}

impl<'a, M: Memory<'a>> HandJudge<'a, M> {
    /// Whether the hand is at the first IU of an activity, and may not have begun it.
    pub(super) fn may_give_up(&self) -> bool {
        self.iu.is_some_and(|iu| iu.number == 0 && self.may_be_no_step(iu.context, iu.observation))
    }

    /// Whether an IU in this context may be no step, because it moves nothing or puts right what was done.
    fn may_be_no_step(&self, context: Context, observation: IuObservation) -> bool {
        self.comparisons.has_moved_nothing(observation)
            || self.last_done.is_some_and(|last| last.goes_on(context, observation))
    }

    /// The first IU has ended, and the hand goes on in the `next` context, if any comes. Whether it was none, or may have been because not all of it was
    /// seen; then the activity is not judged. What the hand does next is another one.
    pub(super) fn gives_up(
        &mut self,
        observation: IuObservation,
        next: Option<Context>,
        progress: &mut Progress<'a>,
    ) -> bool {
        let Some((open, activity)) = self.iu.zip(self.activity.as_ref()) else { return false };
        let is_whole = observation.assumed == 0 && observation.hidden() == 0.0 && !observation.may_be_part;
        let is_seen = is_whole && !open.is_concluded;
        let is_first = open.number == 0 && !activity.is_concluded;
        if !is_first
            || !self.may_be_no_step(open.context, observation)
            || is_seen && next != Some(Context::IDLE)
        {
            return false;
        }
        if !is_seen {
            self.conclude_unseen(progress);
            let cause = self.unseen_cause(progress);
            let nearest = self.activity.as_ref().and_then(|activity| activity.nearest);
            self.doubt.may_be_remainder = true;
            progress.set_doubtful();
            self.conclude_activity(Finding::of(Outcome::NotJudged, cause, nearest), false, progress);
        }
        let Some(activity) = &mut self.activity else { return true };
        activity.give_up();
        progress.give_up(activity.number);
        progress.set_underway(self.side, ActivitySet::EMPTY, Some(ActivitySet::EMPTY));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::{Bounds, Range};
    use crate::job::{LocalCost, MeasureBounds, NominalActivity, NominalIu};
    use crate::segment::Measures;

    fn iu(context: [u16; 4], max_path_m: f32) -> NominalIu<'static> {
        let any = Bounds { min: 0, max: u32::MAX };
        NominalIu {
            context: Context(context),
            reference: &[],
            threshold: 0.0,
            frames: any,
            reversals: any,
            measures: MeasureBounds { path_m: Range { min: 0.0, max: max_path_m }, ..MeasureBounds::ANY },
        }
    }

    #[test]
    fn a_hand_puts_right_what_it_has_done_no_farther_than_its_last_iu_goes_and_a_whole_step_is_no_correction()
    {
        let (polishing, carrying) = ([iu([2, 5, 5, 6], 1.0), iu([2, 5, 0, 0], 0.4)], [iu([2, 5, 0, 0], 0.4)]);
        let last = |activities: &[NominalActivity<'_>]| {
            let job = Job {
                activities,
                laws: &[],
                objects: &[],
                passive_contacts: &[],
                cost: LocalCost::Circular { bins: 8 },
                max_slowdown: 2.0,
                has_free_ends: true,
                min_captured: 0.0,
            };
            LastIu::of(&job, 0, Side::Right)
        };
        let step = |ius| NominalActivity { activity: 0, ius };
        let goes_on = |context, path_m| {
            let observation = IuObservation {
                measures: Measures { path_m, ..Measures::default() },
                ..IuObservation::default()
            };
            last(&[step(&polishing)]).is_some_and(|last| last.goes_on(Context(context), observation))
        };
        assert!(goes_on([1, 5, 0, 0], 0.3), "by this hand");
        assert!(!goes_on([1, 5, 0, 0], 0.5) && !goes_on([1, 5, 5, 6], 0.3) && !goes_on([2, 5, 0, 0], 0.3));
        assert!(last(&[step(&polishing), step(&carrying)]).is_none());
    }
}
