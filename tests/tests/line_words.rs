//! What a technician reads of a station that has run, word for word.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::line::{Line, Settings, andond};
use andon_tests::simulator::Flaw;
use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Command, Output, Stdio};
use std::time::{SystemTime, UNIX_EPOCH};

fn text(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// A line whose worker has made too few strokes, and whose journal has it.
fn line_with_a_fault() -> Line {
    let mut line = Line::new(Settings { flaw: Flaw::J1, ..Settings::default() });
    let mut watcher = line.launch();
    let sent = watcher.until_judged();
    watcher.until("the journal", |watcher| {
        let journal = watcher.health(shm_schemas::RoleId::Journal);
        journal.is_some_and(|journal| journal.received == sent)
    });
    assert_eq!(line.stop(), [""; 0]);
    line
}

/// Lines without their times, whose digits are all the same.
fn without_times(text: &str) -> Vec<String> {
    let same =
        |line: &str| -> String { line.chars().map(|c| if c.is_ascii_digit() { '0' } else { c }).collect() };
    text.lines()
        .map(|line| line.get(..19).map(same).unwrap_or_default() + line.get(19..).unwrap_or(line))
        .collect()
}

#[test]
fn history_names_parts_and_steps_in_local_time_with_one_line_per_fault_a_summary_and_a_picture() {
    let line = line_with_a_fault();
    let table = text(&line.command("history", &["--nok", "--utc"]));
    let table = without_times(&table);
    assert_eq!(table[0], "decided              hand   outcome     what, and why (UTC)");
    let fault = "0000-00-00 00:00:00  right  ANOMALY     step 1 IU 2: polisher at brick: 3 strokes, shown 6";
    assert!(table[1].starts_with(fault), "{table:?}");
    assert_eq!(table[2].trim_start(), "so step 1 (polisher at brick) is wrong");
    let job = &table[3];
    assert!(
        job.contains("ANOMALY     job, for the fault at ") || job.contains("so the job is wrong"),
        "{job}"
    );

    let summary = text(&line.command("history", &["--summary", "--utc"]));
    assert!(summary.starts_with("1 piece at "), "{summary}");
    assert!(summary.contains("  wrong           1  100.0 %\n"), "{summary}");
    assert!(
        summary.contains("wrong, by fault\n       1  step 1 (polisher at brick): too few strokes\n"),
        "{summary}"
    );

    let plot = line.path("plot.svg");
    text(&line.command("history", &["--plot", plot.to_str().unwrap()]));
    let drawn = std::fs::read_to_string(plot).unwrap();
    assert!(drawn.contains("wrong, by fault: 1") && drawn.ends_with("</svg>\n"), "{drawn}");
}

#[test]
fn history_takes_a_job_by_its_name_and_refuses_one_that_is_not_there_with_those_that_are() {
    let line = line_with_a_fault();
    let job = std::fs::read(line.path("job.toml")).unwrap();
    let name = andon_learn::job_file::JobFile::parse("job.toml", &job).unwrap().name;
    let all = text(&line.command("history", &["--csv"]));
    assert_eq!(text(&line.command("history", &["--csv", "--job", &name.to_uppercase()])), all);
    let refused = line.command("history", &["--job", "no-such"]);
    assert_eq!(refused.status.code(), Some(64));
    let said = String::from_utf8_lossy(&refused.stderr);
    assert!(said.contains("no-such: no job of this name or number is in ") && said.contains(&name), "{said}");
}

#[test]
fn a_pipe_gets_no_colours_and_a_reader_that_has_seen_enough_ends_a_command_without_a_word() {
    let line = line_with_a_fault();
    let (job, tracks) = (line.path("job.toml"), line.tracks());
    let commands: [&[&str]; 4] = [
        &["replay", "--job", job.to_str().unwrap(), tracks.to_str().unwrap()],
        &["history"],
        &["config"],
        &["segment", tracks.to_str().unwrap()],
    ];
    for arguments in commands {
        let output = line.command(arguments[0], &arguments[1..]);
        assert!(!output.stdout.is_empty() && !output.stdout.contains(&0x1b), "{arguments:?}");
        let mut command = Command::new(andond());
        command.args([arguments[0], "--config"]).arg(line.config()).args(&arguments[1..]);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        // Its reader is gone before the first line.
        drop(child.stdout.take());
        let errors: Vec<String> =
            BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok).collect();
        assert_eq!(errors, [""; 0], "{arguments:?}");
        // 0 would say that all of it was right.
        assert_eq!(child.wait().unwrap().code(), Some(141), "{arguments:?}");
    }
    let listed =
        Command::new("sh").args(["-c", "\"$0\" explain | head -n 1"]).arg(andond()).output().unwrap();
    assert_eq!((text(&listed).as_str(), listed.stderr.len()), ("Camera\n", 0));
    let taught = line.path("taught.toml");
    let mut teach = Command::new(andond());
    teach.args(["teach", tracks.to_str().unwrap(), "--force", "--out", taught.to_str().unwrap()]);
    let mut child = teach.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    drop(child.stdout.take());
    child.wait().unwrap();
    assert!(taught.is_file(), "what was learned is written before it is told");
}

/// What a command shows on a terminal.
fn on_a_terminal(line: &Line, command: &str, no_color: bool) -> String {
    let command = format!("{} {command} --config {}", andond().display(), line.config().display());
    let mut terminal = Command::new("script");
    terminal.args(["-qec", &command, "/dev/null"]).env("TERM", "xterm-256color").env_remove("NO_COLOR");
    terminal.env_remove("CI").env_remove("CLICOLOR").env_remove("CLICOLOR_FORCE").stdin(Stdio::null());
    if no_color {
        terminal.env("NO_COLOR", "1");
    }
    text(&terminal.output().expect("script is part of bsdutils, which every Debian has"))
}

#[test]
fn a_terminal_gets_colours_and_none_where_no_color_is_set() {
    let line = line_with_a_fault();
    const RED: &str = "\u{1b}[31m";
    let coloured = on_a_terminal(&line, "history", false);
    assert!(
        coloured.lines().any(|row| row.contains(RED) && row.contains("3 strokes, shown 6")),
        "{coloured}"
    );
    let plain = on_a_terminal(&line, "history", true);
    assert!(plain.contains("3 strokes, shown 6") && !plain.contains("\u{1b}["), "{plain}");
}

#[test]
fn a_live_line_is_told_in_the_time_of_the_place() {
    let mut line = Line::new(Settings::live());
    let _watcher = line.up();
    let seconds = || SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_secs();
    let before = seconds();
    let mut tail = Command::new(andond());
    // Five and a half hours before UTC, wherever this machine stands.
    tail.args(["tail", "--config"]).arg(line.config()).env("TZ", "IST-5:30").stdout(Stdio::piped());
    let mut tail = tail.spawn().unwrap();
    let mut told = BufReader::new(tail.stdout.take().unwrap()).lines();
    let row = told.find_map(|row| row.ok().filter(|row| row.contains("  right  "))).unwrap();
    tail.kill().unwrap();
    tail.wait().unwrap();
    let (day, hours_minutes) = (24 * 3600, &row[..8]);
    let parts: Vec<u64> = hours_minutes.split(':').map(|part| part.parse().unwrap()).collect();
    let [hours, minutes, seconds_of_minute] = parts[..] else { unreachable!("{row}") };
    let shown = hours * 3600 + minutes * 60 + seconds_of_minute;
    let there = |utc: u64| (utc + 19_800) % day;
    let since_before = (shown + day - there(before - 60)) % day;
    assert!(since_before <= seconds() - before + 120, "{row}");
}

/// The command is stopped for longer than it is silent, as a busy machine would stop it, in the middle of a long recording.
#[test]
fn off_a_terminal_a_command_says_now_and_then_how_far_it_is() {
    const COPIES: usize = 60;
    let line = Line::new(Settings::default());
    let recording = std::fs::read_to_string(line.tracks()).unwrap();
    let (header, frames) = recording.split_once('\n').unwrap();
    let frames: Vec<serde_json::Value> =
        frames.lines().map(|frame| serde_json::from_str(frame).unwrap()).collect();
    let slow = line.path("slow.tracks.jsonl");
    let mut file = std::io::BufWriter::new(std::fs::File::create(&slow).unwrap());
    writeln!(file, "{header}").unwrap();
    for (number, frame) in frames.iter().cycle().take(COPIES * frames.len()).enumerate() {
        let mut frame = frame.clone();
        frame["t"] = serde_json::json!(number as f64 / 30.0);
        writeln!(file, "{frame}").unwrap();
    }
    drop(file);
    let mut command = Command::new(andond());
    command.args(["segment", "--config"]).arg(line.config()).arg(&slow);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let errors = BufReader::new(child.stderr.take().unwrap());
    let hears = std::thread::spawn(move || errors.lines().map_while(Result::ok).next());
    let has_opened = |process: u32| {
        let mut files = std::fs::read_dir(format!("/proc/{process}/fd")).unwrap().flatten();
        files
            .any(|file| std::fs::read_link(file.path()).is_ok_and(|path| path.ends_with("slow.tracks.jsonl")))
    };
    while !has_opened(child.id()) {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let signal = |name: &str| Command::new("kill").args([name, &child.id().to_string()]).status().unwrap();
    std::thread::sleep(std::time::Duration::from_millis(100));
    signal("-STOP");
    std::thread::sleep(std::time::Duration::from_millis(5500));
    signal("-CONT");
    let heard = hears.join().unwrap();
    assert!(child.wait().unwrap().success());
    let row = heard.unwrap();
    assert!(row.starts_with("slow.tracks.jsonl: ") && row.ends_with(" frames"), "{row}");
}
