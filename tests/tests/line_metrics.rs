//! The metrics of a running line, fetched as a monitoring system fetches them.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_ipc::{Node, Reader, Stop};
use andon_tests::line::{
    Line, Modbus, PATIENCE, Settings, Watcher, ask, measure, samples, scrape, status, tally, verdicts,
};
use andon_tests::python::{all_output, python};
use rustix::process::Signal;
use shm_schemas::{Detections, RoleId, Stamp, flag};
use std::collections::BTreeMap;
use std::io::Write;
use std::net::TcpStream;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Scrapes until the condition holds. The watcher listens meanwhile: what waits for a reader when its writer dies may be lost to it.
fn until(
    port: u16,
    watcher: &mut Watcher,
    what: &str,
    holds: impl Fn(&BTreeMap<String, f64>, &Watcher) -> bool,
) -> BTreeMap<String, f64> {
    let until = Instant::now() + PATIENCE;
    loop {
        watcher.listen(Duration::from_millis(50));
        let text = scrape(port);
        let found = samples(&text);
        if holds(&found, watcher) {
            return found;
        }
        assert!(Instant::now() < until, "waited in vain for {what}: {:?}\n{text}", tally(watcher));
    }
}

/// A live line whose metrics have begun before its judge.
fn measured() -> (Line, Watcher, u16) {
    let mut line = Line::new(Settings::live());
    let port = measure(&mut line);
    let watcher = Watcher::join(&line.station);
    line.start_all_but(&["steward"]);
    (line, watcher, port)
}

#[test]
fn verdicts_restarts_frames_latencies_and_readiness_are_counted_right() {
    let (mut line, mut watcher, port) = measured();
    let watcher = &mut watcher;
    Modbus::connect_when_up(line.port).wait_for(status::READY);
    until(port, watcher, "ready", |found, _| found["andon_ready"] == 1.0);
    watcher.until("verdicts", |watcher| watcher.verdicts.len() > 4);
    line.role("judge").kill();
    let found = until(port, watcher, "a line without a judge", |found, watcher| {
        let is_gone = found["andon_ready"] == 0.0 && found["andon_role_running{role=\"judge\"}"] == 0.0;
        is_gone && verdicts(found) == tally(watcher)
    });
    for stage in ["detections", "couples", "verdict"] {
        let count = found[&format!("andon_latency_seconds_count{{stage=\"{stage}\"}}")];
        let below = found[&format!("andon_latency_seconds_bucket{{le=\"+Inf\",stage=\"{stage}\"}}")];
        assert!(count > 0.0 && count == below, "{stage}: {count} {below}");
    }
    let sent = watcher.verdicts.len();
    assert_eq!(found["andon_latency_seconds_count{stage=\"verdict\"}"], sent as f64);
    assert!(found["andon_frames_processed_total"] > 0.0);
    assert!(found["andon_journal_size_bytes"] > 0.0 && found["andon_disk_free_bytes{of=\"journal\"}"] > 0.0);
    assert_eq!(found["andon_role_restarts_total{role=\"judge\"}"], 0.0);

    for starts in 1..=2 {
        line.role("judge").kill();
        line.start("judge");
        until(port, watcher, "the restart", |found, _| {
            let restarts = found["andon_role_restarts_total{role=\"judge\"}"];
            restarts == f64::from(starts) && found["andon_ready"] == 1.0
        });
    }
    watcher.until("verdicts of the new judge", |watcher| watcher.verdicts.len() > sent);
    line.role("judge").kill();
    let found = until(port, watcher, "all verdicts", |found, watcher| verdicts(found) == tally(watcher));
    for role in ["steward", "perceive", "encode", "journal", "plc"] {
        assert_eq!(found[&format!("andon_role_restarts_total{{role=\"{role}\"}}")], 0.0, "{role}");
    }
}

/// The verdicts that the journal has, by the columns of `andond history`, as the metrics must count them.
fn journalled(line: &Line) -> BTreeMap<String, f64> {
    let output = line.command("history", &["--csv"]);
    assert!(output.status.success(), "{}", all_output(&output));
    let text = String::from_utf8(output.stdout).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|column| *column == name).unwrap();
    let [entry, level, outcome] = ["entry", "level", "outcome"].map(column);
    let mut tally = BTreeMap::new();
    for row in rows.iter().filter(|row| row[entry] == "verdict") {
        let name = format!("andon_verdicts_total{{level=\"{}\",outcome=\"{}\"}}", row[level], row[outcome]);
        *tally.entry(name).or_insert(0.0) += 1.0;
    }
    tally
}

/// Seconds of a film of 30 pictures a second.
const SECONDS: u32 = 12;

#[test]
fn frames_are_counted_as_the_channel_numbers_them_and_verdicts_as_the_journal_has_them() {
    let seconds = SECONDS.to_string();
    let mut line = Line::with_film("speed = \"file\"", "", &["-i", "p1_J1_r1.mp4", "-t", &seconds]);
    line.reconfigure("loop = true", "loop = false");
    let port = measure(&mut line);
    let mut watcher = Watcher::join(&line.station);
    line.start_all_but(&["steward"]);
    let node = Node::open(&line.station, RoleId::Tool, PATIENCE, &Stop::new().unwrap()).unwrap();
    let mut detections = node.reader::<Detections>().unwrap();
    // A frame that comes before `perceive` is there is nobody's loss, and it is there only once its models are loaded.
    watcher.until("perceive", |watcher| watcher.health(RoleId::Perceive).is_some());
    line.start("capture");
    // Frames go on while `perceive` stands still, and it goes on with the newest.
    watcher.until("some frames", |watcher| {
        watcher.health(RoleId::Perceive).is_some_and(|health| health.sent > 30)
    });
    line.role("perceive").signal(Signal::STOP);
    let before = watcher.health(RoleId::Capture).unwrap().sent;
    watcher.until("frames that are not processed", |watcher| {
        // What it said last before the stop may be half a second old.
        watcher.health(RoleId::Capture).unwrap().sent > before + 60
    });
    line.role("perceive").signal(Signal::CONT);
    watcher.until_judged();

    // The message that ends the recording says how many frames were processed, and which frame of the film was the last.
    let end = end_of_recording(&mut detections);
    let frames = 30 * u64::from(SECONDS);
    assert_eq!((end.frame_seq, end.seq > 1), (frames + 1, true), "the newest is the end");
    let processed = end.seq - 1;
    let expected = [
        ("andon_frames_captured_total", frames),
        ("andon_frames_processed_total", processed),
        ("andon_frames_skipped_total", frames - processed),
    ];
    assert!(frames - processed >= 30, "{expected:?}");
    let found = until(port, &mut watcher, "the numbers of the end", |found, watcher| {
        let is = |(name, number): &(&str, u64)| found[*name] == *number as f64;
        expected.iter().all(is) && verdicts(found) == tally(watcher)
    });
    assert!(!verdicts(&found).is_empty() && verdicts(&found) == journalled(&line), "{found:?}");
    // They stay.
    watcher.listen(Duration::from_secs(1));
    let later = samples(&scrape(port));
    assert!(expected.iter().all(|(name, number)| later[*name] == *number as f64), "{expected:?} {later:?}");

    // The film is played again, and the end of the first time has not become a frame.
    line.role("capture").kill();
    line.start("capture");
    let processed = end_of_recording(&mut detections).seq - 2;
    let expected = [("andon_frames_captured_total", 2 * frames), ("andon_frames_processed_total", processed)];
    until(port, &mut watcher, "the numbers of the second end", |found, _| {
        expected.iter().all(|(name, number)| found[*name] == *number as f64)
    });
}

/// Waits for the next message that ends a recording. Returns its stamp.
fn end_of_recording(detections: &mut Reader<Detections>) -> Stamp {
    let until = Instant::now() + PATIENCE;
    loop {
        while let Some(seen) = detections.take().unwrap() {
            if seen.flags & flag::END_OF_STREAM != 0 {
                return seen.stamp;
            }
        }
        assert!(Instant::now() < until, "the recording does not end");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Reads the text as Prometheus's own library for Python does, which refuses what the standard does not allow.
const PARSE: &str = "
import sys
from prometheus_client.openmetrics.parser import text_string_to_metric_families as parse
print('parsed', *sorted(family.name for family in parse(sys.stdin.read())))
";

#[test]
fn the_text_is_openmetrics_and_nothing_else_is_served() {
    let (_line, mut watcher, port) = measured();
    until(port, &mut watcher, "a role", |found, _| found.keys().any(|name| name.contains("role_running")));
    let mut parser = Command::new(python());
    let parser =
        parser.args(["-c", PARSE]).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut parser = parser.spawn().unwrap();
    parser.stdin.take().unwrap().write_all(scrape(port).as_bytes()).unwrap();
    let said = all_output(&parser.wait_with_output().unwrap());
    assert!(said.contains("parsed andon_disk_free_bytes andon_frames_captured"), "{said}");

    // A client that says nothing holds up the next one only for a moment.
    let _silent = TcpStream::connect(("127.0.0.1", port)).unwrap();
    for (request, answer) in [
        ("GET / HTTP/1.1\r\n\r\n", "HTTP/1.1 404 "),
        ("POST /metrics HTTP/1.1\r\n\r\n", "HTTP/1.1 405 "),
        ("\u{1}\u{2} nonsense\r\n\r\n", "HTTP/1.1 400 "),
    ] {
        assert!(ask(port, request).starts_with(answer), "{request:?}");
    }
    samples(&scrape(port));
}
