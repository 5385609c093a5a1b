//! How often something was wrong, and when nobody watched: the last eight hours in steps of ten minutes.
//!
//! An alarm is the first fault of a piece. What follows from it is no further alarm.

use std::collections::{BTreeMap, VecDeque};

use shm_schemas::{Verdict, VerdictLevel, VerdictOutcome};

use crate::told::fault_key;

/// One step of the chart, nanoseconds.
pub(crate) const STEP_NS: u64 = 600_000_000_000;
/// Eight hours.
pub(crate) const STEPS: usize = 48;
const SHIFT_NS: u64 = STEP_NS * STEPS as u64;

/// Alarms that are kept: a line on which every piece is wrong has fewer in a shift.
const MOST: usize = 10_000;

/// Begin and end of a time, nanoseconds since 1970 UTC.
pub(crate) type Span = [u64; 2];

/// What happened in the last hours. All times are nanoseconds since 1970 UTC.
#[derive(Debug, Default)]
pub(crate) struct Shift {
    now_utc_ns: u64,
    /// When each alarm was, and which fault.
    alarms: VecDeque<(u64, String)>,
    /// The start of the judge that the newest verdict is of, and whether its piece has had its alarm.
    piece: (u64, bool),
    unwatched: Vec<Span>,
    /// Since when nobody watches.
    stopped: Option<u64>,
}

impl Shift {
    /// The time is now this. True where another minute has begun.
    pub(crate) fn clock(&mut self, now_utc_ns: u64) -> bool {
        const MINUTE_NS: u64 = 60_000_000_000;
        let is_another = self.now_utc_ns / MINUTE_NS != now_utc_ns / MINUTE_NS;
        self.now_utc_ns = now_utc_ns;
        is_another
    }

    /// No verdict has come yet.
    pub(crate) fn forget_alarms(&mut self) {
        self.alarms.clear();
        self.piece = (0, false);
    }

    /// The next verdict.
    pub(crate) fn take(&mut self, verdict: &Verdict) {
        let (epoch, is_wrong) = self.piece;
        let was_wrong = is_wrong && epoch == verdict.stamp.epoch;
        let is_fault = verdict.outcome() == Ok(VerdictOutcome::Anomaly);
        if is_fault && !was_wrong {
            self.alarms.truncate(MOST - 1);
            self.alarms.push_front((verdict.decided_utc_ns, fault_key(verdict).unwrap_or_default()));
        }
        let has_ended = verdict.level() == Ok(VerdictLevel::Job);
        self.piece = (verdict.stamp.epoch, !has_ended && (was_wrong || is_fault));
    }

    /// A time in which nobody watched.
    pub(crate) fn add_unwatched(&mut self, span: Span) {
        self.unwatched.push(span);
    }

    /// Whether somebody watches, from now on.
    pub(crate) fn watch(&mut self, is_watched: bool) {
        match (is_watched, self.stopped) {
            (true, Some(began)) => {
                self.unwatched.push([began, self.now_utc_ns]);
                self.unwatched.retain(|[_, end]| *end >= self.now_utc_ns.saturating_sub(SHIFT_NS));
                self.stopped = None;
            }
            (false, None) => self.stopped = Some(self.now_utc_ns),
            _ => (),
        }
    }

    /// When the chart begins: its last step is the one that lasts.
    pub(crate) fn began(&self) -> u64 {
        (self.now_utc_ns / STEP_NS + 1) * STEP_NS - SHIFT_NS.min(self.now_utc_ns / STEP_NS * STEP_NS)
    }

    fn of_shift(&self) -> impl Iterator<Item = &(u64, String)> {
        let began = self.began();
        self.alarms.iter().filter(move |(at, _)| *at >= began)
    }

    /// How many alarms there were in each step.
    pub(crate) fn counts(&self) -> [usize; STEPS] {
        let mut counts = [0; STEPS];
        for (at, _) in self.of_shift() {
            let step = ((at - self.began()) / STEP_NS) as usize;
            counts[step.min(STEPS - 1)] += 1;
        }
        counts
    }

    /// The faults and how many alarms were of each, the most frequent first.
    pub(crate) fn faults(&self) -> Vec<(&str, usize)> {
        let mut counts = BTreeMap::<&str, usize>::new();
        for (_, fault) in self.of_shift() {
            *counts.entry(fault).or_default() += 1;
        }
        let mut faults: Vec<_> = counts.into_iter().collect();
        faults.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        faults
    }

    /// The times in which nobody watched, one after the other.
    pub(crate) fn unwatched(&self) -> Vec<Span> {
        let (began, now) = (self.began(), self.now_utc_ns);
        let lasting = self.stopped.map(|since| [since, now]);
        let mut spans: Vec<Span> = self.unwatched.iter().copied().chain(lasting).collect();
        spans.sort_unstable();
        let mut apart = Vec::<Span>::new();
        for [from, to] in
            spans.into_iter().map(|[from, to]| [from.max(began), to]).filter(|[from, to]| to > from)
        {
            match apart.last_mut() {
                Some([_, end]) if from <= *end => *end = to.max(*end),
                _ => apart.push([from, to]),
            }
        }
        apart
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::{right, wrong};
    use shm_schemas::VerdictReason;

    /// A morning.
    const NOW: u64 = 3000 * STEP_NS + STEP_NS / 2;

    fn at(decided_utc_ns: u64, verdict: Verdict) -> Verdict {
        Verdict { decided_utc_ns, ..verdict }
    }

    fn shift() -> Shift {
        let mut shift = Shift::default();
        assert!(shift.clock(NOW));
        shift
    }

    #[test]
    fn a_piece_has_one_alarm_and_the_most_frequent_fault_is_the_first() {
        let mut shift = shift();
        let motion = wrong(VerdictReason::Motion);
        let whole = |verdict| Verdict { level: VerdictLevel::Job.code(), ..verdict };
        let order = wrong(VerdictReason::WrongOrder);
        for verdict in [
            at(NOW - STEP_NS, order),
            at(NOW - STEP_NS, motion),
            at(NOW - STEP_NS, whole(motion)),
            at(NOW - STEP_NS, motion),
            at(NOW, right(VerdictLevel::Job, 0)),
            at(NOW, motion),
        ] {
            shift.take(&verdict);
        }
        let counts = shift.counts();
        assert_eq!((counts[STEPS - 2], counts[STEPS - 1], counts.iter().sum::<usize>()), (2, 1, 3));
        assert_eq!(shift.faults(), [("fault.Motion", 2), ("fault.WrongOrder", 1)]);
        let mut later = motion;
        later.stamp.epoch = 9;
        shift.take(&at(NOW, later));
        assert_eq!(shift.counts()[STEPS - 1], 2, "the judge has started again");
    }

    #[test]
    fn what_was_before_the_shift_is_in_no_step() {
        let mut shift = shift();
        shift.take(&at(NOW - SHIFT_NS, wrong(VerdictReason::Motion)));
        shift.add_unwatched([NOW - 2 * SHIFT_NS, NOW - SHIFT_NS]);
        assert_eq!((shift.counts(), shift.faults().len(), shift.unwatched().len()), ([0; STEPS], 0, 0));
        assert_eq!(shift.began() + SHIFT_NS, NOW + STEP_NS / 2);
        assert_eq!(Shift::default().counts(), [0; STEPS]);
    }

    #[test]
    fn times_that_overlap_are_one_and_what_lasts_goes_on_until_now() {
        let mut shift = shift();
        shift.watch(false);
        shift.clock(NOW + 5);
        for span in [[NOW - 9, NOW - 7], [NOW - 8, NOW - 2], [NOW - 1, NOW + 1]] {
            shift.add_unwatched(span);
        }
        assert_eq!(shift.unwatched(), [[NOW - 9, NOW - 2], [NOW - 1, NOW + 5]]);
        shift.watch(true);
        shift.clock(NOW + 7);
        assert_eq!(shift.unwatched().last(), Some(&[NOW - 1, NOW + 5]));
    }
}
