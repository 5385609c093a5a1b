//! How many pieces there were today, and how they came out.

use shm_schemas::{Verdict, VerdictLevel, VerdictOutcome};

/// The counts of one day.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Pieces {
    /// When the day began, nanoseconds since 1970 UTC.
    began_utc_ns: u64,
    pub(crate) good: u32,
    pub(crate) faulty: u32,
    pub(crate) not_judged: u32,
}

impl Pieces {
    /// The day that begins at this time is today.
    pub(crate) fn day(&mut self, began_utc_ns: u64) {
        if self.began_utc_ns != began_utc_ns {
            *self = Self { began_utc_ns, ..Self::default() };
        }
    }

    /// The same day, of which nothing was counted yet.
    pub(crate) fn uncounted(self) -> Self {
        Self { began_utc_ns: self.began_utc_ns, ..Self::default() }
    }

    /// Counts a verdict, if it is one on a piece of today.
    pub(crate) fn count(&mut self, verdict: &Verdict) {
        if verdict.level() != Ok(VerdictLevel::Job) || verdict.decided_utc_ns < self.began_utc_ns {
            return;
        }
        match verdict.outcome() {
            Ok(VerdictOutcome::Ok) => self.good += 1,
            Ok(VerdictOutcome::Anomaly) => self.faulty += 1,
            Ok(VerdictOutcome::NotJudged) | Err(_) => self.not_judged += 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::right;

    #[test]
    fn pieces_are_counted_from_the_begin_of_the_day_on() {
        let at = |decided_utc_ns| Verdict { decided_utc_ns, ..right(VerdictLevel::Job, 0) };
        let mut pieces = Pieces::default();
        pieces.day(100);
        for verdict in
            [at(99), at(100), at(150), Verdict { decided_utc_ns: 150, ..right(VerdictLevel::Iu, 0) }]
        {
            pieces.count(&verdict);
        }
        pieces.day(100);
        assert_eq!(pieces.good, 2);
        pieces.day(200);
        assert_eq!(pieces, Pieces { began_utc_ns: 200, ..Pieces::default() });
    }
}
