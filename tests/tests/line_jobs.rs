//! `andond jobs` and `andond use`: which jobs a station has, and another one for a running station, which its judge loads or refuses.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::line::{Line, Modbus, PATIENCE, Settings, status};
use andon_tests::python::all_output;
use shm_schemas::JudgePhase;
use std::time::Instant;

/// A station with two jobs whose judge runs and to which nothing happens.
fn idle() -> Line {
    let mut line = Line::with_second_job(Settings::live());
    for role in ["steward", "judge", "journal"] {
        line.start(role);
    }
    line
}

/// The jobs of the station, as programs read them.
fn jobs(line: &Line) -> Vec<serde_json::Value> {
    let output = line.command("jobs", &["--json"]);
    assert!(output.status.success(), "{}", all_output(&output));
    String::from_utf8(output.stdout).unwrap().lines().map(|job| serde_json::from_str(job).unwrap()).collect()
}

/// The number of the job in force, once there is one.
fn in_force(line: &Line) -> u64 {
    let until = Instant::now() + PATIENCE;
    loop {
        if let Some(job) = jobs(line).iter().find(|job| job["in_force"] == true) {
            return job["id"].as_u64().unwrap();
        }
        assert!(Instant::now() < until, "no job is in force:\n{}", line.log("judge"));
    }
}

#[test]
fn jobs_lists_each_with_number_name_hash_date_runs_and_where_it_is_used() {
    let line = Line::with_second_job(Settings::live());
    let found = jobs(&line);
    let ids: Vec<_> =
        found.iter().map(|job| (&job["id"], &job["name"], &job["runs"], &job["misfit"])).collect();
    assert_eq!(ids.len(), 3, "the folder's, and that of the configuration: {ids:?}");
    assert!(ids.iter().all(|job| *job.1 == "job" && *job.2 == 6 && job.3.is_null()), "{ids:?}");
    assert!(found.iter().all(|job| job["in_force"] == false && job["hash"].as_str().unwrap().len() == 16));
    let first: Vec<_> = found.iter().filter(|job| job["stations"] == serde_json::json!(["line"])).collect();
    assert!(first.len() == 1 && first[0]["file"].as_str().unwrap().ends_with("/job.toml"), "{first:?}");

    std::fs::write(line.path("jobs/broken.toml"), "no job").unwrap();
    let output = line.command("jobs", &[]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.starts_with("number  name  hash              taught      runs  steps  file"), "{text}");
    assert_eq!(text.lines().filter(|row| row.contains("first job of line")).count(), 1, "{text}");
    let faults = String::from_utf8(output.stderr).unwrap();
    assert!(faults.contains("broken.toml") && output.status.success(), "{faults}");
}

#[test]
fn a_job_is_loaded_by_number_by_name_or_by_file_and_stays_when_the_judge_starts_again() {
    let mut line = idle();
    assert_eq!(in_force(&line), 1);
    let output = line.command("use", &["2"]);
    let text = all_output(&output);
    assert!(output.status.success() && text.starts_with("job 2 \"job\" of hash "), "{text}");
    assert!(text.contains("is in force until another is loaded or the station ends"), "{text}");
    assert_eq!(in_force(&line), 2);
    line.wait_for_log("judge", "AND-309", "load job 2 of hash ");
    assert!(line.log("judge").contains("for a person or a scanner"), "{}", line.log("judge"));

    line.role("judge").kill();
    line.start("judge");
    assert_eq!(in_force(&line), 2, "the judge goes on with it");

    let several = line.command("use", &["job"]);
    assert_eq!(several.status.code(), Some(64));
    assert!(
        all_output(&several).contains("several jobs are called so: give the number, or one of the files "),
        "{}",
        all_output(&several)
    );
    let file = line.path("jobs/one.toml");
    assert!(line.command("use", &[file.to_str().unwrap()]).status.success());
    assert_eq!(in_force(&line), 1);
    let deeds = all_output(&line.command("history", &["--audit"]));
    assert!(deeds.contains("andond use"), "{deeds}");
}

#[test]
fn a_job_that_is_not_there_is_refused_with_those_that_are() {
    let line = idle();
    let output = line.command("use", &["polish"]);
    assert_eq!(output.status.code(), Some(64));
    let text = all_output(&output);
    assert!(text.starts_with("polish: no job of this name or number is in "), "{text}");
    assert!(text.contains("there are 1 \"job\", ") && text.contains("2 \"job\""), "{text}");
    let mut foreign = std::fs::read_to_string(line.path("job.toml")).unwrap();
    foreign = foreign.lines().filter(|row| !row.starts_with("checksum")).collect::<Vec<_>>().join("\n");
    std::fs::write(line.path("foreign.toml"), foreign).unwrap();
    let output = line.command("use", &[line.path("foreign.toml").to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(78), "{}", all_output(&output));
}

#[test]
fn a_job_is_not_exchanged_while_a_piece_is_made() {
    let mut line = Line::with_second_job(Settings::live());
    let mut watcher = line.up();
    let until = Instant::now() + PATIENCE;
    let refused = loop {
        // Each job that is loaded starts the judge anew, so that it is asked for only while a piece is made.
        watcher.until("a piece", |watcher| watcher.phase() == Some(JudgePhase::Running));
        let output = line.command("use", &["2"]);
        if !output.status.success() {
            break output;
        }
        // The piece had ended meanwhile. The job in force could be loaded at any time.
        assert!(Instant::now() < until, "it is never refused");
        assert!(line.command("use", &["1"]).status.success());
        watcher.judging = None;
    };
    assert_eq!(refused.status.code(), Some(1));
    let text = all_output(&refused);
    assert!(
        text.contains(
            "job 2 \"job\" was not loaded: A job is running. Wait for its end: andond use --when-idle"
        ),
        "{text}"
    );
    let output = line.command("use", &["--when-idle=60", "2"]);
    assert!(output.status.success(), "{}", all_output(&output));
    let kept = all_output(&line.command("history", &["--audit", "--csv"]));
    let refusals = kept.lines().filter(|row| row.contains("job 2 refused")).count();
    assert!((1..4).contains(&refusals), "it waits before it asks: {kept}");
}

#[test]
fn where_the_plc_loads_the_jobs_nobody_else_does() {
    let mut line = Line::with_second_job(Settings { writes: true, ..Settings::live() });
    let mut watcher = line.up();
    let mut plc = Modbus::connect_when_up(line.port);
    plc.enable();
    plc.wait_for(status::READY);
    // It is refused while a job runs.
    let until = Instant::now() + PATIENCE;
    while let Some(refusal) = plc.load_job(2) {
        assert!(Instant::now() < until, "it is always refused: {refusal}");
    }
    let output = line.command("use", &["1"]);
    let text = all_output(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(
        text.contains("was not loaded: The PLC chooses the jobs of this station. Let it load this one."),
        "{text}"
    );
    watcher.listen(std::time::Duration::ZERO);
    assert_eq!(plc.job_in_force(), 2);
}
