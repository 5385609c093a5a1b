//! What the line knows not to have seen is neither right nor an anomaly, on whichever way a result leaves it: one row for each state of its
//! sight, one check for each way out.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::line::{Counted, Line, PATIENCE, Shift, account, andond, kept, root, told_last};
use andon_tests::python::python;
use shm_schemas::{VerdictLevel, VerdictOutcome};
use std::process::Command;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// From when to when the line does not watch, in seconds of the film, in the middle of the strokes of a right run.
const UNSEEN_S: [f64; 2] = [4.0, 7.0];
/// What every picture is like that a camera gives; rendered ones have no noise.
const NOISE: &str = "noise=alls=4:allf=t";

/// A state of the line's sight: what is done to the film, and what the configuration has besides.
struct State {
    filter: &'static str,
    perception: &'static str,
}

/// A filter that acts while the line shall not watch.
const fn film(filter: &'static str) -> State {
    State { filter, perception: "" }
}

/// A verdict as it left the line on some way: start of the judge and number in that, level, outcome.
type Told = (u64, u64, String, String);

/// Plays the film once, and checks every way out.
fn check(state: &State) {
    // A camera that has stopped repeats its noise as well.
    let filter = match state.filter {
        frozen if frozen.starts_with("loop") => format!("{NOISE},{frozen}"),
        filter => format!("{},{NOISE}", filter.replace("HERE", "enable='between(t,4,7)'")),
    };
    // Only where frames are left out does the film not have all instants.
    let mode = if state.filter.starts_with("select") { "passthrough" } else { "auto" };
    let ffmpeg = ["-i", "p1_none_r1.mp4", "-vf", &filter, "-fps_mode", mode];
    let mut line = Line::with_film("speed = \"max\"", state.perception, &ffmpeg);
    let jobs = root().join("config/jobs");
    line.reconfigure("loop = true", "loop = false");
    line.reconfigure("\n\n[camera]", &format!("\njobs = {jobs:?}\n\n[camera]"));
    line.reconfigure("[plc]\n", "[plc]\nwrites = true\n");
    let tail_file = line.path("tail.json");
    let mut watcher = line.launch();
    let mut tail = Command::new(andond());
    tail.args(["tail", "--json", "-c"]).arg(line.config());
    let mut tail = tail.stdout(std::fs::File::create(&tail_file).unwrap()).spawn().unwrap();
    // Made once, whichever row comes first.
    static PYTHON: OnceLock<std::path::PathBuf> = OnceLock::new();
    PYTHON.get_or_init(python);
    let program = Shift::start(&line, "1");
    until("the job of the PLC", || told_last(&line).is_some_and(|told| told.is_job_taken));
    line.start("capture");
    let count = watcher.until_judged() as usize;
    let told: Vec<Told> = watcher
        .verdicts
        .iter()
        .map(|verdict| {
            let level = VerdictLevel::try_from(verdict.level).unwrap();
            let outcome = VerdictOutcome::try_from(verdict.outcome).unwrap();
            let name = |words: String| words.to_lowercase().replace("notjudged", "not_judged");
            let (level, outcome) = (name(format!("{level:?}")), name(format!("{outcome:?}")));
            (verdict.stamp.epoch, verdict.stamp.seq, level, outcome)
        })
        .collect();
    // On all ways the same.
    until("the journal", || kept(&line).len() == count);
    until("the PLC", || account(&line).len() == count);
    let of_tail = || -> Vec<serde_json::Value> {
        let text = std::fs::read_to_string(&tail_file).unwrap();
        let values = text.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
        values.filter(|value| !value["outcome"].is_null()).collect()
    };
    until("tail", || of_tail().len() == count);
    tail.kill().unwrap();
    tail.wait().unwrap();
    program.end();
    let counted = |counted: Counted| (counted.epoch, counted.seq, counted.level, counted.outcome);
    let journal = kept(&line);
    assert_eq!(journal.iter().map(|kept| counted(kept.verdict.clone())).collect::<Vec<_>>(), told);
    assert_eq!(account(&line).into_iter().map(|(_, result)| counted(result)).collect::<Vec<_>>(), told);
    let text = |value: &serde_json::Value| value.as_str().unwrap().to_owned();
    let tailed: Vec<(String, String)> =
        of_tail().iter().map(|verdict| (text(&verdict["level"]), text(&verdict["outcome"]))).collect();
    assert_eq!(
        tailed,
        told.iter().map(|(.., level, outcome)| (level.clone(), outcome.clone())).collect::<Vec<_>>()
    );
    // And none of them rests on what was not seen.
    let spans: Vec<(f64, f64, String)> =
        journal.iter().map(|kept| (kept.began_s, kept.ended_s, kept.verdict.outcome.clone())).collect();
    assert_nothing_rests_on_it(&spans);
    // A replay of the film knows it as well.
    let film = line.path("film.mkv");
    let output = Command::new(andond())
        .args(["replay", "--json", "-c"])
        .arg(line.config())
        .arg("--job")
        .arg(jobs.join("polish-and-measure.toml"))
        .arg(film)
        .output()
        .unwrap();
    let replayed: Vec<(f64, f64, String)> = String::from_utf8(output.stdout)
        .unwrap()
        .lines()
        .map(|line| {
            let verdict: serde_json::Value = serde_json::from_str(line).unwrap();
            let seconds = |key: &str| verdict[key].as_f64().unwrap();
            (seconds("began_s"), seconds("ended_s"), text(&verdict["outcome"]))
        })
        .collect();
    assert_nothing_rests_on_it(&replayed);
    assert_eq!(replayed.len(), spans.len());
}

fn until(what: &str, holds: impl Fn() -> bool) {
    let until = Instant::now() + PATIENCE;
    while !holds() {
        assert!(Instant::now() < until, "{what} does not get all verdicts");
        std::thread::sleep(Duration::from_millis(100));
    }
}

/// A state lasts a little longer than the picture shows it, so what only touches its ends does not rest on it.
fn assert_nothing_rests_on_it(verdicts: &[(f64, f64, String)]) {
    let rests = |(began_s, ended_s, _): &&(f64, f64, String)| {
        *began_s < UNSEEN_S[1] - 0.2 && *ended_s > UNSEEN_S[0] + 0.2
    };
    let resting: Vec<_> = verdicts.iter().filter(rests).collect();
    assert!(resting.iter().all(|(.., outcome)| outcome == "not_judged"), "{resting:?}");
    assert!(verdicts.is_empty() || !resting.is_empty(), "{verdicts:?}");
}

#[test]
fn nothing_rests_on_a_black_picture() {
    check(&film("lutyuv=y=16:u=128:v=128:HERE"));
}

#[test]
fn nothing_rests_on_a_white_picture() {
    check(&film("lutyuv=y=255:u=128:v=128:HERE"));
}

#[test]
fn nothing_rests_on_a_picture_that_stands_still() {
    check(&film("loop=loop=90:size=1:start=120,setpts=N/30/TB"));
}

#[test]
fn nothing_rests_on_a_covered_lens() {
    check(&film("drawbox=c=0x6a4030:t=fill:HERE"));
}

#[test]
fn nothing_rests_on_a_blurred_picture() {
    check(&film("gblur=sigma=12:HERE"));
}

#[test]
fn nothing_rests_on_a_picture_full_of_noise() {
    check(&film("noise=alls=100:allf=t:HERE"));
}

#[test]
fn nothing_rests_on_what_a_camera_shows_that_was_moved() {
    check(&film("rotate=0.08:c=gray:HERE"));
}

#[test]
fn nothing_rests_on_too_few_frames() {
    check(&film("select='not(between(t,4,7))+not(mod(n,8))'"));
}

#[test]
fn nothing_rests_on_a_bench_without_markers_of_the_station() {
    check(&State { filter: "null", perception: "dictionary = \"DICT_5X5_50\"" });
}
