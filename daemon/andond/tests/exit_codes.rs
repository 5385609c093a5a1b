//! A command that cannot do what it is asked ends before any work, with the exit code that says why and with the remedy.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;
use std::process::{Command, Output};

fn andond(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_andond"));
    command.args(arguments).current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    command.env_remove("ANDON_CONFIG").output().unwrap()
}

/// Runs a command that must end with this code and with this text on standard error.
fn ends(arguments: &[&str], code: i32, text: &str) {
    let output = andond(arguments);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {stderr}");
    assert!(stderr.contains(text), "{arguments:?}: {stderr}");
}

const FILM: &str = "tests/footage/p1_none_r1.mp4";

#[test]
fn a_wrong_command_line_ends_with_64() {
    ends(&["tech"], 64, "'teach'");
    ends(&["run", "judgement"], 64, "judge");
    ends(&["segment"], 64, "RECORDING");
    ends(&["segment", FILM, "--speed", "max"], 64, "--speed");
}

#[test]
fn several_folders_are_for_the_ladder_of_the_second_experiment() {
    for arguments in [&["experiment", "2", "a", "b"][..], &["experiment", "1", "--ladder", "a"]] {
        ends(arguments, 64, "experiment 2 --ladder A B");
    }
}

#[test]
fn a_recording_that_is_not_there_ends_with_64() {
    ends(&["segment", "no-such-film.mp4"], 64, "no-such-film.mp4");
    ends(&["segment", "no-such.tracks.jsonl"], 64, "give a film");
}

#[test]
fn a_result_that_cannot_be_written_is_refused_before_the_work() {
    let out = ["--out", "/proc/job.toml"];
    // The recording is not even looked for.
    ends(&["teach", "no-such-film.mp4", out[0], out[1]], 64, "/proc/job.toml: it cannot be written");
    ends(
        &["segment", "no-such-film.mp4", "--plot", "/proc/plot.svg"],
        64,
        "/proc/plot.svg: it cannot be written",
    );
}

#[test]
fn a_job_that_is_there_is_replaced_only_by_force() {
    let folder = tempfile::tempdir().unwrap();
    let there = folder.path().join("there.toml");
    std::fs::write(&there, "a job").unwrap();
    // The recording is not even looked for.
    ends(&["teach", "no-such-film.mp4", "--out", there.to_str().unwrap()], 64, "it exists already");
    assert_eq!(std::fs::read_to_string(there).unwrap(), "a job");
}

#[test]
fn asking_whether_a_result_can_be_written_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (there, new) = (folder.path().join("there.toml"), folder.path().join("new.toml"));
    std::fs::write(&there, "a job").unwrap();
    for out in [&there, &new] {
        let arguments = ["teach", "no-such-film.mp4", "--force", "--out", out.to_str().unwrap()];
        ends(&arguments, 64, "no-such-film.mp4");
    }
    assert_eq!(std::fs::read_to_string(there).unwrap(), "a job");
    assert!(!new.exists());
}

/// A station over the demo's whose models are in `folder`, with these other keys of `[perception]`.
fn station_with(folder: &Path, keys: &str) -> String {
    let path = folder.join("station.toml");
    std::fs::write(&path, format!("[perception]\nmodels = {folder:?}\n{keys}\n")).unwrap();
    path.to_str().unwrap().to_owned()
}

fn station(folder: &Path) -> String {
    station_with(folder, "")
}

#[test]
fn models_that_are_missing_end_with_78_and_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let station = station(folder.path());
    ends(&["segment", "-c", "config/stations/demo.toml", "-c", &station, FILM], 78, "make setup");
}

#[test]
fn a_model_that_is_damaged_ends_with_78_and_names_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let runtime = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/runtime");
    for entry in std::fs::read_dir(&runtime).expect("the models are needed: run `make setup`") {
        let path = entry.unwrap().path();
        let copy = folder.path().join(path.file_name().unwrap());
        if path.is_file() {
            std::os::unix::fs::symlink(&path, &copy).unwrap();
        }
        if path.extension().is_some_and(|ending| ending == "onnx") {
            let mut bytes = std::fs::read(&path).unwrap();
            bytes[1000] ^= 1;
            std::fs::remove_file(&copy).unwrap();
            std::fs::write(&copy, bytes).unwrap();
        }
    }
    let station = station(folder.path());
    ends(&["segment", "-c", "config/stations/demo.toml", "-c", &station, FILM], 78, ".onnx");
}

#[test]
fn only_the_hand_model_that_is_chosen_is_needed() {
    let folder = tempfile::tempdir().unwrap();
    let runtime = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/runtime");
    for name in ["libonnxruntime.so", "hand_landmark_lite.onnx", "palm_detection_lite.onnx"] {
        let file = runtime.join(name).canonicalize().expect("the models are needed: run `make setup`");
        std::os::unix::fs::symlink(file, folder.path().join(name)).unwrap();
    }
    let full = station_with(folder.path(), "hand_model = 'full'");
    ends(&["segment", "-c", "config/stations/demo.toml", "-c", &full, FILM], 78, "palm_detection_full.onnx");
    let lite = station_with(folder.path(), "hand_model = 'lite'");
    ends(&["segment", "-c", "config/stations/demo.toml", "-c", &lite, FILM], 0, "");
}

#[test]
fn a_picture_that_cannot_be_calibrated_from_is_named_once() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("empty.mp4");
    std::fs::write(&picture, "").unwrap();
    let out = folder.path().join("bench.toml");
    let paths = [picture.to_str().unwrap(), out.to_str().unwrap()];
    let marker = ["--marker", "1=0,0"];
    let output = andond(&["calibrate", paths[0], "--side", "0.04", "--out", paths[1], marker[0], marker[1]]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(64), "{stderr}");
    assert_eq!(stderr.matches("empty.mp4").count(), 1, "{stderr}");
}

#[test]
fn millimetres_are_refused_with_what_they_are_in_metres() {
    let [marker, out] = ["--marker", "--out"];
    let markers = [marker, "1=0,0", marker, "2=0.4,0", marker, "3=0.4,0.3", marker, "4=0,0.3"];
    let calibrate = |side: &'static str, markers: &[&'static str]| {
        [&["calibrate", FILM, "--side", side, out, "/tmp/no.toml"], markers].concat()
    };
    ends(&calibrate("40", &markers), 64, "lengths are in metres: 40 mm is 0.04");
    ends(&calibrate("0.04", &[marker, "1=0,250"]), 64, "positions are in metres: 250 mm is 0.25");
    ends(&["new", "bench1", "--part", "brick=33"], 64, "lengths are in metres: 33 mm is 0.033");
}

#[test]
fn a_new_station_is_written_once_and_has_no_fault() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("bench1.toml");
    let (path, film) =
        (file.to_str().unwrap(), concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/footage/p1_none_r1.mp4"));
    let new =
        ["new", "bench1", "--part", "brick=0.033", "--part", "polisher", "--camera", film, "--out", path];
    let output = andond(&new);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.contains("andond markers -c") && said.contains("marker  1  brick     33.0 mm"), "{said}");
    ends(&["check", "-c", path], 0, "");
    let written = std::fs::read(&file).unwrap();
    ends(&new, 64, "it exists already; name another file, or replace it with --force");
    assert_eq!(std::fs::read(&file).unwrap(), written);
    ends(&[&new[..], &["--force"]].concat(), 0, "");
    ends(
        &["new", "bench1", "--out", folder.path().join("other.toml").to_str().unwrap()],
        64,
        "as in --part brick",
    );
    ends(&["new", "Bench 1", "--part", "brick"], 64, "as in bench1");
}

#[test]
fn printed_markers_are_replaced_only_by_force_and_all_or_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (station, out) = (path("bench1.toml"), folder.path().to_str().unwrap());
    let station = station.to_str().unwrap();
    ends(&["new", "bench1", "--part", "brick", "--out", station], 0, "");
    std::fs::write(path("bench1-markers-1.svg"), "mine").unwrap();
    let markers = ["markers", "-c", station, "--out", out];
    ends(
        &markers,
        64,
        "bench1-markers-1.svg: it exists already; name another file, or replace it with --force",
    );
    assert!(!path("bench1-markers.pdf").exists());
    ends(&[&markers[..], &["--force"]].concat(), 0, "");
    assert!(path("bench1-markers.pdf").exists());
    assert!(std::fs::read_to_string(path("bench1-markers-1.svg")).unwrap().contains("<svg"));
}

#[test]
fn what_is_seen_is_said_and_saved_for_the_calibration() {
    let folder = tempfile::tempdir().unwrap();
    let [plain, annotated] =
        ["plain.png", "seen.jpg"].map(|name| folder.path().join(name).to_str().unwrap().to_owned());
    let output = andond(&["look", FILM, "--save", &plain, "--annotated", &annotated]);
    let said = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.starts_with("p1_none_r1.mp4: 640 x 480 pixels, 464 pictures\n"), "{said}");
    assert!(
        said.contains("meter       its marker is 30 px wide; 30 are needed (seen in 100 % of the pictures)"),
        "{said}"
    );
    assert!(said.contains("right hand  seen in 100 % of the pictures") && !said.contains('\u{1b}'), "{said}");
    assert!(std::fs::read(&plain).unwrap().starts_with(b"\x89PNG"));
    assert!(std::fs::read(&annotated).unwrap().starts_with(b"\xff\xd8"));
    // A picture is looked at as a film is.
    let output = andond(&["look", &plain]);
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.contains("one picture") && said.contains("30 are needed (seen)"), "{said}");
}

#[test]
fn what_cannot_be_looked_at_or_saved_is_named_before_the_work() {
    ends(&["look", "no-such-film.mp4"], 64, "no-such-film.mp4");
    ends(&["look", "no-such.tracks.jsonl"], 64, "a track file has no pictures");
    ends(&["look", FILM, "--save", "/tmp/picture.gif"], 64, "a picture ends in .png or .jpg");
    ends(&["look", FILM, "--save", "/proc/picture.png"], 64, "/proc/picture.png: it cannot be written");
}

#[test]
fn a_demo_runs_where_tmpdir_is_too_long_for_sockets() {
    let folder = tempfile::tempdir().unwrap();
    let long = folder.path().join("a-folder-whose-name-alone-is-longer-than-the-path-of-a-socket-may-be");
    let clips = folder.path().join("clips");
    std::fs::create_dir_all(&long).unwrap();
    std::fs::create_dir_all(&clips).unwrap();
    let film = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join("tests/footage/p2_J2_r1.mp4");
    std::os::unix::fs::symlink(film, clips.join("clip.mp4")).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_andond"));
    command.args(["demo", "--speed", "max", "--clips"]).arg(&clips).env("TMPDIR", &long);
    let output = command.current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn a_demo_whose_roles_cannot_start_ends_with_what_the_role_said() {
    let folder = tempfile::tempdir().unwrap();
    let station = folder.path().join("no-models.toml");
    std::fs::write(&station, "[perception]\nmodels = \"not-there\"\n").unwrap();
    let demo = ["demo", "-c", "config/stations/demo.toml", "-c", station.to_str().unwrap()];
    ends(&demo, 78, "the role perceive has ended (exit status: 78)");
    ends(&demo, 78, "not-there/libonnxruntime.so does not exist; run `make setup`");
}
