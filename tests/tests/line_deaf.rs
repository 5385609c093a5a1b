//! A connection that fails once leaves no role deaf. The failure is injected into every connection that a role of the line makes, of messages and of
//! events, one after the other. So every channel has it at both of its ends.
//!
//! `tests/ipc_deaf.rs` does the same to single ports. Here the roles themselves must come through, and the journal and the PLC must have every
//! verdict, or a gap that stands for it.
//!
//! This is the short form: of about a hundred calls of each role it lets every seventh fail. `make deaf` lets every one fail.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::environment;
use andon_tests::line::{Line, Modbus, PATIENCE, Settings, Watcher, role_id, status};
use andon_tests::shim;
use shm_schemas::{RoleId, RoleState};
use std::ffi::OsString;
use std::time::{Duration, Instant};

/// A library in which one call of `shm_open` for a connection fails as when a process has no file descriptor left for a moment. It leaves a note.
const SHIM: &str = r#"
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
static atomic_int calls;
int shm_open(const char *name, int flags, mode_t mode) {
    static int (*real)(const char *, int, mode_t);
    if (!real) *(void **)&real = dlsym(RTLD_NEXT, "shm_open");
    const char *fails = getenv("SHIM_FAILS"), *note = getenv("SHIM_NOTE");
    int connects = strstr(name, ".connection") || strstr(name, ".data") || strstr(name, ".event_mgmt");
    if (fails && note && connects && atomic_fetch_add(&calls, 1) + 1 == atoi(fails)) {
        FILE *file = fopen(note, "w");
        if (file) {
            fputs(name, file);
            fclose(file);
        }
        errno = EMFILE;
        return -1;
    }
    return real(name, flags, mode);
}
"#;

struct Bench {
    line: Line,
    watcher: Watcher,
    plc: Modbus,
    shim: OsString,
}

impl Bench {
    fn new() -> Self {
        let mut line = Line::new(Settings { writes: true, ..Settings::live() });
        let shim = shim::compiled(&line.path(""), SHIM);
        let watcher = line.up();
        let mut plc = Modbus::connect_when_up(line.port);
        plc.enable();
        plc.wait_for(status::READY);
        Self { line, watcher, plc, shim }
    }

    /// Starts a role again whose call number `fails` fails. The name of the file, if there was such a call. It has also how long the line took to be
    /// whole again, counted from the role's first sign of work or its second start.
    fn inject(&mut self, role: &'static str, fails: usize) -> Option<(String, Duration)> {
        let note = self.line.path("note");
        let _ = std::fs::remove_file(&note);
        self.line.role(role).kill();
        self.line.environment = vec![
            ("LD_PRELOAD", self.shim.clone()),
            ("SHIM_FAILS", fails.to_string().into()),
            ("SHIM_NOTE", note.clone().into()),
        ];
        self.line.start(role);
        self.line.environment.clear();
        let began = Instant::now();
        self.until_up(role);
        let up = Instant::now();
        self.until_whole(role, fails);
        let hit = std::fs::read_to_string(&note).ok()?;
        let took = up.elapsed();
        println!(
            "{role} {fails}: whole {took:?} after it was up, {:?} after its start: {hit}",
            began.elapsed()
        );
        Some((hit, took))
    }

    /// Waits until the role works, or has worked: the judge is up once couples have come. One that ends is started again, as systemd does it.
    fn until_up(&mut self, role: &'static str) {
        let until = Instant::now() + PATIENCE;
        loop {
            if self.line.role(role).ended().is_some() {
                self.line.start(role);
            }
            let pid = self.line.role(role).pid();
            self.watcher.listen(Duration::from_millis(20));
            if self.watcher.health(role_id(role)).is_some_and(|health| health.pid == pid) {
                return;
            }
            assert!(Instant::now() < until, "{role} does not come up:\n{}", self.line.log(role));
        }
    }

    /// Waits until all roles run and the PLC sees the line ready. What the judge has sent since must be in the journal and at the PLC.
    fn until_whole(&mut self, role: &'static str, fails: usize) {
        let what = |line: &Line, what: &str, watcher: &Watcher| {
            let health = watcher.describe_health();
            let hit = std::fs::read_to_string(line.path("note")).unwrap_or_default();
            panic!("{role}, call {fails}, {hit}: {what}; {health:?}\n{}\n{}", line.log(role), line.log("plc"))
        };
        let until = Instant::now() + PATIENCE;
        if role == "plc" {
            self.plc = Modbus::connect_when_up(self.line.port);
        }
        loop {
            // A fault that was latched meanwhile is reset, as a person does it.
            let _ = self.plc.control(33);
            let _ = self.plc.control(1);
            let is_ready = self.plc.status().is_ok_and(|word| word & status::READY != 0);
            let pids = andon_tests::line::ROLES.map(|name| (role_id(name), self.line.role(name).pid()));
            if is_ready && pids.iter().all(|(id, pid)| self.watcher.runs(*id, *pid)) {
                break;
            }
            if Instant::now() > until {
                what(&self.line, "the line is not whole", &self.watcher);
            }
            self.watcher.listen(Duration::from_millis(20));
        }
    }
}

/// The roles in turn. The steward makes the services themselves; a failure there ends it, and systemd starts it again.
fn every_call_of(role: &'static str) {
    let mut bench = Bench::new();
    let mut longest = (Duration::ZERO, String::new());
    let every = environment::number("ANDON_EVERY", 7) as usize;
    let mut fails = 1;
    while let Some((name, took)) = bench.inject(role, fails) {
        if took > longest.0 {
            longest = (took, format!("call {fails}, {name}"));
        }
        fails += every;
    }
    assert!(fails > 4 * every, "{role} opens files of shared memory");
    println!("{role}: every {every} of {fails} calls; the longest took {:?} ({})", longest.0, longest.1);
    // What was sent last is on disk, and nothing is missing without a gap.
    let from = bench.watcher.verdicts.len();
    bench.watcher.until("a verdict", |watcher| watcher.verdicts.len() > from);
    let sent = bench.watcher.verdict_keys();
    let until = Instant::now() + PATIENCE;
    while !bench.line.journal().unexplained(&sent).is_empty() {
        assert!(Instant::now() < until, "{:?}", bench.line.journal().unexplained(&sent));
        std::thread::sleep(Duration::from_millis(100));
    }
    assert!(bench.watcher.is(RoleId::Judge, RoleState::Running));
}

#[test]
fn no_failure_in_perceive_leaves_a_role_deaf() {
    every_call_of("perceive");
}

#[test]
fn no_failure_in_encode_leaves_a_role_deaf() {
    every_call_of("encode");
}

#[test]
fn no_failure_in_the_judge_leaves_a_role_deaf() {
    every_call_of("judge");
}

#[test]
fn no_failure_in_the_journal_leaves_a_role_deaf() {
    every_call_of("journal");
}

#[test]
fn no_failure_in_plc_leaves_a_role_deaf() {
    every_call_of("plc");
}
