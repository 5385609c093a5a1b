//! How long a verdict takes to the PLC: over Modbus, through the journal's disk, and to a C program on this machine.
//!
//! `plc_latency [VERDICTS] [REPORT]`: steward, journal and plc are the real roles; the judge is this program, so that
//! verdicts come often enough to be counted. Times run from the sending of the verdict.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_ipc::{Node, Stop, Writer, monotonic_ns};
use andon_tests::line::{Line, Modbus, Settings, andond, report, status};
use shm_schemas::{RoleId, Verdict, VerdictKind};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Between two verdicts: the journal has written the one, and the PLC has acknowledged it, before the next comes.
const EVERY: Duration = Duration::from_millis(40);
/// For whatever must come sooner or later.
const PATIENCE: Duration = Duration::from_secs(60);
const ENABLE: u16 = 1;
const ACKNOWLEDGE: u16 = 16;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let verdicts: usize = arguments.first().map_or(1000, |text| text.parse().expect("a number of verdicts"));
    let path = arguments.get(1).map_or("target/plc_latency/report.json", String::as_str);
    let mut line = Line::new(Settings { writes: true, ..Settings::default() });
    for role in ["steward", "journal", "plc"] {
        line.start(role);
    }
    let mut judge = Judge::new(&line);
    let mut plc = Modbus::wait(line.port);
    plc.write(100, ENABLE).unwrap();
    plc.wait_for(status::ONLINE);
    let folder = tempfile::tempdir().unwrap();
    let (mut c_reader, c_lines) = c_reader(folder.path(), &line, verdicts, &mut judge);

    let mut register_us = Vec::new();
    for _ in 0..verdicts {
        let next = Instant::now() + EVERY;
        let sent_ns = judge.say();
        until_offered(&mut plc, judge.said);
        register_us.push((monotonic_ns() - sent_ns) as f64 / 1e3);
        plc.write(100, ENABLE | ACKNOWLEDGE).unwrap();
        plc.write(100, ENABLE).unwrap();
        judge.idle(next.saturating_duration_since(Instant::now()));
    }
    register_us.sort_by(f64::total_cmp);
    let at = |percent: usize| register_us[(verdicts - 1) * percent / 100];
    let c = c_lines.last().unwrap();
    let c: Vec<&str> = c.strip_prefix("latency_us ").unwrap().split(' ').collect();
    assert!(c_reader.wait().unwrap().success());
    drop(judge);
    assert_eq!(line.stop(), [""; 0]);
    let text = format!(
        "{{\n  \"verdicts\": {verdicts},\n  \"verdict_to_register_us\": {{ \"p50\": {:.0}, \"p99\": {:.0}, \"most\": {:.0} }},\n  \
         \"c_reader_us\": {{ \"p50\": {}, \"p99\": {}, \"most\": {} }}\n}}\n",
        at(50),
        at(99),
        at(100),
        c[1],
        c[3],
        c[5]
    );
    report(path, &text);
}

/// Says verdicts, which nobody judged.
struct Judge {
    verdicts: Writer<Verdict>,
    node: Node,
    said: u64,
}

impl Judge {
    fn new(line: &Line) -> Self {
        let node = Node::open(&line.station, RoleId::Judge, PATIENCE, &Stop::new().unwrap()).unwrap();
        Self { verdicts: node.writer().unwrap(), node, said: 0 }
    }

    /// Sends one; returns when.
    fn say(&mut self) -> u64 {
        self.said += 1;
        let mut verdict = self.verdicts.loan().unwrap();
        verdict.kind = VerdictKind::IuOk.code();
        let before_ns = monotonic_ns();
        self.verdicts.send(verdict).unwrap();
        before_ns
    }

    /// Answers readers that come up, for so long.
    fn idle(&mut self, time: Duration) {
        let until = Instant::now() + time;
        while Instant::now() < until {
            let left = until.saturating_duration_since(Instant::now());
            self.node.wait(&mut [&mut self.verdicts], left).unwrap();
        }
    }
}

/// Polls without a pause until the registers show this verdict: 42 to 45 are its number.
fn until_offered(plc: &mut Modbus, seq: u64) {
    let until = Instant::now() + PATIENCE;
    loop {
        let words = plc.read(42, 4).unwrap();
        if words.iter().fold(0, |number, word| number << 16 | u64::from(*word)) == seq {
            return;
        }
        assert!(Instant::now() < until, "verdict {seq} is never offered");
    }
}

/// The C example, compiled against the library beside this program, after it has opened the station; and its lines to come.
fn c_reader(
    folder: &Path,
    line: &Line,
    count: usize,
    judge: &mut Judge,
) -> (Child, impl Iterator<Item = String> + use<>) {
    let plc = Path::new(env!("CARGO_MANIFEST_DIR")).join("../daemon/plc");
    let library = andond().with_file_name("libandon_plc.so");
    // Programs ask for the library by the name that it was given when it was linked.
    std::fs::copy(&library, folder.join("libandon_plc.so.0")).unwrap_or_else(|error| {
        panic!("{}: {error}: build it first with `cargo build --release -p andon-plc`", library.display())
    });
    let program = folder.join("soft_plc");
    let status = Command::new("cc")
        .args(["-std=c11", "-O2", "-o"])
        .arg(&program)
        .arg(format!("-I{}", plc.join("include").display()))
        .arg(plc.join("examples/soft_plc.c"))
        .arg(folder.join("libandon_plc.so.0"))
        .arg(format!("-Wl,-rpath,{}", folder.display()))
        .status()
        .unwrap();
    assert!(status.success(), "the example does not compile");
    let mut child = Command::new(program)
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
