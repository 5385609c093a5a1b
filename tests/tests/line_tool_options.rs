//! Every option of a command does what the help says, and every command that gives a verdict ends with its exit code.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_learn::job_file::JobFile;
use andon_learn::recording::{read, write};
use andon_study::analysis::draw_order;
use andon_tests::line::{Line, Settings, andond};
use andon_tests::simulator::{Flaw, Noise, Performance, perform};
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
fn teach_writes_the_number_and_the_name_that_it_was_given_and_keeps_them() {
    let line = Line::new(Settings::default());
    let job = taught(&line, &[]);
    // That of the station, which lies beside it, has the number 1.
    assert!(job.contains("\nid = 2\n") && job.contains("\nname = \"taught\"\n"), "{job}");
    let job = taught(&line, &["--id", "7", "--name", "seven"]);
    assert!(job.contains("\nid = 7\n") && job.contains("\nname = \"seven\"\n"), "{job}");
    let job = taught(&line, &[]);
    assert!(job.contains("\nid = 7\n") && job.contains("\nname = \"seven\"\n"), "{job}");
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

/// A folder with the recordings of four people, and the program that is asked to teach in it.
struct Folder {
    line: Line,
    path: PathBuf,
    runs: Vec<PathBuf>,
}

impl Folder {
    fn new() -> Self {
        let line = Line::new(Settings::default());
        let path = line.path("teach");
        std::fs::create_dir_all(path.join("away")).unwrap();
        let record = |person: u64| {
            let performance = Performance { seed: 2003, person, repetition: 1, noise: Noise::default() };
            let (recording, _) = perform(&performance, Flaw::None);
            let run = path.join(format!("run{person}.tracks.jsonl"));
            let mut file = std::fs::File::create(&run).unwrap();
            write(&mut file, &recording.header, &recording.frames).unwrap();
            run
        };
        let runs = (1..=4).map(record).collect();
        Self { line, path, runs }
    }

    /// What `teach` says to these arguments and with which exit code it ends.
    fn teach(&self, job: &str, arguments: &[&str]) -> (Option<i32>, String) {
        let mut command = Command::new(andond());
        command.arg("teach").args(arguments).args(["--name", "job", "--id", "1", "--out", job, "--config"]);
        command.arg(self.line.config()).current_dir(&self.path);
        let output = command.output().unwrap();
        let said = [output.stdout, output.stderr].concat();
        (output.status.code(), String::from_utf8(said).unwrap())
    }

    #[track_caller]
    fn taught(&self, job: &str, arguments: &[&str]) -> String {
        let (code, said) = self.teach(job, arguments);
        assert_eq!(code, Some(0), "{said}");
        std::fs::read_to_string(self.path.join(job)).unwrap()
    }

    #[track_caller]
    fn refused(&self, job: &str, arguments: &[&str], words: &[&str]) {
        let before = std::fs::read(self.path.join(job)).unwrap();
        let (code, said) = self.teach(job, arguments);
        assert_eq!(code, Some(64), "{said}");
        assert!(words.iter().all(|word| said.contains(word)), "{words:?} in {said}");
        assert_eq!(std::fs::read(self.path.join(job)).unwrap(), before);
    }

    fn run(&self, number: usize) -> &str {
        text(&self.runs[number - 1])
    }
}

#[test]
fn the_same_recordings_teach_the_same_job_whichever_way_they_came_to_it() {
    let folder = Folder::new();
    let [one, two, three, four] = [1, 2, 3, 4].map(|number| folder.run(number));
    let at_once = folder.taught("at_once.toml", &[one, two, three, "--strictness", "4", "--order", "true"]);
    folder.taught("grown.toml", &[three, one, "--strictness", "4", "--order", "true"]);
    assert_eq!(folder.taught("grown.toml", &["--add", two]), at_once);
    folder.taught("shrunk.toml", &[four, three, two, one, "--strictness", "4", "--order", "true"]);
    assert_eq!(folder.taught("shrunk.toml", &["--without", "run4.tracks.jsonl"]), at_once);
    let exchanged = folder.taught("grown.toml", &["--add", four, "--without", "run2.tracks.jsonl"]);
    assert!(exchanged.contains("run4") && !exchanged.contains("run2"), "{exchanged}");
}

#[test]
fn track_files_need_no_station_and_films_do() {
    let folder = Folder::new();
    let andond = |arguments: &[&str]| {
        let mut command = Command::new(andond());
        command.args(arguments).current_dir(&folder.path).env_remove("ANDON_CONFIG").output().unwrap()
    };
    let job = folder.path.join("job.toml");
    let runs = [1, 2, 3].map(|number| folder.run(number));
    stdout(&andond(&[&["teach", "--force", "--out", text(&job)], &runs[..]].concat()));
    for command in [&["replay", "--job", text(&job)][..], &["segment"]] {
        let said = stdout(&andond(&[command, &[folder.run(4)]].concat()));
        assert!(said.contains("brick"), "{said}");
    }
    let film = andond(&["teach", "--out", "none.toml", "film.mp4"]);
    let said = String::from_utf8_lossy(&film.stderr);
    assert!(film.status.code() == Some(78) && said.contains("only track files need none"), "{said}");
}

#[test]
fn a_recording_that_is_added_twice_is_noticed() {
    let folder = Folder::new();
    folder.taught("job.toml", &[folder.run(1), folder.run(2)]);
    let (code, said) = folder.teach("job.toml", &["--add", folder.run(2)]);
    assert_eq!(code, Some(1), "{said}");
    assert!(
        said.contains("run2.tracks.jsonl repeats an earlier run") && said.contains("\nnot written: "),
        "{said}"
    );
}

#[test]
fn a_recording_that_is_not_found_again_is_told_with_where_it_was_looked_for() {
    let folder = Folder::new();
    folder.taught("job.toml", &[folder.run(1), folder.run(2)]);
    let moved = folder.path.join("away/run1.tracks.jsonl");
    std::fs::rename(folder.run(1), &moved).unwrap();
    let add = ["--add", folder.run(3)];
    folder.refused("job.toml", &add, &["taught from run1.tracks.jsonl, not found in ", "--without"]);
    let given = folder.taught("job.toml", &[text(&moved), add[0], add[1]]);
    assert!(given.contains("run1") && given.contains("run3"), "{given}");
}

#[test]
fn a_recording_that_has_changed_is_not_taken_for_the_one_that_was_taught() {
    let folder = Folder::new();
    folder.taught("job.toml", &[folder.run(1), folder.run(2)]);
    std::fs::copy(folder.run(3), folder.run(1)).unwrap();
    let words =
        ["is not the run1.tracks.jsonl that job job.toml was taught from", "--without run1.tracks.jsonl"];
    folder.refused("job.toml", &["--add", folder.run(4)], &words);
}

#[test]
fn only_recordings_of_the_job_are_left_out_or_given_again() {
    let folder = Folder::new();
    folder.taught("job.toml", &[folder.run(1), folder.run(2)]);
    let words = [
        "--without run9: job job.toml was not taught from it, but from run1.tracks.jsonl, run2.tracks.jsonl",
    ];
    folder.refused("job.toml", &["--without", "run9"], &words);
    let words = ["job job.toml was not taught from ", "--add "];
    folder.refused("job.toml", &[folder.run(3), "--add", folder.run(4)], &words);
    let nothing = folder.teach("none.toml", &["--add", folder.run(1)]);
    assert!(nothing.1.contains("none.toml") && nothing.0 == Some(78), "{nothing:?}");
}

#[test]
fn teach_draws_the_steps_and_their_order() {
    let folder = Folder::new();
    folder.taught("job.toml", &[folder.run(1), folder.run(2), folder.run(3), "--plot", "order.svg"]);
    let drawn = std::fs::read_to_string(folder.path.join("order.svg")).unwrap();
    for words in
        ["1. polisher at brick", "2. brick at meter", "required", "right hand", "marker-end=\"url(#law)\""]
    {
        assert!(drawn.contains(words), "{words}: {drawn}");
    }
    assert!(drawn.contains("Each run judged by what the others teach: 0 of 3 rejected (0 %)"), "{drawn}");
}

#[test]
fn strictness_is_a_number_from_1_to_5() {
    let folder = Folder::new();
    for (number, code) in [("0", Some(64)), ("6", Some(64)), ("5", Some(0))] {
        let (found, said) = folder.teach("job.toml", &[folder.run(1), folder.run(2), "--strictness", number]);
        assert_eq!(found, code, "{said}");
    }
}

#[test]
fn replay_says_how_many_strokes_there_were_and_how_many_were_shown() {
    let line = Line::new(Settings { flaw: Flaw::J1, ..Settings::default() });
    let job = line.path("job.toml");
    let output = line.command("replay", &["--job", text(&job), text(&line.tracks())]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains(" ANOMALY     step 1 IU 2: polisher at brick: 3 strokes, shown 6"), "{said}");
    let job = said.lines().find(|line| line.contains(" ANOMALY     job")).unwrap();
    assert!(job.contains("job, for the fault at ") && job.contains(": 3 strokes, shown 6"), "{said}");
    assert!(
        said.contains("\n                                so step 1 (polisher at brick) is wrong\n"),
        "{said}"
    );
}

#[test]
fn replay_shows_beneath_an_accusation_where_the_run_lies_among_those_shown_and_so_does_its_json() {
    let line = Line::new(Settings { flaw: Flaw::J1, ..Settings::default() });
    let (job, tracks) = (line.path("job.toml"), line.tracks());
    let replay = |options: &[&str]| {
        let output = line.command("replay", &[options, &["--job", text(&job), text(&tracks)]].concat());
        String::from_utf8(output.stdout).unwrap()
    };
    let said = replay(&[]);
    let rows: Vec<&str> = said.lines().skip_while(|row| !row.contains("3 strokes, shown 6")).collect();
    assert!(rows[1].starts_with("           strokes: 3 --X---"), "{said}");
    assert!(rows[1].contains("; less than all 6 shown; right is "), "{said}");
    assert!(rows[2].starts_with("           (X is this run, "), "{said}");
    assert_eq!((said.matches("strokes: ").count(), said.matches("(X is ").count()), (1, 1), "{said}");
    assert!(said.is_ascii(), "{said}");
    let lines = replay(&["--json"]);
    let lines = lines.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
    let distributions: Vec<_> = lines.filter_map(|line| line.get("distribution").cloned()).collect();
    let [of] = &distributions[..] else { panic!("{distributions:?}") };
    assert_eq!(
        (&of["measure"], &of["unit"], &of["value"]),
        (&"Strokes".into(), &"strokes".into(), &3.0.into())
    );
    assert_eq!((&of["runs"], &of["place"]), (&6.into(), &"less than all 6 shown".into()), "{of}");
    assert_eq!(of["shown"].as_array().unwrap().len(), 6, "{of}");
    assert!(of["right"][0].as_f64().unwrap() > 3.0, "{of}");
}

/// The worker has not come to the end there: without the cut this would be an anomaly.
#[test]
fn a_track_file_that_was_cut_is_judged_up_to_there_and_not_at_its_end() {
    let line = Line::new(Settings::default());
    let (job, whole) = (line.path("job.toml"), std::fs::read(line.tracks()).unwrap());
    let whole_said = line.command("replay", &["--job", text(&job), text(&line.tracks())]);
    let whole_said = String::from_utf8(whole_said.stdout).unwrap();
    let cut = line.path("cut.tracks.jsonl");
    for tenths in 4..10 {
        std::fs::write(&cut, &whole[..whole.len() * tenths / 10 - 7]).unwrap();
        let output = line.command("replay", &["--job", text(&job), text(&cut)]);
        let said = String::from_utf8(output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(64), "{said}");
        assert!(whole_said.starts_with(&said), "{tenths} tenths: {said}");
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(errors.contains("cut.tracks.jsonl, line ") && errors.contains("copy it again"), "{errors}");
    }
    let taught = line.command("teach", &["--force", "--out", text(&line.path("new.toml")), text(&cut)]);
    assert_eq!(taught.status.code(), Some(64), "a run that is cut teaches nothing");
}

#[test]
fn segment_draws_its_plot() {
    let line = Line::new(Settings::default());
    let plot = line.path("plot.svg");
    let events = stdout(&line.command("segment", &[text(&line.tracks()), "--plot", text(&plot)]));
    assert!(events.contains("activity"), "{events}");
    let drawn = std::fs::read_to_string(plot).unwrap();
    assert!(drawn.starts_with("<svg") && drawn.contains("right hand") && drawn.ends_with("</svg>\n"));
    // What was seen of each part, and what the colours say.
    for words in ["what was seen", "polisher: seen", "legend", "no hand was seen to move it"] {
        assert!(drawn.contains(words), "{words}: {drawn}");
    }
}

#[test]
fn a_pair_that_is_not_counted_is_named_by_segment_and_in_the_picture_of_the_job() {
    let line = Line::new(Settings::default());
    let path = line.path("job.toml");
    let mut job = JobFile::parse("job.toml", &std::fs::read(&path).unwrap()).unwrap();
    let (one, other) = (job.objects[0].name.clone(), job.objects[1].clone());
    job.objects[0].shape.incidental.push(other.shape.id).unwrap();
    std::fs::write(&path, job.to_toml()).unwrap();
    let segmented = line.command("segment", &["--job", text(&path), text(&line.tracks())]);
    let said = String::from_utf8(segmented.stderr).unwrap();
    let pair = format!("{one} and {}", other.name);
    assert!(said.contains(&format!("not counted: {pair} come near each other by chance only")), "{said}");
    let drawn = draw_order(&job, None);
    assert!(drawn.contains(&format!("Near each other by chance only, so not counted: {pair}")), "{drawn}");
}

/// How `replay` ends on the line's recording.
fn replayed(line: &Line) -> Option<i32> {
    line.command("replay", &["--job", text(&line.path("job.toml")), text(&line.tracks())]).status.code()
}

#[test]
fn replay_ends_with_0_for_a_correct_job_1_for_an_anomaly_and_2_for_what_could_not_be_judged() {
    assert_eq!(replayed(&Line::new(Settings::default())), Some(0));
    assert_eq!(replayed(&Line::new(Settings { flaw: Flaw::J1, ..Settings::default() })), Some(1));
    let nothing_seen = Line::new(Settings::default());
    nothing_seen.edit_tracks(|frames| frames.iter_mut().for_each(|frame| frame.hands.clear()));
    assert_eq!(replayed(&nothing_seen), Some(2));
}

#[test]
fn what_a_recording_never_shows_is_named_and_not_judged() {
    let line = Line::new(Settings::default());
    let mut recording = read("work", &std::fs::read(line.tracks()).unwrap()).unwrap();
    let hidden = recording.header.objects.pop().unwrap();
    for frame in &mut recording.frames {
        frame.objects.retain(|object| object.id != hidden.shape.id);
    }
    let path = line.path("hidden.tracks.jsonl");
    write(&mut std::fs::File::create(&path).unwrap(), &recording.header, &recording.frames).unwrap();
    let job = line.path("job.toml");
    let replay = Command::new(andond()).args(["replay", "--job", text(&job), text(&path)]).output().unwrap();
    let said = String::from_utf8(replay.stderr).unwrap();
    assert!(
        said.contains(&format!("never shows the {} (object {})", hidden.name, hidden.shape.id)),
        "{said}"
    );
    assert_eq!(replay.status.code(), Some(2), "{}", String::from_utf8_lossy(&replay.stdout));
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
