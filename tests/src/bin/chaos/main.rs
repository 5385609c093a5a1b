//! Kills, stops and restarts the roles of a line at random, also while they start, and looks at what is left.
//!
//! `chaos [KILLS] [SEED] [REPORT] [MOST_MS]`: ends with an error when something hangs, when a verdict is missing from the
//! journal without a gap, when shared memory is leaked, when the PLC did not see `ready` drop, or when a role took
//! longer than `MOST_MS` to come back; without `MOST_MS` that time is only reported, because a busy machine has a say in it.
#![allow(clippy::unwrap_used, clippy::panic)]

mod plc;
mod tally;

use andon_ipc::monotonic_ns;
use andon_tests::line::{Line, ROLES, Settings, Watcher, report, role_id};
use andon_tests::simulator::Random;
use plc::Plc;
use rustix::process::Signal;
use shm_schemas::RoleState;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use tally::{Recovery, Tally, load_average};

/// As in the units.
const RESTART_SEC: Duration = Duration::from_millis(100);
/// A role that has not come back by then hangs.
const HANGS: Duration = Duration::from_secs(30);

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |place: usize, default: u64| {
        arguments.get(place).map_or(default, |text| text.parse().expect("a number"))
    };
    let (kills, seed) = (number(0, 1000), number(1, 1));
    let path = arguments.get(2).map_or("target/chaos/report.json", String::as_str);
    let most_ms = arguments.get(3).map_or(f64::INFINITY, |text| text.parse().expect("milliseconds"));
    let mut chaos = Chaos::start(seed);
    while chaos.tally.kills() < kills {
        chaos.disturb();
    }
    let (text, well) = chaos.finish(most_ms);
    report(path, &text);
    if well { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

struct Chaos {
    line: Line,
    watcher: Watcher,
    plc: Plc,
    random: Random,
    tally: Tally,
}

impl Chaos {
    fn start(seed: u64) -> Self {
        let mut line = Line::new(Settings { at_full_speed: false, repeat: true, ..Settings::default() });
        let watcher = line.launch();
        let plc = Plc::watch(line.port);
        let mut chaos = Self { line, watcher, plc, random: Random::new(seed, &[]), tally: Tally::default() };
        for role in ROLES {
            chaos.recover(role, "the first start", Instant::now(), 0);
        }
        chaos.until_ready("the start");
        chaos
    }

    fn sleep(&mut self, from_ms: f64, to_ms: f64) {
        std::thread::sleep(Duration::from_micros((1e3 * self.random.between(from_ms, to_ms)) as u64));
    }

    /// One disturbance of one role, until the line is well again.
    fn disturb(&mut self) {
        let role = ROLES[self.random.index(ROLES.len())];
        let (began, began_ns) = (Instant::now(), monotonic_ns());
        let what = match self.random.index(10) {
            // For longer than any deadline of the default configuration (3 s), shorter than the watchdog's (5 s).
            0 => {
                self.line.role(role).signal(Signal::STOP);
                self.sleep(3300.0, 4300.0);
                self.line.role(role).signal(Signal::CONT);
                self.tally.stops += 1;
                "a stop for seconds"
            }
            1 => {
                self.line.role(role).signal(Signal::TERM);
                let status = self.line.role(role).wait();
                assert!(status.success(), "{role} was asked to stop: {status}");
                self.line.start(role);
                self.tally.restarts += 1;
                "a restart"
            }
            2..=5 => {
                self.kill_while_it_starts(role);
                "kills while it started"
            }
            _ => {
                self.line.role(role).kill();
                std::thread::sleep(RESTART_SEC);
                self.line.start(role);
                self.tally.steady_kills += 1;
                "a kill"
            }
        };
        self.recover(role, what, began, began_ns);
        self.until_ready(&format!("{role} after {what}"));
        if self.plc.dropped_since(began_ns) {
            self.tally.ready_drops += 1;
        } else {
            self.tally.unseen.push(format!("{role} after {what}"));
        }
        self.tally.disturbances += 1;
    }

    /// Waits until the PLC sees the line ready, starting again whatever ends by itself.
    fn until_ready(&mut self, after: &str) {
        let (since, since_ns) = (Instant::now(), monotonic_ns());
        while !self.plc.ready_since(since_ns) {
            assert!(
                since.elapsed() < HANGS,
                "the PLC does not see the line ready again: {after}; health: {:?}; log of plc:\n{}",
                self.watcher.words(),
                self.line.log("plc")
            );
            self.watcher.listen(Duration::from_millis(5));
            self.supervise();
        }
    }

    fn kill_while_it_starts(&mut self, role: &'static str) {
        for _ in 0..=self.random.index(4) {
            self.line.role(role).kill();
            self.line.start(role);
            self.tally.startup_kills += 1;
            self.sleep(0.0, 60.0);
        }
        self.line.role(role).kill();
        self.line.start(role);
        self.tally.startup_kills += 1;
    }

    /// Waits until the role has gone a step, starting again whatever ends by itself, as systemd does.
    fn recover(&mut self, role: &'static str, what: &str, began: Instant, began_ns: u64) {
        let since = Instant::now();
        while !self.is_well(role, began_ns) {
            assert!(since.elapsed() < HANGS, "{role} hangs; its log:\n{}", self.line.log(role));
            self.watcher.listen(Duration::from_millis(5));
            self.supervise();
        }
        // One that was only stopped did not start again.
        let started = self.line.role(role).started;
        if began_ns > 0 && started > began {
            let sent_ns = self.watcher.health(role_id(role)).unwrap().stamp.sent_ns;
            let heard = Duration::from_nanos(monotonic_ns().saturating_sub(sent_ns));
            let up = started.elapsed().saturating_sub(heard);
            let (what, ms) = (format!("{role} after {what}"), 1e3 * up.as_secs_f64());
            self.tally.recoveries.push(Recovery { what, ms, load: load_average() });
        }
    }

    fn is_well(&mut self, role: &str, began_ns: u64) -> bool {
        let pid = self.line.role(role).pid();
        self.watcher.health(role_id(role)).is_some_and(|health| {
            health.pid == pid && health.state == RoleState::Running.code() && health.stamp.sent_ns > began_ns
        })
    }

    fn supervise(&mut self) {
        for name in ROLES {
            if let Some(status) = self.line.role(name).ended() {
                self.tally.ended_by_itself.push(format!("{name}: {status}"));
                std::thread::sleep(RESTART_SEC);
                self.line.start(name);
            }
        }
    }

    /// Stops everything and looks at what is left.
    fn finish(mut self, most_ms: f64) -> (String, bool) {
        self.plc.stop();
        let mut bad = self.line.stop_all_but_steward();
        self.watcher.listen(Duration::ZERO);
        let sent: Vec<_> =
            self.watcher.heard.iter().map(|verdict| (verdict.stamp.epoch, verdict.stamp.seq)).collect();
        // The steward cleans up as the last one out.
        drop(self.watcher);
        bad.extend(self.line.stop());
        let journal = self.line.journal();
        let missing = journal.unexplained(&sent);
        let leaked = self.line.shared_files();
        let well = bad.is_empty()
            && missing.is_empty()
            && leaked.is_empty()
            && self.tally.unseen.is_empty()
            && self.tally.all_within(most_ms);
        let text = self.tally.report(&[
            ("verdicts_heard", sent.len().to_string()),
            ("journal_rows", journal.verdicts().len().to_string()),
            ("journal_gaps", journal.gaps().to_string()),
            ("verdicts_missing_without_gap", missing.len().to_string()),
            ("shared_memory_files_leaked", format!("{leaked:?}")),
            ("ended_badly", format!("{bad:?}")),
        ]);
        (text, well)
    }
}
