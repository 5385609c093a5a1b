//! Throws random bytes at the Modbus side of a running line, beside a good client that polls as a PLC does.
//!
//! `modbus_fuzz [SECONDS] [SEED] [REPORT]`: ends with an error when the role ends, when the good client is not answered
//! rightly, when no bad request is counted, or when memory grows.
#![allow(clippy::unwrap_used, clippy::panic)]

mod attack;

use andon_tests::line::{Line, Modbus, Settings, Watcher, own_memory_kib, report, status};
use attack::Sent;
use shm_schemas::RoleId;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Attackers at once: with the good client all but two of the eight connections that the server takes.
const ATTACKERS: u64 = 5;
/// The good client's scan.
const SCAN: Duration = Duration::from_millis(5);
/// What buffers and the allocator may add once everything is warm. A leak of a byte a frame shows.
const SLACK_KIB: u64 = 2048;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |place: usize, default: u64| {
        arguments.get(place).map_or(default, |text| text.parse().expect("a number"))
    };
    let (seconds, seed) = (number(0, 600), number(1, 1));
    let path = arguments.get(2).map_or("target/modbus_fuzz/report.json", String::as_str);
    let mut line =
        Line::new(Settings { at_full_speed: false, repeat: true, writes: true, ..Settings::default() });
    let mut watcher = line.launch();
    let mut plc = Modbus::wait(line.port);
    plc.write(100, 1).unwrap();
    plc.wait_for(status::ONLINE | status::READY);

    let (sent, end) = (Arc::new(Sent::default()), Arc::new(AtomicBool::new(false)));
    let attackers: Vec<_> =
        (0..ATTACKERS).map(|number| attack::start(line.port, seed * 1000 + number, &sent, &end)).collect();
    let served = serve(&mut line, &mut watcher, &mut plc, Duration::from_secs(seconds));
    end.store(true, Ordering::Relaxed);
    attackers.into_iter().for_each(|attacker| attacker.join().unwrap());
    // What is counted is told once a second.
    let newest = watcher.health(RoleId::Plc).unwrap().stamp.sent_ns;
    let told = newest + 2_000_000_000;
    watcher.until("the last counts", |watcher| watcher.health(RoleId::Plc).unwrap().stamp.sent_ns > told);
    let refused = watcher.health(RoleId::Plc).unwrap().refused;
    let bad = line.stop();

    let grew = served.end_kib > served.warm_kib + SLACK_KIB;
    let well = served.failures == 0 && refused > 0 && bad.is_empty() && !grew;
    let count = |counter: &std::sync::atomic::AtomicU64| counter.load(Ordering::Relaxed);
    let text = format!(
        "{{\n  \"seconds\": {seconds},\n  \"seed\": {seed},\n  \"connections\": {},\n  \"frames\": {},\n  \"bytes\": {},\n  \
         \"refused_and_counted\": {refused},\n  \"good_requests\": {},\n  \"good_requests_not_served\": {},\n  \
         \"good_request_us\": {{ \"p50\": {}, \"p99\": {}, \"most\": {} }},\n  \
         \"own_memory_kib\": {{ \"warm\": {}, \"end\": {} }},\n  \"ended_badly\": {bad:?}\n}}\n",
        count(&sent.connections),
        count(&sent.frames),
        count(&sent.bytes),
        served.took_us.len(),
        served.failures,
        served.at(50),
        served.at(99),
        served.at(100),
        served.warm_kib,
        served.end_kib,
    );
    report(path, &text);
    if well { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// How the good client was served.
#[derive(Default)]
struct Served {
    /// One a request, in ascending order at the end.
    took_us: Vec<u128>,
    /// Answers that did not come, or that no register map allows.
    failures: u64,
    warm_kib: u64,
    end_kib: u64,
}

impl Served {
    fn at(&self, percent: usize) -> u128 {
        let last = self.took_us.len().saturating_sub(1);
        self.took_us.get(last * percent / 100).copied().unwrap_or_default()
    }
}

/// Polls for so long; panics when the role ends.
fn serve(line: &mut Line, watcher: &mut Watcher, plc: &mut Modbus, time: Duration) -> Served {
    let (mut served, began) = (Served::default(), Instant::now());
    while began.elapsed() < time {
        let asked = Instant::now();
        let right = plc.read(0, 48).is_ok_and(|words| {
            // The map's version, and a result whose number is the same at both its ends.
            words.len() == 48 && words[7] == 1 && words[11..13] == words[46..48]
        });
        served.took_us.push(asked.elapsed().as_micros());
        if !right {
            served.failures += 1;
            *plc = Modbus::wait(line.port);
        }
        let role = line.role("plc");
        assert!(role.ended().is_none(), "the role has ended; its log:\n{}", line.log("plc"));
        served.end_kib = own_memory_kib(line.role("plc").pid()).unwrap();
        if began.elapsed() < time / 5 {
            served.warm_kib = served.warm_kib.max(served.end_kib);
        }
        watcher.listen(SCAN);
    }
    served.took_us.sort_unstable();
    served
}
