//! Kills, stops and restarts the roles of a line at random, also while they start. It does so with the program of a PLC that acknowledges every
//! result and gives part ids, and with the recorder of everything. Checks what is left.
//!
//! `chaos [KILLS] [SEED] [REPORT] [P99_MS]` fails when something hangs, or when a verdict is lost or doubled for the journal or for the PLC. It fails
//! when a job was OK that was not right and whole. It also fails when one was OK for a part or by a job that the PLC did not want then. It fails when
//! no right job was OK or no wrong one was found while nothing was disturbed. It fails when the line was ready while it could not judge, or not by
//! the job that the PLC wants. It fails when shared memory is leaked, or when the PLC did not see `ready` drop. It fails when a recording cannot be
//! read to its end. It fails when of a hundred roles more than one took longer than `P99_MS` to come back. Without `P99_MS` that time is only reported,
//! because it depends on how busy the machine is.
#![allow(clippy::unwrap_used, clippy::panic)]

mod accounts;
mod earned;
mod oracle;
mod poller;
mod tally;

use andon_ipc::MonotonicTime;
use andon_tests::line::{Line, ROLES, Settings, Shift, Watcher, detections_in, role_id, told_last};
use andon_tests::measure::{Arguments, report};
use andon_tests::simulator::{Flaw, Random};
use earned::Recording;
use oracle::Oracle;
use poller::Poller;
use rustix::process::Signal;
use serde_json::{Value, json};
use shm_schemas::{RoleState, VerdictLevel, VerdictOutcome};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use tally::{Recovery, Tally, load_average};

/// `RestartSec` of the units.
const RESTART_SEC: Duration = Duration::from_millis(100);
/// Nothing waits for it, and no verdict needs it.
const RECORDER: &str = "record";
/// The jobs of the parts, in turn.
const JOBS: &str = "1,2";
/// A role that has come back may have been heard here before the PLC's side has heard it.
const NOTICED: Duration = Duration::from_secs(1);
/// A judge that works and does not watch, because it has not been given back job and `enable`, cannot judge either. Nor can one that has
/// another job than the PLC was told that it has.
const WATCH: &str = "the judge's watch";
/// What the worker does in turn. Most parts are right, so that there are OKs that could be false. The one that is not comes early: with every
/// start of `perceive` the worker begins again.
const WORK: [Flaw; 4] = [Flaw::None, Flaw::WrongOrder, Flaw::None, Flaw::None];
/// Between two parts, in seconds: longer than `idle_end_ms`, so that a judge that has started again sees the next job begin.
const PAUSE_S: f64 = 5.0;
/// After every 10 disturbances the worker is left alone until a part is right, and every third time until one is not.
const CALM_EVERY: u64 = 10;
const WRONG_EVERY: u64 = 3 * CALM_EVERY;
/// A role that has not come back after this long hangs.
const HANGS: Duration = Duration::from_secs(30);

fn main() -> ExitCode {
    let arguments = Arguments::of_this_program();
    let (kills, seed) = (arguments.number(0, 1000), arguments.number(1, 1));
    let path = arguments.path(2, "target/chaos/report.json");
    let mut chaos = Chaos::start(seed, path.with_extension("evidence"));
    while chaos.tally.kills() < kills {
        chaos.disturb();
    }
    chaos.leave_alone(VerdictOutcome::Ok);
    chaos.leave_alone(VerdictOutcome::Anomaly);
    let (text, has_passed) = chaos.finish(arguments.number(3, f64::INFINITY));
    report(path, &text, has_passed)
}

/// Where something has failed, the files of the line are kept beside the report, with every log. Its recordings are too: `andond replay` says what led to
/// each verdict.
struct Evidence {
    from: PathBuf,
    to: PathBuf,
    is_wanted: bool,
}

impl Drop for Evidence {
    fn drop(&mut self) {
        if !self.is_wanted && !std::thread::panicking() {
            return;
        }
        let _ = std::fs::create_dir_all(&self.to);
        let folders = [self.from.clone(), self.from.join("recordings")];
        let files = folders.iter().flat_map(std::fs::read_dir).flatten().flatten();
        for file in files.filter(|file| file.path().is_file()) {
            let _ = std::fs::copy(file.path(), self.to.join(file.file_name()));
        }
    }
}

struct Chaos {
    /// Dropped before the line, whose folder it reads.
    evidence: Evidence,
    line: Line,
    watcher: Watcher,
    program: Shift,
    poller: Poller,
    oracle: Oracle,
    recording: Recording,
    random: Random,
    tally: Tally,
}

impl Chaos {
    fn start(seed: u64, to: PathBuf) -> Self {
        let mut line = Line::with_second_job(Settings { writes: true, ..Settings::live() });
        let (works_s, length_s) = line.work_in_turn(&WORK, PAUSE_S);
        let works_s = works_s.into_iter().zip(WORK);
        let right_s = works_s.filter(|(_, flaw)| *flaw == Flaw::None).map(|(work_s, _)| work_s).collect();
        let recording = Recording { right_s, length_s };
        let evidence = Evidence { from: line.path(""), to, is_wanted: false };
        line.record("always");
        let watcher = line.launch_recorded();
        let (program, poller) = (Shift::start(&line, JOBS), Poller::start(line.port));
        let (oracle, random, tally) = (Oracle::default(), Random::new(seed, &[]), Tally::default());
        let mut chaos = Self { evidence, line, watcher, program, poller, oracle, recording, random, tally };
        for role in ROLES {
            chaos.recover(role, "the first start", Instant::now(), 0);
        }
        chaos.until_ready("the start");
        chaos
    }

    fn sleep(&mut self, from_ms: f64, to_ms: f64) {
        std::thread::sleep(Duration::from_micros((1e3 * self.random.between(from_ms, to_ms)) as u64));
    }

    /// Disturbs one role, or the PLC's program, and waits until the line is ready again.
    fn disturb(&mut self) {
        let index = self.random.index(ROLES.len() + 2);
        let Some(&role) = ROLES.get(index) else {
            return if index == ROLES.len() { self.restart_program() } else { self.kill_recorder() };
        };
        let (began, began_ns) = (Instant::now(), MonotonicTime::now().nanoseconds());
        let what = match self.random.index(10) {
            // Longer than any deadline of the default configuration (3 s), shorter than the watchdog's (5 s).
            0 => {
                self.stop_for_seconds(role);
                "a stop for seconds"
            }
            1 => {
                self.restart(role);
                "a restart"
            }
            2..=5 => {
                self.kill_while_it_starts(role);
                "kills while it started"
            }
            _ => {
                self.kill(role);
                std::thread::sleep(RESTART_SEC);
                self.line.start(role);
                self.tally.steady_kills += 1;
                "a kill"
            }
        };
        self.recover(role, what, began, began_ns);
        self.until_ready(&format!("{role} after {what}"));
        let until = Instant::now() + NOTICED;
        while !self.poller.dropped_since(began_ns) && Instant::now() < until {
            self.listen(Duration::from_millis(5));
        }
        self.until_ready(&format!("{role} after {what}, which was noticed late"));
        if self.poller.dropped_since(began_ns) {
            self.tally.ready_drops += 1;
        } else {
            self.tally.unseen.push(format!("{role} after {what}"));
        }
        self.tally.disturbances += 1;
        if self.tally.disturbances.is_multiple_of(WRONG_EVERY) {
            self.leave_alone(VerdictOutcome::Anomaly);
        } else if self.tally.disturbances.is_multiple_of(CALM_EVERY) {
            self.leave_alone(VerdictOutcome::Ok);
        }
    }

    /// Until a job that began after the last disturbance comes out so. One of the recording does, wherever it was.
    fn leave_alone(&mut self, outcome: VerdictOutcome) {
        let (since, since_ns) = (Instant::now(), MonotonicTime::now().nanoseconds());
        let patience = Duration::from_secs_f64(2.0 * self.recording.length_s);
        let heard = self.watcher.verdicts.len();
        while since.elapsed() < patience {
            self.listen(Duration::from_millis(50));
            self.supervise();
            let is_so = self.watcher.verdicts[heard..].iter().any(|verdict| {
                verdict.level == VerdictLevel::Job.code()
                    && verdict.outcome == outcome.code()
                    && verdict.stamp.sent_ns.saturating_sub(verdict.decided_ns - verdict.began_ns) > since_ns
            });
            if is_so {
                self.tally.calm_s.push(since.elapsed().as_secs_f64());
                return;
            }
        }
        self.tally.in_vain.push(format!("no job was {} although nothing was disturbed", outcome.name()));
    }

    /// As a controller that loses its power. The line goes on.
    fn restart_program(&mut self) {
        self.program.kill();
        self.sleep(0.0, 1000.0);
        self.program = Shift::start(&self.line, JOBS);
        self.tally.program_kills += 1;
    }

    /// The line goes on, and to the PLC it is as ready as before.
    fn kill_recorder(&mut self) {
        let since_ns = MonotonicTime::now().nanoseconds();
        self.line.role(RECORDER).kill();
        self.sleep(0.0, 1000.0);
        self.line.start(RECORDER);
        self.recover(RECORDER, "a kill", Instant::now(), since_ns);
        if let Some(drop) = self.poller.first_drop_since(since_ns) {
            let asked_ms = drop.asked_ns.saturating_sub(since_ns) / 1_000_000;
            let took_ms = (drop.answered_ns - drop.asked_ns) / 1_000_000;
            self.tally
                .needless_drops
                .push(format!("asked {asked_ms} ms after its kill, answered in {took_ms} ms"));
        }
        self.tally.recorder_kills += 1;
    }

    fn stop_for_seconds(&mut self, role: &'static str) {
        self.line.role(role).signal(Signal::STOP);
        self.oracle.unable(role, "a stop", MonotonicTime::now().nanoseconds());
        self.sleep(3300.0, 4300.0);
        self.oracle.able(role, MonotonicTime::now().nanoseconds());
        self.line.role(role).signal(Signal::CONT);
        self.tally.stops += 1;
    }

    fn restart(&mut self, role: &'static str) {
        self.line.role(role).signal(Signal::TERM);
        let status = self.line.role(role).wait();
        assert!(status.success(), "{role} was asked to stop: {status}");
        self.oracle.unable(role, "an orderly stop", MonotonicTime::now().nanoseconds());
        self.line.start(role);
        self.tally.restarts += 1;
    }

    fn kill(&mut self, role: &'static str) {
        self.line.role(role).kill();
        let killed_ns = MonotonicTime::now().nanoseconds();
        self.listen(Duration::ZERO);
        self.oracle.unable(role, "a kill", killed_ns);
    }

    fn kill_while_it_starts(&mut self, role: &'static str) {
        for _ in 0..=self.random.index(4) {
            self.kill(role);
            self.line.start(role);
            self.tally.startup_kills += 1;
            self.sleep(0.0, 60.0);
        }
        self.kill(role);
        self.line.start(role);
        self.tally.startup_kills += 1;
    }

    /// Takes what has come. The oracle hears who works.
    fn listen(&mut self, patience: Duration) {
        self.watcher.listen(patience);
        for role in ROLES {
            let Some(health) = self.watcher.health(role_id(role)) else { continue };
            let is_its_own = health.pid == self.line.role(role).pid();
            if is_its_own && health.state == RoleState::Running.code() {
                self.oracle.works(role, health.stamp.sent_ns);
            }
        }
        let Some((said_ns, watches)) = self.watcher.watches() else { return };
        // The PLC may not know yet that the judge has started again; what it was told of before counts.
        let wanted = told_last(&self.line).filter(|told| told.is_job_taken).map(|told| told.job);
        if !watches {
            self.oracle.unable(WATCH, "a start of the judge", said_ns);
        } else if wanted.is_none_or(|job| self.watcher.judging.is_some_and(|judging| judging.job_id == job)) {
            self.oracle.works(WATCH, said_ns);
        } else {
            self.oracle.unable(WATCH, "a start of the judge with another job", said_ns);
        }
    }

    /// Waits until the PLC sees the line ready. Starts every role that ends by itself again.
    fn until_ready(&mut self, after: &str) {
        let (since, since_ns) = (Instant::now(), MonotonicTime::now().nanoseconds());
        while !self.poller.ready_since(since_ns) {
            assert!(
                since.elapsed() < HANGS,
                "the PLC does not see the line ready again: {after}; health: {:?}; logs of plc and judge:\n{}\n{}",
                self.watcher.describe_health(),
                self.line.log("plc"),
                self.line.log("judge")
            );
            self.listen(Duration::from_millis(5));
            self.supervise();
        }
    }

    /// Waits until the role has done a step. Starts every role that ends by itself again, as systemd does.
    fn recover(&mut self, role: &'static str, what: &str, began: Instant, began_ns: u64) {
        let since = Instant::now();
        while !self.is_running(role, began_ns) {
            assert!(since.elapsed() < HANGS, "{role} hangs; its log:\n{}", self.line.log(role));
            self.listen(Duration::from_millis(5));
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
        for name in ROLES.into_iter().chain([RECORDER]) {
            if let Some(status) = self.line.role(name).ended() {
                self.tally.ended_by_itself.push(format!("{name}: {status}"));
                self.oracle.unable(name, "its own end", MonotonicTime::now().nanoseconds());
                std::thread::sleep(RESTART_SEC);
                self.line.start(name);
            }
        }
    }

    /// Ends the shift, stops everything and checks what is left. Returns the report, and whether it is as it must be.
    fn finish(mut self, p99_ms: f64) -> (Value, bool) {
        let said = self.program.end();
        let answers = self.poller.stop();
        let mut failures = self.line.stop_all_but_steward();
        self.watcher.listen(Duration::ZERO);
        let heard = std::mem::take(&mut self.watcher.verdicts);
        // The steward cleans up when it is the last member.
        drop(self.watcher);
        failures.extend(self.line.stop_recorded());
        let (detections, unreadable) = recorded(&self.line);
        failures.extend(unreadable);
        failures.extend(accounts::differences(&self.line, &heard, &self.recording));
        if !said.contains("\"missed\": 0,") {
            failures.push(format!("the PLC's program says {said}"));
        }
        let (ready, false_ready) = self.oracle.judge(&answers);
        failures.extend(false_ready);
        failures.extend(self.line.shared_files().iter().map(|name| format!("left in shared memory: {name}")));
        failures.append(&mut self.tally.in_vain);
        let needless = self.tally.needless_drops.iter();
        failures.extend(needless.map(|drop| format!("ready dropped for the recorder alone: {drop}")));
        failures.extend(self.tally.unseen.iter().map(|what| format!("ready did not drop: {what}")));
        if self.tally.p99_ms() > p99_ms {
            failures
                .push(format!("of a hundred roles more than one took longer than {p99_ms} ms to come back"));
        }
        let mut text = self.tally.json();
        text["recorded_detections"] = json!(detections);
        text["verdicts"] = accounts::counts(&self.line, &heard);
        text["ready_while_a_role_could_not_work"] = ready;
        text["failures"] = json!(failures);
        self.evidence.is_wanted = !failures.is_empty();
        (text, failures.is_empty())
    }
}

/// How many detections the recordings of a line hold, and what is wrong with those that cannot be read to their ends.
fn recorded(line: &Line) -> (usize, Vec<String>) {
    let (read, failed): (Vec<_>, Vec<_>) =
        line.recordings().iter().map(|recording| detections_in(recording)).partition(Result::is_ok);
    (read.into_iter().flatten().sum(), failed.into_iter().filter_map(Result::err).collect())
}
