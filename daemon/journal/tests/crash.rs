//! What the journal must survive: SIGKILL in the middle of a write, and a full disk.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_journal::{Entry, History, Journal, Query, Retention};
use shm_schemas::{Verdict, VerdictLevel, VerdictOutcome};
use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};

const KEEP: Retention = Retention { keep_days: 36_500, keep_mb: 1000, without: &[] };
/// Names the journal that a child process writes.
const JOURNAL: &str = "ANDON_TEST_JOURNAL";
/// Names the epoch that a child process writes.
const EPOCH: &str = "ANDON_TEST_EPOCH";

fn verdict(epoch: u64, seq: u64) -> Verdict {
    let mut verdict = Verdict {
        level: VerdictLevel::Iu.code(),
        outcome: VerdictOutcome::Ok.code(),
        decided_utc_ns: seq,
        ..Default::default()
    };
    (verdict.stamp.epoch, verdict.stamp.seq) = (epoch, seq);
    verdict
}

/// The body of the child processes: writes verdicts and prints each confirmation, until it is killed or the journal refuses. In the
/// parent it does nothing.
#[test]
fn child_process_that_writes() {
    let (Ok(path), Ok(epoch)) = (std::env::var(JOURNAL), std::env::var(EPOCH)) else { return };
    let mut journal = Journal::open(Path::new(&path), KEEP).unwrap();
    let epoch = epoch.parse().unwrap();
    let mut out = std::io::stdout();
    for seq in 1.. {
        journal.push(&verdict(epoch, seq));
        match journal.flush() {
            Ok(()) => writeln!(out, "confirmed {}", journal.newest().unwrap().seq).unwrap(),
            Err(error) => {
                writeln!(out, "refused {error}").unwrap();
                return;
            }
        }
    }
}

fn child(journal: &Path, epoch: u64, shell: &str) -> Command {
    let mut command = Command::new("sh");
    command
        .args(["-c", &format!("{shell} exec \"$0\" --exact child_process_that_writes --nocapture")])
        .arg(std::env::current_exe().unwrap())
        .env(JOURNAL, journal)
        .env(EPOCH, epoch.to_string())
        .stdout(Stdio::piped())
        .stderr(Stdio::null());
    command
}

/// The number in a line `confirmed N`, which the test harness may prefix.
fn confirmed(line: &str) -> Option<u64> {
    line.rsplit_once("confirmed ")?.1.parse().ok()
}

/// The verdicts in the journal; panics when one is missing without a gap.
fn verdicts(path: &Path) -> BTreeSet<(u64, u64)> {
    let mut newest: Option<(u64, u64)> = None;
    let mut explained = false;
    let mut there = BTreeSet::new();
    let check = |entry| {
        match entry {
            Entry::NotWatching(_) => {}
            Entry::Gap(_) => explained = true,
            Entry::Verdict(record) => {
                let follows = match newest {
                    Some((epoch, seq)) => (record.stamp.epoch, record.stamp.seq) == (epoch, seq + 1),
                    None => record.stamp.seq == 1,
                };
                assert!(follows || explained, "{newest:?} then {} {}", record.stamp.epoch, record.stamp.seq);
                explained = false;
                newest = Some((record.stamp.epoch, record.stamp.seq));
                there.insert((record.stamp.epoch, record.stamp.seq));
            }
        }
        Ok(())
    };
    History::open(path).unwrap().visit(&Query::default(), check).unwrap();
    there
}

#[test]
fn no_confirmed_verdict_is_lost_when_the_writer_is_killed_in_the_middle_of_a_write() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("j.sqlite");
    let mut promised = BTreeSet::new();
    for epoch in 1..=12 {
        let mut writer = child(&path, epoch, "").spawn().unwrap();
        let mut lines = BufReader::new(writer.stdout.take().unwrap()).lines();
        // Killed after 1, 8, 15 ... confirmed rows, at whatever point of the next one.
        let patience = (epoch * 7 - 6) as usize;
        promised.extend(
            lines
                .by_ref()
                .map_while(Result::ok)
                .filter_map(|l| confirmed(&l))
                .take(patience)
                .map(|s| (epoch, s)),
        );
        writer.kill().unwrap();
        writer.wait().unwrap();
        promised.extend(lines.map_while(Result::ok).filter_map(|l| confirmed(&l)).map(|s| (epoch, s)));
        let there = verdicts(&path);
        let missing: Vec<_> = promised.difference(&there).collect();
        assert!(missing.is_empty(), "confirmed but missing: {missing:?}");
    }
    assert!(promised.len() >= 12 * 30, "the children wrote");
}

#[test]
fn a_full_disk_refuses_verdicts_and_keeps_those_that_were_confirmed() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("j.sqlite");
    // No file may exceed 200 blocks; the signal is ignored, so that the write fails as on a full disk.
    let output = child(&path, 1, "trap '' XFSZ; ulimit -f 200;").output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("refused cannot write the journal"), "{text}");
    let promised: BTreeSet<_> = text.lines().filter_map(confirmed).map(|seq| (1, seq)).collect();
    assert!(!promised.is_empty());
    let there = verdicts(&path);
    assert!(promised.is_subset(&there));

    let mut journal = Journal::open(&path, KEEP).unwrap();
    let next = journal.newest().unwrap().seq + 1;
    assert!(next <= promised.len() as u64 + 2, "at most the verdict that was being written is there too");
    journal.push(&verdict(1, next));
    journal.flush().unwrap();
    assert!(verdicts(&path).contains(&(1, next)));
}

/// How many verdicts a reader sees that may write nothing.
fn read_only(path: &Path) -> Result<usize, andon_journal::JournalError> {
    let mut count = 0;
    let visit = |entry| {
        count += usize::from(matches!(entry, Entry::Verdict(_)));
        Ok(())
    };
    History::open_read_only(path)?.visit(&Query::default(), visit)?;
    Ok(count)
}

/// The files of a folder, with their sizes and the times of their last change.
fn files(folder: &Path) -> BTreeSet<(std::ffi::OsString, u64, std::time::SystemTime)> {
    let entries = std::fs::read_dir(folder).unwrap().map(Result::unwrap);
    let told = entries.map(|entry| {
        let meta = entry.metadata().unwrap();
        (entry.file_name(), meta.len(), meta.modified().unwrap())
    });
    told.collect()
}

#[test]
fn a_reader_without_the_right_to_write_sees_what_a_living_and_a_killed_writer_have_confirmed_and_changes_no_file()
 {
    let dir = tempfile::tempdir().unwrap();
    // The name has what means something in an address.
    let path = dir.path().join("j 1%3f?#.sqlite");
    assert!(matches!(read_only(&path), Err(andon_journal::JournalError::Open { .. })), "there is none");
    let mut writer = child(&path, 1, "").spawn().unwrap();
    let mut lines = BufReader::new(writer.stdout.take().unwrap()).lines().map_while(Result::ok);
    for _ in 0..20 {
        let confirmed = lines.by_ref().find_map(|line| confirmed(&line)).unwrap();
        let seen = read_only(&path).unwrap();
        assert!(seen as u64 >= confirmed, "{seen} of {confirmed}");
    }
    writer.kill().unwrap();
    writer.wait().unwrap();
    let promised = lines.filter_map(|line| confirmed(&line)).last().unwrap_or_default();
    let before = files(dir.path());
    let seen = read_only(&path).unwrap();
    assert!(seen as u64 >= promised, "{seen} of {promised}");
    assert_eq!(files(dir.path()), before, "of a killed writer");

    // Whoever closes it last takes the log with it.
    drop(Journal::open(&path, KEEP).unwrap());
    let before = files(dir.path());
    assert!(matches!(read_only(&path), Err(andon_journal::JournalError::Open { .. })), "nobody writes it");
    assert_eq!(files(dir.path()), before, "of nobody");
}
