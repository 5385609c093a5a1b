//! A shift with a simulated PLC, which runs the program that is shipped for PLCs, while everything is killed in turn.
#![allow(clippy::unwrap_used, clippy::panic)]

mod plc_python;

use andon_tests::line::{Line, PATIENCE, Settings};
use andon_tests::simulator::Flaw;
use std::collections::{BTreeMap, BTreeSet};
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// One verdict, as the PLC has counted it or as the journal has it.
#[derive(Clone, Debug, PartialEq)]
struct Counted {
    epoch: u64,
    seq: u64,
    level: String,
    outcome: String,
    part: String,
}

/// The simulated PLC.
struct Plc(Child);

impl Plc {
    fn start(line: &Line) -> Self {
        let shift = Path::new(env!("CARGO_MANIFEST_DIR")).join("plc/shift.py");
        let mut program = Command::new(plc_python::python());
        program.arg(shift).arg(line.port.to_string()).arg(line.path("plc.memory")).arg("1,2");
        Self(program.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap())
    }

    /// As a controller that loses its power.
    fn kill(&mut self) {
        self.0.kill().unwrap();
        self.0.wait().unwrap();
    }

    /// Ends the shift; what the program says at its end.
    fn end(mut self) -> String {
        self.0.stdin.as_mut().unwrap().write_all(b"over\n").unwrap();
        let until = Instant::now() + PATIENCE;
        while self.0.try_wait().unwrap().is_none() {
            assert!(Instant::now() < until, "the shift does not end");
            std::thread::sleep(Duration::from_millis(50));
        }
        let mut said = String::new();
        self.0.stdout.as_mut().unwrap().read_to_string(&mut said).unwrap();
        assert!(self.0.wait().unwrap().success(), "{said}");
        said
    }
}

impl Drop for Plc {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The PLC's own account, with the number of each result.
fn account(line: &Line) -> Vec<(u32, Counted)> {
    let memory = std::fs::read_to_string(line.path("plc.memory")).unwrap_or_default();
    // A line that a kill has cut off never counted.
    let lines = memory.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
    let results = lines.map(|line| line["result"].clone()).filter(|result| !result.is_null());
    let text = |value: &serde_json::Value| value.as_str().unwrap().to_owned();
    let counted = |result: serde_json::Value| {
        let counted = Counted {
            epoch: result["epoch"].as_u64().unwrap(),
            seq: result["seq"].as_u64().unwrap(),
            level: text(&result["level"]),
            outcome: text(&result["outcome"]),
            part: text(&result["part"]),
        };
        (u32::try_from(result["sequence"].as_u64().unwrap()).unwrap(), counted)
    };
    results.map(counted).collect()
}

/// The verdicts of the journal, by `andond history`.
fn journal(line: &Line) -> Vec<Counted> {
    let output = line.command("history", &["--csv"]);
    let csv = String::from_utf8(output.stdout).unwrap();
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows = lines.map(|line| header.iter().copied().zip(line.split(',')).collect::<BTreeMap<_, _>>());
    let counted = |row: BTreeMap<&str, &str>| Counted {
        epoch: row["epoch"].parse().unwrap(),
        seq: row["seq"].parse().unwrap(),
        level: row["level"].to_owned(),
        outcome: row["outcome"].to_owned(),
        part: row["part"].to_owned(),
    };
    rows.filter(|row| row["entry"] == "verdict").map(counted).collect()
}

/// Waits until the PLC has counted so many more results.
fn wait_for_results(line: &Line, more: usize, after: &str) {
    let (from, until) = (account(line).len(), Instant::now() + PATIENCE);
    while account(line).len() < from + more {
        assert!(Instant::now() < until, "no results {after}; log of plc:\n{}", line.log("plc"));
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// The parts whose job has a result.
fn parts(line: &Line) -> BTreeSet<String> {
    let jobs = account(line).into_iter().filter(|(_, counted)| counted.level == "job");
    jobs.map(|(_, job)| job.part).filter(|part| !part.is_empty()).collect()
}

/// What is killed in turn, while the worker works.
const KILLED: [&str; 8] = ["plc", "program", "judge", "encode", "program", "journal", "plc", "perceive"];

/// The shift goes on until so many parts are done, and a job was right and one was not.
const PARTS: usize = 5;

fn is_over(line: &Line) -> bool {
    let counted = account(line);
    let has = |outcome| counted.iter().any(|(_, counted)| counted.outcome == outcome);
    parts(line).len() >= PARTS && has("ok") && has("anomaly")
}

/// A shift: after every few results something is killed, and started again a moment later.
fn work(line: &mut Line) -> String {
    let mut program = Plc::start(line);
    for killed in KILLED {
        wait_for_results(line, 4, &format!("before {killed} is killed"));
        if killed == "program" {
            program.kill();
            std::thread::sleep(Duration::from_millis(300));
            program = Plc::start(line);
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
    line.work_once_more(Flaw::WrongOrder);
    let _watcher = line.launch();
    let said = work(&mut line);
    let (counted, journal) = (account(&line), journal(&line));

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
    assert!(log.contains("LoadJob { job_id: 1") && log.contains("LoadJob { job_id: 2"), "{log}");
    assert!(line.log("plc").contains("AND-510"), "no fault was seen");
}
