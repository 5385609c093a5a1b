//! The line as the PLC sees it: results only after the journal has them, read by our own client and by others' clients.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_ipc::{Node, Stop};
use andon_tests::line::{Line, Modbus, PATIENCE, Settings, Watcher, control, status};
use andon_tests::python::{all_output, python};
use rustix::process::Signal;
use shm_schemas::{Health, Refusal, RoleId, Verdict, VerdictLevel, VerdictOutcome};
use std::process::Command;
use std::time::Duration;

/// The register `phase`, and its number while a job runs, as `REGISTERS.md` has them.
const PHASE: u16 = 58;
const RUNNING: u16 = 3;

/// A line at the worker's own pace, ready.
fn ready(writes: bool) -> (Line, Watcher, Modbus) {
    let mut line = Line::new(Settings { writes, ..Settings::live() });
    let (watcher, plc) = up(&mut line, writes);
    (line, watcher, plc)
}

fn up(line: &mut Line, writes: bool) -> (Watcher, Modbus) {
    let watcher = line.launch();
    let mut plc = Modbus::connect_when_up(line.port);
    if writes {
        plc.enable();
    }
    plc.wait_for(status::ONLINE | status::READY);
    (watcher, plc)
}

#[test]
fn a_result_is_offered_only_once_the_journal_has_it() {
    let (mut line, mut watcher, mut plc) = ready(false);
    line.role("journal").signal(Signal::STOP);
    let before = watcher.verdicts.len();
    watcher.until("a verdict that the journal cannot take", |watcher| watcher.verdicts.len() > before + 1);
    let unwritten = watcher.newest_verdict_key().unwrap();
    for _ in 0..20 {
        assert!(plc.result() < unwritten, "a result is offered that is not on disk");
        std::thread::sleep(Duration::from_millis(20));
    }
    line.role("journal").signal(Signal::CONT);
    let until = std::time::Instant::now() + PATIENCE;
    while plc.result() < unwritten {
        assert!(std::time::Instant::now() < until, "the result is never offered");
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(line.journal().verdicts().contains(&unwritten));
}

#[test]
fn each_acknowledged_result_is_the_next_verdict_of_the_journal() {
    let (line, _watcher, mut plc) = ready(true);
    let mut taken = Vec::new();
    for _ in 0..4 {
        plc.wait_for(status::DONE);
        taken.push(plc.result());
        plc.acknowledge();
    }
    let rows = line.journal().verdicts();
    let from = rows.iter().position(|row| *row == taken[0]).unwrap();
    assert_eq!(&rows[from..from + taken.len()], taken);
}

#[test]
fn a_restart_of_plc_offers_again_what_was_not_acknowledged_and_loses_and_doubles_nothing() {
    let (mut line, _watcher, mut plc) = ready(true);
    let mut taken: Vec<(u32, (u64, u64))> = Vec::new();
    for round in 0..4 {
        plc.wait_for(status::DONE);
        let offered = (plc.sequence(), plc.result());
        line.role("plc").kill();
        // Whatever is sent meanwhile is still the PLC's.
        std::thread::sleep(Duration::from_millis(500));
        line.start("plc");
        plc = Modbus::connect_when_up(line.port);
        plc.enable();
        plc.wait_for(status::DONE);
        assert_eq!((plc.sequence(), plc.result()), offered, "round {round}");
        assert_eq!(plc.boot(), round + 2);
        for _ in 0..2 {
            plc.wait_for(status::DONE);
            taken.push((plc.sequence(), plc.result()));
            plc.acknowledge();
        }
    }
    assert!(taken.windows(2).all(|two| two[1].0 > two[0].0), "{taken:?}");
    assert_eq!(plc.lost(), 0, "the PLC was fast enough");
    let rows = line.journal().verdicts();
    let from = rows.iter().position(|row| *row == taken[0].1).unwrap();
    let keys: Vec<_> = taken.iter().map(|(_, key)| *key).collect();
    assert_eq!(&rows[from..from + keys.len()], keys);
}

#[test]
fn the_log_says_why_ready_has_dropped() {
    let (mut line, _watcher, mut plc) = ready(true);
    plc.control(0).unwrap();
    line.wait_for_log("plc", "AND-510", "the PLC has not set `enable`, or has cleared it");
    plc.enable();
    plc.wait_for(status::READY);
    let pid = line.role("encode").pid();
    line.role("encode").signal(Signal::STOP);
    plc.wait_for(status::ERROR);
    line.role("encode").signal(Signal::CONT);
    assert_eq!(line.role("encode").pid(), pid, "it was slow, and never gone");
    let log = line.log("plc");
    let dropped: Vec<&str> = log.lines().filter(|line| line.contains("AND-510")).collect();
    assert!(!dropped.iter().any(|line| line.contains("error 0")), "{dropped:?}");
    let named = ["encode gives no sign of life", "judge runs and gets nothing, or too late"];
    assert!(named.iter().any(|named| dropped[1].contains(named)), "{dropped:?}");
    assert!(!dropped[1].contains("gone"), "{dropped:?}");
}

#[test]
fn a_client_that_may_only_read_is_named_once_in_the_log_and_commands_nothing() {
    let mut line = Line::new(Settings { writes: true, ..Settings::live() });
    line.reconfigure(
        "[plc]\n",
        "[plc]\nallow = [\"127.0.0.1\", \"127.0.0.2\"]\ncommanders = [\"127.0.0.2\"]\n",
    );
    let _watcher = line.launch();
    let mut plc = Modbus::connect_when_up(line.port);
    for _ in 0..3 {
        assert!(plc.control(control::ENABLE).is_err());
        line.wait_for_log("plc", "AND-505", "127.0.0.1 may only read: it is not in plc.commanders");
        // Longer than the log waits between two looks at the counters.
        std::thread::sleep(Duration::from_millis(1200));
    }
    assert_eq!(line.log("plc").matches("AND-505").count(), 1, "{}", line.log("plc"));
    assert_eq!(plc.read(100, 1).unwrap(), [0]);
}

fn with_two_jobs() -> Line {
    Line::with_second_job(Settings { writes: true, ..Settings::live() })
}

#[test]
fn a_job_that_is_refused_is_told_with_the_reason_and_the_job_in_force_is_on_the_registers() {
    let mut line = with_two_jobs();
    let (_watcher, mut plc) = up(&mut line, true);
    assert_eq!(plc.job_in_force(), 1);
    // A worker who is at it would make every job be refused.
    line.role("encode").kill();
    line.wait_for_log("judge", "AND-610", "");
    plc.control(control::ENABLE | control::RESET_ERROR).unwrap();
    assert_eq!(plc.load_job(999), Some(u16::from(Refusal::NoSuchJob.code())));
    assert_eq!(plc.job_in_force(), 1);
    assert_eq!(plc.load_job(2), None);
    assert_eq!(plc.job_in_force(), 2);
    let status = String::from_utf8(line.command("status", &[]).stdout).unwrap();
    assert!(status.contains(" (number 2, hash "), "{status}");
}

#[test]
fn a_judge_or_a_plc_that_starts_again_goes_on_with_the_job_that_the_plc_has_loaded() {
    let mut line = with_two_jobs();
    let mut watcher = line.launch();
    let mut plc = Modbus::connect_when_up(line.port);
    plc.enable();
    plc.wait_for(status::READY);
    plc.abort_and_load_job(2);
    line.role("judge").kill();
    // What the one before has sent.
    watcher.listen(Duration::from_millis(100));
    line.start("judge");
    plc.control(control::ENABLE | control::RESET_ERROR).unwrap();
    let from = watcher.verdicts.len();
    watcher.until("verdicts of the new judge", |watcher| watcher.verdicts.len() > from + 3);
    assert!(
        watcher.verdicts[from..].iter().all(|verdict| verdict.job_id == 2),
        "nothing is judged by another"
    );
    assert_eq!(plc.job_in_force(), 2);

    for role in ["plc", "judge"] {
        line.role(role).kill();
    }
    line.start("judge");
    line.start("plc");
    plc = Modbus::connect_when_up(line.port);
    watcher.listen(Duration::from_millis(100));
    let from = watcher.verdicts.len();
    let until = std::time::Instant::now() + Duration::from_secs(4);
    while std::time::Instant::now() < until {
        watcher.listen(Duration::from_millis(100));
        assert!(plc.status().unwrap() & status::READY == 0);
    }
    assert_eq!(
        watcher.verdicts.len(),
        from,
        "the control word is 0 after a restart of plc: nothing is judged"
    );
    plc.enable();
    watcher.until("verdicts of the newest judge", |watcher| watcher.verdicts.len() > from + 3);
    assert!(
        watcher.verdicts[from..].iter().all(|verdict| verdict.job_id == 2),
        "nothing is judged by another"
    );
    assert_eq!(plc.job_in_force(), 2);
}

#[test]
fn another_job_that_is_loaded_in_the_middle_of_one_while_a_fault_is_latched_leaves_that_one_not_judged() {
    let mut line = with_two_jobs();
    let (mut watcher, mut plc) = up(&mut line, true);
    let until = std::time::Instant::now() + PATIENCE;
    while plc.read(PHASE, 1).unwrap() != [RUNNING] {
        assert!(std::time::Instant::now() < until, "no job begins");
        std::thread::sleep(Duration::from_millis(20));
    }
    line.role("perceive").kill();
    plc.wait_for(status::ERROR);
    watcher.listen(Duration::ZERO);
    let known = watcher.verdicts.len();
    assert_eq!(plc.load_job(2), None);
    assert_eq!(plc.job_in_force(), 2);
    watcher.until("the end of the job", |watcher| {
        watcher.verdicts[known..].iter().any(|verdict| verdict.level() == Ok(VerdictLevel::Job))
    });
    let outcomes: Vec<_> = watcher.verdicts[known..].iter().map(Verdict::outcome).collect();
    assert!(outcomes.iter().all(|outcome| *outcome == Ok(VerdictOutcome::NotJudged)), "{outcomes:?}");
}

#[test]
fn enable_holds_before_its_first_write() {
    let mut line = Line::new(Settings { writes: true, ..Settings::live() });
    let mut watcher = line.up();
    let mut plc = Modbus::connect_when_up(line.port);
    let until = std::time::Instant::now() + Duration::from_secs(10);
    while std::time::Instant::now() < until {
        watcher.listen(Duration::from_millis(100));
        let status = plc.status().unwrap();
        assert_eq!(status & (status::READY | status::DONE), 0, "nobody has enabled the line");
    }
    assert!(watcher.verdicts.is_empty(), "{:?}", watcher.verdicts);
    plc.enable();
    plc.wait_for(status::READY);
    plc.wait_for(status::DONE);
}

/// Kills a role, waits until the PLC sees it, starts the role, and waits until the PLC sees the line ready.
fn kill_and_start(line: &mut Line, plc: &mut Modbus, role: &'static str) {
    line.role(role).kill();
    let until = std::time::Instant::now() + PATIENCE;
    while plc.status().unwrap() & status::READY != 0 {
        assert!(std::time::Instant::now() < until, "{role} is gone and the line is still ready");
        std::thread::sleep(Duration::from_millis(5));
    }
    line.start(role);
    plc.wait_for(status::READY);
}

#[test]
fn ready_drops_when_a_role_is_killed_and_comes_back_with_it() {
    let (mut line, _watcher, mut plc) = ready(false);
    for role in ["perceive", "encode", "judge", "journal", "steward"] {
        kill_and_start(&mut line, &mut plc, role);
    }
    let log = line.log("plc");
    assert!(log.contains("AND-510") && log.contains("AND-509"), "{log}");
}

/// Resets the error until the line is ready.
fn reset_until_ready(line: &Line, plc: &mut Modbus) {
    let until = std::time::Instant::now() + PATIENCE;
    while plc.status().unwrap() & status::READY == 0 {
        assert!(std::time::Instant::now() < until, "log of plc:\n{}", line.log("plc"));
        plc.control(control::ENABLE | control::RESET_ERROR).unwrap();
        plc.enable();
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// As many programs as may hear the roles are left somewhere, stopped.
#[test]
fn plc_goes_on_through_a_fault_where_health_has_as_many_readers_as_it_allows() {
    let (mut line, _watcher, mut plc) = ready(true);
    let node = Node::open(&line.station, RoleId::Tool, Duration::from_millis(100), &Stop::new().unwrap());
    let node = node.unwrap();
    let readers: Vec<_> = std::iter::from_fn(|| node.reader::<Health>().ok()).collect();
    assert!(!readers.is_empty());
    line.role("encode").signal(Signal::STOP);
    plc.wait_for(status::ERROR);
    // Longer than any patience of plc.
    std::thread::sleep(Duration::from_secs(3));
    line.role("encode").signal(Signal::CONT);
    reset_until_ready(&line, &mut plc);
    // Nor does it take another reader for the one that it has where somebody leaves.
    line.role("steward").kill();
    plc.wait_for(status::ERROR);
    line.start("steward");
    reset_until_ready(&line, &mut plc);
    assert_eq!(line.role("plc").ended(), None);
    drop(readers);
}

#[test]
fn ready_comes_back_without_a_verdict_while_nobody_works() {
    let mut line = Line::new(Settings::live());
    line.edit_tracks(|frames| frames.iter_mut().for_each(|frame| frame.hands.clear()));
    let (watcher, mut plc) = up(&mut line, false);
    kill_and_start(&mut line, &mut plc, "judge");
    assert!(watcher.verdicts.is_empty());
}

#[test]
fn the_error_register_names_the_fault_of_a_role_that_is_gone() {
    let (mut line, _watcher, mut plc) = ready(true);
    line.role("encode").kill();
    plc.wait_for(status::ERROR);
    assert_eq!(plc.read(4, 1).unwrap(), [3], "a process of the line is gone");
}

#[test]
fn the_configuration_decides_which_register_of_a_value_comes_first() {
    for (word_order, not_a_number) in [("big", [0x7FC0, 0]), ("little", [0, 0x7FC0])] {
        let mut line = Line::new(Settings::default());
        let text = std::fs::read_to_string(line.config()).unwrap();
        let text = text.replace("[plc]\n", &format!("[plc]\nword_order = \"{word_order}\"\n"));
        std::fs::write(line.config(), text).unwrap();
        line.start("steward");
        line.start("plc");
        let mut plc = Modbus::connect_when_up(line.port);
        // `distance`, which is not a number before the first result.
        assert_eq!(plc.read(31, 2).unwrap(), not_a_number, "{word_order}");
    }
}

#[test]
fn a_write_that_is_not_allowed_and_a_plc_that_leaves_are_logged() {
    let (line, _watcher, mut plc) = ready(false);
    assert!(plc.control(control::ENABLE).is_err());
    line.wait_for_log("plc", "AND-505", "Set plc.writes = true");
    drop(plc);
    line.wait_for_log("plc", "AND-503", "Check the PLC and the network");
}

#[test]
fn a_part_id_goes_with_every_verdict_of_the_job_that_begins_next_and_with_no_other() {
    let (mut line, mut watcher, _plc) = ready(false);
    let give = |id: &str| line.command("part", &[id]);
    for id in ["A-1", "A-2", "A-3"] {
        assert!(give(id).status.success(), "{}", all_output(&give(id)));
        watcher.until(id, |watcher| watcher.verdicts.iter().filter(|v| v.part.text() == id).count() > 2);
    }
    assert_eq!(give("").status.code(), Some(0));
    watcher.until("a verdict without an id", |watcher| watcher.verdicts.last().unwrap().part.is_none());
    let verdicts = &watcher.verdicts;
    let jobs: Vec<_> = verdicts.iter().filter(|v| v.level() == Ok(VerdictLevel::Job)).collect();
    assert!(jobs.iter().any(|job| job.part.text() == "A-2"), "{jobs:?}");
    for job in jobs {
        let of_job = |v: &&Verdict| v.began_ns >= job.began_ns && v.ended_ns <= job.ended_ns;
        for verdict in verdicts.iter().filter(of_job) {
            assert_eq!(verdict.part, job.part, "{verdict:?} of {job:?}");
        }
    }
    let bad = give("Teil \u{e4}");
    assert!(bad.status.code() == Some(64) && all_output(&bad).contains("ASCII"), "{}", all_output(&bad));
    let csv = String::from_utf8(line.command("history", &["--csv"]).stdout).unwrap();
    assert!(csv.lines().any(|row| row.ends_with(",A-3")), "{csv}");
    line.role("judge").kill();
    let silent = line.command("part", &["A-4"]);
    assert!(silent.status.code() == Some(70) && all_output(&silent).contains("does not answer"));
}

#[test]
fn where_the_plc_gives_the_part_ids_nobody_else_does_and_a_judge_that_starts_again_has_them() {
    let (mut line, mut watcher, mut plc) = ready(true);
    plc.set_part("PLC-7");
    assert_eq!(plc.next_part(), "PLC-7");
    let refused = line.command("part", &["A-1"]);
    assert!(all_output(&refused).contains("PLC gives the part ids"), "{}", all_output(&refused));
    line.role("judge").kill();
    line.start("judge");
    plc.control(control::ENABLE | control::RESET_ERROR).unwrap();
    let from = watcher.verdicts.len();
    watcher.until("verdicts of the new judge", |watcher| watcher.verdicts.len() > from + 3);
    assert!(watcher.verdicts[from + 1..].iter().all(|verdict| verdict.part.text() == "PLC-7"));

    // Neither of the two remembers it: the journal does.
    for role in ["plc", "judge"] {
        line.role(role).kill();
    }
    watcher.listen(Duration::from_millis(100));
    let from = watcher.verdicts.len();
    line.start("judge");
    line.start("plc");
    plc = Modbus::connect_when_up(line.port);
    plc.enable();
    watcher.until("verdicts after both", |watcher| watcher.verdicts.len() > from + 3);
    assert!(watcher.verdicts[from + 1..].iter().all(|verdict| verdict.part.text() == "PLC-7"));
    assert_eq!(plc.next_part(), "PLC-7");
    let of_part = |id: &str| line.command("history", &["--csv", "--part", id]);
    let rows = String::from_utf8(of_part("PLC-7").stdout).unwrap();
    let verdicts = || rows.lines().filter(|row| row.contains(",verdict,"));
    assert!(verdicts().count() > 3 && verdicts().all(|row| row.ends_with(",PLC-7")), "{rows}");
    assert!(!String::from_utf8(of_part("A-1").stdout).unwrap().contains(",verdict,"));
    assert_eq!(of_part("Teil \u{e4}").status.code(), Some(64));
}

#[test]
fn mbpoll_reads_the_status_word_of_a_ready_line() {
    let (line, _watcher, _plc) = ready(false);
    let port = line.port.to_string();
    let output = Command::new("mbpoll")
        .args(["-m", "tcp", "-p", &port, "-t", "4", "-0", "-r", "0", "-c", "1", "-1", "127.0.0.1"])
        .output()
        .expect("mbpoll is needed: run `make test-packages`, or apt install mbpoll");
    let text = all_output(&output);
    let word = text.lines().find_map(|row| row.strip_prefix("[0]:")).map(|word| word.trim().parse::<u16>());
    assert!(matches!(word, Some(Ok(word)) if word & status::READY != 0), "{text}");
}

/// Reads results and acknowledges them, with no knowledge but the register map.
const PYMODBUS: &str = r#"
import sys, time
from pymodbus.client import ModbusTcpClient
client = ModbusTcpClient("127.0.0.1", port=int(sys.argv[1]))
assert client.connect()
client.write_register(100, 1)
numbers = []
until = time.monotonic() + 60
while len(numbers) < 3:
    assert time.monotonic() < until, "no result"
    words = client.read_holding_registers(0, count=48).registers
    if not words[0] & 8:
        time.sleep(0.01)
        continue
    first, again = words[11:13], words[46:48]
    assert first == again, "torn"
    numbers.append(first[0] << 16 | first[1])
    client.write_register(100, 1 | 16)
    while client.read_holding_registers(0, count=1).registers[0] & 8:
        assert time.monotonic() < until, "not acknowledged"
    client.write_register(100, 1)
assert numbers == list(range(numbers[0], numbers[0] + 3)), numbers
print("taken", numbers)
"#;

#[test]
fn pymodbus_takes_results_in_order() {
    let python = python();
    let (line, _watcher, _plc) = ready(true);
    let output = Command::new(python).args(["-c", PYMODBUS, &line.port.to_string()]).output().unwrap();
    assert!(output.status.success() && all_output(&output).contains("taken"), "{}", all_output(&output));
}
