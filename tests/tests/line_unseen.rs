//! What the line knows not to have seen is neither right nor an anomaly, on whichever way a result leaves it. Nothing is learnt from it either. There
//! is one row for each state of not watching, and one check for each way out.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_ipc::{Channel, Reader};
use andon_tests::line::{
    Counted, Line, NOISE, PATIENCE, Shift, UNSEEN, UNSEEN_S, Watcher, account, andond, kept, measure, root,
    samples, scrape, soft_plc, stand_in, tally, told_last, verdicts,
};
use andon_tests::python::python;
use andon_tests::{environment, workers};
use rustix::process::Signal;
use shm_schemas::{Detections, RoleId, VerdictLevel, VerdictOutcome, flag};
use std::convert::Infallible;
use std::fs::{self, File};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// The run that the film of a row shows.
const RUN: &str = "p1_none_r1.mp4";
/// The other runs that are taught beside it.
const OTHERS: [&str; 4] = ["p1_none_r2", "p1_none_r3", "p2_none_r1", "p2_none_r2"];

/// A verdict as it left the line on some way: start of the judge and number in that, level, outcome.
type Told = (u64, u64, String, String);
/// From when to when a result lasted, in seconds of the film, and how it came out.
type Span = (f64, f64, String);

/// A row whose film has the state: the line, a replay and `teach` must all know it.
struct State {
    /// What is done to the film.
    filter: &'static str,
    /// What the configuration has besides, in `[perception]`.
    perception: &'static str,
}

/// Plays the film once, and checks every way out.
fn check(state: &State) {
    // A camera that has stopped repeats its noise as well.
    let filter = match state.filter {
        frozen if frozen.starts_with("loop") => format!("{NOISE},{frozen}"),
        filter => format!("{filter},{NOISE}"),
    };
    // Only where frames are left out does the film not have all instants.
    let mode = if state.filter.starts_with("select") { "passthrough" } else { "auto" };
    let ffmpeg = ["-i", RUN, "-vf", &filter, "-fps_mode", mode];
    let mut line = Line::with_film("speed = \"max\"", state.perception, &ffmpeg);
    let spans = played(&mut line, |_, _| ());
    assert_only_unjudged_rests_on(&spans, UNSEEN_S);
    // To look for hands and markers is most of what a replay and `teach` compute: it is done once for both.
    let seen = line.path("film.tracks.jsonl");
    write_tracks(&line.path("film.mkv"), &line.config(), &seen);
    let replayed = replayed(&line, &seen);
    assert_only_unjudged_rests_on(&replayed, UNSEEN_S);
    assert_eq!(replayed.len(), spans.len());
    assert_nothing_is_learnt_of_it(&line, &seen);
}

/// A row in which a role does not run for some seconds: only the line can know it. The newest detections wait for a role that is only stopped, as many
/// as `kept`: how long that is depends on the machine. Only what came before them is lost.
fn check_down(
    role: &'static str,
    kept: usize,
    goes_down: impl Fn(&mut Line),
    comes_back: impl Fn(&mut Line),
) {
    let filter = ["-i", RUN, "-vf", NOISE];
    let mut line = Line::with_film("speed = \"file\"", "", &filter);
    let mut unseen_s = [0.0; 2];
    let spans = played(&mut line, |line, watcher| {
        let node = stand_in(line, RoleId::Tool);
        let mut detections = node.reader().unwrap();
        let before_s = until_detected(watcher, &mut detections, 0, UNSEEN_S[0]);
        goes_down(line);
        unseen_s[0] = newest_detected(&mut detections).unwrap_or(before_s);
        if role == "perceive" {
            std::thread::sleep(Duration::from_secs_f64(UNSEEN_S[1] - UNSEEN_S[0]));
            comes_back(line);
            // Nothing was detected meanwhile: what it sees first is the end.
            unseen_s[1] = until_detected(watcher, &mut detections, 0, unseen_s[0] + 1.0);
        } else {
            unseen_s[1] =
                until_detected(watcher, &mut detections, kept, unseen_s[0] + UNSEEN_S[1] - UNSEEN_S[0]);
            comes_back(line);
        }
    });
    assert_nothing_rests_on(&spans, unseen_s);
    // A busy machine may not have seen what was begun before: then the job that lacks it is not judged.
    let is_told = spans.iter().any(|(.., outcome)| outcome == "not_judged");
    let is_lost = unseen_s[1] > unseen_s[0];
    assert!(spans.is_empty() || !is_lost || is_told, "{unseen_s:?}: {spans:?}");
}

/// The times in the film of the new frames in which was looked for something, in seconds. Infinite at its end, which a slow machine may reach without
/// many frames.
fn detected(detections: &mut Reader<Detections>) -> Vec<f64> {
    let next = || {
        let found = detections.take().unwrap()?;
        let is_end = found.flags & flag::END_OF_STREAM != 0;
        Some(if is_end { f64::INFINITY } else { found.source_ns as f64 / 1e9 })
    };
    std::iter::from_fn(next).collect()
}

/// The newest of [`detected`].
fn newest_detected(detections: &mut Reader<Detections>) -> Option<f64> {
    detected(detections).last().copied()
}

/// The newest of [`detected`] that is lost to who keeps as many of those after it. Waits until it comes after this time, or the film ends. On a
/// machine that is so busy that it looks at no more pictures than these, none is lost.
fn until_detected(
    watcher: &mut Watcher,
    detections: &mut Reader<Detections>,
    kept: usize,
    after_s: f64,
) -> f64 {
    let until = Instant::now() + PATIENCE;
    let mut all_s = Vec::new();
    loop {
        all_s.extend(detected(detections));
        let lost_s = all_s.iter().rev().nth(kept);
        let is_end = all_s.last().is_some_and(|newest_s| newest_s.is_infinite());
        match lost_s {
            Some(lost_s) if is_end || *lost_s >= after_s => return *lost_s,
            None if is_end => return f64::NEG_INFINITY,
            _ => (),
        }
        assert!(Instant::now() < until, "no frame after {after_s} s");
        watcher.listen(Duration::from_millis(5));
    }
}

/// Plays the film of a line to its end and asks all ways out for the same; `meanwhile` is called when it has begun. Returns the results.
fn played(line: &mut Line, meanwhile: impl FnOnce(&mut Line, &mut Watcher)) -> Vec<Span> {
    let jobs = root().join("config/jobs");
    line.reconfigure("loop = true", "loop = false");
    line.reconfigure("\n\n[camera]", &format!("\njobs = {jobs:?}\n\n[camera]"));
    line.reconfigure("[plc]\n", "[plc]\nwrites = true\n");
    let port = measure(line);
    let mut watcher = Watcher::join(&line.station);
    line.start_all_but(&["steward"]);
    let ways = Ways::start(line);
    line.start("capture");
    meanwhile(line, &mut watcher);
    let count = watcher.until_judged() as usize;
    let told: Vec<Told> = watcher
        .verdicts
        .iter()
        .map(|verdict| {
            let level = verdict.level().map(VerdictLevel::name).unwrap();
            let outcome = verdict.outcome().map(VerdictOutcome::name).unwrap();
            (verdict.stamp.epoch, verdict.stamp.seq, level.to_owned(), outcome.to_owned())
        })
        .collect();
    let journal = ways.end(line, count, &told);
    until("the metrics", || verdicts(&samples(&scrape(port))) == tally(&watcher));
    journal
}

/// Programs that follow a line's verdicts. They are killed when this is dropped.
struct Ways {
    tail: Child,
    c_reader: Child,
    plc: Option<Shift>,
}

impl Ways {
    fn start(line: &Line) -> Self {
        let file = |name: &str| File::create(line.path(name)).unwrap();
        let mut tail = Command::new(andond());
        tail.args(["tail", "--json", "-c"]).arg(line.config()).stdout(file("tail.json"));
        let mut c_reader = Command::new(soft_plc(&line.path("")));
        c_reader.args(["line", "0"]).arg(line.station.root()).stdout(file("c-reader.txt"));
        // Made once, whichever row comes first.
        static PYTHON: OnceLock<std::path::PathBuf> = OnceLock::new();
        PYTHON.get_or_init(python);
        let (tail, c_reader) = (tail.spawn().unwrap(), c_reader.spawn().unwrap());
        let ways = Self { tail, c_reader, plc: Some(Shift::start(line, "1")) };
        until("the job of the PLC", || told_last(line).is_some_and(|told| told.is_job_taken));
        until("the C reader", || lines(&line.path("c-reader.txt")).iter().any(|line| line == "open"));
        ways
    }

    /// Waits until all have as many verdicts, and compares them with what was sent. Returns those of the journal.
    fn end(mut self, line: &Line, count: usize, told: &[Told]) -> Vec<Span> {
        let tailed = || -> Vec<serde_json::Value> {
            let lines = lines(&line.path("tail.json"));
            let values = lines.iter().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
            values.filter(|value| !value["outcome"].is_null()).collect()
        };
        let c_read = || -> Vec<String> {
            let lines = lines(&line.path("c-reader.txt"));
            lines.into_iter().filter(|line| line.starts_with("verdict ")).collect()
        };
        until("the journal", || kept(line).len() == count);
        until("the PLC", || account(line).len() == count);
        until("tail", || tailed().len() == count);
        until("the C reader", || c_read().len() == count);
        if let Some(plc) = self.plc.take() {
            plc.end();
        }
        let counted = |counted: Counted| (counted.epoch, counted.seq, counted.level, counted.outcome);
        let journal = kept(line);
        assert_eq!(journal.iter().map(|kept| counted(kept.verdict.clone())).collect::<Vec<_>>(), told);
        assert_eq!(account(line).into_iter().map(|(_, result)| counted(result)).collect::<Vec<_>>(), told);
        let levels = |verdict: &serde_json::Value| (text(&verdict["level"]), text(&verdict["outcome"]));
        assert_eq!(
            tailed().iter().map(levels).collect::<Vec<_>>(),
            told.iter().map(|(.., level, outcome)| (level.clone(), outcome.clone())).collect::<Vec<_>>()
        );
        let in_c = |(_, seq, _, outcome): &Told| {
            let word = match outcome.as_str() {
                "anomaly" => "nok",
                "not_judged" => "not-judged",
                outcome => outcome,
            };
            format!("verdict {seq} {word}")
        };
        let begin = |line: String| line.split(" reason").next().unwrap().to_owned();
        assert_eq!(
            c_read().into_iter().map(begin).collect::<Vec<_>>(),
            told.iter().map(in_c).collect::<Vec<_>>()
        );
        journal.into_iter().map(|kept| (kept.began_s, kept.ended_s, kept.verdict.outcome)).collect()
    }
}

impl Drop for Ways {
    fn drop(&mut self) {
        for program in [&mut self.tail, &mut self.c_reader] {
            let _ = program.kill();
            let _ = program.wait();
        }
    }
}

fn text(value: &serde_json::Value) -> String {
    value.as_str().unwrap().to_owned()
}

/// The whole lines of a file that is being written.
fn lines(path: &Path) -> Vec<String> {
    let text = fs::read_to_string(path).unwrap();
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    whole.lines().map(str::to_owned).collect()
}

fn until(what: &str, holds: impl Fn() -> bool) {
    let until = Instant::now() + PATIENCE;
    while !holds() {
        assert!(Instant::now() < until, "{what} does not get all verdicts");
        std::thread::sleep(Duration::from_millis(100));
    }
}

/// What a replay of the line's film says, with what is seen in it.
fn replayed(line: &Line, seen: &Path) -> Vec<Span> {
    let output = Command::new(andond())
        .args(["replay", "--json", "-c"])
        .arg(line.config())
        .arg("--job")
        .arg(root().join("config/jobs/polish-and-measure.toml"))
        .arg(seen)
        .output()
        .unwrap();
    String::from_utf8(output.stdout)
        .unwrap()
        .lines()
        .map(|line| {
            let verdict: serde_json::Value = serde_json::from_str(line).unwrap();
            let seconds = |key: &str| verdict[key].as_f64().unwrap();
            (seconds("began_s"), seconds("ended_s"), text(&verdict["outcome"]))
        })
        .collect()
}

/// Teaches a job by the line's film, with what is seen in it, and by films of which all was seen. The IU that was not seen is learnt from these alone.
fn assert_nothing_is_learnt_of_it(line: &Line, seen: &Path) {
    // What is in them is the same for every row, and a film takes long.
    static TRACKS: OnceLock<Vec<Vec<u8>>> = OnceLock::new();
    let tracks = TRACKS.get_or_init(|| OTHERS.map(|run| tracks_of(line, run)).into());
    let mut teach = Command::new(andond());
    teach.args(["teach", "-c"]).arg(line.config()).arg("--out").arg(line.path("taught.toml"));
    teach.arg(seen);
    for (run, tracks) in OTHERS.iter().zip(tracks) {
        let path = line.path(&format!("{run}.tracks.jsonl"));
        fs::write(&path, tracks).unwrap();
        teach.arg(path);
    }
    let output = teach.stderr(Stdio::inherit()).output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{said}");
    let is_told = said.contains("too little was seen of film.tracks.jsonl in step 1, IU 2 ")
        || said.contains("film.tracks.jsonl was left out: ");
    let is_learnt_from = |runs: &str| said.contains(&format!("\n   1   2      {runs}  "));
    assert!(is_told && is_learnt_from("4"), "{said}");
}

/// What is seen in a shipped film.
fn tracks_of(line: &Line, run: &str) -> Vec<u8> {
    let (footage, demo) = (root().join("tests/footage"), root().join("config/stations/demo.toml"));
    let path = line.path("other.tracks.jsonl");
    write_tracks(&footage.join(format!("{run}.mp4")), &demo, &path);
    let tracks = fs::read(&path).unwrap();
    fs::remove_file(path).unwrap();
    tracks
}

/// Writes what is seen in a film, by this configuration.
fn write_tracks(film: &Path, config: &Path, out: &Path) {
    let mut tracks = Command::new(andond());
    tracks.arg("tracks").arg(film).arg("-c").arg(config).arg("--out").arg(out);
    assert!(tracks.stdout(Stdio::null()).status().unwrap().success());
}

/// What rests on this time is not judged. How many of the results those are.
///
/// A state lasts a little longer than the picture shows it, so what only touches its ends does not depend on it.
fn assert_nothing_rests_on(spans: &[Span], unseen_s: [f64; 2]) -> usize {
    let rests = |(began_s, ended_s, _): &&Span| *began_s < unseen_s[1] - 0.2 && *ended_s > unseen_s[0] + 0.2;
    let resting: Vec<_> = spans.iter().filter(rests).collect();
    assert!(resting.iter().all(|(.., outcome)| outcome == "not_judged"), "{unseen_s:?}: {resting:?}");
    resting.len()
}

/// The same, and where there are results, some rest on this time.
fn assert_only_unjudged_rests_on(spans: &[Span], unseen_s: [f64; 2]) {
    let resting = assert_nothing_rests_on(spans, unseen_s);
    assert!(spans.is_empty() || resting > 0, "{unseen_s:?}: {spans:?}");
}

/// A role that is stopped for a while, and goes on.
fn check_stopped(role: &'static str) {
    check_down(
        role,
        Channel::Detections.qos().buffer,
        |line| line.role(role).signal(Signal::STOP),
        |line| line.role(role).signal(Signal::CONT),
    );
}

/// A role that is killed, and starts again after a while.
fn check_killed(role: &'static str) {
    check_down(
        role,
        0,
        |line| line.role(role).kill(),
        |line| {
            line.start(role);
        },
    );
}

/// What the line does not watch, and what makes it so.
type Row<T> = (&'static str, T);

/// The states that a film has.
fn films() -> Vec<Row<State>> {
    let film = |(shown, filter)| (shown, State { filter, perception: "" });
    let no_markers = State { filter: "null", perception: "dictionary = \"DICT_5X5_50\"" };
    // Where the hand works, and no marker lies.
    let no_hand = "drawbox=x=382:y=100:w=258:h=380:c=0x504f4b:t=fill:enable='between(t,4,7)'";
    let own = [("no markers of the station", no_markers), film(("parts that move without a hand", no_hand))];
    UNSEEN.into_iter().map(film).chain(own).collect()
}

/// The states that only a running line has.
const ROLES_DOWN: [Row<fn()>; 4] = [
    ("perceive is stopped", || check_stopped("perceive")),
    ("perceive is killed", || check_killed("perceive")),
    ("encode is stopped", || check_stopped("encode")),
    ("encode is killed", || check_killed("encode")),
];

/// A row takes half a minute of a processor: each draw tries one in as many, and `make unseen` all.
const EVERY: u64 = 4;

/// The rows of this draw.
fn check_rows<T: Sync>(rows: Vec<Row<T>>, check: impl Fn(&T) + Sync) {
    let drawn = environment::one_in(EVERY, rows);
    assert!(!drawn.is_empty());
    let checked: Result<(), Infallible> = workers::for_each(&drawn, |(name, row)| {
        println!("{name}");
        check(row);
        Ok(())
    });
    let Ok(()) = checked;
}

#[test]
fn nothing_rests_on_a_time_in_which_a_film_shows_nothing() {
    check_rows(films(), check);
}

#[test]
fn nothing_rests_on_a_time_in_which_a_role_is_down() {
    check_rows(ROLES_DOWN.to_vec(), |check| check());
}
