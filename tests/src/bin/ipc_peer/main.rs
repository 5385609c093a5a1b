//! A process of a station under test: `ipc_peer ROLE STATION ROOT [ARGUMENT...]`.
//!
//! It prints `up` once it is ready and `key=value` lines at the end, and stops on SIGTERM. The tests start it, because
//! what they show needs processes of its own: shared memory, death, signals.

mod counting;
mod frames;
mod mapping;
mod messages;

use andon_ipc::{Limits, Node, POLL_PERIOD, Station, Steward, Stop};
use shm_schemas::RoleId;
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

#[global_allocator]
static ALLOCATOR: counting::Counting = counting::Counting;

/// Longer than any test lasts: if a wait ends, something has ended it.
pub(crate) const FOREVER: Duration = Duration::from_secs(600);

/// How long to wait for a station: other processes start at the same time, on a machine that may be busy.
const PATIENCE: Duration = Duration::from_secs(60);

pub(crate) type Outcome = Result<(), Box<dyn std::error::Error>>;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{arguments:?}: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &[String]) -> Outcome {
    let [task, name, root, rest @ ..] = arguments else {
        return Err("ipc_peer TASK STATION ROOT [ARGUMENT...]".into());
    };
    let station = Station::under(name, Path::new(root))?;
    let stop = Stop::on_signals()?;
    if task == "steward" {
        return steward(&station, number(rest, 0)?, &stop);
    }
    let role = match task.as_str() {
        "write-frames" => RoleId::Capture,
        "read-frames" | "frames-to-detections" => RoleId::Perceive,
        "detections-to-couples" => RoleId::Encode,
        "couples-to-verdicts" | "write-verdicts" => RoleId::Judge,
        "read-verdicts" | "wait" => RoleId::Journal,
        other => return Err(format!("no task {other}").into()),
    };
    let node = Node::open(&station, role, PATIENCE, &stop)?;
    match task.as_str() {
        "write-frames" => frames::write(&node, rest),
        "read-frames" => frames::read(&node, rest),
        "frames-to-detections" => messages::frames_to_detections(&node),
        "detections-to-couples" => messages::detections_to_couples(&node),
        "couples-to-verdicts" => messages::couples_to_verdicts(&node),
        "write-verdicts" => messages::write_verdicts(&node, rest),
        "read-verdicts" => messages::read_verdicts(&node, rest),
        _ => messages::wait_for_nothing(&node),
    }
}

fn steward(station: &Station, frame_bytes: u64, stop: &Stop) -> Outcome {
    let mut steward = Steward::create(station, Limits { frame_bytes: usize::try_from(frame_bytes)? })?;
    println!("up");
    while !stop.wait(POLL_PERIOD) {
        for death in steward.poll()? {
            if let Some(member) = death.member {
                println!("died={} {}", member.name, member.pid);
            }
        }
    }
    Ok(())
}

pub(crate) fn number(arguments: &[String], index: usize) -> Result<u64, Box<dyn std::error::Error>> {
    Ok(arguments.get(index).ok_or("an argument is missing")?.parse()?)
}
