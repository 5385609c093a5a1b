//! A simulated PLC, which runs the program that is shipped for PLCs, and its own account of every result.

use super::Line;
use crate::python::python;
use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The account, in the line's folder.
const MEMORY: &str = "plc.memory";
/// Whatever must happen sooner or later has happened by then; only a test that fails waits for so long.
const PATIENCE: Duration = Duration::from_secs(120);

/// One verdict, as the PLC has counted it or as the journal has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Counted {
    /// The start of the judge.
    pub epoch: u64,
    /// The number in that start.
    pub seq: u64,
    /// `iu`, `activity` or `job`.
    pub level: String,
    /// `ok`, `anomaly` or `not_judged`.
    pub outcome: String,
    /// The part id; empty where there is none.
    pub part: String,
}

/// The simulated PLC, which goes on with its account wherever the last one ended. It is killed when this is dropped.
pub struct Shift(Child);

impl Shift {
    /// Begins or goes on. The parts take these jobs in turn, such as `1,2`.
    pub fn start(line: &Line, jobs: &str) -> Self {
        let shift = Path::new(env!("CARGO_MANIFEST_DIR")).join("plc/shift.py");
        let mut program = Command::new(python());
        program.arg(shift).arg(line.port.to_string()).arg(line.path(MEMORY)).arg(jobs);
        Self(program.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap())
    }

    /// As a controller that loses its power.
    pub fn kill(&mut self) {
        self.0.kill().unwrap();
        self.0.wait().unwrap();
    }

    /// Ends the shift; what the program says at its end.
    pub fn end(mut self) -> String {
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

impl Drop for Shift {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The PLC's own account, with the number of each result.
pub fn account(line: &Line) -> Vec<(u32, Counted)> {
    let memory = std::fs::read_to_string(line.path(MEMORY)).unwrap_or_default();
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

/// A verdict of the journal, and when it began in the recording, in seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// The verdict.
    pub verdict: Counted,
    /// Its begin.
    pub began_s: f64,
}

/// The verdicts of the journal, by `andond history`.
pub fn kept(line: &Line) -> Vec<Kept> {
    let output = line.command("history", &["--csv"]);
    let csv = String::from_utf8(output.stdout).unwrap();
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows = lines.map(|line| header.iter().copied().zip(line.split(',')).collect::<BTreeMap<_, _>>());
    let kept = |row: BTreeMap<&str, &str>| Kept {
        verdict: Counted {
            epoch: row["epoch"].parse().unwrap(),
            seq: row["seq"].parse().unwrap(),
            level: row["level"].to_owned(),
            outcome: row["outcome"].to_owned(),
            part: row["part"].to_owned(),
        },
        began_s: row["began_s"].parse().unwrap(),
    };
    rows.filter(|row| row["entry"] == "verdict").map(kept).collect()
}
