//! Faults of the machine and of the set-up: each is logged with its code and what to do, and nothing hangs.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_ipc::{Node, Stop};
use andon_tests::line::{Line, Settings, Watcher, andond};
use shm_schemas::{Layout, RoleId, RoleState, Verdict};
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Duration;

/// A line at the worker's own pace, all of it up.
fn up(settings: Settings) -> (Line, Watcher) {
    let mut line = Line::new(Settings { at_full_speed: false, repeat: true, ..settings });
    let watcher = line.up();
    (line, watcher)
}

#[test]
fn a_second_steward_is_refused_and_the_first_goes_on() {
    let (line, mut watcher) = up(Settings::default());
    let second = Command::new(andond()).args(["run", "steward", "-c"]).arg(line.config()).output().unwrap();
    let said = String::from_utf8_lossy(&second.stderr);
    assert_eq!(second.status.code(), Some(70), "{said}");
    assert!(said.contains("AND-604") && said.contains("systemctl status andon-steward@"), "{said}");
    let before = watcher.heard.len();
    watcher.until("a verdict", |watcher| watcher.heard.len() > before);
}

#[test]
fn a_role_without_a_steward_says_so_and_is_to_be_started_again() {
    let mut line = Line::new(Settings::default());
    assert_eq!(line.start("judge").wait().code(), Some(70));
    line.logs("judge", "AND-605", "systemctl start andon-steward@");
}

#[test]
fn a_root_that_is_deleted_ends_the_steward_with_the_remedy() {
    let (mut line, _watcher) = up(Settings::default());
    std::fs::remove_dir_all(line.station.root()).unwrap();
    assert_eq!(line.role("steward").wait().code(), Some(70));
    line.logs("steward", "AND-606", "Keep cleaners away");
}

#[test]
fn a_journal_that_is_locked_waits_and_loses_nothing() {
    let (mut line, mut watcher) = up(Settings { writes: true, ..Settings::default() });
    // Whoever opens the database by hand and leaves a transaction open.
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
    line.logs("journal", "AND-403", "fuser");
    watcher.until("the journal's fault", |watcher| watcher.is(RoleId::Journal, RoleState::Fault));
    drop(holder.stdin.take());
    holder.wait().unwrap();
    let sent = watcher.heard_newest().unwrap();
    watcher.until("the journal", |watcher| watcher.is(RoleId::Journal, RoleState::Running));
    line.stop();
    watcher.listen(Duration::ZERO);
    let rows = line.journal();
    assert!(rows.verdicts().contains(&sent));
    assert_eq!(rows.gaps(), 0);
}

#[test]
fn a_disk_that_is_full_is_told_and_what_was_confirmed_stays() {
    let mut line = Line::new(Settings { at_full_speed: false, repeat: true, ..Settings::default() });
    line.start("steward");
    let mut watcher = Watcher::join(&line.station);
    line.start_all_but(&["steward", "journal"]);
    // No file may grow over 100 blocks; the signal is ignored, so that the write fails as it does on a full disk.
    let log = std::fs::File::create(line.path("journal.log")).unwrap();
    let mut journal = Command::new("sh")
        .args(["-c", "trap '' XFSZ; ulimit -f 100; exec \"$0\" run journal -c \"$1\" 2>&1"])
        .arg(andond())
        .arg(line.config())
        .stdout(log)
        .spawn()
        .unwrap();
    watcher.until("the journal's fault", |watcher| watcher.is(RoleId::Journal, RoleState::Fault));
    line.logs("journal", "AND-402", "Make room on the disk");
    journal.kill().unwrap();
    journal.wait().unwrap();
    let rows = line.journal().verdicts();
    assert!(!rows.is_empty());
    // There is room again.
    line.start("journal");
    let sent = watcher.heard_newest().unwrap();
    watcher.until("the journal", |watcher| watcher.is(RoleId::Journal, RoleState::Running));
    line.stop();
    watcher.listen(Duration::ZERO);
    assert_eq!(line.journal().unexplained(&[sent]), []);
    assert!(line.journal().verdicts().starts_with(&rows));
}

#[test]
fn a_file_that_is_no_journal_is_refused_and_not_touched() {
    let mut line = Line::new(Settings::default());
    let path = line.path("journal.sqlite");
    std::fs::write(&path, vec![b'x'; 4096]).unwrap();
    line.start("steward");
    assert_eq!(line.start("journal").wait().code(), Some(78));
    line.logs("journal", "AND-404", "Move the file away");
    assert_eq!(std::fs::read(&path).unwrap(), vec![b'x'; 4096]);
}

#[test]
fn a_modbus_port_that_is_taken_is_told_with_what_to_look_at() {
    let mut line = Line::new(Settings::default());
    let _taken = std::net::TcpListener::bind(("127.0.0.1", line.port)).unwrap();
    line.start("steward");
    assert_eq!(line.start("plc").wait().code(), Some(70));
    line.logs("plc", "AND-506", "Another program has it");
}

#[test]
fn a_full_dev_shm_is_found_before_anything_starts() {
    let line = Line::new(Settings::default());
    // A /dev/shm of 1 MiB of its own, where this user may make one.
    let script = "mount -t tmpfs -o size=1m none /dev/shm && exec \"$0\" run steward -c \"$1\"";
    let output = Command::new("unshare")
        .args(["--mount", "--map-root-user", "sh", "-c", script])
        .arg(andond())
        .arg(line.config())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        said.contains("AND-"),
        "no /dev/shm of its own can be made here; run the tests as root, or allow user namespaces \
         (`sysctl kernel.unprivileged_userns_clone=1`): {said}"
    );
    assert_eq!(output.status.code(), Some(70), "{said}");
    assert!(said.contains("AND-603") && said.contains("mount -o remount"), "{said}");
}

/// The program as another version would be: its verdicts have another layout hash.
fn other_version(line: &Line) -> PathBuf {
    let mut program = std::fs::read(andond()).unwrap();
    let hash = Verdict::HASH.to_le_bytes();
    let places: Vec<usize> = (0..program.len() - 7).filter(|&at| program[at..at + 8] == hash).collect();
    assert!(!places.is_empty(), "the layout hash of this build is not in {}", andond().display());
    places.into_iter().for_each(|at| program[at] ^= 1);
    let path = line.path("andond-of-another-version");
    std::fs::write(&path, program).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path
}

#[test]
fn a_process_of_another_version_is_refused_and_the_line_goes_on() {
    let (line, mut watcher) = up(Settings::default());
    let output = Command::new(other_version(&line)).args(["run", "judge", "-c"]).arg(line.config()).output();
    let output = output.unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(70), "{said}");
    assert!(said.contains("AND-607") && said.contains("start it again from one version"), "{said}");
    let before = watcher.heard.len();
    watcher.until("a verdict", |watcher| watcher.heard.len() > before);
}

#[test]
fn a_steward_of_another_version_is_refused_while_the_old_roles_run() {
    let (mut line, _watcher) = up(Settings::default());
    line.role("steward").kill();
    let output =
        Command::new(other_version(&line)).args(["run", "steward", "-c"]).arg(line.config()).output();
    let output = output.unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(70), "{said}");
    assert!(said.contains("AND-607") && said.contains("judge"), "who must stop is named: {said}");
}

#[test]
fn a_command_that_is_none_is_counted_and_told_and_the_line_goes_on() {
    let (line, mut watcher) = up(Settings::default());
    let node =
        Node::open(&line.station, RoleId::Tool, Duration::from_secs(60), &Stop::new().unwrap()).unwrap();
    let mut commands = node.writer::<shm_schemas::Command>().unwrap();
    let mut message = commands.loan().unwrap();
    message.kind = 200;
    commands.send(message).unwrap();
    line.logs("judge", "AND-310", "Check the order of the commands");
    watcher
        .until("the count", |watcher| watcher.health(RoleId::Judge).is_some_and(|judge| judge.refused == 1));
    let before = watcher.heard.len();
    watcher.until("a verdict", |watcher| watcher.heard.len() > before);
}
