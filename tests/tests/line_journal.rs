//! A whole line and a simulated worker: the journal and the tools say what the judge has sent.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::line::{Line, PATIENCE, Settings, Watcher};
use andon_tests::simulator::Flaw;
use shm_schemas::{RoleId, VerdictOutcome};
use std::io::{BufRead as _, BufReader};
use std::process::{ChildStdout, Command, Output, Stdio};
use std::sync::mpsc::{Receiver, channel};

/// What a command that succeeded has printed.
fn text(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Plays the line's track file until every verdict on it is on disk, and stops the line.
fn play(line: &mut Line) -> Watcher {
    let mut watcher = line.launch();
    let sent = watcher.until_judged();
    watcher.until("the journal", |watcher| {
        watcher.health(RoleId::Journal).is_some_and(|journal| journal.received == sent)
    });
    assert_eq!(line.stop(), [""; 0]);
    watcher
}

#[test]
fn every_verdict_that_was_sent_is_in_the_journal_once_and_in_order() {
    let mut line = Line::new(Settings::default());
    let watcher = play(&mut line);
    let sent = watcher.verdict_keys();
    assert!(sent.len() > 5, "the worker was judged: {}", sent.len());
    assert_eq!(line.journal().verdicts(), sent);
    let table = text(&line.command("history", &[]));
    assert_eq!(table.lines().count(), sent.len() + 1);
}

#[test]
fn the_judge_logs_when_a_job_begins_and_how_it_ends() {
    let mut line = Line::new(Settings::default());
    play(&mut line);
    let log = line.log("judge");
    let index_of = |code: &str| log.find(code).unwrap_or_else(|| panic!("no {code} in {log}"));
    assert!(index_of("AND-303") < index_of("AND-304"), "{log}");
    assert_eq!(log.matches("AND-303").count(), 1, "{log}");
}

#[test]
fn the_judge_logs_that_a_job_begins_also_after_one_that_it_could_not_judge() {
    let mut line = Line::new(Settings::default());
    line.work_in_turn(&[Flaw::OffPicture, Flaw::None], 5.0);
    play(&mut line);
    let log = line.log("judge");
    let jobs: Vec<&str> = log.lines().filter_map(of_a_job).collect();
    assert_eq!(jobs, ["has begun", "NOT JUDGED", "has begun", "ok"], "{log}");
}

/// What a message of the judge says of a whole job: that it has begun, or how it ended.
fn of_a_job(message: &str) -> Option<&'static str> {
    let outcome = |outcome: &&str| message.contains(&format!("{outcome:10}  job"));
    if message.contains("AND-303") {
        return Some("has begun");
    }
    ["ok", "ANOMALY", "NOT JUDGED"].into_iter().find(outcome)
}

#[test]
fn history_shows_on_request_only_what_is_not_right() {
    let mut line = Line::new(Settings { flaw: Flaw::WrongOrder, ..Settings::default() });
    let watcher = play(&mut line);
    let wrong = watcher.verdicts.iter().filter(|verdict| verdict.outcome() != Ok(VerdictOutcome::Ok)).count();
    assert!(wrong > 0, "the worker did something wrong");
    let table = text(&line.command("history", &["--nok"]));
    assert_eq!(table.lines().count(), wrong + 1, "{table}");
    let other_job = text(&line.command("history", &["--job", "99", "--csv"]));
    assert_eq!(other_job.lines().count(), 1, "{other_job}");
    let refused = line.command("history", &["--since", "yesterday"]);
    assert_eq!(refused.status.code(), Some(64));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("8h"));
}

/// What `andond replay` prints for a recording, with this line's job.
fn replayed(line: &Line, recording: &str) -> String {
    let job = line.path("job.toml");
    let output = line.command("replay", &["--json", "--job", job.to_str().unwrap(), recording]);
    // The exit code is the verdict: 1 is an anomaly, 2 that something was not judged.
    assert!(matches!(output.status.code(), Some(0..=2)), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn tail_prints_byte_for_byte_what_a_replay_of_the_same_tracks_and_of_the_line_s_own_recording_prints() {
    // A recorder that lost frames says so and has failed; on a machine as busy as that there is nothing to compare.
    let compared = (0..5).any(|_| tail_and_recording_agree_with_replay());
    assert!(compared, "the recorder lost frames five times");
}

/// The lines that a program prints, as they come.
fn lines_of(stdout: ChildStdout) -> Receiver<String> {
    let (sender, lines) = channel();
    std::thread::spawn(move || {
        let printed = BufReader::new(stdout).lines().map_while(Result::ok);
        printed.map(|line| line + "\n").try_for_each(|line| sender.send(line))
    });
    lines
}

/// Returns false, and has compared nothing, where the recorder lost frames.
fn tail_and_recording_agree_with_replay() -> bool {
    let mut line = Line::new(Settings::default());
    line.work_in_turn(&[Flaw::WrongObject, Flaw::J1], 2.0);
    line.start("steward");
    let mut watcher = Watcher::join(&line.station);
    let recording = line.path("recorded.tracks.jsonl");
    let spawn = |command: &str, arguments: &[&str]| {
        let mut tool = Command::new(andon_tests::line::andond());
        tool.args([command, "--config"]).arg(line.config()).args(arguments);
        tool.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let mut tail = spawn("tail", &["--json"]);
    let printed = lines_of(tail.stdout.take().unwrap());
    let record = spawn("record", &["--out", recording.to_str().unwrap()]);
    // Both tools must be members before the first frame.
    while line.station.members().iter().filter(|member| member.name == "tool").count() < 3 {
        watcher.listen(std::time::Duration::from_millis(20));
    }
    std::thread::sleep(std::time::Duration::from_millis(500));
    line.start_all_but(&["steward"]);
    let sent = watcher.until_judged();
    let record = record.wait_with_output().unwrap();
    let recorder_said = String::from_utf8_lossy(&record.stderr);
    let lost_frames = recorder_said.contains("frames were lost");
    assert!(record.status.success() || lost_frames, "{recorder_said}");
    let mut said: Vec<String> = (0..sent).map(|_| printed.recv_timeout(PATIENCE).unwrap()).collect();
    rustix::process::kill_process(
        rustix::process::Pid::from_raw(i32::try_from(tail.id()).unwrap()).unwrap(),
        rustix::process::Signal::TERM,
    )
    .unwrap();
    assert!(tail.wait().unwrap().success());
    if lost_frames {
        return false;
    }
    said.extend(printed.iter());
    assert_eq!(said.len() as u64, sent, "nothing is printed twice");
    let printed = said.concat();
    assert!(printed.contains("\"distribution\":{\"measure\":\"Strokes\""), "{printed}");
    assert_eq!(printed, replayed(&line, line.tracks().to_str().unwrap()));
    assert_eq!(printed, replayed(&line, recording.to_str().unwrap()));
    true
}
