//! Holds what the judge has sent, what the journal has and what the PLC has counted against each other.

use andon_tests::line::{Counted, Kept, Line, account, kept};
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashSet};

/// What the worker does over and over: a job that is right, and one with a flaw.
pub(crate) struct Recording {
    /// The job with the flaw begins after the one that is right, in seconds.
    pub(crate) flawed_from_s: f64,
    /// Both together.
    pub(crate) length_s: f64,
}

impl Recording {
    /// Whether a job that began at this time of the recording, which goes on when it is repeated, has the flaw.
    fn is_flawed(&self, began_s: f64) -> bool {
        began_s.rem_euclid(self.length_s) >= self.flawed_from_s
    }
}

/// Everything in which they differ, and every job with a flaw that was OK.
pub(crate) fn differences(line: &Line, sent: &[(u64, u64)], recording: &Recording) -> Vec<String> {
    let (rows, counted) = (kept(line), account(line));
    let journal: HashSet<_> = rows.iter().map(|row| key(&row.verdict)).collect();
    let mut found: Vec<String> = sent
        .iter()
        .filter(|key| !journal.contains(key))
        .map(|key| format!("lost to the journal: {key:?}"))
        .collect();
    found.extend(differing(rows.iter().map(|row| &row.verdict), counted.iter().map(|(_, result)| result)));
    let numbers: Vec<u32> = counted.iter().map(|(sequence, _)| *sequence).collect();
    let jumps = numbers.windows(2).filter(|two| two[1] != two[0] + 1);
    found.extend(jumps.map(|two| format!("the PLC was given result {} after {}", two[1], two[0])));
    let is_false = |row: &&Kept| {
        row.verdict.level == "job" && row.verdict.outcome == "ok" && recording.is_flawed(row.began_s)
    };
    found.extend(rows.iter().filter(is_false).map(|row| format!("OK for a job with a flaw: {row:?}")));
    found
}

/// How many there are of what.
pub(crate) fn counts(line: &Line, sent: &[(u64, u64)]) -> Value {
    let rows = kept(line);
    let mut of_jobs = BTreeMap::new();
    for row in rows.iter().filter(|row| row.verdict.level == "job") {
        *of_jobs.entry(row.verdict.outcome.clone()).or_insert(0) += 1;
    }
    let parts: HashSet<_> =
        rows.iter().map(|row| &row.verdict.part).filter(|part| !part.is_empty()).collect();
    json!({
        "sent_and_heard": sent.len(),
        "in_the_journal": rows.len(),
        "counted_by_the_plc": account(line).len(),
        "gaps": line.journal().gaps(),
        "jobs": of_jobs,
        "parts": parts.len(),
    })
}

/// What the PLC has counted must be what the journal has, in its order.
fn differing<'v>(
    journal: impl Iterator<Item = &'v Counted> + Clone,
    plc: impl Iterator<Item = &'v Counted> + Clone,
) -> Vec<String> {
    let mut times: BTreeMap<(u64, u64), (usize, usize)> = BTreeMap::new();
    journal.clone().for_each(|row| times.entry(key(row)).or_default().0 += 1);
    plc.clone().for_each(|result| times.entry(key(result)).or_default().1 += 1);
    let unequal = times.iter().filter(|(_, times)| **times != (1, 1));
    let mut found: Vec<String> = unequal
        .map(|(key, (rows, results))| {
            format!("{key:?} is {rows} times in the journal, {results} times with the PLC")
        })
        .collect();
    if found.is_empty() {
        let others = journal.zip(plc).filter(|(row, result)| row != result);
        found.extend(others.map(|(row, result)| format!("the journal has {row:?}, the PLC {result:?}")));
    }
    found
}

fn key(verdict: &Counted) -> (u64, u64) {
    (verdict.epoch, verdict.seq)
}
