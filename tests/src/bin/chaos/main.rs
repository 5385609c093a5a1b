//! Kills, stops and restarts the roles of a line at random, also while they start, and checks what is left.
//!
//! `chaos [KILLS] [SEED] [REPORT] [MAX_MS]`: fails when something hangs, when a verdict is missing from the journal without a
//! gap, when shared memory is leaked, when the PLC did not see `ready` drop, or when a role took longer than `MAX_MS` to
//! come back. Without `MAX_MS` that time is only reported, because it depends on how busy the machine is.
#![allow(clippy::unwrap_used, clippy::panic)]

mod plc;
mod tally;

use andon_ipc::MonotonicTime;
use andon_tests::line::{Line, ROLES, Settings, Watcher, role_id};
use andon_tests::measure::{Arguments, report};
use andon_tests::simulator::Random;
use plc::Plc;
use rustix::process::Signal;
use serde_json::{Value, json};
use shm_schemas::RoleState;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use tally::{Recovery, Tally, load_average};

/// `RestartSec` of the units.
const RESTART_SEC: Duration = Duration::from_millis(100);
/// A role that has not come back after this long hangs.
const HANGS: Duration = Duration::from_secs(30);

fn main() -> ExitCode {
    let arguments = Arguments::of_this_program();
    let (kills, seed) = (arguments.number(0, 1000), arguments.number(1, 1));
    let mut chaos = Chaos::start(seed);
    while chaos.tally.kills() < kills {
        chaos.disturb();
    }
    let (text, has_passed) = chaos.finish(arguments.number(3, f64::INFINITY));
    report(arguments.path(2, "target/chaos/report.json"), &text, has_passed)
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
        let mut line = Line::new(Settings::live());
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

    /// Disturbs one role and waits until the line is ready again.
    fn disturb(&mut self) {
        let role = ROLES[self.random.index(ROLES.len())];
        let (began, began_ns) = (Instant::now(), MonotonicTime::now().nanoseconds());
        let what = match self.random.index(10) {
            // Longer than any deadline of the default configuration (3 s), shorter than the watchdog's (5 s).
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

    /// Waits until the PLC sees the line ready. Starts every role that ends by itself again.
    fn until_ready(&mut self, after: &str) {
        let (since, since_ns) = (Instant::now(), MonotonicTime::now().nanoseconds());
        while !self.plc.ready_since(since_ns) {
            assert!(
                since.elapsed() < HANGS,
                "the PLC does not see the line ready again: {after}; health: {:?}; log of plc:\n{}",
                self.watcher.describe_health(),
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

    /// Waits until the role has done a step. Starts every role that ends by itself again, as systemd does.
    fn recover(&mut self, role: &'static str, what: &str, began: Instant, began_ns: u64) {
        let since = Instant::now();
        while !self.is_running(role, began_ns) {
            assert!(since.elapsed() < HANGS, "{role} hangs; its log:\n{}", self.line.log(role));
            self.watcher.listen(Duration::from_millis(5));
            self.supervise();
        }
        // A role that was only stopped has not been started again.
        let started = self.line.role(role).started;
        if began_ns > 0 && started > began {
            let sent_ns = self.watcher.health(role_id(role)).unwrap().stamp.sent_ns;
            let age = MonotonicTime::now().since(MonotonicTime::from_nanoseconds(sent_ns));
            let up = started.elapsed().saturating_sub(age);
            let (what, ms) = (format!("{role} after {what}"), 1e3 * up.as_secs_f64());
            self.tally.recoveries.push(Recovery { what, ms, load: load_average() });
        }
    }

    fn is_running(&mut self, role: &str, began_ns: u64) -> bool {
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

    /// Stops everything and checks what is left. Returns the report, and whether it is as it must be.
    fn finish(mut self, max_ms: f64) -> (Value, bool) {
        self.plc.stop();
        let mut failures = self.line.stop_all_but_steward();
        self.watcher.listen(Duration::ZERO);
        let sent = self.watcher.verdict_keys();
        // The steward cleans up when it is the last member.
        drop(self.watcher);
        failures.extend(self.line.stop());
        let journal = self.line.journal();
        let missing = journal.unexplained(&sent);
        let leaked = self.line.shared_files();
        let has_passed = failures.is_empty()
            && missing.is_empty()
            && leaked.is_empty()
            && self.tally.unseen.is_empty()
            && self.tally.slower_than(max_ms).is_empty();
        let mut text = self.tally.json();
        text["verdicts_received"] = json!(sent.len());
        text["journal_rows"] = json!(journal.verdicts().len());
        text["journal_gaps"] = json!(journal.gaps());
        text["verdicts_missing_without_gap"] = json!(missing.len());
        text["shared_memory_files_leaked"] = json!(leaked);
        text["failures"] = json!(failures);
        (text, has_passed)
    }
}
