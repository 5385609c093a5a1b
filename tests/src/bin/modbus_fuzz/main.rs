//! Sends random bytes to the Modbus side of a running line, beside a good client that polls as a PLC does.
//!
//! `modbus_fuzz [SECONDS] [SEED] [REPORT]` fails when the role ends, or when the good client gets a wrong answer or none. It also fails when no bad
//! request is counted, or when memory grows.
#![allow(clippy::unwrap_used, clippy::panic)]

mod attack;

use andon_tests::line::{Line, Modbus, Settings, Watcher, own_memory_kib, status};
use andon_tests::measure::{Arguments, percentile, report};
use attack::Sent;
use serde_json::json;
use shm_schemas::RoleId;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Attackers at once: with the good client all but two of the eight connections that the server takes.
const ATTACKERS: u64 = 5;
/// The good client's cycle.
const SCAN: Duration = Duration::from_millis(5);
/// What buffers and the allocator may add once everything is warm. A leak of one byte per frame is found.
const SLACK_KIB: u64 = 2048;

fn main() -> ExitCode {
    let arguments = Arguments::of_this_program();
    let (seconds, seed) = (arguments.number(0, 600), arguments.number(1, 1));
    let mut line = Line::new(Settings { writes: true, ..Settings::live() });
    let mut watcher = line.launch();
    let mut plc = Modbus::connect_when_up(line.port);
    plc.enable();
    plc.wait_for(status::ONLINE | status::READY);

    let (sent, end) = (Arc::new(Sent::default()), Arc::new(AtomicBool::new(false)));
    let attackers: Vec<_> =
        (0..ATTACKERS).map(|number| attack::start(line.port, seed * 1000 + number, &sent, &end)).collect();
    let mut served = serve(&mut line, &mut watcher, &mut plc, Duration::from_secs(seconds));
    end.store(true, Ordering::Relaxed);
    attackers.into_iter().for_each(|attacker| attacker.join().unwrap());
    // The role reports its counts once per second.
    let newest = watcher.health(RoleId::Plc).unwrap().stamp.sent_ns;
    let counted = newest + 2_000_000_000;
    watcher.until("the last counts", |watcher| watcher.health(RoleId::Plc).unwrap().stamp.sent_ns > counted);
    let refused = watcher.health(RoleId::Plc).unwrap().refused;
    let failures = line.stop();

    let has_grown = served.end_kib > served.warm_kib + SLACK_KIB;
    let has_passed = served.failures == 0 && refused > 0 && failures.is_empty() && !has_grown;
    let count = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
    let requests = served.took_us.len();
    let mut at = |percent| percentile(&mut served.took_us, percent);
    let text = json!({
        "seconds": seconds,
        "seed": seed,
        "connections": count(&sent.connections),
        "frames": count(&sent.frames),
        "bytes": count(&sent.bytes),
        "refused_and_counted": refused,
        "good_requests": requests,
        "good_requests_not_served": served.failures,
        "good_request_us": { "p50": at(50), "p99": at(99), "max": at(100) },
        "own_memory_kib": { "warm": served.warm_kib, "end": served.end_kib },
        "failures": failures,
    });
    report(arguments.path(2, "target/modbus_fuzz/report.json"), &text, has_passed)
}

/// What the good client got.
#[derive(Default)]
struct Served {
    /// Microseconds of each request.
    took_us: Vec<f64>,
    /// Answers that did not come, or that the register map does not allow.
    failures: u64,
    warm_kib: u64,
    end_kib: u64,
}

/// Polls for this long; panics when the role ends.
fn serve(line: &mut Line, watcher: &mut Watcher, plc: &mut Modbus, time: Duration) -> Served {
    let (mut served, began) = (Served::default(), Instant::now());
    while began.elapsed() < time {
        let asked = Instant::now();
        let is_right = plc.read(0, 100).is_ok_and(|words| {
            // The map's version, and a result whose number is the same at both its ends.
            words.len() == 100 && words[7] == 6 && words[11..13] == words[76..78]
        });
        served.took_us.push(asked.elapsed().as_secs_f64() * 1e6);
        if !is_right {
            served.failures += 1;
            *plc = Modbus::connect_when_up(line.port);
        }
        let role = line.role("plc");
        assert!(role.ended().is_none(), "the role has ended; its log:\n{}", line.log("plc"));
        served.end_kib = own_memory_kib(line.role("plc").pid()).unwrap();
        if began.elapsed() < time / 5 {
            served.warm_kib = served.warm_kib.max(served.end_kib);
        }
        watcher.listen(SCAN);
    }
    served
}
