//! The piece that is being worked on, or the last one: which steps are done, and what is to be said of it.
//!
//! ```text
//!            first verdict                 verdict on the job
//!  waiting ----------------> under way ------------------------> ended
//!                                ^                                 |
//!                                +---------------------------------+
//!                                  the judge says that a job runs,
//!                                  or what comes is not simply right
//! ```
//!
//! Another job begins another piece: one that is under way is left, and one that has ended is told of until the next begins.

use shm_schemas::{NO_INDEX, PartId, Verdict, VerdictLevel, VerdictOutcome};

/// How a piece is, or was.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Standing {
    /// Nothing is wrong.
    Right,
    /// Something should be looked at.
    Noted,
    /// Something could not be judged.
    NotJudged,
    /// Something is wrong.
    Wrong,
}

impl Standing {
    fn of(verdict: &Verdict) -> Self {
        match verdict.outcome() {
            Ok(VerdictOutcome::Ok) if verdict.note == 0 => Self::Right,
            Ok(VerdictOutcome::Ok) => Self::Noted,
            Ok(VerdictOutcome::Anomaly) => Self::Wrong,
            // A number that this build does not know is a result that nobody can rely on.
            Ok(VerdictOutcome::NotJudged) | Err(_) => Self::NotJudged,
        }
    }
}

/// The piece.
#[derive(Clone, Debug, Default)]
pub(crate) struct Piece {
    /// The steps that have come, right or wrong.
    done: Vec<u16>,
    /// The step of the newest IU.
    running: Option<u16>,
    /// The first verdict of the worst kind: what follows from it is not told once more.
    cause: Option<Verdict>,
    /// The verdict on the job.
    ended: Option<Verdict>,
    /// The newest verdict of all.
    newest: Option<Verdict>,
}

impl Piece {
    /// Takes the next verdict. `is_running` is what the judge has said last: whether a job has begun and has not ended.
    pub(crate) fn take(&mut self, verdict: &Verdict, is_running: bool) {
        let is_another = |newest: Verdict| {
            newest.stamp.epoch != verdict.stamp.epoch || newest.model_hash != verdict.model_hash
        };
        let is_of_another = self.newest.is_some_and(is_another);
        // What lets go of the last part may come after the end.
        let is_next = self.ended.is_some() && (is_running || Standing::of(verdict) != Standing::Right);
        if is_of_another || is_next {
            *self = Self::default();
        }
        self.newest = Some(*verdict);
        if self.cause.is_none_or(|cause| Standing::of(&cause) < Standing::of(verdict)) {
            self.cause = Some(*verdict).filter(|verdict| Standing::of(verdict) != Standing::Right);
        }
        match verdict.level() {
            Ok(VerdictLevel::Iu) => self.running = step(verdict).or(self.running),
            Ok(VerdictLevel::Activity) => self.done.extend(step(verdict)),
            Ok(VerdictLevel::Job) => self.ended = Some(*verdict),
            Err(_) => (),
        }
    }

    /// A job has begun.
    pub(crate) fn begin(&mut self) {
        if self.ended.is_some() {
            *self = Self::default();
        }
    }

    /// It is left before its end: another job is in force.
    pub(crate) fn leave(&mut self) {
        if self.ended.is_none() {
            *self = Self::default();
        }
    }

    /// How it is; of a piece that has ended, how that was judged.
    pub(crate) fn standing(&self) -> Standing {
        let worst = self.cause.as_ref().map_or(Standing::Right, Standing::of);
        match self.ended.as_ref().map(Standing::of) {
            None => worst,
            // A piece is right although one of its notes should be looked at.
            Some(Standing::Right) if worst == Standing::Noted => worst,
            Some(ended) => ended,
        }
    }

    /// What is to be told of it: the first verdict that made it what it is.
    pub(crate) fn cause(&self) -> Option<&Verdict> {
        let of_standing = |verdict: &&Verdict| Standing::of(verdict) == self.standing();
        self.cause
            .as_ref()
            .filter(of_standing)
            .or(self.ended.as_ref())
            .filter(|verdict| Standing::of(verdict) != Standing::Right)
    }

    /// When it ended, CLOCK_MONOTONIC.
    pub(crate) fn ended_ns(&self) -> Option<u64> {
        self.ended.map(|ended| ended.stamp.sent_ns)
    }

    /// Whether any of it has come.
    pub(crate) fn has_begun(&self) -> bool {
        self.newest.is_some() && self.ended.is_none()
    }

    /// The part that is worked on, or of which a fault is told.
    pub(crate) fn part(&self) -> Option<PartId> {
        self.newest.filter(|_| self.ended.is_none() || self.cause().is_some()).map(|newest| newest.part)
    }

    /// The step that is under way, or should come, and the one after it, of a job of `count` steps.
    pub(crate) fn steps(&self, count: u16) -> [Option<u16>; 2] {
        if self.ended.is_some() {
            let first = |step: u16| Some(step).filter(|step| *step < count);
            return [first(0), first(1)];
        }
        let open = |step: &u16| !self.done.contains(step);
        let running = self.running.filter(|step| *step < count).filter(open);
        let now = running.or_else(|| (0..count).find(open));
        let next = (0..count).find(|step| open(step) && now.is_some_and(|now| *step != now));
        [now, next]
    }
}

fn step(verdict: &Verdict) -> Option<u16> {
    Some(verdict.nearest).filter(|step| *step != NO_INDEX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::{right, wrong};
    use shm_schemas::{VerdictNote, VerdictReason};

    /// The verdict with this number, by which it is known again: some of its values are no numbers, which are equal to nothing.
    fn numbered(seq: u64, mut verdict: Verdict) -> Verdict {
        verdict.stamp.seq = seq;
        verdict
    }

    fn told(piece: &Piece) -> (Standing, Option<u64>) {
        (piece.standing(), piece.cause().map(|cause| cause.stamp.seq))
    }

    fn after(verdicts: &[Verdict]) -> Piece {
        let mut piece = Piece::default();
        verdicts.iter().for_each(|verdict| piece.take(verdict, true));
        piece
    }

    #[test]
    fn the_step_under_way_is_that_of_the_newest_iu_and_else_the_first_that_has_not_come() {
        use VerdictLevel::{Activity, Iu, Job};
        let steps = |verdicts: &[Verdict]| after(verdicts).steps(3);
        assert_eq!(steps(&[]), [Some(0), Some(1)]);
        assert_eq!(steps(&[right(Iu, 1)]), [Some(1), Some(0)]);
        assert_eq!(steps(&[right(Iu, 0), right(Activity, 0)]), [Some(1), Some(2)]);
        assert_eq!(steps(&[0, 1].map(|step| right(Activity, step))), [Some(2), None]);
        assert_eq!(steps(&[0, 1, 2].map(|step| right(Activity, step))), [None, None]);
        assert_eq!(steps(&[right(Activity, 0), right(Job, NO_INDEX)]), [Some(0), Some(1)]);
        assert_eq!(after(&[]).steps(0), [None, None]);
    }

    #[test]
    fn the_first_fault_is_told_until_the_next_piece_begins() {
        let unseen = Verdict { outcome: VerdictOutcome::NotJudged.code(), ..wrong(VerdictReason::Blind) };
        let follows = wrong(VerdictReason::NotCompleted);
        let job = Verdict { level: VerdictLevel::Job.code(), ..follows };
        let first = numbered(2, wrong(VerdictReason::Motion));
        let mut piece = after(&[numbered(1, unseen), first, numbered(3, follows), numbered(4, job)]);
        assert_eq!(told(&piece), (Standing::Wrong, Some(2)));
        piece.take(&numbered(5, right(VerdictLevel::Iu, 1)), false);
        assert_eq!(told(&piece), (Standing::Wrong, Some(2)), "the last part is let go");
        piece.begin();
        assert_eq!(told(&piece), (Standing::Right, None));
    }

    #[test]
    fn a_piece_is_what_its_job_was_judged_to_be() {
        let unseen = Verdict { outcome: VerdictOutcome::NotJudged.code(), ..wrong(VerdictReason::Blind) };
        let end = numbered(2, right(VerdictLevel::Job, NO_INDEX));
        assert_eq!(told(&after(&[numbered(1, unseen), end])), (Standing::Right, None));
        let note = Verdict { note: VerdictNote::Again.code(), ..right(VerdictLevel::Activity, 0) };
        assert_eq!(told(&after(&[numbered(1, note), end])), (Standing::Noted, Some(1)));
        let left_out = Verdict { level: VerdictLevel::Job.code(), ..wrong(VerdictReason::NotCompleted) };
        assert_eq!(told(&after(&[numbered(1, left_out)])), (Standing::Wrong, Some(1)));
    }

    #[test]
    fn another_job_begins_another_piece_and_what_has_ended_is_told_until_then() {
        let mut piece = after(&[right(VerdictLevel::Activity, 0), wrong(VerdictReason::Motion)]);
        piece.leave();
        assert_eq!((told(&piece), piece.steps(2)), ((Standing::Right, None), [Some(0), Some(1)]));
        let end = Verdict { level: VerdictLevel::Job.code(), ..wrong(VerdictReason::NotCompleted) };
        let mut piece = after(&[numbered(1, end)]);
        piece.leave();
        assert_eq!(told(&piece), (Standing::Wrong, Some(1)));
        piece.take(&Verdict { model_hash: 8, ..right(VerdictLevel::Iu, 0) }, false);
        assert_eq!(told(&piece), (Standing::Right, None));
    }

    #[test]
    fn a_judge_that_starts_again_begins_another_piece() {
        let mut piece = after(&[wrong(VerdictReason::Motion)]);
        let mut later = right(VerdictLevel::Iu, 0);
        later.stamp.epoch = 9;
        piece.take(&later, true);
        assert_eq!(told(&piece), (Standing::Right, None));
    }
}
