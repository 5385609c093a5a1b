//! Knows what the worker did and what the PLC wanted, and holds every OK against both. It must be of a job that was right and whole, for the part
//! that lay at the bench then. It must be by the job that the PLC wanted for it.

use andon_tests::line::{Kept, Told};
use shm_schemas::Verdict;
use std::collections::HashMap;

/// An IU may be taken to begin or end so much sooner or later than the hand comes and goes.
const REACH_S: f64 = 3.0;
/// From what happened to the verdict on it, on a machine that does other things too, and from a command to its answer.
const LATE_NS: u64 = 1_000_000_000;

/// What the worker does over and over. Times are those of the recording, in seconds, which go on when it is repeated.
pub(crate) struct Recording {
    /// From when to when the hand is in the picture for each job that is right.
    pub(crate) right_s: Vec<(f64, f64)>,
    /// Its length.
    pub(crate) length_s: f64,
}

impl Recording {
    /// Whether this is the whole of a job that is right.
    fn is_right_and_whole(&self, began_s: f64, ended_s: f64) -> bool {
        let (from_s, to_s) =
            (began_s.rem_euclid(self.length_s), began_s.rem_euclid(self.length_s) + ended_s - began_s);
        let is_near = |seconds: f64, of: f64| (0.0..REACH_S).contains(&(seconds - of));
        self.right_s.iter().any(|(began_s, ended_s)| is_near(from_s, *began_s) && is_near(*ended_s, to_s))
    }
}

/// What is known beside the line.
pub(crate) struct Earned<'a> {
    pub(crate) recording: &'a Recording,
    pub(crate) told: &'a [Told],
    /// The verdicts that were heard as they were sent.
    pub(crate) heard: &'a [Verdict],
}

impl Earned<'_> {
    /// The OKs for jobs that were not earned, and why not.
    pub(crate) fn not(&self, rows: &[Kept]) -> Vec<String> {
        let heard: HashMap<_, _> =
            self.heard.iter().map(|verdict| ((verdict.stamp.epoch, verdict.stamp.seq), verdict)).collect();
        let mut found = Vec::new();
        let mut newest_end_ns = 0;
        for row in rows.iter().filter(|row| row.verdict.level == "job" && row.verdict.outcome == "ok") {
            let mut fail = |why: &str| found.push(format!("OK {why}: {row:?}"));
            if !self.recording.is_right_and_whole(row.began_s, row.ended_s) {
                fail("for a job that was not right and whole");
            }
            let Some(verdict) = heard.get(&(row.verdict.epoch, row.verdict.seq)) else {
                fail("that was never sent");
                continue;
            };
            let sent_ns = verdict.stamp.sent_ns;
            let began_ns = sent_ns.saturating_sub(verdict.decided_ns - verdict.began_ns);
            if began_ns + LATE_NS < newest_end_ns {
                fail("for work that had one");
            }
            newest_end_ns = sent_ns;
            if !self.lay_at_bench(&row.verdict.part, began_ns) {
                fail("for a part that did not lie at the bench");
            }
            if !self.was_wanted(row.job_id, began_ns, sent_ns) {
                fail("by a job that the PLC did not want");
            }
        }
        found
    }

    /// Whether this part lay there when a job began, from when the PLC told of it until the line had the next one.
    fn lay_at_bench(&self, part: &str, began_ns: u64) -> bool {
        let is_its_begin = |told: &Told| told.part == part;
        let is_its_end = |told: &Told| told.part != part && told.is_part_taken;
        // Before the PLC has said anything there is no part.
        part.is_empty() && self.told.first().is_none_or(|first| first.from_ns + LATE_NS > began_ns)
            || self.is_within(is_its_begin, is_its_end, began_ns, began_ns)
    }

    /// Whether the PLC wanted this job all the time. Before it says anything the line has the configured one.
    fn was_wanted(&self, job: u32, began_ns: u64, sent_ns: u64) -> bool {
        let is_its_begin = |told: &Told| told.job == job || told.job == 0;
        let is_its_end = |told: &Told| told.job != job && told.is_job_taken;
        self.is_within(is_its_begin, is_its_end, began_ns, sent_ns)
    }

    /// Whether a time lies between a start and the end that follows it.
    fn is_within(
        &self,
        is_begin: impl Fn(&Told) -> bool,
        is_end: impl Fn(&Told) -> bool,
        from_ns: u64,
        to_ns: u64,
    ) -> bool {
        let mut since_ns = None;
        for told in self.told {
            if is_end(told) {
                let was_within = since_ns.is_some_and(|since_ns| since_ns < from_ns + LATE_NS);
                if was_within && to_ns < told.from_ns + LATE_NS {
                    return true;
                }
                since_ns = None;
            } else if is_begin(told) {
                since_ns = since_ns.or(Some(told.from_ns));
            }
        }
        since_ns.is_some_and(|since_ns| since_ns < from_ns + LATE_NS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use andon_tests::line::Counted;
    use shm_schemas::Stamp;

    const S: u64 = 1_000_000_000;

    /// The worker is right from 5 s to 20 s of 40 s.
    fn recording() -> Recording {
        Recording { right_s: vec![(5.0, 20.0)], length_s: 40.0 }
    }

    /// The parts A and B take the jobs 1 and 2; B came after 30 s.
    fn told() -> Vec<Told> {
        let told = |at_s: u64, part: &str, is_part_taken, job, is_job_taken| Told {
            from_ns: at_s * S,
            part: part.into(),
            is_part_taken,
            job,
            is_job_taken,
        };
        vec![
            told(1, "A", false, 0, false),
            told(2, "A", true, 1, false),
            told(3, "A", true, 1, true),
            told(30, "B", false, 1, true),
            told(31, "B", true, 1, true),
            told(32, "B", true, 2, false),
            told(33, "B", true, 2, true),
        ]
    }

    /// What is said against an OK for this part by this job. It is on work of the recording that was sent at its end, and one more of 40 s later.
    fn said(part: &str, job_id: u32, began_s: u64, ended_s: u64) -> Vec<String> {
        let verdict =
            Counted { epoch: 1, seq: 1, level: "job".into(), outcome: "ok".into(), part: part.into() };
        let row = Kept { verdict, began_s: began_s as f64, ended_s: ended_s as f64, job_id };
        let stamp = Stamp { epoch: 1, seq: 1, sent_ns: ended_s * S, ..Stamp::default() };
        let sent = Verdict { stamp, began_ns: began_s * S, decided_ns: ended_s * S, ..Verdict::default() };
        Earned { recording: &recording(), told: &told(), heard: &[sent] }.not(&[row])
    }

    #[test]
    fn an_ok_for_the_whole_of_a_right_job_on_its_part_is_earned() {
        assert_eq!(said("A", 1, 6, 19), Vec::<String>::new());
        assert_eq!(said("B", 2, 46, 59), Vec::<String>::new());
    }

    #[test]
    fn an_ok_for_a_flawed_job_or_a_half_one_is_found() {
        assert!(said("A", 1, 25, 38)[0].contains("not right and whole"));
        assert!(said("A", 1, 12, 19)[0].contains("not right and whole"));
        assert!(said("A", 1, 6, 14)[0].contains("not right and whole"));
    }

    #[test]
    fn an_ok_for_a_part_that_has_gone_or_has_not_come_is_found() {
        assert!(said("A", 2, 46, 59)[0].contains("did not lie at the bench"));
        assert!(said("B", 1, 6, 19)[0].contains("did not lie at the bench"));
        assert!(said("", 1, 6, 19)[0].contains("did not lie at the bench"));
    }

    #[test]
    fn an_ok_by_another_job_than_the_wanted_one_is_found() {
        assert!(said("A", 2, 6, 19)[0].contains("did not want"));
        assert!(said("B", 1, 46, 59)[0].contains("did not want"));
    }
}
