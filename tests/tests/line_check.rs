//! `andond check` opens what the roles will open: each fault that a role would end with is found before anything starts.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_learn::job_file::JobFile;
use andon_tests::line::{Line, Settings};
use std::net::TcpListener;
use std::path::Path;

/// Runs `andond check` on a line, with more configuration; its exit code and what it says.
fn check(line: &Line, more: &str) -> (Option<i32>, String) {
    let extra = line.path("extra").join("more.toml");
    std::fs::create_dir_all(extra.parent().unwrap()).unwrap();
    std::fs::write(&extra, more).unwrap();
    let output = line.command("check", &["--config", extra.to_str().unwrap()]);
    let said =
        String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    (output.status.code(), said)
}

/// It must end with 78, say that the configuration is wrong, and name each of these.
fn refuses(line: &Line, more: &str, named: &[&str]) {
    ends(line, more, 78, &[&["in the configuration, or in a file that it names:\n"], named].concat());
}

/// It must end with 70, say that only this machine is at fault, and name each of these.
fn lacks(line: &Line, more: &str, named: &[&str]) {
    let words = ["on this machine:\n", "no fault in the configuration, 1 fault on this machine"];
    ends(line, more, 70, &[&words, named].concat());
}

fn ends(line: &Line, more: &str, code: i32, named: &[&str]) {
    let (ended, said) = check(line, more);
    assert_eq!(ended, Some(code), "{more}: {said}");
    for name in named {
        assert!(said.contains(name), "{more}: {name} is not named: {said}");
    }
}

fn line() -> Line {
    Line::new(Settings::default())
}

fn footage() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("footage").canonicalize().unwrap()
}

fn models() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/runtime").canonicalize().unwrap()
}

#[test]
fn a_station_without_a_fault_passes() {
    let (code, said) = check(&line(), "");
    assert_eq!(code, Some(0), "{said}");
    let film = footage().join("p1_none_r1.mp4");
    let (code, said) = check(
        &line(),
        &format!("[camera]\nsource = \"video\"\npath = {film:?}\n[perception]\nmodels = {:?}\n", models()),
    );
    assert_eq!(code, Some(0), "{said}");
}

#[test]
fn models_or_a_library_that_are_missing_are_found() {
    let line = line();
    let film = footage().join("p1_none_r1.mp4");
    let empty = line.path("empty");
    std::fs::create_dir(&empty).unwrap();
    let station =
        format!("[camera]\nsource = \"video\"\npath = {film:?}\n[perception]\nmodels = {empty:?}\n");
    lacks(&line, &station, &["perception: ", "make setup"]);
    // The models without the library that runs them.
    for entry in std::fs::read_dir(models()).unwrap().flatten() {
        if entry.path().extension().is_some_and(|ending| ending == "onnx") {
            std::os::unix::fs::symlink(entry.path(), empty.join(entry.file_name())).unwrap();
        }
    }
    lacks(&line, &station, &["perception: ", "onnxruntime"]);
}

#[test]
fn a_camera_that_is_not_there_is_found() {
    let camera = "[camera]\nsource = \"v4l2\"\npath = \"x\"\ndevice = \"/dev/video99\"\nspeed = \"file\"\n";
    let station = format!("{camera}[perception]\nmodels = {:?}\n", models());
    let films = "films can be taught from and judged without a camera";
    lacks(&line(), &station, &["camera: /dev/video99: no such device", films]);
    // What is wrong in the file is said beside it, and then the file must be corrected first.
    let both = format!("{station}[journal]\npath = \"missing/j.sqlite\"\n");
    let words = ["journal.path: ", "camera: ", "1 fault in the configuration, 1 fault on this machine"];
    refuses(&line(), &both, &words);
}

#[test]
fn a_realsense_camera_that_is_not_attached_is_found() {
    let camera = "[camera]\nsource = \"realsense\"\nspeed = \"file\"\n";
    let station = format!("{camera}[perception]\nmodels = {:?}\n", models());
    lacks(&line(), &station, &["camera: ", "RealSense"]);
}

/// Its name, its port and its journal are those of this station because it is the same file.
#[test]
fn a_copy_of_the_station_file_in_its_folder_is_told_as_a_copy() {
    let line = line();
    std::fs::copy(line.config(), line.path("station copy.toml")).unwrap();
    let output = line.command("check", &[]);
    let said =
        String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(78), "{said}");
    assert!(said.contains("station copy.toml is a copy of this station's file: move it"), "{said}");
    assert!(!said.contains("listens on port"), "one cause is one fault: {said}");
}

/// Who waits for the writer of a pipe waits for ever.
#[test]
fn a_pipe_in_place_of_a_file_is_refused_and_not_waited_for() {
    let line = line();
    let pipe = line.path("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for key in
        ["[station]\njob", "[camera]\nsource = \"video\"\npath", "[journal]\npath", "[bench]\ncalibration"]
    {
        let (code, said) = check(&line, &format!("{key} = {pipe:?}\n"));
        assert!(code == Some(78) && said.contains("pipe"), "{key}: {code:?} {said}");
    }
    let output = std::process::Command::new(andon_tests::line::andond())
        .args(["check", "-c"])
        .arg(&pipe)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(78) && said.contains("save it as one first"), "{said}");
}

#[test]
fn a_text_as_film_or_as_job_is_found() {
    let line = line();
    let text = line.path("text.mp4");
    std::fs::write(&text, "no film").unwrap();
    let film =
        format!("[camera]\nsource = \"video\"\npath = {text:?}\n[perception]\nmodels = {:?}\n", models());
    refuses(&line, &film, &["camera: ", "text.mp4: it is text and no film"]);
    refuses(&line, &format!("[station]\njob = {text:?}\n"), &["station.job: ", "text.mp4"]);
    refuses(&line, &format!("[camera]\npath = {text:?}\n"), &["camera: ", "text.mp4"]);
}

#[test]
fn a_journal_that_cannot_be_written_is_found() {
    let line = line();
    let folder = line.path("folder");
    std::fs::create_dir(&folder).unwrap();
    let text = line.path("text.sqlite");
    std::fs::write(&text, "no journal, but a text that is long enough").unwrap();
    refuses(&line, "[journal]\npath = \"missing/j.sqlite\"\n", &["journal.path: ", "missing"]);
    refuses(&line, &format!("[journal]\npath = {folder:?}\n"), &["journal.path: ", "is a folder"]);
    refuses(&line, &format!("[journal]\npath = {text:?}\n"), &["journal.path: ", "is not a journal"]);
}

#[test]
fn folders_in_which_an_engineer_s_commands_cannot_write_are_found_with_what_helps() {
    let line = line();
    let executor = "[board]\nenable = true\n[executor]\nenable = true\n";
    let station = |jobs: &str, more: &str| format!("[station]\njobs = {jobs:?}\n{executor}{more}");
    let (code, said) = check(&line, &station("jobs", "path = \"made\"\n"));
    assert_eq!(code, Some(0), "the role makes them: {said}");
    let remedy = "name a folder below /var/lib/andon";
    refuses(
        &line,
        &station("/proc/jobs", "path = \"made\"\n"),
        &["station.jobs: /proc/jobs cannot be made", remedy],
    );
    refuses(&line, &station("jobs", "path = \"/proc/made\"\n"), &["executor.path: /proc/made", remedy]);
    let films = "path = \"made\"\nfilms = \"/proc/films\"\n";
    refuses(&line, &station("jobs", films), &["executor.films: /proc/films", "name another one"]);
}

/// The line's job, changed.
fn job(line: &Line, change: impl FnOnce(&mut JobFile)) -> std::path::PathBuf {
    let mut job = JobFile::parse("job", &std::fs::read(line.path("job.toml")).unwrap()).unwrap();
    change(&mut job);
    let path = line.path("changed.toml");
    std::fs::write(&path, job.to_toml()).unwrap();
    path
}

/// An object that the station does not have.
fn with_another_object(job: &mut JobFile) {
    let mut object = job.objects[0].clone();
    (object.shape.id, object.name) = (49, "another".into());
    job.objects.push(object);
}

#[test]
fn a_job_that_was_taught_with_other_constants_or_for_other_objects_is_found() {
    let line = line();
    let persist = job(&line, |job| job.method.persist_frames += 1);
    refuses(&line, &format!("[station]\njob = {persist:?}\n"), &["station.job: ", "method.persist_frames"]);
    let object = job(&line, with_another_object);
    refuses(&line, &format!("[station]\njob = {object:?}\n"), &["station.job: ", "no object 49"]);
}

#[test]
fn a_folder_of_jobs_that_is_missing_or_has_a_damaged_file_is_found_where_a_plc_may_select() {
    let line = Line::new(Settings { writes: true, ..Settings::default() });
    let folder = line.path("jobs");
    let station = format!("[station]\njobs = {folder:?}\n");
    refuses(&line, &station, &["station.jobs: ", "a PLC selects jobs from there"]);
    std::fs::create_dir(&folder).unwrap();
    std::fs::copy(line.path("job.toml"), folder.join("good.toml")).unwrap();
    // One for another station that has the same folder is not a fault.
    std::fs::copy(job(&line, with_another_object), folder.join("other.toml")).unwrap();
    let (code, said) = check(&line, &station);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("other.toml: not for this station"), "{said}");
    std::fs::write(folder.join("text.toml"), "no job").unwrap();
    refuses(&line, &station, &["station.jobs: ", "text.toml"]);
}

#[test]
fn a_port_that_is_taken_is_found_and_a_line_that_runs_is_not_disturbed() {
    let mut line = Line::new(Settings::live());
    let taken = TcpListener::bind(("127.0.0.1", line.port)).unwrap();
    lacks(&line, "", &["plc.port: 127.0.0.1:", "cannot be listened on"]);
    drop(taken);
    let _watcher = line.up();
    let (code, said) = check(&line, "");
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("the line runs"), "{said}");
}

#[test]
fn another_station_of_the_same_folder_with_the_same_port_journal_or_name_is_found() {
    let line = line();
    let text = std::fs::read_to_string(line.config()).unwrap();
    let other = line.path("bench2.toml");
    let changed =
        text.replace("name = \"line\"", "name = \"bench2\"").replace("journal.sqlite", "bench2.sqlite");
    std::fs::write(&other, &changed).unwrap();
    let said = || {
        let output = line.command("check", &[]);
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, errors) = said();
    assert!(code == Some(78) && errors.contains("plc.port: this station listens on port"), "{errors}");
    assert!(errors.contains("bench2.toml") && errors.contains("1 fault"), "{errors}");
    std::fs::write(&other, changed.replace(&format!("port = {}", line.port), "port = 1")).unwrap();
    assert_eq!(said().0, Some(0), "{}", said().1);
    std::fs::write(&other, text.replace(&format!("port = {}", line.port), "port = 1")).unwrap();
    let (_, errors) = said();
    assert!(errors.contains("station.name: ") && errors.contains("journal.path: "), "{errors}");
}

#[test]
fn ever_so_many_objects_are_one_fault() {
    let line = line();
    let objects: String = (0..20_000)
        .map(|n| format!("[[objects]]\nid = 1\nname = \"part {n}\"\nmarker_side_m = 0.03\ninteraction_points = [[0.0, 0.0, 0.0]]\n"))
        .collect();
    let (code, said) = check(&line, &objects);
    assert_eq!(code, Some(78), "{said}");
    assert!(said.contains("there are 20000; must be at most 32"), "{}", &said[..1000.min(said.len())]);
    assert!(
        said.lines().count() < 50,
        "what else is wrong with the 20,000 helps nobody: {} lines",
        said.lines().count()
    );
}
