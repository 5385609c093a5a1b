//! The Python example, with the iceoryx2 wheel from PyPI, reads what a Rust writer writes.
#![allow(clippy::unwrap_used)]

mod python;
mod station;

use shm_schemas::{Layout, Verdict};
use station::{TestStation, start_reader};
use std::process::Command;
use std::time::Duration;

fn example() -> String {
    format!("{}/examples/read_verdicts.py", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_example_names_the_layout_of_this_build() {
    let text = std::fs::read_to_string(example()).unwrap();
    let line = format!("LAYOUT = \"{:016x}/", Verdict::HASH);
    assert!(text.contains(&line), "read_verdicts.py needs {line}…, it has another layout");
}

#[test]
fn a_python_program_reads_every_verdict_as_it_was_written() {
    let python = python::python();
    let station = TestStation::new();
    let mut judge = station.judge();
    let mut program = Command::new(python);
    program.arg(example()).args(["plctest", "--count", "300", "--root"]).arg(station.station.root());
    let (mut child, lines) = start_reader(&mut program);
    for number in 1..=300 {
        judge.send(number);
        judge.idle(Duration::from_millis(1));
    }
    let lines: Vec<String> = lines.collect();
    assert!(child.wait().unwrap().success());
    assert_eq!(lines.len(), 300);
    for (line, number) in lines.iter().zip(1..) {
        let (outcome, reason) = if number % 3 == 0 { ("anomaly", "Motion") } else { ("ok", "None") };
        let start = format!(
            "{{\"seq\": {number}, \"level\": \"iu\", \"outcome\": \"{outcome}\", \"reason\": \"{reason}\", "
        );
        assert!(line.starts_with(&start), "{line}");
        assert!(line.contains(&format!("\"distance\": {:?},", number as f32 / 2.0)), "{line}");
        let measures = format!(
            "\"measures\": {{\"measure\": \"Strokes\", \"unit\": \"strokes\", \"value\": {number}.0, \"shown\": [5.5, 6.5]}},"
        );
        assert!(line.contains(&measures), "{line}");
        assert!(line.contains(&format!("\"part\": \"A-{number}\"")), "{line}");
    }
    let mut micros: Vec<f64> = lines.iter().map(|line| latency_us(line)).collect();
    micros.sort_by(f64::total_cmp);
    println!("Python reader: latency_us p50 {:.1} p99 {:.1}", micros[150], micros[297]);
}

fn latency_us(line: &str) -> f64 {
    line.rsplit_once("\"latency_us\": ").unwrap().1.trim_end_matches('}').parse().unwrap()
}
