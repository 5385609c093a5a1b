//! Holds what the judge has sent, what the journal has and what the PLC has counted against each other.

use crate::earned::{Earned, Recording};
use andon_tests::line::{Counted, Line, account, kept, told};
use serde_json::{Value, json};
use shm_schemas::Verdict;
use std::collections::{BTreeMap, HashSet};

/// Everything in which they differ, and every OK that no part has earned.
pub(crate) fn differences(line: &Line, heard: &[Verdict], recording: &Recording) -> Vec<String> {
    let (rows, counted) = (kept(line), account(line));
    let journal: HashSet<_> = rows.iter().map(|row| key(&row.verdict)).collect();
    let mut found: Vec<String> = heard
        .iter()
        .map(|verdict| (verdict.stamp.epoch, verdict.stamp.seq))
        .filter(|key| !journal.contains(key))
        .map(|key| format!("lost to the journal: {key:?}"))
        .collect();
    found.extend(differing(rows.iter().map(|row| &row.verdict), counted.iter().map(|(_, result)| result)));
    let numbers: Vec<u32> = counted.iter().map(|(sequence, _)| *sequence).collect();
    let jumps = numbers.windows(2).filter(|two| two[1] != two[0] + 1);
    found.extend(jumps.map(|two| format!("the PLC was given result {} after {}", two[1], two[0])));
    found.extend(Earned { recording, told: &told(line), heard }.not(&rows));
    found
}

/// How many there are of what.
pub(crate) fn counts(line: &Line, heard: &[Verdict]) -> Value {
    let rows = kept(line);
    let mut of_jobs = BTreeMap::from(["ok", "anomaly", "not_judged"].map(|outcome| (outcome, 0)));
    for row in rows.iter().filter(|row| row.verdict.level == "job") {
        *of_jobs.entry(&row.verdict.outcome).or_insert(0) += 1;
    }
    let parts = |is_counted: fn(&Counted) -> bool| {
        let counted = rows.iter().map(|row| &row.verdict).filter(|verdict| is_counted(verdict));
        let parts: HashSet<_> =
            counted.map(|verdict| &verdict.part).filter(|part| !part.is_empty()).collect();
        parts.len()
    };
    json!({
        "sent_and_heard": heard.len(),
        "in_the_journal": rows.len(),
        "counted_by_the_plc": account(line).len(),
        "gaps": line.journal().gaps(),
        "jobs": of_jobs,
        "parts": parts(|_| true),
        "parts_with_an_ok": parts(|verdict| verdict.level == "job" && verdict.outcome == "ok"),
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
