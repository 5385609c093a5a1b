//! A simulated PLC, which runs the program that is shipped for PLCs, and its own account of every result.

use super::Line;
use crate::python::python;
use std::collections::BTreeMap;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The account, in the line's folder.
const MEMORY: &str = "plc.memory";
/// This many bytes hold its newest lines.
const NEWEST_BYTES: u64 = 8192;
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

/// What the PLC had told the line from some time on.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    /// From when on, on the monotonic clock: before it was sent.
    pub from_ns: u64,
    /// The part at the bench; empty where there is none.
    pub part: String,
    /// Whether the line has answered that it has it.
    pub is_part_taken: bool,
    /// The job; 0 before the first.
    pub job: u32,
    /// Whether the line has answered that it has it.
    pub is_job_taken: bool,
}

/// What the PLC has told the line, from its beginning on.
pub fn told(line: &Line) -> Vec<Told> {
    let memory = std::fs::read_to_string(line.path(MEMORY)).unwrap_or_default();
    memory.lines().filter_map(told_by).collect()
}

/// What the PLC has told the line last.
pub fn told_last(line: &Line) -> Option<Told> {
    let mut memory = std::fs::File::open(line.path(MEMORY)).ok()?;
    let length = memory.metadata().ok()?.len();
    memory.seek(SeekFrom::Start(length.saturating_sub(NEWEST_BYTES))).ok()?;
    let mut newest = String::new();
    memory.read_to_string(&mut newest).ok()?;
    newest.lines().rev().find_map(told_by)
}

/// `None` for a line that a kill has cut off. Panics if a whole one lacks a name that `andon.st` retains.
fn told_by(line: &str) -> Option<Told> {
    let line: serde_json::Value = serde_json::from_str(line).ok()?;
    let retained = |name: &str| line["retained"].get(name).unwrap_or_else(|| panic!("no {name} in {line}"));
    let number = |value: &serde_json::Value| value.as_u64().unwrap();
    let words = retained("sentPart").as_array().unwrap().iter().map(number);
    let bytes: Vec<u8> = words.flat_map(|word| [(word >> 8) as u8, word as u8]).collect();
    Some(Told {
        from_ns: number(&line["at_ns"]),
        part: String::from_utf8(bytes).unwrap().trim_end_matches('\0').to_owned(),
        is_part_taken: retained("isPartSent").as_bool().unwrap(),
        job: number(retained("sentJob")).try_into().unwrap(),
        is_job_taken: retained("isJobSent").as_bool().unwrap(),
    })
}

/// A verdict of the journal, with its times in the recording in seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// The verdict.
    pub verdict: Counted,
    /// Its begin.
    pub began_s: f64,
    /// Its end.
    pub ended_s: f64,
    /// The job that it was judged by.
    pub job_id: u32,
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
        ended_s: row["ended_s"].parse().unwrap(),
        job_id: row["job_id"].parse().unwrap(),
    };
    rows.filter(|row| row["entry"] == "verdict").map(kept).collect()
}
