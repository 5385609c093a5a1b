//! What a line keeps through the faults of its surroundings: its journal, its configuration, and who has changed what.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::line::{Line, Modbus, PATIENCE, ROLES, Settings, Watcher, andond, control, role_id, status};
use rustix::process::Signal;
use shm_schemas::{RoleId, RoleState};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let until = Instant::now() + PATIENCE;
    while !holds() {
        assert!(Instant::now() < until, "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

fn text(line: &Line, command: &str, arguments: &[&str]) -> String {
    let output = line.command(command, arguments);
    String::from_utf8(output.stdout).unwrap() + &String::from_utf8_lossy(&output.stderr)
}

/// What `andond history --audit` shows.
fn audit(line: &Line) -> String {
    text(line, "history", &["--audit"])
}

#[test]
fn a_journal_that_is_removed_under_its_writer_begins_anew_with_a_gap_and_confirms_nothing_to_nowhere() {
    let mut line = Line::new(Settings { writes: true, ..Settings::live() });
    let mut watcher = line.up();
    let mut plc = Modbus::connect_when_up(line.port);
    plc.enable();
    plc.wait_for(status::DONE);
    for name in ["journal.sqlite", "journal.sqlite-wal", "journal.sqlite-shm"] {
        let _ = std::fs::remove_file(line.path(name));
    }
    line.wait_for_log("journal", "AND-407", "Find out who removed it");
    let from = watcher.verdicts.len();
    watcher.until("verdicts after it", |watcher| watcher.verdicts.len() > from + 2);
    let sent = watcher.newest_verdict_key().unwrap();
    until("the new journal", || {
        line.path("journal.sqlite").exists() && line.journal().verdicts().contains(&sent)
    });
    let history = text(&line, "history", &[]);
    assert!(history.contains("-- what was before is not here any more: somebody has removed"), "{history}");
    assert!(audit(&line).contains("a new one has begun"), "{}", audit(&line));
    // The PLC goes on: what it is offered from now on is in the new journal.
    plc.control(control::ENABLE | control::RESET_ERROR).unwrap();
    until("a result of the new journal", || {
        let word = plc.status().unwrap();
        if word & status::DONE != 0 {
            let result = plc.result();
            if line.journal().verdicts().contains(&result) {
                return true;
            }
            plc.acknowledge();
        }
        false
    });
    assert_eq!(line.log("journal").matches("AND-407").count(), 1, "it is said once");
}

#[test]
fn a_damaged_journal_is_put_aside_and_the_line_comes_up_with_a_new_one() {
    let mut line = Line::new(Settings::live());
    let path = line.path("journal.sqlite");
    std::fs::write(&path, vec![b'x'; 4096]).unwrap();
    let mut watcher = line.up();
    line.wait_for_log("journal", "AND-404", "sqlite3 .recover");
    assert_eq!(line.log("journal").matches("AND-404").count(), 1, "it is said once");
    let folder = std::fs::read_dir(path.parent().unwrap()).unwrap().flatten();
    let aside: Vec<_> = folder
        .filter(|entry| entry.file_name().to_string_lossy().contains("journal.sqlite.damaged-"))
        .collect();
    assert_eq!(aside.len(), 1);
    assert_eq!(std::fs::read(aside[0].path()).unwrap(), vec![b'x'; 4096], "nothing of it is lost");
    watcher.until("a verdict", |watcher| !watcher.verdicts.is_empty());
    let sent = watcher.newest_verdict_key().unwrap();
    until("the verdict", || line.journal().verdicts().contains(&sent));
    assert!(
        text(&line, "history", &[])
            .contains("-- what was before is not here any more: the database was damaged")
    );
}

#[test]
fn a_journal_whose_folder_is_missing_waits_for_it_and_says_so_once() {
    let mut line = Line::new(Settings::live());
    let missing = line.path("not-mounted");
    line.reconfigure("path = \"journal.sqlite\"", "path = \"not-mounted/journal.sqlite\"");
    let mut watcher = line.launch();
    watcher.until("the fault", |watcher| watcher.is(RoleId::Journal, RoleState::Fault));
    let log = line.log("journal");
    assert!(log.contains("AND-408") && log.contains("does its directory exist"), "{log}");
    assert!(!log.to_lowercase().contains("make room"), "{log}");
    let pid = line.role("journal").pid();
    // Several of its tries.
    let tried = Instant::now() + Duration::from_secs(2);
    while Instant::now() < tried {
        watcher.listen(Duration::from_millis(100));
    }
    std::fs::create_dir(missing).unwrap();
    watcher.until("the journal", |watcher| watcher.runs(RoleId::Journal, pid));
    assert_eq!(line.log("journal").matches("AND-408").count(), 1);
}

#[test]
fn a_modbus_port_that_is_taken_is_waited_for() {
    let mut line = Line::new(Settings::live());
    let taken = std::net::TcpListener::bind(("127.0.0.1", line.port)).unwrap();
    let mut watcher = line.launch();
    watcher.until("the fault", |watcher| watcher.is(RoleId::Plc, RoleState::Fault));
    line.wait_for_log("plc", "AND-506", "Another program has it");
    let pid = line.role("plc").pid();
    drop(taken);
    watcher.until("plc", |watcher| watcher.runs(RoleId::Plc, pid));
    assert_eq!(line.log("plc").matches("AND-506").count(), 1, "it is said once");
    Modbus::connect_when_up(line.port).wait_for(status::ONLINE);
}

#[test]
fn a_root_that_is_deleted_ends_every_role_and_the_line_comes_back_whole() {
    let mut line = Line::new(Settings::live());
    let _watcher = line.up();
    std::fs::remove_dir_all(line.station.root()).unwrap();
    for role in ROLES {
        assert_eq!(line.role(role).wait().code(), Some(70), "{role}");
        line.wait_for_log(role, "AND-606", "keep cleaners of temporary files away");
    }
    line.start("steward");
    let mut watcher = Watcher::join(&line.station);
    line.start_all_but(&["steward"]);
    for role in ROLES {
        let pid = line.role(role).pid();
        watcher.until(role, |watcher| watcher.runs(role_id(role), pid));
    }
}

#[test]
fn a_role_that_starts_again_goes_on_with_the_configuration_of_the_line_and_status_says_that_the_files_have_changed()
 {
    let mut line = Line::new(Settings::live());
    let mut watcher = line.up();
    let before = watcher.health(RoleId::Encode).unwrap().configuration;
    assert_ne!(before, 0);
    let good = std::fs::read_to_string(line.config()).unwrap();
    // Another value first, and then a file that somebody is in the middle of editing.
    for (edited, said) in [
        (format!("{good}\n[method]\nrest_speed_m_s = 0.07\n"), "the files have changed since (hash "),
        (format!("{good}\n[method]\nrest_spe"), "have faults"),
    ] {
        std::fs::write(line.config(), edited).unwrap();
        for role in ["encode", "steward"] {
            line.role(role).kill();
            line.start(role);
            let pid = line.role(role).pid();
            watcher.until(role, |watcher| watcher.runs(role_id(role), pid));
            assert_eq!(watcher.health(role_id(role)).unwrap().configuration, before, "{role}: {said}");
        }
        line.wait_for_log("encode", "AND-802", "restart the station's target");
        let status = line.command("status", &[]);
        let shown = String::from_utf8(status.stdout).unwrap();
        assert!(shown.contains("AND-802") && shown.contains(said), "{shown}");
        let json: serde_json::Value =
            serde_json::from_slice(&line.command("status", &["--json"]).stdout).unwrap();
        assert!(json["configuration"]["changed"].as_str().unwrap().contains(said), "{json}");
    }
    // A line that is ended in good order takes the files as they are then, and the journal has the change.
    drop(watcher);
    line.stop();
    std::fs::write(line.config(), format!("{good}\n[health]\njudge_deadline_ms = 1500\n")).unwrap();
    let watcher = line.up();
    assert_ne!(watcher.health(RoleId::Encode).unwrap().configuration, before);
    assert!(!text(&line, "status", &[]).contains("AND-802"));
    let audit = audit(&line);
    assert!(audit.contains("configuration") && audit.contains("before: hash "), "{audit}");
    assert!(audit.contains("station.toml"), "who: the file and its owner: {audit}");
}

#[test]
fn a_role_that_is_started_with_the_files_as_given_is_named_by_status() {
    let mut line = Line::new(Settings::live());
    let _watcher = line.up();
    line.role("encode").kill();
    let edited = line.path("edited.toml");
    let good = std::fs::read_to_string(line.config()).unwrap();
    std::fs::write(&edited, format!("{good}\n[health]\njudge_deadline_ms = 1500\n")).unwrap();
    let mut encode = Command::new(andond())
        .args(["run", "encode", "--as-given", "--config"])
        .arg(edited)
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    until("the role is named", || {
        text(&line, "status", &[])
            .contains("look here: encode: it runs with another configuration than the line has taken")
    });
    encode.kill().unwrap();
    encode.wait().unwrap();
}

#[test]
fn commands_and_job_loads_are_in_the_journal_with_who_and_when() {
    let mut line = Line::new(Settings { writes: true, ..Settings::live() });
    let _watcher = line.up();
    let mut plc = Modbus::connect_when_up(line.port);
    plc.enable();
    plc.wait_for(status::READY);
    let _ = plc.load_job(999);
    plc.control(0).unwrap();
    until("the rows", || audit(&line).contains("disable"));
    let audit = audit(&line);
    for row in ["enable", "load job 999", "disable"] {
        let found =
            audit.lines().find(|shown| shown.ends_with(row)).unwrap_or_else(|| panic!("{row}: {audit}"));
        assert!(
            found.contains("command") && found.contains("127.0.0.1") && found.starts_with("20"),
            "{found}"
        );
    }
    assert!(audit.contains("configuration") && audit.contains("loaded"), "the job at the start: {audit}");
    let csv = text(&line, "history", &["--audit", "--csv"]);
    assert!(csv.lines().skip(1).all(|row| row.matches('"').count() >= 4), "{csv}");
}

#[test]
fn a_role_that_was_down_leaves_a_row_from_begin_to_end_and_tail_says_so() {
    let mut line = Line::new(Settings::live());
    let mut watcher = line.up();
    let follow = |name: &str, json: &[&str]| {
        let file = |kind: &str| std::fs::File::create(line.path(&format!("{name}.{kind}"))).unwrap();
        let mut tail = std::process::Command::new(andon_tests::line::andond());
        tail.args(["tail", "--config"]).arg(line.config()).args(json);
        tail.stdout(file("verdicts")).stderr(file("log")).spawn().unwrap()
    };
    let tails = [follow("tail", &[]), follow("json", &["--json"])];
    let verdicts = ["tail", "json"].map(|name| line.path(&format!("{name}.verdicts")));
    // It must have heard encode before it can miss it: it listens when it shows a verdict.
    until("the first verdict of both", || {
        verdicts.iter().all(|path| std::fs::metadata(path).unwrap().len() > 0)
    });
    let beat = |watcher: &Watcher| watcher.health(RoleId::Encode).unwrap().stamp.seq;
    watcher.listen(Duration::from_millis(100));
    let heard = beat(&watcher);
    watcher.until("four more signs of life", |watcher| beat(watcher) >= heard + 4);
    line.role("encode").kill();
    until("the row", || {
        text(&line, "history", &[]).contains("-- not watching from here on, no end is known: encode was down")
    });
    until("tail", || std::fs::read_to_string(line.path("tail.log")).unwrap().contains("encode is down"));
    line.start("encode");
    until("the end", || {
        let history = text(&line, "history", &[]);
        history.lines().any(|row| row.contains("-- not watching until 2") && row.ends_with("encode was down"))
    });
    until("tail's end", || {
        let said = std::fs::read_to_string(line.path("tail.log")).unwrap();
        said.contains("not watching from ") && said.contains("encode was down")
    });
    until("the JSON lines", || {
        let said = std::fs::read_to_string(&verdicts[1]).unwrap();
        let of_encode = r#"{"kind":"Outage","role":"encode","began_utc_ns":"#;
        let mut outages = said.lines().filter(|line| line.starts_with(of_encode));
        outages.next().is_some_and(|begun| begun.ends_with(r#""ended_utc_ns":null}"#))
            && outages.next().is_some_and(|ended| !ended.contains("null"))
    });
    for mut tail in tails {
        tail.kill().unwrap();
        tail.wait().unwrap();
    }
    // The steward has seen who died.
    until("the death", || audit(&line).contains("death"));
    assert!(audit(&line).contains("encode (pid "), "{}", audit(&line));
}

#[test]
fn a_journal_that_was_down_leaves_a_row_of_its_own_and_one_that_comes_up_with_its_line_none() {
    let mut line = Line::new(Settings::live());
    let mut watcher = line.up();
    let outages = |line: &Line| text(line, "history", &[]).matches("journal was down").count();
    assert_eq!(outages(&line), 0);
    for (number, how) in [Signal::KILL, Signal::TERM].into_iter().enumerate() {
        line.role("journal").signal(how);
        line.role("journal").wait();
        std::thread::sleep(Duration::from_millis(300));
        line.start("journal");
        let pid = line.role("journal").pid();
        watcher.until("the journal", |watcher| watcher.runs(RoleId::Journal, pid));
        until("the row", || outages(&line) == number + 1);
    }
    let history = text(&line, "history", &[]);
    let rows: Vec<_> = history.lines().filter(|row| row.ends_with("journal was down")).collect();
    assert!(rows.iter().all(|row| row.contains("until 2")), "from begin to end: {history}");
    // What stands still for longer than its deadline is down as well.
    line.role("journal").signal(Signal::STOP);
    std::thread::sleep(Duration::from_millis(3500));
    line.role("journal").signal(Signal::CONT);
    until("the row", || outages(&line) == 3);
    drop(watcher);
    line.stop();
    line.up();
    assert_eq!(outages(&line), 3, "nobody else worked meanwhile");
}

#[test]
fn idle_is_told_of_a_line_on_which_nobody_works() {
    let mut line = Line::new(Settings::live());
    line.edit_tracks(|frames| frames.iter_mut().for_each(|frame| frame.hands.clear()));
    line.up();
    let idle = line.command("idle", &["--timeout", "60"]);
    assert_eq!(idle.status.code(), Some(0), "{}", String::from_utf8_lossy(&idle.stderr));
}
