//! The whole line, each stage in a process of its own.
#![allow(clippy::unwrap_used, clippy::panic)]

mod ipc_support;

use ipc_support::{Bench, SMALL};

const FRAMES: u64 = 3_000;

/// The journal is the slowest stage, and 3000 verdicts are three times its buffer: each stage must hold back the one before it.
#[test]
fn a_slow_journal_holds_back_the_recording_and_nothing_is_lost_anywhere() {
    let bench = Bench::new("line");
    let steward = bench.start("steward", &[SMALL.frame_bytes as u64]);
    let mut capture = bench.start_with("write-frames", &[FRAMES, 64, 48], "paced");
    let mut stages = ["frames-to-detections", "detections-to-couples", "couples-to-verdicts"]
        .map(|task| bench.start(task, &[]));
    let mut journal = bench.start("read-verdicts", &[0, 500]);

    assert_eq!(journal.number("lost"), 0);
    assert_eq!(journal.number("received"), FRAMES);
    journal.finish();
    capture.until("done");
    capture.stop();
    for stage in &mut stages {
        assert_eq!(stage.number("lost"), 0);
        assert_eq!(stage.number("received"), FRAMES);
    }
    for stage in stages {
        stage.stop();
    }
    steward.stop();
}

/// When the writer does not wait, the same reader loses messages and counts each of them.
#[test]
fn a_reader_that_is_too_slow_for_a_live_writer_counts_every_loss() {
    let bench = Bench::new("live");
    let steward = bench.start("steward", &[SMALL.frame_bytes as u64]);
    let mut journal = bench.start("read-verdicts", &[FRAMES, 500]);
    let judge = bench.start("write-verdicts", &[FRAMES, 0]);

    let lost = journal.number("lost");
    assert!(lost > 0, "1024 fit, {FRAMES} were sent at once");
    assert_eq!(lost + journal.number("received"), FRAMES);
    journal.finish();
    judge.stop();
    steward.stop();
}

/// SIGSTOP holds one reader while the judge sends four times as much as its buffer holds.
#[test]
fn a_reader_that_is_stuck_does_not_stop_the_line() {
    let bench = Bench::new("stuck");
    let steward = bench.start("steward", &[SMALL.frame_bytes as u64]);
    let mut stuck = bench.start("read-verdicts", &[4096, 0]);
    let mut quick = bench.start("read-verdicts", &[4096, 0]);
    stuck.signal(rustix::process::Signal::STOP);
    let mut judge = bench.start("write-verdicts", &[4096, 50]);

    judge.until("done");
    assert_eq!(quick.number("lost") + quick.number("received"), 4096);
    quick.finish();

    stuck.signal(rustix::process::Signal::CONT);
    assert_eq!(stuck.number("lost"), 4096 - 1024);
    assert_eq!(stuck.number("received"), 1024);
    stuck.finish();
    judge.stop();
    steward.stop();
}

/// The times are printed and not checked: a wake-up is as fast as the machine is idle. `--nocapture` shows them.
#[test]
fn verdicts_at_200_hz_wake_their_reader() {
    let bench = Bench::new("wake");
    let steward = bench.start("steward", &[SMALL.frame_bytes as u64]);
    let mut journal = bench.start("read-verdicts", &[1_000, 0]);
    let judge = bench.start("write-verdicts", &[1_000, 5_000]);

    assert_eq!(journal.number("received"), 1_000);
    println!(
        "send to take: p50 {} us, p99 {} us",
        journal.number("p50_ns") / 1000,
        journal.number("p99_ns") / 1000
    );
    journal.finish();
    judge.stop();
    steward.stop();
}
