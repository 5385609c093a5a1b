//! What people do with recordings. They find the clip of a verdict, say that it was right, teach it and ask what another job would have said. They
//! remove it, and open it in other viewers.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_learn::recording;
use andon_record::{picture, store};
use andon_tests::line::{Line, Settings, Watcher, root};
use andon_tests::python::{all_output, python};
use andon_tests::simulator::{Flaw, Noise, Performance, perform};
use shm_schemas::{VerdictLevel, VerdictOutcome};
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn up(line: &mut Line, others: &[&'static str]) -> Watcher {
    let watcher = line.launch_recorded();
    for role in others {
        line.start(role);
    }
    watcher
}

/// Also leaves the station: what is done to it then is done to one that does not run.
fn stop(line: &mut Line, watcher: Watcher) {
    drop(watcher);
    line.roles.retain(|role| role.role != "capture");
    let failures = line.stop_recorded();
    assert!(failures.is_empty(), "{failures:?}");
}

/// What a command prints that must succeed, or end with this code.
fn said(output: &Output, code: i32) -> String {
    let text = all_output(output);
    assert_eq!(output.status.code(), Some(code), "{text}");
    text
}

/// Right runs beside the station's job, which is taught from them.
fn teach(line: &Line) -> Vec<PathBuf> {
    let mut runs = Vec::new();
    for (person, repetition) in [(1, 1), (2, 1), (3, 1), (4, 1), (9, 2), (9, 3)] {
        let path = line.path(&format!("p{person}_r{repetition}.tracks.jsonl"));
        let performance = Performance { seed: 4, person, repetition, noise: Noise::default() };
        let (run, _) = perform(&performance, Flaw::None);
        recording::write(&mut BufWriter::new(File::create(&path).unwrap()), &run.header, &run.frames)
            .unwrap();
        runs.push(path);
    }
    let job = line.path("job.toml");
    let mut arguments: Vec<&str> = runs.iter().map(|run| run.to_str().unwrap()).collect();
    arguments.extend(["--force", "--out", job.to_str().unwrap()]);
    said(&line.command("teach", &arguments), 0);
    runs
}

/// The number of a clip in a row of the history that contains these words.
fn clip_of(history: &str, words: &str) -> String {
    let row = history.lines().find(|row| row.contains(words) && row.contains("clip "));
    let row = row.unwrap_or_else(|| panic!("no clip of {words}:\n{history}"));
    let (_, number) = row.rsplit_once("clip ").unwrap();
    number.trim_end_matches(']').to_owned()
}

#[test]
fn a_piece_that_was_accused_and_right_is_found_confirmed_taught_and_at_last_removed() {
    let settings = Settings { at_full_speed: false, flaw: Flaw::J1, ..Settings::default() };
    let mut line = Line::new(settings);
    teach(&line);
    line.record("always");
    let mut watcher = up(&mut line, &[]);
    line.command("part", &["SN-7"]);
    watcher.until_judged();
    stop(&mut line, watcher);

    let history = said(&line.command("history", &[]), 0);
    let row = clip_of(&history, "job");
    let clip = said(&line.command("clip", &[&row]), 0);
    assert!(clip.lines().next().unwrap().ends_with(".mcap"), "{clip}");
    let question = format!("SELECT clip FROM verdict WHERE id = {row}");
    let asked = said(&line.command("history", &["--sql", &question]), 0);
    assert_eq!(asked, format!("clip\r\n{}\r\n", clip.lines().next().unwrap()));
    let unknown = said(&line.command("clip", &["999999"]), 64);
    assert!(unknown.contains("the journal has no verdict of this number"), "{unknown}");

    // Nobody has confirmed anything yet.
    let job = line.path("job.toml");
    let job = job.to_str().unwrap();
    let nothing = said(&line.command("teach", &["--from-history", "--out", job]), 64);
    assert!(nothing.contains("`andond confirm ID right` confirms it"), "{nothing}");
    let before = said(&line.command("whatif", &["--since", "1h", "--job", job]), 1);
    assert!(before.contains("pieces wrong") && before.contains("would be"), "{before}");
    assert!(before.contains(": too few strokes  "), "by step and fault: {before}");

    // Two commands.
    said(&line.command("confirm", &[&row, "right"]), 0);
    let taught = said(&line.command("teach", &["--from-history", "--force", "--out", job]), 0);
    assert!(taught.contains("written: "), "{taught}");
    let file = fs::read_to_string(job).unwrap();
    assert!(file.contains("name = \"confirmed-") && file.contains(".tracks.jsonl\""), "{file}");
    let after = line.command("whatif", &["--since", "1h", "--job", job]);
    let text = all_output(&after);
    assert!(
        text.lines().any(|row| row.starts_with("pieces right") && row.ends_with(" 1")),
        "{taught}{text}{history}"
    );
    assert!(after.status.success(), "{text}");
    // The clip of what the other job says otherwise is named.
    let clip_row = text.lines().find(|row| row.starts_with(clip.lines().next().unwrap()));
    assert!(clip_row.is_some_and(|row| row.contains("pieces wrong 1 -> 0")), "{text}");

    let deeds = said(&line.command("history", &["--audit"]), 0);
    assert!(deeds.contains("confirmation") && deeds.contains(&format!("verdict {row} of ")), "{deeds}");
    // Somebody has looked again: the job is as it was before.
    said(&line.command("confirm", &[&row, "wrong"]), 0);
    said(&line.command("teach", &["--from-history", "--force", "--out", job]), 0);
    assert!(!fs::read_to_string(job).unwrap().contains("confirmed-"));
    said(&line.command("teach", &["--from-history", "--out", job]), 64);
    // The recording itself is a run: the one piece in it, and not what was seen before and after.
    let recording = clip.lines().next().unwrap();
    let taught = said(&line.command("teach", &["--add", recording, "--force", "--out", job]), 0);
    assert!(taught.contains("written: "), "{taught}");

    let other = said(&line.command("forget", &["--part", "SN-8"]), 0);
    assert!(other.contains("no recording is of part \"SN-8\""), "{other}");
    let removed = said(&line.command("forget", &["--before", "2199-01-01T00:00:00Z"]), 0);
    assert!(removed.contains("removed: "), "{removed}");
    assert!(line.recordings().is_empty());
    assert_eq!(fs::read_dir(line.path("recordings")).unwrap().count(), 0, "nor anything beside them");
    let deeds = said(&line.command("history", &["--audit"]), 0);
    assert!(deeds.contains("1 recordings to be removed: from before 2199-01-01T00:00:00Z"), "{deeds}");
    assert!(!said(&line.command("history", &[]), 0).contains("clip "));
    assert_eq!(said(&line.command("history", &["--sql", &question]), 0), "clip\r\n\r\n");
}

/// What `whatif` says of everything that was recorded, with the two numbers of each row.
fn whatif(line: &Line, job: &Path) -> (String, Vec<[u32; 2]>) {
    let output = line.command("whatif", &["--job", job.to_str().unwrap()]);
    let text = all_output(&output);
    assert!(output.status.code().is_some_and(|code| code < 3), "{text}");
    let numbers = |row: &str| {
        let mut words = row.split_whitespace().rev().map(str::parse);
        let (is, was) = (words.next()?.ok()?, words.next()?.ok()?);
        Some([was, is])
    };
    let rows = text.lines().filter_map(numbers).collect();
    (text, rows)
}

/// A line whose recorder begins another file every few seconds, with the work on a part in the midst of that.
fn in_several_files() -> (Line, Watcher) {
    let mut line = Line::with_film("speed = \"file\"", "", &["-i", "p1_order_r1.mp4"]);
    line.record("always");
    line.reconfigure("[record]\n", "[record]\nfile_mb = 4\nmemory_mb = 4\n");
    let mut watcher = up(&mut line, &[]);
    watcher.until("the judge", |watcher| watcher.judging.is_some());
    said(&line.command("part", &["SN-7"]), 0);
    line.start("capture");
    let is_job = |level: u8| level == VerdictLevel::Job.code();
    watcher.until("a piece", |watcher| watcher.verdicts.iter().any(|verdict| is_job(verdict.level)));
    said(&line.command("part", &["SN-8"]), 0);
    let seen = watcher.verdicts.len();
    watcher.until("the next one", |watcher| watcher.verdicts.len() > seen);
    // What follows the piece by less than two seconds shows it as well. A file holds more than that, so the second from now on does not.
    let files = || line.recordings().len();
    let enough = (files() + 2).max(3);
    watcher.until("several files", |_| files() >= enough);
    (line, watcher)
}

#[test]
fn work_that_is_recorded_in_several_files_is_one_for_whatif_and_each_says_what_its_replay_is_worth() {
    let (mut line, watcher) = in_several_files();
    stop(&mut line, watcher);
    let found = store::recordings(&line.path("recordings")).unwrap();
    assert!(found.len() >= 3, "{} files", found.len());

    let replayed = |path: &Path| all_output(&line.command("replay", &[path.to_str().unwrap()]));
    let first = replayed(&found[0].path);
    assert!(!first.contains("differs") && !first.contains("in the middle"), "{first}");
    let with_verdicts = found[1..].iter().filter(|recording| !recording.index.verdicts.is_empty());
    let mut later = 0;
    for recording in with_verdicts {
        let text = replayed(&recording.path);
        assert!(text.contains("begins in the middle"), "{text}");
        let says_from_when =
            ["on are equal", "they differ up to the end"].iter().any(|words| text.contains(words));
        assert!(!text.contains("differs") || says_from_when, "{text}");
        later += 1;
    }
    assert!(later > 0);

    // The job that was in force says what was said. So it does of one file that has lost the others.
    let job = root().join("config/jobs/polish-and-measure.toml");
    let (text, rows) = whatif(&line, &job);
    assert!(rows.len() >= 3 && rows.iter().all(|[was, is]| was == is), "{text}");
    assert!(rows[1] >= [1, 1] && !text.contains("->") && !text.contains("left out"), "{text}");
    // What two recordings show is counted once, as where a clip repeats what the one before it ends with.
    let again = line.path("recordings").join("99999999-20000101T000000.000Z.mcap");
    fs::copy(&found[0].path, &again).unwrap();
    assert_eq!(whatif(&line, &job), (text, rows));
    fs::remove_file(&again).unwrap();
    fs::remove_file(&found[1].path).unwrap();
    fs::write(line.path("recordings").join("00000000-20000101T000000.000Z.mcap"), "no recording at all")
        .unwrap();
    let (text, rows) = whatif(&line, &job);
    assert!(rows.iter().all(|[was, is]| was == is) && !text.contains("->"), "{text}");
    assert!(text.contains("1 recordings were left out:") && text.contains("this is no MCAP file"), "{text}");

    let csv = said(&line.command("history", &["--csv"]), 0);
    let shown = csv.lines().filter(|row| row.contains(".mcap,")).count();
    assert!(csv.lines().next().unwrap().ends_with(",clip,part") && shown > 0, "{csv}");
}

#[test]
fn a_part_is_forgotten_in_every_file_that_shows_it_and_not_in_the_one_that_is_written() {
    let (mut line, watcher) = in_several_files();
    let before = store::recordings(&line.path("recordings")).unwrap();
    let written = before.last().unwrap().path.clone();
    // For the second half, with the one that is being written, which is whole by then.
    let saved = line.path("saved");
    fs::create_dir(&saved).unwrap();
    let is_whole = |path: &Path| stem(path).starts_with('0') && stem(path) < stem(&written);
    copy_files(&line.path("recordings"), &saved, is_whole);
    let orphan = line.path("recordings").join("00000000-20000101T000000.000Z.json");
    fs::write(&orphan, "{\"part\":\"SN-7\"}").unwrap();
    let far = "2199-01-01T00:00:00Z";
    let text = said(&line.command("forget", &["--before", far]), 1);
    assert!(text.contains("NOT removed: ") && text.contains("is being written"), "{text}");
    assert!(!orphan.exists());
    let left = store::recordings(&line.path("recordings")).unwrap();
    // Its recorder may have begun another one meanwhile.
    assert!(left.iter().any(|recording| recording.path >= written), "{text}");
    assert!(left.len() < before.len() && left.iter().all(|recording| recording.path >= written), "{text}");
    stop(&mut line, watcher);
    let whole = store::recordings(&line.path("recordings")).unwrap();
    for recording in &whole {
        let reader = andon_record::RecordingReader::open(&recording.path);
        assert!(reader.is_ok(), "what was being written is whole");
    }

    copy_files(&saved, &line.path("recordings"), |_| true);
    let before = store::recordings(&line.path("recordings")).unwrap();
    let names =
        |recording: &store::Recording| recording.index.verdicts.iter().any(|verdict| verdict.part == "SN-7");
    let (first, last) = (before.iter().position(names).unwrap(), before.iter().rposition(names).unwrap());
    said(&line.command("forget", &["--part", "SN-7"]), 0);
    let deeds = said(&line.command("history", &["--audit"]), 0);
    assert!(deeds.contains("recordings to be removed: of part \"SN-7\""), "{deeds}");
    let left: Vec<PathBuf> = store::recordings(&line.path("recordings"))
        .unwrap()
        .into_iter()
        .map(|recording| recording.path)
        .collect();
    for recording in &before[..=last] {
        // The work on it began with the first picture: nothing of it is left, verdict or not.
        assert!(!left.contains(&recording.path), "{first}..={last}: {left:?}");
    }
    assert!(!left.is_empty(), "the work on the next part is not forgotten");
    said(&line.command("forget", &["--before", far]), 0);
    assert_eq!(fs::read_dir(line.path("recordings")).unwrap().count(), 0);
}

/// What the names of a recording and of what lies beside it have in common.
fn stem(path: &Path) -> String {
    let name = path.file_name().unwrap().to_str().unwrap();
    name.split('Z').next().unwrap().to_owned()
}

/// Copies the files of a folder that are wanted.
fn copy_files(from: &Path, to: &Path, is_wanted: impl Fn(&Path) -> bool) {
    for path in fs::read_dir(from).unwrap().map(|entry| entry.unwrap().path()).filter(|path| is_wanted(path))
    {
        fs::copy(&path, to.join(path.file_name().unwrap())).unwrap();
    }
}

#[test]
fn look_shows_nothing_of_the_bench_that_a_recording_would_not() {
    let line = Line::with_film("speed = \"max\"", "", &["-i", "p1_none_r1.mp4", "-t", "1"]);
    line.reconfigure("loop = true", "loop = false");
    line.reconfigure(
        "[journal]",
        "[record]\nsize = [640, 480]\nmasks = [[[0, 0], [400, 0], [400, 479], [0, 479]]]\n\n[journal]",
    );
    let [plain, drawn] = ["plain.png", "drawn.png"].map(|name| line.path(name));
    let arguments = ["--save", plain.to_str().unwrap(), "--annotated", drawn.to_str().unwrap()];
    said(&line.command("look", &arguments), 0);
    let brightest = |path: &Path, columns: std::ops::Range<usize>| {
        let mut reader = Command::new("ffmpeg");
        let to_pixels = ["-f", "rawvideo", "-pix_fmt", "bgr24", "-"];
        let pixels = reader.args(["-v", "error", "-i"]).arg(path).args(to_pixels).output().unwrap().stdout;
        assert_eq!(pixels.len(), 3 * 640 * 480);
        let rows = pixels.chunks_exact(3 * 640);
        rows.flat_map(|row| row[3 * columns.start..3 * columns.end].iter().copied()).max().unwrap()
    };
    assert_eq!(brightest(&plain, 0..400), 0);
    assert!(brightest(&plain, 410..640) > 100 && brightest(&drawn, 410..640) > 100);
    // A film that somebody names is theirs.
    let film = line.path("film.mkv");
    said(&line.command("look", &[film.to_str().unwrap(), "--save", plain.to_str().unwrap()]), 0);
    assert!(brightest(&plain, 0..400) > 100);
}

#[test]
fn a_fault_in_a_film_becomes_a_clip_with_a_still_that_our_tools_and_those_of_others_open() {
    let mut line = Line::with_film("speed = \"max\"", "", &["-i", "p1_J1_r1.mp4"]);
    line.record("fault");
    let mut watcher = up(&mut line, &["capture"]);
    let is_fault = |level: u8, outcome: u8| {
        outcome == VerdictOutcome::Anomaly.code() && level != VerdictLevel::Job.code()
    };
    watcher.until("a fault", |watcher| {
        watcher.verdicts.iter().any(|verdict| is_fault(verdict.level, verdict.outcome))
    });
    line.wait_for_log("record", "AND-410", "");
    let seen = watcher.verdicts.len();
    watcher.until("what comes after it", |watcher| watcher.verdicts.len() > seen);
    stop(&mut line, watcher);

    let history = said(&line.command("history", &[]), 0);
    let row = clip_of(&history, "ANOMALY");
    let film = line.path("fault.mp4");
    let text = said(&line.command("clip", &[&row, "--annotate", film.to_str().unwrap()]), 0);
    assert!(film.metadata().unwrap().len() > 10_000, "{text}");
    let still =
        text.lines().find(|path| path.ends_with(".jpg")).unwrap_or_else(|| panic!("no still:\n{text}"));
    let still = picture::decode(&fs::read(still).unwrap()).unwrap();
    assert!(still.width == 640 && still.height > 480, "{} x {}", still.width, still.height);

    let clip = text.lines().find(|path| path.ends_with(".mcap")).unwrap();
    let shown = ["/camera", "/log", "/distance_over_threshold", "/measure"];
    let mut viewers = Command::new(python());
    viewers.arg(root().join("tests/viewers.py")).arg(clip).arg("--expect").args(shown);
    let found = said(&viewers.output().unwrap(), 0);
    let (_, pictures) = found.split_once(" messages, ").unwrap();
    let pictures: u32 = pictures.split(' ').next().unwrap().parse().unwrap();
    assert!(pictures > 30, "{found}");
    // A film of what was detected is as good a source for `teach` and `replay` as any other.
    let job = root().join("config/jobs/polish-and-measure.toml");
    let again = line.command("replay", &["--job", job.to_str().unwrap(), clip]);
    assert!(again.status.code().is_some_and(|code| code < 3), "{}", all_output(&again));
}
