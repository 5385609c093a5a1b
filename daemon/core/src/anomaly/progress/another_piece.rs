//! Whether there was time, while nobody watched, to end the piece and to begin another one.

use super::Progress;
use crate::capacity::HANDS;
use crate::couple::{Couple, Couples, Unseen};
use crate::input::Side;
use crate::job::{NominalActivity, NominalIu};
use crate::set::ActivitySet;

impl Progress<'_> {
    /// Takes the next couples, which come as many frames after those before. Nobody watches where no frame came, or one that shows neither a hand nor all
    /// that lay on the bench.
    pub(crate) fn watch(&mut self, couples: &Couples, frames: u32) {
        let is_any_seen = couples.hands.iter().any(Couple::is_hand_seen) || !couples.lacks(Unseen::BENCH);
        let is_watched = !couples.lacks(Unseen::FRAME) && is_any_seen;
        self.unwatched = self.unwatched.saturating_add(frames - u32::from(is_watched));
    }

    /// A hand begins the IU with this number of one of these nominal activities. It may belong to another piece than what came before. For that, nobody
    /// watched for as long as the quickest run needs to end this piece and to come to it in another, in any order.
    pub(crate) fn note_another_piece(&mut self, side: Side, nominal: ActivitySet, ius: usize) {
        let fits = |nominal: &NominalActivity<'_>| self.unwatched >= self.exchange(side, nominal, ius);
        let all = self.job.activities;
        if !self.is_concluded() && nominal.iter().filter_map(|nominal| all.get(nominal)).any(fits) {
            self.note_unjudged(self.unseen_cause(), None);
        }
    }

    /// Whether nobody watched for as long as a step takes with which a job may begin.
    pub(super) fn may_have_begun_unwatched(&self) -> bool {
        let first = self.first().iter().filter_map(|activity| self.quickest(activity));
        let quickest = first.map(|(_, frames)| frames.max(2 * self.persist_frames)).min();
        quickest.is_some_and(|frames| self.unwatched >= frames)
    }

    /// The minimum number of frames in which this piece is ended and another one begun, up to an IU of a nominal activity. Both hands may work at
    /// once, and what the other hand is in the middle of may be about to end.
    fn exchange(&self, side: Side, nominal: &NominalActivity<'_>, ius: usize) -> u32 {
        let activity = ActivitySet::of(nominal.activity.into());
        let is_left = self.state.required.without(self.tried()).intersects(activity);
        let left =
            self.state.required.without(self.tried() | self.state.underway[side.other().index()] | activity);
        let (came, rest) = nominal.ius.split_at(ius.min(nominal.ius.len()));
        let mut frames = [0u32; HANDS];
        frames[side.index()] = quickest(came).saturating_add(if is_left { quickest(rest) } else { 0 });
        for activity in left.iter() {
            if let Some((hand, worked)) = self.quickest(activity) {
                frames[hand] = frames[hand].saturating_add(worked);
            }
        }
        // What begins and ends sooner than two changes are believed is no work.
        frames.into_iter().fold(2 * self.persist_frames, u32::max)
    }

    /// The hand that was shown to do an activity, and in how few frames it may have.
    fn quickest(&self, activity: usize) -> Option<(usize, u32)> {
        let variants = self.job.activities.iter().filter(|nominal| usize::from(nominal.activity) == activity);
        let hand =
            |nominal: &NominalActivity<'_>| usize::from(nominal.ius[0].context.0[0] == Side::Left as u16);
        variants.map(|nominal| (hand(nominal), quickest(nominal.ius))).min_by_key(|(_, frames)| *frames)
    }
}

/// In how few frames these IUs may have come.
pub(crate) fn quickest(ius: &[NominalIu<'_>]) -> u32 {
    ius.iter().map(NominalIu::quickest).fold(0, u32::saturating_add)
}
