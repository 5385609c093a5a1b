//! Listens to a line and says how long each frame took. That is from its capture to the couples that `encode` has sent of it: the judge waits for them.
//!
//! `latencies STATION.toml [SECONDS]`: prints a line for each frame, in milliseconds. It fails where it was too slow to hear of every one.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_host::config::Config;
use andon_ipc::{Node, Stop};
use andon_tests::line::PATIENCE;
use shm_schemas::{Couples, RoleId, flag};
use std::io::Write;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// For how long it listens otherwise.
const SECONDS: u64 = 60;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let station = arguments.next().expect("name the file of a station");
    let seconds = arguments.next().map_or(SECONDS, |text| text.parse().expect("a number of seconds"));
    let config = Config::load(&[station]).unwrap_or_else(|faults| panic!("{faults}"));
    let node =
        Node::open(&config.ipc_station().unwrap(), RoleId::Tool, PATIENCE, &Stop::new().unwrap()).unwrap();
    let mut couples = node.reader::<Couples>().unwrap();
    let mut out = std::io::stdout().lock();
    let until = Instant::now() + Duration::from_secs(seconds);
    while let Some(left) = until.checked_duration_since(Instant::now()) {
        node.wait(&mut [&mut couples], left).unwrap();
        while let Some(message) = couples.take().unwrap() {
            let stamp = &message.stamp;
            if message.flags & flag::END_OF_STREAM == 0 && stamp.captured_ns > 0 {
                let latency = Duration::from_nanos(stamp.sent_ns.saturating_sub(stamp.captured_ns));
                writeln!(out, "{:.3}", 1e3 * latency.as_secs_f64()).unwrap();
            }
        }
    }
    match couples.lost() {
        0 => ExitCode::SUCCESS,
        lost => {
            eprintln!("{lost} messages were lost on the way to this program");
            ExitCode::FAILURE
        }
    }
}
