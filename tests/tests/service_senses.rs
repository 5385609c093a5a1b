//! What a line says when it cannot see, and when the machine's clock is not what it was.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_core::input::Frame;
use andon_tests::line::{Line, ROLES, Settings, role_id};
use shm_schemas::{RoleId, RoleState, VerdictKind, VerdictReason};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The first IU of the line's recording in which something is touched: what, and from when to when in seconds.
fn first_touch(line: &Line) -> (u16, f64, f64) {
    let output = line.command("segment", &["--json", line.tracks().to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let events = text.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
    let first = events.filter(|event| event["level"] == "iu").find(|event| event["context"][0] != 0).unwrap();
    let id = u16::try_from(first["context"][1].as_u64().unwrap()).unwrap();
    (id, first["began_s"].as_f64().unwrap(), first["ended_s"].as_f64().unwrap())
}

/// Plays a recording in which something is hidden from the middle of the first IU on, for two seconds; what `encode`
/// has logged, and whether an IU was not judged because of it.
fn with_a_blind_spot(hide: impl Fn(&mut Frame, u16)) -> (Line, bool) {
    let mut line = Line::new(Settings::default());
    let (id, began_s, ended_s) = first_touch(&line);
    let from_s = (began_s + ended_s) / 2.0;
    line.edit_tracks(|frames| {
        let inside = |frame: &&mut Frame| (from_s..from_s + 2.0).contains(&(frame.captured_ns as f64 / 1e9));
        frames.iter_mut().filter(inside).for_each(|frame| hide(frame, id));
    });
    let mut watcher = line.launch();
    watcher.until_judged();
    let blind = watcher.heard.iter().any(|verdict| {
        verdict.kind == VerdictKind::NotJudged.code() && verdict.reason == VerdictReason::Blind.code()
    });
    (line, blind)
}

#[test]
fn a_marker_that_is_covered_at_work_is_told_with_its_name_and_the_step_is_not_judged() {
    let (line, blind) = with_a_blind_spot(|frame, id| frame.objects.retain(|object| object.id != id));
    line.logs("encode", "AND-201", "Clean the marker");
    line.logs("encode", "AND-202", "is seen again");
    assert!(blind, "a step that could not be seen was judged");
}

#[test]
fn a_hand_that_leaves_the_picture_at_work_is_told_and_the_step_is_not_judged() {
    let (line, blind) = with_a_blind_spot(|frame, id| {
        frame.hands.clear();
        frame.objects.retain(|object| object.id != id);
    });
    line.logs("encode", "AND-203", "so that the hand stays in view");
    line.logs("encode", "AND-204", "is seen again");
    assert!(blind, "a step that could not be seen was judged");
}

#[test]
fn a_track_file_that_was_cut_off_is_played_to_the_cut_and_told() {
    let mut line = Line::new(Settings::default());
    let bytes = std::fs::read(line.tracks()).unwrap();
    std::fs::write(line.tracks(), &bytes[..bytes.len() - 20]).unwrap();
    let mut watcher = line.launch();
    watcher.until("the judge's end", |watcher| watcher.is(RoleId::Judge, RoleState::Finished));
    line.logs("perceive", "AND-210", "everything up to there has been used");
}

/// A machine whose UTC is as many seconds off as a file says, for programs that are started with it.
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

fn compiled(folder: &Path) -> PathBuf {
    let (source, library) = (folder.join("clock.c"), folder.join("clock.so"));
    std::fs::write(&source, CLOCK).unwrap();
    let status = Command::new("cc")
        .args(["-shared", "-fPIC", "-O1", "-o"])
        .args([&library, &source])
        .arg("-ldl")
        .status()
        .expect("a C compiler is needed: apt install g++");
    assert!(status.success(), "the library that steps the clock does not compile");
    library
}

#[test]
fn a_clock_that_is_stepped_is_told_and_the_line_goes_on_in_order() {
    let mut line = Line::new(Settings { at_full_speed: false, repeat: true, ..Settings::default() });
    let offset = line.path("offset");
    std::fs::write(&offset, "0").unwrap();
    line.environment = vec![
        ("LD_PRELOAD", compiled(offset.parent().unwrap()).into_os_string()),
        ("CLOCK_OFFSET", offset.clone().into_os_string()),
    ];
    let mut watcher = line.up();
    let step = |seconds: &str| {
        // In one go, as the roles see it.
        std::fs::write(offset.with_extension("new"), seconds).unwrap();
        std::fs::rename(offset.with_extension("new"), &offset).unwrap();
    };
    watcher.until("a verdict before", |watcher| !watcher.heard.is_empty());
    for (seconds, told) in [("-7200", "-7200.0 s"), ("0", "+7200.0 s")] {
        let before = watcher.heard.len();
        step(seconds);
        line.logs("journal", told, "Let one time service set the clock");
        watcher.until("a verdict", |watcher| watcher.heard.len() > before);
    }
    for role in ROLES {
        let pid = line.role(role).pid();
        watcher.until(role, |watcher| watcher.runs(role_id(role), pid));
    }
    line.stop();
    watcher.listen(std::time::Duration::ZERO);
    let utc: Vec<u64> = watcher.heard.iter().map(|verdict| verdict.decided_utc_ns).collect();
    assert!(utc.windows(2).any(|two| two[1] + 3600 * 1_000_000_000 < two[0]), "the clock was never stepped");
    let sent: Vec<_> = watcher.heard.iter().map(|verdict| (verdict.stamp.epoch, verdict.stamp.seq)).collect();
    let journal = line.journal();
    assert_eq!(journal.gaps(), 0);
    assert_eq!(journal.verdicts(), sent, "the journal has them in the order of sending");
}
