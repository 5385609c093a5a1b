//! What a process engineer meets between the first recording and the job: each message says what is and what to do.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_learn::job_file::JobFile;
use andon_learn::recording::{Header, read, write};
use andon_tests::line::{Line, Settings, andond};
use andon_tests::simulator::{Flaw, Noise, Performance, perform};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// A folder with recordings of some people.
struct Desk {
    folder: TempDir,
}

impl Desk {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// A recording under this name.
    fn record(&self, name: &str, person: u64, flaw: Flaw) -> String {
        let performance = Performance { seed: 2003, person, repetition: 1, noise: Noise::default() };
        let (recording, _) = perform(&performance, flaw);
        let mut file = std::fs::File::create(self.path(name)).unwrap();
        write(&mut file, &recording.header, &recording.frames).unwrap();
        name.to_owned()
    }

    fn runs(&self) -> Vec<String> {
        (1..=5).map(|person| self.record(&format!("run{person}.tracks.jsonl"), person, Flaw::None)).collect()
    }

    fn andond(&self, arguments: &[&str]) -> Output {
        let mut command = Command::new(andond());
        command.args(arguments).current_dir(self.folder.path()).env_remove("ANDON_CONFIG");
        command.output().unwrap()
    }

    /// Teaches a job from these recordings, with these options.
    fn teach(&self, runs: &[String], options: &[&str]) -> (Option<i32>, String) {
        let runs: Vec<&str> = runs.iter().map(String::as_str).collect();
        let output = self.andond(&[&["teach"], &runs[..], options].concat());
        (output.status.code(), said(&output))
    }

    fn job(&self, name: &str) -> JobFile {
        JobFile::parse(name, &std::fs::read(self.path(name)).unwrap()).unwrap()
    }
}

fn said(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// A station with the objects of a recording, whose own film is not there.
fn station(header: &Header, method: &str) -> String {
    let mut text = format!(
        "[station]\nname = \"copied\"\n[camera]\nsource = \"video\"\npath = \"not-there.mp4\"\n[method]\n{method}\n"
    );
    for object in &header.objects {
        let points: Vec<[f32; 3]> = object.shape.interaction_points.iter().copied().collect();
        text += &format!(
            "[[objects]]\nid = {}\nname = {:?}\nmarker_side_m = 0.03\ninteraction_points = {points:?}\n",
            object.shape.id, object.name
        );
    }
    text
}

fn header(desk: &Desk, name: &str) -> Header {
    read(name, &std::fs::read(desk.path(name)).unwrap()).unwrap().header
}

#[test]
fn a_station_whose_own_film_is_not_there_teaches_and_judges_other_recordings() {
    let desk = Desk::new();
    let runs = desk.runs();
    std::fs::write(desk.path("station.toml"), station(&header(&desk, &runs[0]), "")).unwrap();
    let options = ["--config", "station.toml", "--out", "job.toml"];
    assert_eq!(desk.teach(&runs, &options).0, Some(0));
    let replay = desk.andond(&["replay", "--config", "station.toml", "--job", "job.toml", &runs[0]]);
    assert_eq!(replay.status.code(), Some(0), "{}", said(&replay));
    let check = desk.andond(&["check", "--config", "station.toml"]);
    assert!(said(&check).contains("not-there.mp4 cannot be opened"), "{}", said(&check));
}

#[test]
fn a_part_that_no_run_shows_is_named_although_the_rest_is_learned() {
    let desk = Desk::new();
    let runs = desk.runs();
    let unseen = header(&desk, &runs[0]).objects[0].clone();
    for name in &runs {
        let mut recording = read(name, &std::fs::read(desk.path(name)).unwrap()).unwrap();
        for frame in &mut recording.frames {
            frame.objects.retain(|object| object.id != unseen.shape.id);
        }
        let mut file = std::fs::File::create(desk.path(name)).unwrap();
        write(&mut file, &recording.header, &recording.frames).unwrap();
    }
    let (_, words) = desk.teach(&runs, &["--out", "job.toml"]);
    let named = format!(
        "marker {} ({}) is in no frame of the {} recordings",
        unseen.shape.id,
        unseen.name,
        runs.len()
    );
    assert!(words.contains(&named), "{words}");
}

#[test]
fn nothing_is_overwritten_and_every_job_has_a_number_of_its_own() {
    let desk = Desk::new();
    let runs = desk.runs();
    for (name, id) in [("one.toml", 1), ("two.toml", 2)] {
        let (code, said) = desk.teach(&runs, &["--out", name]);
        assert!(code == Some(0) && said.contains(&format!("written: {name}, job {id} ")), "{said}");
        assert_eq!(desk.job(name).id, id);
    }
    let before = std::fs::read(desk.path("two.toml")).unwrap();
    let (code, said) = desk.teach(&runs[..2], &["--out", "two.toml"]);
    let refused = "two.toml: it exists already; name another file, or replace it with --force\n";
    assert_eq!((code, said.as_str()), (Some(64), refused));
    assert_eq!(std::fs::read(desk.path("two.toml")).unwrap(), before);
    assert_eq!(desk.teach(&runs[..3], &["--out", "two.toml", "--force"]).0, Some(0));
    assert_eq!(desk.job("two.toml").id, 2, "a job that is taught again keeps its number");
    let (_, said) = desk.teach(&runs, &["--out", "three.toml", "--id", "1"]);
    assert!(said.contains("note: ./one.toml has the number 1 as well"), "{said}");
    std::fs::write(desk.path("page.html"), "mine").unwrap();
    assert_eq!(desk.teach(&runs, &["--out", "four.toml", "--report", "page.html"]).0, Some(64));
    for command in [&["tracks", "film.mp4"][..], &["record"]] {
        std::fs::write(desk.path("station.toml"), station(&header(&desk, &runs[0]), "")).unwrap();
        let arguments = [command, &["--config", "station.toml", "--out", &runs[0]]].concat();
        let output = desk.andond(&arguments);
        assert!(!output.status.success(), "{}", said.len());
        assert!(header(&desk, &runs[0]).rate_hz > 0.0, "it is still what it was");
    }
}

#[test]
fn the_report_is_one_sentence_then_a_table_with_a_legend_and_a_page() {
    let desk = Desk::new();
    let runs = desk.runs();
    let (code, said) = desk.teach(&runs, &["--out", "job.toml", "--report", "page.html"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.starts_with("usable, because the 5 runs agree in all their steps"), "{said}");
    for words in [
        "\nstep  IU  shown  seconds ",
        "\n  shown: number of demonstrations\n",
        "\n  threshold: the maximum ",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let page = std::fs::read_to_string(desk.path("page.html")).unwrap();
    for words in [
        "<h1>Job 1 “job”</h1><div class=\"say\"><div>usable, because",
        "<svg",
        "How to read it",
        "<li>polisher at brick<ul>",
        "run5.tracks.jsonl",
    ] {
        assert!(page.contains(words), "{words}: {page}");
    }
    assert!(!page.contains("How to read a strip"), "{page}");
    // Where half of the strokes lie among those of the others.
    let half = desk.record("half.tracks.jsonl", 6, Flaw::J1);
    let (code, said) =
        desk.teach(&[&runs[..], &[half]].concat(), &["--out", "not.toml", "--report", "half.html"]);
    assert_eq!(code, Some(1), "{said}");
    let page = std::fs::read_to_string(desk.path("half.html")).unwrap();
    for words in [
        "<title>strokes: 3",
        "<figcaption>strokes: less than all 5 shown; right is 3.5 to ",
        "<figcaption>half.tracks.jsonl, strokes: less than all 5 shown; right is ",
        "How to read a strip: a tick is a run",
    ] {
        assert!(page.contains(words), "{words}: {page}");
    }
    // What one run cannot show is said once, whatever the number of its IUs.
    let (_, said) = desk.teach(&runs[..2], &["--out", "two.toml"]);
    assert_eq!(said.matches("show 3 more\n").count(), 1, "{said}");
    let job = std::fs::read_to_string(desk.path("job.toml")).unwrap();
    assert!(!job.contains("4294967295") && job.contains("\"unbounded\""), "{job}");
}

#[test]
fn recordings_of_any_name_are_compared_by_a_pattern_or_a_table() {
    let desk = Desk::new();
    std::fs::create_dir(desk.path("films")).unwrap();
    let mut table = String::from("file,person,what\n");
    for (number, (person, flaw, what)) in
        [(1, Flaw::None, "none"), (2, Flaw::None, "none"), (3, Flaw::None, "none"), (1, Flaw::J1, "J1")]
            .into_iter()
            .enumerate()
    {
        desk.record(&format!("films/worker {person} - {what}.tracks.jsonl"), person, flaw);
        table += &format!("worker {person} - {what}.tracks.jsonl,name{person},{what}\n");
        assert!(number < 4);
    }
    std::fs::write(desk.path("films/runs.csv"), table).unwrap();
    let plain = desk.andond(&["analyze", "films", "--out", "report"]);
    assert_eq!(plain.status.code(), Some(64));
    let words = "named p<person>_<what>_r<repetition>; say with --names 'PATTERN' how they are named, or with --runs FILE who did what";
    assert!(said(&plain).contains(words), "{}", said(&plain));
    for options in [["--names", "worker {person} - {what}"], ["--runs", "films/runs.csv"]] {
        let output = desk.andond(&[&["analyze", "films", "--out", "report"], &options[..]].concat());
        assert!(output.status.success(), "{}", said(&output));
        assert!(desk.path("report/index.html").is_file());
        let output = desk.andond(&[&["experiment", "2", "films"], &options[..]].concat());
        assert!(output.status.success(), "{}", said(&output));
    }
    let output = desk.andond(&["analyze", "films", "--out", "report", "--runs", "films/runs.csv"]);
    assert!(said(&output).contains("person 1 is name1\n"), "{}", said(&output));
}

#[test]
fn a_job_that_does_not_fit_the_station_judges_nothing() {
    let desk = Desk::new();
    let runs = desk.runs();
    assert_eq!(desk.teach(&runs, &["--out", "job.toml"]).0, Some(0));
    let mut header = header(&desk, &runs[0]);
    let cases = [
        ("bins = 12", "it was taught with another method.bins than this station has"),
        ("", "this station has no object "),
    ];
    for (number, (method, words)) in cases.into_iter().enumerate() {
        if number == 1 {
            header.objects.pop();
        }
        std::fs::write(desk.path("station.toml"), station(&header, method)).unwrap();
        let output = desk.andond(&["replay", "--config", "station.toml", "--job", "job.toml", &runs[0]]);
        assert_eq!(output.status.code(), Some(78), "{}", said(&output));
        assert!(
            said(&output).starts_with("job job.toml: ") && said(&output).contains(words),
            "{}",
            said(&output)
        );
    }
    // Without a station a track file says itself what it shows.
    assert_eq!(desk.andond(&["replay", "--job", "job.toml", &runs[0]]).status.code(), Some(0));
}

#[test]
fn the_rate_of_a_camera_that_is_not_used_limits_no_recording() {
    let desk = Desk::new();
    let runs = desk.runs();
    std::fs::write(desk.path("station.toml"), station(&header(&desk, &runs[0]), "rate_hz = 60.0")).unwrap();
    let (code, said) = desk.teach(&runs, &["--config", "station.toml", "--out", "job.toml"]);
    assert_ne!(code, Some(78), "{said}");
    assert!(!said.contains("camera.rate_hz"), "{said}");
}

#[test]
fn a_film_becomes_a_track_file_that_is_judged_as_the_film() {
    let line = Line::new(Settings::default());
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let out = line.path("film.tracks.jsonl");
    let film = "tests/footage/p1_J1_r1.mp4";
    let run = |arguments: &[&str]| Command::new(andond()).args(arguments).current_dir(root).output().unwrap();
    let config = ["--config", "config/stations/demo.toml"];
    let output = run(&[&["tracks", film, "--out", text(&out)], &config[..]].concat());
    assert!(said(&output).starts_with("written: ") && output.status.success(), "{}", said(&output));
    let judged = |recording: &str| {
        let job = ["replay", "--job", "config/jobs/polish-and-measure.toml", recording];
        String::from_utf8(run(&[&job[..], &config].concat()).stdout).unwrap()
    };
    let verdicts = judged(text(&out));
    assert!(verdicts.contains("ANOMALY"), "{verdicts}");
    assert_eq!(verdicts, judged(film));
}

#[test]
fn shells_and_man_find_every_command() {
    let desk = Desk::new();
    assert!(desk.andond(&["man", "pages"]).status.success());
    let page = std::fs::read_to_string(desk.path("pages/andond-teach.1")).unwrap();
    assert!(page.contains("EXAMPLES") && page.contains("\\-\\-live"), "{page}");
    let page = std::fs::read_to_string(desk.path("pages/andond.1")).unwrap();
    assert!(page.contains("EXIT STATUS"));
    assert!(std::fs::read_to_string(desk.path("pages/andond-video.1")).unwrap().contains("SEE ALSO"));
    let table = said(&desk.andond(&["help", "exit-codes"]));
    assert!(table.trim_start().starts_with("Exit codes:\n    0  success"), "{table}");
    for row in table.lines().filter(|row| row.get(..5).is_some_and(|code| !code.trim().is_empty())).skip(1) {
        let code = row[..5].trim();
        assert!(page.lines().any(|line| line == format!("\\fB{code}\\fR")), "{code}: {page}");
    }
    for shell in ["bash", "zsh", "fish"] {
        let completions = said(&desk.andond(&["completions", shell]));
        assert!(completions.contains("teach") && completions.contains("strictness"), "{shell}");
    }
}
