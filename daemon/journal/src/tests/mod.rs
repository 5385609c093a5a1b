//! Tests of the journal, by subject.
#![allow(clippy::unwrap_used)]

mod account;
mod faults;
mod history;
mod retention;
mod versions;
mod written;

use super::*;
use shm_schemas::{VerdictLevel, VerdictOutcome};

const KEEP: Retention = Retention { keep_days: 36_500, keep_mb: 1000, without: &[] };
const DAY_NS: u64 = 86_400_000_000_000;

fn verdict(epoch: u64, seq: u64) -> Verdict {
    let mut verdict = Verdict {
        level: VerdictLevel::Activity.code(),
        outcome: VerdictOutcome::Ok.code(),
        job_id: 3,
        threshold: 2.5,
        activity: 1,
        nearest: 0,
        broken_activity: 0,
        decided_utc_ns: seq * 1_000_000_000,
        ..Verdict::NONE
    };
    verdict.station[..6].copy_from_slice(b"bench1");
    (verdict.stamp.epoch, verdict.stamp.seq) = (epoch, seq);
    verdict
}

struct Bench {
    dir: tempfile::TempDir,
    journal: Journal,
}

impl Bench {
    fn new() -> Self {
        Self::keeping(KEEP)
    }

    fn keeping(retention: Retention) -> Self {
        let dir = tempfile::tempdir().unwrap();
        let journal = Journal::open(&dir.path().join("j.sqlite"), retention).unwrap();
        Self { dir, journal }
    }

    fn path(&self) -> PathBuf {
        self.dir.path().join("j.sqlite")
    }

    fn send(&mut self, epoch: u64, seqs: impl IntoIterator<Item = u64>) {
        for seq in seqs {
            self.append(&verdict(epoch, seq)).unwrap();
        }
    }

    /// Writes one verdict, as the role does when one has arrived.
    fn append(&mut self, verdict: &Verdict) -> Result<(), JournalError> {
        self.journal.push(verdict);
        self.journal.flush()
    }

    fn entries(&self, query: &Query) -> Vec<Entry> {
        let mut entries = Vec::new();
        let collect = |entry| {
            entries.push(entry);
            Ok(())
        };
        History::open(&self.path()).unwrap().visit(query, collect).unwrap();
        entries
    }

    /// One line per entry: `v EPOCH SEQ` or `WHY EPOCH FIRST-LAST`.
    fn lines(&self, query: &Query) -> Vec<String> {
        self.entries(query)
            .iter()
            .map(|entry| match entry {
                Entry::Verdict(record) => format!("v {} {}", record.stamp.epoch, record.stamp.seq),
                Entry::NotWatching(blind) => {
                    format!("blind {} {:?} {}", blind.began_utc_ns, blind.ended_utc_ns, blind.why)
                }
                Entry::Gap(gap) => {
                    let last = gap.last_seq.map_or("?".into(), |last| last.to_string());
                    format!("{} {} {}-{last}", gap.why, gap.epoch, gap.first_seq)
                }
            })
            .collect()
    }
}
