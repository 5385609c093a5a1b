//! Faults of the machine and of the installation: each is logged with its code and remedy, and nothing hangs.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_ipc::{Node, Stop};
use andon_tests::line::{Killed, Line, PATIENCE, ROLES, Settings, Watcher, andond, role_id};
use andon_tests::shim;
use shm_schemas::{Layout, RoleId, RoleState, Verdict};
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Duration;

/// A line that is up.
fn up(settings: Settings) -> (Line, Watcher) {
    let mut line = Line::new(settings);
    let watcher = line.up();
    (line, watcher)
}

#[test]
fn a_second_steward_is_refused_and_the_first_goes_on() {
    let (line, mut watcher) = up(Settings::live());
    let second = Command::new(andond()).args(["run", "steward", "-c"]).arg(line.config()).output().unwrap();
    let errors = String::from_utf8_lossy(&second.stderr);
    assert_eq!(second.status.code(), Some(70), "{errors}");
    assert!(errors.contains("AND-604") && errors.contains("systemctl status andon-steward@"), "{errors}");
    let before = watcher.verdicts.len();
    watcher.until("a verdict", |watcher| watcher.verdicts.len() > before);
}

#[test]
fn a_role_without_a_steward_logs_that_and_ends_with_the_code_that_systemd_restarts_on() {
    let mut line = Line::new(Settings::default());
    assert_eq!(line.start("judge").wait().code(), Some(70));
    line.wait_for_log("judge", "AND-605", "systemctl start andon-steward@");
}

#[test]
fn a_journal_whose_database_is_locked_waits_and_loses_nothing() {
    let (mut line, mut watcher) = up(Settings::live());
    // As when somebody opens the database by hand and leaves a transaction open.
    let hold = "import sqlite3, sys\nc = sqlite3.connect(sys.argv[1])\nc.execute('BEGIN IMMEDIATE')\n\
                print('locked', flush=True)\nsys.stdin.read()\n";
    let mut holder = Command::new("python3")
        .args(["-c", hold])
        .arg(line.path("journal.sqlite"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut word = [0; 6];
    std::io::Read::read_exact(holder.stdout.as_mut().unwrap(), &mut word).unwrap();
    line.wait_for_log("journal", "AND-403", "fuser");
    watcher.until("the journal's fault", |watcher| watcher.is(RoleId::Journal, RoleState::Fault));
    drop(holder.stdin.take());
    holder.wait().unwrap();
    let sent = watcher.newest_verdict_key().unwrap();
    watcher.until("the journal", |watcher| watcher.is(RoleId::Journal, RoleState::Running));
    line.stop();
    watcher.listen(Duration::ZERO);
    let rows = line.journal();
    assert!(rows.verdicts().contains(&sent));
    assert_eq!(rows.gaps(), 0);
}

/// The longest file of a role that [`start_on_full_disk`] has started.
const ROOM: usize = 1600 * 512;

/// Starts a role on a disk that is nearly full, of which no file may grow over 1600 blocks: its longest file in shared memory has 1050. The signal is ignored, so that the write fails as it does on a full disk.
fn start_on_full_disk(line: &Line, role: &str) -> Killed {
    let log = std::fs::File::create(line.path(&format!("{role}.log"))).unwrap();
    let child = Command::new("sh")
        .args(["-c", "trap '' XFSZ; ulimit -f 1600; exec \"$0\" run \"$1\" -c \"$2\" 2>&1"])
        .arg(andond())
        .arg(role)
        .arg(line.config())
        .stdout(log)
        .spawn();
    Killed(child.unwrap())
}

#[test]
fn a_disk_that_is_full_is_logged_and_what_was_confirmed_stays() {
    let mut line = Line::new(Settings::live());
    line.start("steward");
    let mut watcher = Watcher::join(&line.station);
    line.start_all_but(&["steward", "journal"]);
    let journal = start_on_full_disk(&line, "journal");
    watcher.until("the journal's fault", |watcher| watcher.is(RoleId::Journal, RoleState::Fault));
    line.wait_for_log("journal", "AND-402", "Make room on the disk");
    drop(journal);
    let rows = line.journal().verdicts();
    assert!(!rows.is_empty());
    // There is room again.
    line.start("journal");
    let sent = watcher.newest_verdict_key().unwrap();
    watcher.until("the journal", |watcher| watcher.is(RoleId::Journal, RoleState::Running));
    line.stop();
    watcher.listen(Duration::ZERO);
    assert_eq!(line.journal().unexplained(&[sent]), []);
    assert!(line.journal().verdicts().starts_with(&rows));
}

#[test]
fn a_configuration_that_cannot_be_saved_is_logged_and_the_line_comes_up_all_the_same() {
    let mut line = Line::new(Settings::live());
    // Nothing is read from there, because no role of this line looks at pictures.
    let models = "m".repeat(2 * ROOM);
    line.reconfigure("[plc]\n", &format!("[perception]\nmodels = {models:?}\n\n[plc]\n"));
    let _steward = start_on_full_disk(&line, "steward");
    let mut watcher = Watcher::join(&line.station);
    line.start_all_but(&["steward"]);
    line.wait_for_log("steward", "AND-803", "Make room in the file system of station.root");
    watcher.until("a verdict", |watcher| !watcher.verdicts.is_empty());
}

#[test]
fn a_full_dev_shm_is_found_before_anything_starts() {
    let line = Line::new(Settings::default());
    // A /dev/shm of 1 MiB for this process alone, where this user may mount one.
    let script = "mount -t tmpfs -o size=1m none /dev/shm && exec \"$0\" run steward -c \"$1\"";
    let output = Command::new("unshare")
        .args(["--mount", "--map-root-user", "sh", "-c", script])
        .arg(andond())
        .arg(line.config())
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(
        errors.contains("AND-"),
        "no /dev/shm of its own can be made here; run the tests as root, or allow user namespaces \
         (`sysctl kernel.unprivileged_userns_clone=1`): {errors}"
    );
    assert_eq!(output.status.code(), Some(70), "{errors}");
    assert!(errors.contains("AND-603") && errors.contains("mount -o remount"), "{errors}");
}

/// The program as another version would be, with another layout hash of verdicts. Returns its path.
fn other_version(line: &Line) -> PathBuf {
    let mut program = std::fs::read(andond()).unwrap();
    let hash = Verdict::HASH.to_le_bytes();
    let offsets: Vec<usize> = (0..program.len() - 7).filter(|&at| program[at..at + 8] == hash).collect();
    assert!(!offsets.is_empty(), "the layout hash of this build is not in {}", andond().display());
    offsets.into_iter().for_each(|at| program[at] ^= 1);
    let path = line.path("andond-of-another-version");
    std::fs::write(&path, program).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path
}

#[test]
fn a_process_of_another_version_is_refused_and_the_line_goes_on() {
    let (line, mut watcher) = up(Settings::live());
    let output = Command::new(other_version(&line)).args(["run", "judge", "-c"]).arg(line.config()).output();
    let output = output.unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(70), "{errors}");
    assert!(errors.contains("AND-607") && errors.contains("install one version, start again"), "{errors}");
    let before = watcher.verdicts.len();
    watcher.until("a verdict", |watcher| watcher.verdicts.len() > before);
}

#[test]
fn a_steward_of_another_version_is_refused_while_the_old_roles_run() {
    let (mut line, _watcher) = up(Settings::live());
    line.role("steward").kill();
    let output =
        Command::new(other_version(&line)).args(["run", "steward", "-c"]).arg(line.config()).output();
    let output = output.unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(70), "{errors}");
    assert!(
        errors.contains("AND-607") && errors.contains("judge"),
        "the message must name who has to stop: {errors}"
    );
}

#[test]
fn a_message_that_is_no_command_is_counted_and_logged_and_the_line_goes_on() {
    let (line, mut watcher) = up(Settings::live());
    let node = Node::open(&line.station, RoleId::Tool, PATIENCE, &Stop::new().unwrap()).unwrap();
    let mut commands = node.writer::<shm_schemas::Command>().unwrap();
    let mut message = commands.loan().unwrap();
    message.kind = 200;
    commands.send(message).unwrap();
    line.wait_for_log("judge", "AND-310", "Check the order of the commands");
    watcher
        .until("the count", |watcher| watcher.health(RoleId::Judge).is_some_and(|judge| judge.refused == 1));
    let before = watcher.verdicts.len();
    watcher.until("a verdict", |watcher| watcher.verdicts.len() > before);
}

/// A library whose UTC is off by the number of seconds in a file, for programs that are started with it.
const CLOCK: &str = r#"
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
int clock_gettime(clockid_t clock, struct timespec *now) {
    static int (*real)(clockid_t, struct timespec *);
    if (!real) *(void **)&real = dlsym(RTLD_NEXT, "clock_gettime");
    int result = real(clock, now);
    FILE *file = clock == CLOCK_REALTIME ? fopen(getenv("CLOCK_OFFSET"), "r") : NULL;
    long seconds = 0;
    if (file) {
        if (fscanf(file, "%ld", &seconds) == 1) now->tv_sec += seconds;
        fclose(file);
    }
    return result;
}
"#;

#[test]
fn a_clock_that_is_stepped_is_logged_and_the_line_goes_on_in_order() {
    let mut line = Line::new(Settings::live());
    let offset = line.path("offset");
    std::fs::write(&offset, "0").unwrap();
    line.environment = vec![
        ("LD_PRELOAD", shim::compiled(&line.path(""), CLOCK)),
        ("CLOCK_OFFSET", offset.clone().into_os_string()),
    ];
    let mut watcher = line.up();
    let step = |seconds: &str| {
        // The rename changes it in one step for the roles.
        std::fs::write(offset.with_extension("new"), seconds).unwrap();
        std::fs::rename(offset.with_extension("new"), &offset).unwrap();
    };
    watcher.until("a verdict before", |watcher| !watcher.verdicts.is_empty());
    for (seconds, logged) in [("-7200", "-7200.0 s"), ("0", "+7200.0 s")] {
        let before = watcher.verdicts.len();
        step(seconds);
        line.wait_for_log("journal", logged, "Let one time service set the clock");
        watcher.until("a verdict", |watcher| watcher.verdicts.len() > before);
    }
    for role in ROLES {
        let pid = line.role(role).pid();
        watcher.until(role, |watcher| watcher.runs(role_id(role), pid));
    }
    line.stop();
    watcher.listen(std::time::Duration::ZERO);
    let utc: Vec<u64> = watcher.verdicts.iter().map(|verdict| verdict.decided_utc_ns).collect();
    assert!(utc.windows(2).any(|two| two[1] + 3600 * 1_000_000_000 < two[0]), "the clock was never stepped");
    let journal = line.journal();
    assert_eq!(journal.gaps(), 0);
    assert_eq!(journal.verdicts(), watcher.verdict_keys(), "the journal has them in the order of sending");
}
