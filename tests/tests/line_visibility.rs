//! What a line says and judges when a marker, a hand or the rest of a recording cannot be seen.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_core::input::Frame;
use andon_tests::line::{Line, Settings};
use shm_schemas::{RoleId, RoleState, VerdictOutcome, VerdictReason};

/// The first IU of the line's recording in which something is touched: the object's id, and the IU's begin and end in seconds.
fn first_touch(line: &Line) -> (u16, f64, f64) {
    let output = line.command("segment", &["--json", line.tracks().to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let events = text.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
    let first = events.filter(|event| event["level"] == "iu").find(|event| event["context"][0] != 0).unwrap();
    let id = u16::try_from(first["context"][1].as_u64().unwrap()).unwrap();
    (id, first["began_s"].as_f64().unwrap(), first["ended_s"].as_f64().unwrap())
}

/// Plays a recording in which something is hidden for two seconds from the middle of that IU on. Returns the line, and
/// whether an IU was not judged for this reason.
fn with_a_blind_spot(reason: VerdictReason, hide: impl Fn(&mut Frame, u16)) -> (Line, bool) {
    let mut line = Line::new(Settings::default());
    let (id, began_s, ended_s) = first_touch(&line);
    let from_s = (began_s + ended_s) / 2.0;
    line.edit_tracks(|frames| {
        let inside = |frame: &&mut Frame| (from_s..from_s + 2.0).contains(&(frame.captured_ns as f64 / 1e9));
        frames.iter_mut().filter(inside).for_each(|frame| hide(frame, id));
    });
    let mut watcher = line.launch();
    watcher.until_judged();
    let blind = watcher
        .verdicts
        .iter()
        .any(|verdict| verdict.outcome() == Ok(VerdictOutcome::NotJudged) && verdict.reason == reason.code());
    (line, blind)
}

#[test]
fn a_marker_that_is_covered_at_work_is_logged_with_its_name_and_the_step_is_not_judged() {
    let (line, blind) = with_a_blind_spot(VerdictReason::ObjectNotSeen, |frame, id| {
        frame.objects.retain(|object| object.id != id);
    });
    line.wait_for_log("encode", "AND-201", "Clean the marker");
    line.wait_for_log("encode", "AND-202", "is seen again");
    line.wait_for_log("judge", "AND-307", "the reason names what was missing");
    assert!(blind, "a step that could not be seen was judged");
}

#[test]
fn a_hand_that_leaves_the_picture_at_work_is_logged_and_the_step_is_not_judged() {
    let (line, blind) = with_a_blind_spot(VerdictReason::HandNotSeen, |frame, id| {
        frame.hands.clear();
        frame.objects.retain(|object| object.id != id);
    });
    line.wait_for_log("encode", "AND-203", "so that the hand stays in view");
    line.wait_for_log("encode", "AND-204", "is seen again");
    assert!(blind, "a step that could not be seen was judged");
}

#[test]
fn a_track_file_that_was_cut_off_is_played_to_the_cut_and_nothing_is_said_of_its_end() {
    let mut line = Line::new(Settings::default());
    let bytes = std::fs::read(line.tracks()).unwrap();
    // In the middle of the work: the job is not done.
    std::fs::write(line.tracks(), &bytes[..bytes.len() * 3 / 5]).unwrap();
    let mut watcher = line.launch();
    line.wait_for_log("perceive", "AND-210", "Nothing is said of what came then");
    watcher.until("the end of perceive", |watcher| !watcher.is(RoleId::Perceive, RoleState::Running));
    line.stop();
    watcher.listen(std::time::Duration::ZERO);
    let accused = watcher.verdicts.iter().filter(|verdict| verdict.outcome() == Ok(VerdictOutcome::Anomaly));
    assert_eq!(accused.count(), 0, "the cut is taken for the end of the job");
}
