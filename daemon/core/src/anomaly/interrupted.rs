//! A hand corrects its grip: it lets go in the middle of an activity and takes the same part again, in the same context. The IU goes on, and has its
//! verdict only when something else begins, unless it is certainly wrong before. Where the job has the same IU twice, it counts twice.

use super::activity::{Against, Step};
use super::comparison::Memory;
use super::hand::{HandJudge, OpenIu};
use super::observation::IuObservation;
use super::progress::Progress;
use crate::couple::Context;
use crate::segment::Iu;

/// An IU of which the hand has let go in the middle of its activity.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interrupted {
    pub(super) open: OpenIu,
    /// What is known of it if it is over.
    pub(super) observation: IuObservation,
    pub(super) iu: Iu,
}

impl<'a, M: Memory<'a>> HandJudge<'a, M> {
    /// Whether the hand, which lets go, is certainly not at the end of its activity, and no IU in the same context comes next.
    pub(super) fn may_be_interrupted(&self, progress: &Progress<'a>) -> bool {
        let Some((open, activity)) = self.iu.zip(self.activity.as_ref()) else { return false };
        let is_of_step = matches!(activity.step, Step::Shown(_)) && activity.against == Against::Candidates;
        let is_at_end = !activity.may_have_come(progress.job).is_empty()
            || activity.matched(self.side, progress).is_some();
        is_of_step
            && open.is_certain
            && open.context.is_touch()
            && !activity.is_concluded
            && !is_at_end
            && !activity.goes_on_with(progress.job, open.context)
    }

    /// The hand has taken again what it had let go of.
    pub(super) fn resume_iu(&mut self) {
        self.iu = self.interrupted.take().map(|interrupted| OpenIu { ended_ns: None, ..interrupted.open });
    }

    /// Something else begins than the IU of which the hand has let go, so that one is over.
    pub(super) fn end_interrupted(&mut self, progress: &mut Progress<'a>) {
        let Some(Interrupted { open, observation, iu }) = self.interrupted.take() else { return };
        self.iu = Some(open);
        self.decide_at_end(observation, Some(Context::IDLE), progress);
        self.close_iu(&iu, progress);
    }
}
