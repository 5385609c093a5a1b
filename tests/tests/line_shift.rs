//! A shift with a simulated PLC, which runs the program that is shipped for PLCs, while everything is killed in turn.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::line::{Counted, Line, PATIENCE, Settings, Shift, account, kept};
use andon_tests::simulator::Flaw;
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

/// Waits until the PLC has counted this number of further results.
fn wait_for_results(line: &Line, more: usize, after: &str) {
    let (from, until) = (account(line).len(), Instant::now() + PATIENCE);
    while account(line).len() < from + more {
        assert!(Instant::now() < until, "no results {after}; log of plc:\n{}", line.log("plc"));
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// Waits until the journal has this number of further verdicts.
fn wait_for_rows(line: &Line, more: usize) {
    let (from, until) = (line.journal().verdicts().len(), Instant::now() + PATIENCE);
    while line.journal().verdicts().len() < from + more {
        assert!(Instant::now() < until, "no verdicts; log of the judge:\n{}", line.log("judge"));
        std::thread::sleep(Duration::from_millis(200));
    }
}

/// The parts whose job has a result.
fn parts(line: &Line) -> BTreeSet<String> {
    let jobs = account(line).into_iter().filter(|(_, counted)| counted.level == "job");
    jobs.map(|(_, job)| job.part).filter(|part| !part.is_empty()).collect()
}

/// What is killed in turn, while the worker works.
const KILLED: [&str; 8] = ["plc", "program", "judge", "encode", "program", "journal", "plc", "perceive"];

/// Verdicts while the PLC is away: more than wait for it outside of the journal.
const AWAY: usize = 15;

/// The shift goes on until this number of parts is done, and at least one job was right and one was not.
const PARTS: usize = 5;

fn is_over(line: &Line) -> bool {
    let counted = account(line);
    let has = |outcome| counted.iter().any(|(_, counted)| counted.outcome == outcome);
    parts(line).len() >= PARTS && has("ok") && has("anomaly")
}

/// A shift: after every few results something is killed, and started again a moment later.
fn work(line: &mut Line) -> String {
    let mut program = Shift::start(line, "1,2");
    wait_for_results(line, 1, "at the beginning of the shift");
    program.kill();
    wait_for_rows(line, AWAY);
    program = Shift::start(line, "1,2");
    for killed in KILLED {
        wait_for_results(line, 4, &format!("before {killed} is killed"));
        if killed == "program" {
            program.kill();
            std::thread::sleep(Duration::from_millis(300));
            program = Shift::start(line, "1,2");
        } else {
            line.role(killed).kill();
            std::thread::sleep(Duration::from_millis(300));
            line.start(killed);
        }
    }
    let until = Instant::now() + PATIENCE;
    while !is_over(line) {
        assert!(Instant::now() < until, "the line does not go on; log of plc:\n{}", line.log("plc"));
        std::thread::sleep(Duration::from_millis(50));
    }
    program.end()
}

#[test]
fn after_a_shift_with_faults_and_kills_the_account_of_the_plc_is_the_journal_to_the_last_verdict() {
    let mut line = Line::with_second_job(Settings { writes: true, ..Settings::live() });
    line.work_in_turn(&[Flaw::None, Flaw::J1], 0.0);
    let _watcher = line.launch();
    let said = work(&mut line);
    let counted = account(&line);
    let journal: Vec<Counted> = kept(&line).into_iter().map(|kept| kept.verdict).collect();

    let of_plc: Vec<&Counted> = counted.iter().map(|(_, counted)| counted).collect();
    assert_eq!(of_plc, journal.iter().collect::<Vec<_>>(), "nothing lost, nothing double, nothing else");
    let sequences: Vec<u32> = counted.iter().map(|(sequence, _)| *sequence).collect();
    assert_eq!(sequences, (1..).take(sequences.len()).collect::<Vec<_>>());
    let sum = format!("\"counted\": {}, \"missed\": 0,", counted.len());
    assert!(said.contains(&sum), "{said}");

    let parts = parts(&line);
    let outcomes: BTreeSet<&str> = journal.iter().map(|row| row.outcome.as_str()).collect();
    println!("{} verdicts; parts {parts:?}; outcomes {outcomes:?}", journal.len());
    assert!(parts.iter().all(|part| part.starts_with("SHIFT-")), "{parts:?}");
    assert!(outcomes.contains("ok") && outcomes.contains("anomaly"), "{outcomes:?}");
    let given: Vec<&str> =
        journal.iter().map(|row| row.part.as_str()).filter(|part| !part.is_empty()).collect();
    assert!(given.is_sorted(), "a part that has gone came back: {given:?}");
    let log = line.log("judge");
    assert!(
        log.contains("load job 1, whatever its hash, for the PLC") && log.contains("load job 2, "),
        "{log}"
    );
    assert!(line.log("plc").contains("AND-510"), "no fault was seen");
}
