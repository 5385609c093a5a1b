//! The metrics of a running line, fetched as a monitoring system fetches them.

use super::{Line, PATIENCE, Watcher, free_port};
use shm_schemas::{VerdictLevel, VerdictOutcome};
use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::net::TcpStream;

/// Sends these bytes and reads until the server closes.
pub fn ask(port: u16, request: &str) -> String {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

/// The text of the metrics.
pub fn scrape(port: u16) -> String {
    let answer = ask(port, "GET /metrics HTTP/1.1\r\nHost: here\r\n\r\n");
    let (head, body) = answer.split_once("\r\n\r\n").unwrap();
    assert!(
        head.starts_with("HTTP/1.1 200 OK\r\n") && head.contains("application/openmetrics-text"),
        "{head}"
    );
    body.to_owned()
}

/// Every sample: its name and labels as they stand there, without the station, and its value.
pub fn samples(text: &str) -> BTreeMap<String, f64> {
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    let sample = |line: &str| {
        let (name, value) = line.rsplit_once(' ').unwrap();
        let name = name.replace("station=\"line\",", "").replace("{station=\"line\"}", "");
        (name, value.parse().unwrap())
    };
    lines.map(sample).collect()
}

/// The verdicts that were sent, as the metrics must count them.
pub fn tally(watcher: &Watcher) -> BTreeMap<String, f64> {
    let mut tally = BTreeMap::new();
    for verdict in &watcher.verdicts {
        let level = verdict.level().map(VerdictLevel::name).unwrap();
        let outcome = verdict.outcome().map(VerdictOutcome::name).unwrap();
        let name = format!("andon_verdicts_total{{level=\"{level}\",outcome=\"{outcome}\"}}");
        *tally.entry(name).or_insert(0.0) += 1.0;
    }
    tally
}

/// What the metrics have counted of verdicts.
pub fn verdicts(found: &BTreeMap<String, f64>) -> BTreeMap<String, f64> {
    let of_verdicts = found.iter().filter(|(name, _)| name.starts_with("andon_verdicts_total"));
    of_verdicts.map(|(name, value)| (name.clone(), *value)).collect()
}

/// Starts steward and metrics, which is before everything that they measure. Returns where the metrics are served.
pub fn measure(line: &mut Line) -> u16 {
    let port = free_port();
    line.reconfigure("[plc]\n", &format!("[metrics]\nenable = true\nport = {port}\n\n[plc]\n"));
    line.start("steward");
    line.start("metrics");
    line.wait_for_log("metrics", "AND-617", "");
    port
}
