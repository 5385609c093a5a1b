//! A step that was not shown and does the work of one that was, with another part.

use super::comparison::Memory;
use super::hand::HandJudge;
use super::progress::{Progress, quickest};
use crate::segment::Iu;

impl<'a, M: Memory<'a>> HandJudge<'a, M> {
    /// An IU has ended that was seen well. Where it does the work of a step that must come now, its part is wrong. Only strokes tell such work from a
    /// part that is held or put aside; without them it shows when the step is missed.
    pub(super) fn compare_but_for_part(&mut self, iu: &Iu, progress: &mut Progress<'a>) {
        let Some((open, activity)) = self.iu.zip(self.activity.as_mut()) else { return };
        let (job, number) = (progress.job, usize::from(open.number));
        activity.compare_but_for_part(number, iu.context);
        let shown = |nominal: usize| &job.activities[nominal].ius[number];
        let has_worked = |nominal: &usize| {
            let ius = job.activities[*nominal].ius;
            // The runs do not show how the other part would meet what the step's own one meets.
            let is_all = !iu.context.is_pair() && number == 0;
            let is_partner = ius.iter().any(|shown| shown.context.involves(iu.context.0[1]));
            let frames = if is_all { quickest(ius) } else { ius[number].quickest() };
            (iu.context.is_pair() || is_all && !is_partner) && iu.frames >= frames
        };
        for nominal in activity.like.iter().filter(has_worked) {
            progress.note_instead(nominal);
        }
        let has_stroked = |nominal: &usize| {
            let strokes = shown(*nominal).reversals.min;
            strokes > 0 && iu.measures.reversals >= strokes && iu.frames >= shown(*nominal).quickest()
        };
        if let Some(nominal) = activity.like.iter().find(has_stroked) {
            progress.set_done_instead(self.side, activity.number, nominal);
        }
    }
}
