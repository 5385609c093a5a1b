//! A hand that touches what a step moves, moves nothing and lets go has not begun that step: it corrects its grip, or has thought better of it.

use super::comparison::Memory;
use super::hand::HandJudge;
use super::progress::Progress;
use crate::set::ActivitySet;

impl<'a, M: Memory<'a>> HandJudge<'a, M> {
    /// Whether the hand is at the first IU of an activity, and has certainly not moved yet what that moves.
    pub(super) fn has_moved_nothing_yet(&self) -> bool {
        self.iu.is_some_and(|iu| iu.number == 0 && self.comparisons.has_moved_nothing(iu.extent))
    }

    /// The hand has let go of what it has not moved: that was no IU, and what it does next is another activity.
    pub(super) fn give_up(&mut self, progress: &mut Progress<'a>) {
        let Some(activity) = &mut self.activity else { return };
        activity.give_up();
        progress.set_no_step(activity.number);
        progress.set_underway(self.side, ActivitySet::EMPTY, ActivitySet::EMPTY);
    }
}
