//! Measures how long a verdict takes to the PLC's register, through the journal's disk, and to a C program on this machine.
//!
//! `plc_latency [VERDICTS] [REPORT]`: steward, journal and plc are the real roles; the judge is this program, so that there
//! are enough verdicts for a percentile. Times begin when the verdict is sent.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_ipc::{MonotonicTime, Node, Stop, Writer};
use andon_tests::line::{Line, Modbus, Settings, soft_plc, status};
use andon_tests::measure::{Arguments, percentile, report};
use serde_json::json;
use shm_schemas::{RoleId, Verdict, VerdictLevel, VerdictOutcome};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

/// Between two verdicts: one has been written to disk and acknowledged before the next comes.
const EVERY: Duration = Duration::from_millis(40);
/// Whatever must happen sooner or later has happened by then.
const PATIENCE: Duration = Duration::from_secs(60);

fn main() -> ExitCode {
    let arguments = Arguments::of_this_program();
    let verdicts = arguments.number(0, 1000);
    let mut line = Line::new(Settings { writes: true, ..Settings::default() });
    for role in ["steward", "journal", "plc"] {
        line.start(role);
    }
    let mut judge = Judge::new(&line);
    let mut plc = Modbus::connect_when_up(line.port);
    plc.enable();
    plc.wait_for(status::ONLINE);
    let folder = tempfile::tempdir().unwrap();
    let (mut c_reader, c_lines) = c_reader(folder.path(), &line, verdicts, &mut judge);

    let mut register_us = Vec::new();
    for _ in 0..verdicts {
        let next = Instant::now() + EVERY;
        let sent = judge.send();
        until_offered(&mut plc, judge.sent);
        register_us.push(1e6 * MonotonicTime::now().since(sent).as_secs_f64());
        plc.acknowledge();
        judge.idle(next.saturating_duration_since(Instant::now()));
    }
    let c_line = c_lines.last().unwrap();
    let c_words: Vec<&str> = c_line.strip_prefix("latency_us ").unwrap().split(' ').collect();
    let c_reader_us = |index: usize| c_words[index].parse::<f64>().unwrap();
    assert!(c_reader.wait().unwrap().success());
    drop(judge);
    assert_eq!(line.stop(), [""; 0]);
    let mut at = |percent| percentile(&mut register_us, percent);
    let text = json!({
        "verdicts": verdicts,
        "verdict_to_register_us": { "p50": at(50), "p99": at(99), "max": at(100) },
        "c_reader_us": { "p50": c_reader_us(1), "p99": c_reader_us(3), "max": c_reader_us(5) },
    });
    report(arguments.path(1, "target/plc_latency/report.json"), &text, true)
}

/// Sends verdicts in the place of the judge.
struct Judge {
    verdicts: Writer<Verdict>,
    node: Node,
    sent: u64,
}

impl Judge {
    fn new(line: &Line) -> Self {
        let node = Node::open(&line.station, RoleId::Judge, PATIENCE, &Stop::new().unwrap()).unwrap();
        Self { verdicts: node.writer().unwrap(), node, sent: 0 }
    }

    /// Sends one, and returns the time just before.
    fn send(&mut self) -> MonotonicTime {
        self.sent += 1;
        let mut verdict = self.verdicts.loan().unwrap();
        verdict.level = VerdictLevel::Iu.code();
        verdict.outcome = VerdictOutcome::Ok.code();
        let before = MonotonicTime::now();
        self.verdicts.send(verdict).unwrap();
        before
    }

    /// Waits for this long, and answers readers that come up meanwhile.
    fn idle(&mut self, time: Duration) {
        let until = Instant::now() + time;
        while Instant::now() < until {
            let left = until.saturating_duration_since(Instant::now());
            self.node.wait(&mut [&mut self.verdicts], left).unwrap();
        }
    }
}

/// Polls without a pause until the registers show the verdict of this number.
fn until_offered(plc: &mut Modbus, seq: u64) {
    let until = Instant::now() + PATIENCE;
    loop {
        if plc.result().1 == seq {
            return;
        }
        assert!(Instant::now() < until, "verdict {seq} is never offered");
    }
}

/// Compiles the C example against the library beside this program and starts it. Returns it when it has opened the station, with
/// the lines that it will print.
fn c_reader(
    folder: &Path,
    line: &Line,
    count: usize,
    judge: &mut Judge,
) -> (Child, impl Iterator<Item = String> + use<>) {
    let mut child = Command::new(soft_plc(folder))
        .args(["line", &count.to_string()])
        .arg(line.station.root())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
    assert_eq!(lines.next().as_deref(), Some("open"));
    judge.idle(Duration::from_millis(200));
    (child, lines)
}
