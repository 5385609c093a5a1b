//! A station with a judge that sends what a test wants, for the tests of readers.

use andon_ipc::{Limits, Node, POLL_PERIOD, Station, Steward, Stop, Writer};
use shm_schemas::{PartId, RoleId, Verdict, VerdictLevel, VerdictMeasure, VerdictOutcome, VerdictReason};
use std::io::{BufRead as _, BufReader};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

const PATIENCE: Duration = Duration::from_secs(20);

/// A station with its steward in a thread. Its directory is deleted when it is dropped.
pub(crate) struct TestStation {
    pub(crate) station: Station,
    stop: Arc<AtomicBool>,
    steward: Option<thread::JoinHandle<()>>,
    _dir: tempfile::TempDir,
}

impl TestStation {
    pub(crate) fn new() -> Self {
        let dir = tempfile::Builder::new().prefix("andon").tempdir().unwrap();
        let station = Station::under("plctest", &dir.path().join("s")).unwrap();
        let mut steward = Steward::create(&station, Limits { frame_bytes: 4096 }).unwrap();
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        let steward = thread::spawn(move || {
            while !stopped.load(Ordering::Relaxed) {
                steward.poll().unwrap();
                thread::sleep(POLL_PERIOD);
            }
        });
        Self { station, stop, steward: Some(steward), _dir: dir }
    }

    pub(crate) fn judge(&self) -> Judge {
        let node = Node::open(&self.station, RoleId::Judge, PATIENCE, &Stop::new().unwrap()).unwrap();
        Judge { verdicts: node.writer().unwrap(), node }
    }
}

/// Starts a program that reads verdicts. Returns it when it has opened the station, with the lines that it will print.
pub(crate) fn start_reader(program: &mut Command) -> (Child, impl Iterator<Item = String> + use<>) {
    let mut child = program.stdout(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
    assert_eq!(lines.next().as_deref(), Some("open"));
    (child, lines)
}

impl Drop for TestStation {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        let _ = self.steward.take().map(thread::JoinHandle::join);
    }
}

/// Writes verdicts.
pub(crate) struct Judge {
    verdicts: Writer<Verdict>,
    node: Node,
}

impl Judge {
    /// Sends a verdict; every third is an anomaly.
    pub(crate) fn send(&mut self, number: u64) {
        let mut verdict = self.verdicts.loan().unwrap();
        let (outcome, reason) = match number % 3 {
            0 => (VerdictOutcome::Anomaly, VerdictReason::Motion),
            _ => (VerdictOutcome::Ok, VerdictReason::None),
        };
        verdict.level = VerdictLevel::Iu.code();
        verdict.outcome = outcome.code();
        verdict.reason = reason.code();
        verdict.distance = number as f32 / 2.0;
        verdict.measure = VerdictMeasure::Strokes.code();
        (verdict.measured, verdict.shown_min, verdict.shown_max) = (number as f32, 5.5, 6.5);
        verdict.station[..7].copy_from_slice(b"plctest");
        verdict.part = PartId::new(format!("A-{number}").as_bytes()).unwrap();
        self.verdicts.send(verdict).unwrap();
    }

    /// Waits for this long, and answers readers that come up meanwhile.
    pub(crate) fn idle(&mut self, time: Duration) {
        self.node.wait(&mut [&mut self.verdicts], time).unwrap();
    }
}
