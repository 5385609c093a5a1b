//! Every option of a command does what the help says, and every command that gives a verdict ends with its exit code.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::line::{Line, Settings, andond};
use andon_tests::simulator::Flaw;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn stdout(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// The job file that `teach` writes from the line's recording with these options.
fn taught(line: &Line, options: &[&str]) -> String {
    let (tracks, out) = (line.tracks(), line.path("taught.toml"));
    let arguments = [&[text(&tracks), "--force", "--out", text(&out)], options].concat();
    stdout(&line.command("teach", &arguments));
    std::fs::read_to_string(out).unwrap()
}

#[test]
fn teach_writes_the_number_and_the_name_that_it_was_given() {
    let line = Line::new(Settings::default());
    let job = taught(&line, &["--id", "7", "--name", "seven"]);
    assert!(job.contains("\nid = 7\n") && job.contains("\nname = \"seven\"\n"), "{job}");
    let job = taught(&line, &[]);
    assert!(job.contains("\nid = 1\n") && job.contains("\nname = \"taught\"\n"), "{job}");
}

#[test]
fn teach_takes_the_rule_the_cost_and_the_order_that_it_was_given() {
    let line = Line::new(Settings::default());
    for (rule, written) in
        [("paper", "paper"), ("leave-one-out", "leave_one_out"), ("conformal", "conformal")]
    {
        let job = taught(&line, &["--rule", rule]);
        assert!(job.contains(&format!("rule = {{ name = \"{written}\"")), "{job}");
    }
    for cost in ["normalised", "ordinal", "circular"] {
        let job = taught(&line, &["--cost", cost]);
        assert!(job.contains(&format!("\ncost = \"{cost}\"\n")), "{job}");
    }
    for (order, laws) in [("true", 1), ("false", 0)] {
        let job = taught(&line, &["--order", order]);
        assert_eq!(job.matches("law = \"begin\"").count(), laws, "{job}");
    }
}

#[test]
fn teach_writes_what_it_cannot_trust_only_by_force() {
    let line = Line::new(Settings::default());
    let (tracks, out) = (line.tracks(), line.path("taught.toml"));
    let arguments = ["teach", text(&tracks), text(&tracks), "--out", text(&out)];
    let output = line.command(arguments[0], &arguments[1..]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.starts_with("not usable, because ") && said.contains("\nnot written: "), "{said}");
    assert!(!out.exists());
    let said = stdout(&line.command("teach", &[&arguments[1..], &["--force"]].concat()));
    assert!(said.starts_with("not usable, because ") && said.contains("\nwritten: "), "{said}");
    assert!(out.exists());
}

#[test]
fn segment_draws_its_plot() {
    let line = Line::new(Settings::default());
    let plot = line.path("plot.svg");
    let events = stdout(&line.command("segment", &[text(&line.tracks()), "--plot", text(&plot)]));
    assert!(events.contains("activity"), "{events}");
    let drawn = std::fs::read_to_string(plot).unwrap();
    assert!(drawn.starts_with("<svg") && drawn.contains("right hand") && drawn.ends_with("</svg>\n"));
}

/// How `replay` ends on the line's recording.
fn replayed(line: &Line) -> Option<i32> {
    line.command("replay", &["--job", text(&line.path("job.toml")), text(&line.tracks())]).status.code()
}

#[test]
fn replay_ends_with_0_for_a_correct_job_1_for_an_anomaly_and_2_for_what_could_not_be_judged() {
    assert_eq!(replayed(&Line::new(Settings::default())), Some(0));
    assert_eq!(replayed(&Line::new(Settings { flaw: Flaw::WrongOrder, ..Settings::default() })), Some(1));
    let nothing_seen = Line::new(Settings::default());
    nothing_seen.edit_tracks(|frames| frames.iter_mut().for_each(|frame| frame.hands.clear()));
    assert_eq!(replayed(&nothing_seen), Some(2));
}

#[test]
fn tail_shows_the_level_and_the_outcomes_that_it_was_asked_for() {
    let settings = Settings { flaw: Flaw::J1, at_full_speed: false, repeat: true, ..Settings::default() };
    let mut line = Line::new(settings);
    line.start("steward");
    let mut command = Command::new(andond());
    command.args(["tail", "--json", "--nok", "--level", "activity", "--config"]).arg(line.config());
    let mut tail = command.stdout(Stdio::piped()).spawn().unwrap();
    line.start_all_but(&["steward"]);
    let mut shown = String::new();
    BufReader::new(tail.stdout.take().unwrap()).read_line(&mut shown).unwrap();
    tail.kill().unwrap();
    tail.wait().unwrap();
    let verdict: serde_json::Value = serde_json::from_str(&shown).unwrap();
    assert_eq!((&verdict["level"], &verdict["outcome"]), (&"activity".into(), &"anomaly".into()), "{shown}");
}

/// A folder with the line's recording under a name that says who did what.
fn folder(line: &Line) -> PathBuf {
    let folder = line.path("recordings");
    std::fs::create_dir(&folder).unwrap();
    for repetition in 1..=3 {
        std::fs::copy(line.tracks(), folder.join(format!("p1_none_r{repetition}.tracks.jsonl"))).unwrap();
    }
    folder
}

#[test]
fn analyze_writes_a_report_of_a_folder() {
    let line = Line::new(Settings::default());
    let (recordings, report) = (folder(&line), line.path("report"));
    let output = Command::new(andond()).arg("analyze").arg(recordings).arg("--out").arg(&report).output();
    assert!(stdout(&output.unwrap()).contains("index.html"));
    assert!(report.join("index.html").is_file());
}

#[test]
fn experiment_names_the_recordings_that_it_lacks() {
    let line = Line::new(Settings::default());
    let output = Command::new(andond()).args(["experiment", "2"]).arg(folder(&line)).output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(64), "{stderr}");
    assert!(stderr.contains("p<person>_none_r<repetition>"), "{stderr}");
}
