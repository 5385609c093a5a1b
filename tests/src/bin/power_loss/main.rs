//! Takes the power from a line at random, in the middle of what its journal does to the disk. Checks that what was confirmed is there.
//!
//! `power_loss [CUTS] [SEED] [REPORT]`: steward, journal and plc are the real roles. The judge is this program, so that there is always something to
//! write, and so is the PLC, which acknowledges every result. The journal runs with the library of `disk`. Each time it is ended before one of its
//! writes, truncations or synchronisations, in one life of four after it was asked to stop. Everything else is ended with it, shared memory is gone,
//! and of what was not synchronised `disk` leaves what chance wants. Fails when the database does not open, or when a verdict that the PLC was
//! offered is not in it, or twice. Fails when the PLC is offered what it has acknowledged, or another verdict under a number that it knows. Fails
//! when a start of the line has a number that the PLC knows.
#![allow(clippy::unwrap_used, clippy::panic)]

mod disk;
mod plc;

use andon_tests::line::{Line, Sender, Settings};
use andon_tests::measure::{Arguments, report};
use andon_tests::simulator::Random;
use disk::{Disk, Lost};
use plc::Plc;
use rustix::process::Signal;
use serde_json::{Value, json};
use shm_schemas::{RoleId, Verdict, VerdictLevel, VerdictOutcome};
use std::collections::HashSet;
use std::fs;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// A life ends before the journal has done more than this to its disk. Opening takes about 20, and a verdict with its acknowledgement 20.
const MAX_STEPS: usize = 160;
/// The cycle of the PLC: the journal is at work for most of the time.
const SCAN: Duration = Duration::from_millis(1);
/// Verdicts that may be under way to the PLC: fewer than wait for it without a loss.
const UNDER_WAY: usize = 4;
/// Whatever must happen sooner or later has happened by then.
const PATIENCE: Duration = Duration::from_secs(60);

fn main() -> ExitCode {
    let arguments = Arguments::of_this_program();
    let (cuts, seed) = (arguments.number(0, 500), arguments.number(1, 1));
    let mut station = Station::new(seed);
    for _ in 0..cuts {
        station.live_until_cut();
    }
    let (text, has_passed) = station.finish(cuts);
    report(arguments.path(2, "target/power_loss/report.json"), &text, has_passed)
}

struct Station {
    line: Line,
    disk: Disk,
    plc: Plc,
    random: Random,
    failures: Vec<String>,
    lost: Lost,
    /// Lives in which the journal ended in good order before the cut.
    closed: usize,
    /// Cuts that found something that was not synchronised.
    unsynchronised: usize,
}

impl Station {
    fn new(seed: u64) -> Self {
        let line = Line::new(Settings { writes: true, ..Settings::default() });
        line.reconfigure("path = \"journal.sqlite\"", "path = \"disk/journal.sqlite\"");
        let folder = line.path("disk");
        fs::create_dir(&folder).unwrap();
        let disk = Disk::new(folder, line.path("x").parent().unwrap());
        Self {
            line,
            disk,
            plc: Plc::default(),
            random: Random::new(seed, &[]),
            failures: Vec::new(),
            lost: Lost::default(),
            closed: 0,
            unsynchronised: 0,
        }
    }

    /// Switches the line on, lets it work, and takes its power.
    fn live_until_cut(&mut self) {
        let mounted = self.disk.mount();
        let cut = 1 + self.random.index(MAX_STEPS);
        let stop_after = (self.random.index(4) == 0).then(|| self.random.index(6));
        let mut judge = self.switch_on(cut);
        self.work(&mut judge, stop_after);
        drop(judge);
        self.closed += usize::from(self.line.role("journal").wait().success());
        self.switch_off();
        let lost = self.disk.cut(mounted, &mut self.random);
        self.unsynchronised += usize::from(lost.sectors + lost.names > 0);
        self.lost.add(&lost);
    }

    fn switch_on(&mut self, cut: usize) -> Sender<Verdict> {
        self.line.start("steward");
        let judge = Sender::new(&self.line, RoleId::Judge, &[RoleId::Journal]);
        self.line.environment = self.disk.environment(cut);
        self.line.start("journal");
        self.line.environment.clear();
        self.line.start("plc");
        self.plc.power_is_back();
        judge
    }

    /// Everything ends at once, and nothing that was in memory is left.
    fn switch_off(&mut self) {
        self.line.roles.clear();
        let _ = fs::remove_dir_all(self.line.station.root());
        for name in self.line.shared_files() {
            let _ = fs::remove_file(format!("/dev/shm/{name}"));
        }
    }

    /// Sends verdicts and takes their results until the journal has ended, which it is asked to do after this number of results.
    fn work(&mut self, judge: &mut Sender<Verdict>, stop_after: Option<usize>) {
        let until = Instant::now() + PATIENCE;
        let (mut written, mut before, mut is_asked_to_stop) = (None, 0, false);
        while self.line.role("journal").ended().is_none() {
            assert!(
                Instant::now() < until,
                "nothing is cut; {:?}; log of the journal:\n{}",
                self.failures,
                self.line.log("journal")
            );
            self.failures.extend(self.plc.look(self.line.port));
            if self.plc.is_told() && written.is_none() {
                (written, before) = (Some(self.check_journal()), self.plc.acknowledged());
            }
            std::thread::sleep(SCAN);
            let (Some(written), taken) = (written.as_mut(), self.plc.acknowledged()) else { continue };
            if *written < taken + UNDER_WAY && judge.send_within(Duration::from_millis(2), correct) {
                *written += 1;
            }
            if stop_after.is_some_and(|results| taken >= before + results) && !is_asked_to_stop {
                self.line.role("journal").signal(Signal::TERM);
                is_asked_to_stop = true;
            }
        }
    }

    /// Every verdict that the PLC was ever offered is in the journal, and none is there twice. Returns how many there are.
    fn check_journal(&mut self) -> usize {
        let rows = self.line.journal().verdicts();
        let distinct: HashSet<_> = rows.iter().copied().collect();
        if distinct.len() != rows.len() {
            self.failures.push(format!("{} verdicts are there twice", rows.len() - distinct.len()));
        }
        let missing = self.plc.offered().filter(|verdict| !distinct.contains(verdict));
        self.failures.extend(missing.map(|verdict| format!("confirmed and gone: {verdict:?}")));
        rows.len()
    }

    /// One more life, which lasts. Returns the report, and whether it is as it must be.
    fn finish(mut self, cuts: usize) -> (Value, bool) {
        let judge = self.switch_on(0);
        let until = Instant::now() + PATIENCE;
        while !self.plc.is_told() {
            assert!(
                Instant::now() < until,
                "the line does not come up; log of the journal:\n{}",
                self.line.log("journal")
            );
            self.failures.extend(self.plc.look(self.line.port));
        }
        self.check_journal();
        drop(judge);
        let log = self.line.log("journal");
        for code in ["AND-404", "AND-407"] {
            let lines = log.lines().filter(|line| line.contains(code));
            self.failures.extend(lines.map(|line| format!("the database did not open: {line}")));
        }
        let text = json!({
            "cuts": cuts,
            "cuts_after_an_orderly_stop": self.closed,
            "cuts_with_something_not_synchronised": self.unsynchronised,
            "sectors_not_synchronised": self.lost.sectors,
            "sectors_lost": self.lost.gone,
            "names_not_synchronised": self.lost.names,
            "names_lost": self.lost.names_gone,
            "verdicts_confirmed": self.plc.offered().count(),
            "acknowledgements_confirmed": self.plc.acknowledged(),
            "rows": self.line.journal().verdicts().len(),
            "failures": self.failures,
        });
        (text, self.failures.is_empty())
    }
}

fn correct(verdict: &mut Verdict) {
    verdict.level = VerdictLevel::Job.code();
    verdict.outcome = VerdictOutcome::Ok.code();
}
