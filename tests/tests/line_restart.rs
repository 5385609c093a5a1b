//! After every phase the next correct piece is right and nobody is accused. Phases are a restart of any role in the middle of a job, `enable` off,
//! and a late start. Jobs also follow each other without a pause.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_learn::recording::{self, Recording};
use andon_tests::deletion::{Deletion, one_after_the_other};
use andon_tests::line::{Line, Modbus, Settings, Watcher};
use andon_tests::simulator::Random;
use shm_schemas::{Verdict, VerdictLevel, VerdictOutcome};
use std::fs::File;
use std::io::BufWriter;

fn recording(line: &Line) -> Recording {
    recording::read("work", &std::fs::read(line.tracks()).unwrap()).unwrap()
}

/// The last two thirds of a job, and three whole jobs, one after the other without a pause.
fn begun_late(whole: &Recording) -> Recording {
    let length_s = whole.frames.last().unwrap().captured_ns as f64 * 1e-9;
    let late = Deletion::Late(length_s / 3.0).of(whole, &mut Random::new(1, &[]));
    one_after_the_other(&[&late, whole, whole, whole], 0.04)
}

fn save(line: &Line, recording: &Recording) {
    let mut file = BufWriter::new(File::create(line.tracks()).unwrap());
    recording::write(&mut file, &recording.header, &recording.frames).unwrap();
}

fn is(verdict: &Verdict, level: VerdictLevel, outcome: VerdictOutcome) -> bool {
    verdict.level() == Ok(level) && verdict.outcome() == Ok(outcome)
}

fn jobs(verdicts: &[Verdict]) -> Vec<VerdictOutcome> {
    let jobs = verdicts.iter().filter(|verdict| verdict.level() == Ok(VerdictLevel::Job));
    jobs.map(|job| job.outcome().unwrap()).collect()
}

fn assert_nobody_is_accused(verdicts: &[Verdict], after: &str) {
    let accused = verdicts.iter().filter(|verdict| verdict.outcome() == Ok(VerdictOutcome::Anomaly));
    assert_eq!(accused.count(), 0, "after {after}: {verdicts:#?}");
}

/// All frames that were lost between two roles.
fn losses(watcher: &Watcher) -> u64 {
    watcher.healths.iter().map(|health| health.losses).sum()
}

/// Does something in the middle of a job, between its first activity and its last, and waits for the next job that is right.
fn next_piece_is_right_after(what: &str, watcher: &mut Watcher, mut disturb: impl FnMut(&mut Watcher)) {
    let from = watcher.verdicts.len();
    watcher.until(&format!("the middle of a job, before {what}"), |watcher| {
        let new = &watcher.verdicts[from..];
        let began = new.iter().rposition(|verdict| verdict.level() == Ok(VerdictLevel::Job));
        let open = &new[began.map_or(0, |job| job + 1)..];
        began.is_some() && open.iter().any(|verdict| is(verdict, VerdictLevel::Activity, VerdictOutcome::Ok))
    });
    let from = watcher.verdicts.len();
    disturb(watcher);
    watcher.until(&format!("a right job after {what}"), |watcher| {
        jobs(&watcher.verdicts[from..]).contains(&VerdictOutcome::Ok)
    });
    let after = &watcher.verdicts[from..];
    assert_nobody_is_accused(after, what);
    let jobs = jobs(after);
    // On a busy machine frames are lost, and what they showed is not judged.
    if losses(watcher) == 0 {
        let interrupted = jobs.iter().take_while(|job| **job != VerdictOutcome::Ok).count();
        // The piece that was broken off, and what was seen of the rest of it.
        assert!(interrupted <= 2, "after {what}: {jobs:?}");
    }
}

/// Restarts these roles, one after the other.
fn restart(roles: &[&'static str]) {
    let mut line = Line::new(Settings { writes: true, ..Settings::live() });
    let mut watcher = line.up();
    let mut plc = Modbus::connect_when_up(line.port);
    plc.enable();
    for &role in roles {
        next_piece_is_right_after(role, &mut watcher, |_| {
            line.role(role).kill();
            line.start(role);
            if role == "plc" {
                // As a PLC does that is connected again.
                Modbus::connect_when_up(line.port).enable();
            }
        });
    }
}

#[test]
fn after_a_restart_of_steward_or_perceive_the_next_correct_piece_is_right() {
    restart(&["steward", "perceive"]);
}

#[test]
fn after_a_restart_of_encode_or_judge_the_next_correct_piece_is_right() {
    restart(&["encode", "judge"]);
}

#[test]
fn after_a_restart_of_journal_or_plc_the_next_correct_piece_is_right() {
    restart(&["journal", "plc"]);
}

#[test]
fn after_enable_was_off_the_next_correct_piece_is_right() {
    let mut line = Line::new(Settings { writes: true, ..Settings::live() });
    let mut watcher = line.up();
    let mut plc = Modbus::connect_when_up(line.port);
    plc.enable();
    next_piece_is_right_after("enable was off", &mut watcher, |watcher| {
        plc.control(0).unwrap();
        watcher.listen(std::time::Duration::from_millis(500));
        plc.enable();
    });
}

#[test]
fn after_a_late_start_every_piece_of_jobs_without_a_pause_is_right() {
    let mut line = Line::new(Settings::default());
    save(&line, &begun_late(&recording(&line)));
    let mut watcher = line.launch();
    watcher.until_judged();
    assert_nobody_is_accused(&watcher.verdicts, "a late start");
    let jobs = jobs(&watcher.verdicts);
    assert!(jobs.ends_with(&[VerdictOutcome::Ok; 3]) && jobs.len() <= 4, "{jobs:?}");
}
