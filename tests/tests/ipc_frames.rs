//! Frames between processes: none is copied, none is lost, and none costs an allocation.
#![allow(clippy::unwrap_used, clippy::panic)]

mod ipc_support;

use ipc_support::Bench;

const WIDTH: u64 = 1280;
const HEIGHT: u64 = 720;
const FRAME: u64 = WIDTH * HEIGHT * 3;

/// What writer and reader measured.
struct Run {
    frames_per_s: f64,
    /// Frames that were written in the steady state.
    measured: u64,
    writer_allocations: u64,
    reader_allocations: u64,
}

/// Runs writer, reader and steward in processes of their own. Every frame is checked.
fn run(frames: u64, writer_mode: &str, reader_copies: u64) -> Run {
    let bench = Bench::new("frames");
    let steward = bench.start("steward", &[FRAME]);
    let mut writer = bench.start_with("write-frames", &[frames, WIDTH, HEIGHT], writer_mode);
    let mut reader = bench.start("read-frames", &[reader_copies]);

    let nanoseconds = writer.number("nanoseconds");
    let measured = writer.number("frames");
    let (writer_allocations, reader_allocations) =
        (writer.number("allocations"), reader.number("allocations"));
    assert_eq!(reader.number("received"), frames);
    assert_eq!(reader.number("lost"), 0);
    assert_eq!(reader.number("wrong"), 0, "frames whose pixels are not what was written");
    assert_eq!(reader.number("elsewhere"), 0, "frames that were not read where they were written");
    reader.finish();
    writer.until("done");
    writer.stop();
    steward.stop();
    assert_eq!(bench.shared_files(), Vec::<String>::new());
    let frames_per_s = measured as f64 / (nanoseconds as f64 * 1e-9);
    Run { frames_per_s, measured, writer_allocations, reader_allocations }
}

/// The reader finds the pixels of each frame in the same byte of the same file where the writer put them. Our code allocates nothing in either
/// process. There is no second place where they could have been in between.
#[test]
fn ten_thousand_frames_are_read_where_they_were_written_without_an_allocation() {
    let run = run(10_000, "paced", 0);
    println!("{:.0} frames/s, {:.2} GB/s", run.frames_per_s, run.frames_per_s * FRAME as f64 * 1e-9);
    assert_eq!(run.reader_allocations, 0, "iceoryx2's included, after the first 100 frames");
    // iceoryx2 0.10.0 keeps the state of a loan in an `Arc`: one small allocation per frame. None is ours.
    assert_eq!(run.writer_allocations, run.measured, "iceoryx2's included, after the first 100 frames");
}

/// The same with a copy on each side: the printed figures show what a copy costs. It also shows that the checks do
/// not depend on how the pixels came there.
#[test]
fn frames_that_are_copied_on_both_sides_arrive_as_well() {
    let run = run(1_000, "copied", 1);
    println!("{:.0} frames/s with two copies", run.frames_per_s);
}
