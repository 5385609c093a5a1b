//! The commands that a technician runs, by the real binary.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::line::{Line, ROLES, Settings, andond};
use std::path::Path;
use std::process::Command;

#[test]
fn check_reports_all_faults_at_once_and_exits_78() {
    let line = Line::new(Settings::default());
    let good = line.command("check", &[]);
    assert_eq!(good.status.code(), Some(0), "{}", String::from_utf8_lossy(&good.stderr));
    let bad = line.path("bad.toml");
    std::fs::write(&bad, "[station]\nnmae = 1\n[camera]\nwidth = -1\n").unwrap();
    let output = line.command("check", &["--config", bad.to_str().unwrap()]);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(78), "{errors}");
    assert!(
        errors.contains("bad.toml:2: station.nmae") && errors.contains("bad.toml:4: camera.width"),
        "{errors}"
    );
}

#[test]
fn the_configuration_in_force_is_printed_as_a_file_that_means_the_same() {
    let line = Line::new(Settings::default());
    let printed = line.command("config", &[]);
    assert!(printed.status.success(), "{}", String::from_utf8_lossy(&printed.stderr));
    let copy = line.path("copy.toml");
    std::fs::write(&copy, &printed.stdout).unwrap();
    let again = Command::new(andond()).args(["config", "-c"]).arg(&copy).output().unwrap();
    assert_eq!(String::from_utf8_lossy(&again.stdout), String::from_utf8_lossy(&printed.stdout));
    assert!(String::from_utf8_lossy(&printed.stdout).contains("source = \"tracks\""));
}

#[test]
fn the_reference_is_printed_without_a_configuration() {
    let output = Command::new(andond()).args(["config", "--default"]).output().unwrap();
    let shipped = concat!(env!("CARGO_MANIFEST_DIR"), "/../config/andon.toml");
    assert_eq!(String::from_utf8_lossy(&output.stdout), std::fs::read_to_string(shipped).unwrap());
}

#[test]
fn status_is_healthy_while_every_role_runs_and_names_the_role_that_does_not() {
    let mut line = Line::new(Settings::live());
    assert_eq!(line.command("status", &[]).status.code(), Some(70), "no role runs yet");
    line.up();
    let output = line.command("status", &["--json"]);
    let status: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{status}");
    assert_eq!(status["roles"].as_array().unwrap().len(), ROLES.len());
    for key in ["rate_hz", "p50_us", "p99_us", "losses", "pid"] {
        assert!(status["roles"][1][key].is_number(), "{key}: {status}");
    }
    line.role("encode").kill();
    let output = line.command("status", &[]);
    let table = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{table}");
    assert!(table.lines().any(|row| row.starts_with("encode") && row.contains("Silent")), "{table}");
    let bad = line.command("status", &["--json"]);
    let status: serde_json::Value = serde_json::from_slice(&bad.stdout).unwrap();
    assert_eq!(status["healthy"], false);
}

#[test]
fn a_bench_is_calibrated_from_a_picture_and_a_picture_without_markers_is_refused() {
    let line = Line::new(Settings::default());
    let out = line.path("bench.toml");
    let film = concat!(env!("CARGO_MANIFEST_DIR"), "/footage/p1_none_r1.mp4");
    let named = ["1=0,0", "2=0.4,0", "4=0.4,0.3", "7=0,0.3"];
    let mut arguments = vec![film, "--side", "0.04", "--out", out.to_str().unwrap()];
    arguments.extend(named.iter().flat_map(|marker| ["--marker", marker]));
    let output = line.command("calibrate", &arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(64), "{errors}");
    assert!(errors.contains("were not found in the picture"), "{errors}");
    assert!(!out.exists());
}

/// Teaches a job from the worker's own recording under a limit for the size of a file, in blocks of 512 bytes.
fn teach(line: &Line, job: &Path, blocks: u32) -> std::process::Output {
    Command::new("sh")
        .args(["-c", &format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"")])
        .arg(andond())
        .args(["teach", "--force", "--config"])
        .arg(line.config())
        .arg("--out")
        .arg(job)
        .arg(line.tracks())
        .output()
        .unwrap()
}

#[test]
fn a_job_that_cannot_be_written_to_its_end_leaves_the_one_before_it() {
    let line = Line::new(Settings::default());
    let jobs = line.path("jobs");
    std::fs::create_dir(&jobs).unwrap();
    let job = jobs.join("job.toml");
    std::fs::write(&job, "the job before").unwrap();
    // As on a disk that is full after the first kilobyte.
    let failed = teach(&line, &job, 2);
    assert!(!failed.status.success());
    assert_eq!(std::fs::read_to_string(&job).unwrap(), "the job before");
    assert_eq!(std::fs::read_dir(&jobs).unwrap().count(), 1, "nothing else is left");
    let taught = teach(&line, &job, 1_000_000);
    assert!(taught.status.success(), "{}", String::from_utf8_lossy(&taught.stderr));
    assert!(std::fs::metadata(&job).unwrap().len() > 1024);
}
