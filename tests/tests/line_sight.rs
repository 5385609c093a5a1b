//! What a line says of its own sight: in the log, in the health, to the PLC, by its tools and in the journal.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::line::{Line, Watcher, andond};
use shm_schemas::{RoleId, Sight};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

/// A station that plays a shipped clip again and again, as fast as it can be looked at. From its fourth second on the clip is black.
fn line_that_goes_black() -> Line {
    let line = Line::configured(|folder, port| {
        let shipped = std::fs::read_to_string(root().join("config/stations/film.toml")).unwrap();
        let (_, objects) = shipped.split_once("[[objects]]").unwrap();
        let (objects, _) = objects.split_once("[plc]").unwrap();
        let models = root().join("target/runtime");
        let job = root().join("config/jobs/polish-and-measure.toml");
        format!(
            "[station]\nname = \"line\"\nroot = {folder:?}\njob = {job:?}\n\n\
             [camera]\nsource = \"video\"\npath = \"film.mp4\"\nspeed = \"max\"\nloop = true\n\n\
             [perception]\nhands = [\"right\"]\nmodels = {models:?}\n\n\
             [journal]\npath = \"journal.sqlite\"\n\n\
             [plc]\nenable = true\nport = {port}\n\n[[objects]]{objects}"
        )
    });
    let status = Command::new("ffmpeg")
        .args(["-v", "error", "-i"])
        .arg(root().join("tests/footage/p1_J1_r1.mp4"))
        .args(["-vf", "lutyuv=y=16:u=128:v=128:enable='gte(t,4)'", "-preset", "ultrafast"])
        .arg(line.path("film.mp4"))
        .status()
        .expect("ffmpeg is needed: run `make test-packages`, or apt install ffmpeg");
    assert!(status.success());
    line
}

/// Runs a command until it prints this; panics after a minute.
fn until_printed(line: &Line, command: &str, expected: &str) -> std::process::Output {
    let until = Instant::now() + Duration::from_secs(60);
    loop {
        let output = line.command(command, &[]);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        if text.contains(expected) {
            return output;
        }
        assert!(Instant::now() < until, "`andond {command}` does not say {expected}:\n{text}");
    }
}

fn until_sees(watcher: &mut Watcher, sight: Sight) {
    watcher.until(sight.name(), |watcher| {
        watcher.health(RoleId::Perceive).is_some_and(|health| health.sight == sight.code())
    });
}

#[test]
fn a_black_picture_is_said_everywhere_and_undone_when_it_is_over() {
    let mut line = line_that_goes_black();
    let mut watcher = line.launch();
    line.start("capture");
    until_sees(&mut watcher, Sight::Clear);
    until_sees(&mut watcher, Sight::Black);
    line.wait_for_log("perceive", "AND-213", "Switch on the light");
    line.wait_for_log("plc", "AND-510", "does not see its bench");
    let status = until_printed(&line, "status", "BLIND");
    assert_eq!(status.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&status.stdout).contains("AND-213"), "{status:?}");
    let mut tail = Command::new(andond())
        .args(["tail", "-c"])
        .arg(line.config())
        .stdout(std::process::Stdio::null())
        .stderr(std::fs::File::create(line.path("tail.log")).unwrap())
        .spawn()
        .unwrap();
    until_sees(&mut watcher, Sight::Clear);
    line.wait_for_log("perceive", "AND-221", "");
    until_printed(&line, "history", "-- not watching until 2");
    line.wait_for_log("tail", "not watching: the picture is black", "Switch on the light");
    line.wait_for_log("tail", "watching again", "");
    tail.kill().unwrap();
    tail.wait().unwrap();
}
