//! A real person, recorded by motion capture, moves a box from a shelf to a table and back: taught by all runs but one, the job
//! knows the one left out, and what is composed of it wrongly.
#![allow(clippy::unwrap_used)]

mod capture;

use andon_core::config::{Contact, Method};
use andon_core::couple::Context;
use andon_core::input::{Side, Space};
use andon_core::verdict::Kind;
use andon_learn::job_file::JobFile;
use andon_learn::run::Run;
use andon_learn::teach::{TeachOptions, teach};
use capture::{BOX, Capture, RATE_HZ, SHELF, TABLE};
use std::sync::LazyLock;

/// The runs of the recording.
const RUNS: std::ops::RangeInclusive<u32> = 1..=9;

fn method() -> Method {
    Method {
        space: Space::Metric,
        rate_hz: RATE_HZ,
        // A tip is up to 6 cm from the middle of the tips, where the box is taken.
        hand_contact: Contact { on_m: 0.08, off_m: 0.11 },
        // The middle of the box, from where it came to rest in the other runs.
        object_contact: Contact { on_m: 0.08, off_m: 0.11 },
        // A sixth of a second, as five frames are at 30 Hz.
        persist_frames: 10,
        ..Method::default()
    }
}

fn run(capture: &Capture) -> Run {
    Run::new("run", "", &capture.recording(), &method()).unwrap()
}

/// For each run in turn the job that all others teach.
static TAUGHT_BY_OTHERS: LazyLock<Vec<(u32, JobFile)>> = LazyLock::new(|| {
    let runs: Vec<Run> = RUNS.map(|number| run(&Capture::read(number))).collect();
    let options = TeachOptions::new("shelf to table and back", "", method());
    let without = |left_out: usize| {
        let others: Vec<Run> =
            (0..runs.len()).filter(|place| *place != left_out).map(|place| runs[place].clone()).collect();
        teach(&others, &options).unwrap().0
    };
    RUNS.enumerate().map(|(place, number)| (number, without(place))).collect()
});

/// The runs that are right, as `compose` makes them, for the job that all others taught.
fn judged_right(compose: impl Fn(Capture) -> Capture) -> Vec<u32> {
    let is_right = |(number, job): &&(u32, JobFile)| {
        let composed = run(&compose(Capture::read(*number)));
        let verdicts = job.with_job(|lent| composed.judge(lent, &method())).unwrap();
        verdicts.iter().any(|verdict| verdict.kind == Kind::JobOk)
    };
    TAUGHT_BY_OTHERS.iter().filter(is_right).map(|(number, _)| *number).collect()
}

fn all() -> Vec<u32> {
    RUNS.collect()
}

fn none() -> Vec<u32> {
    Vec::new()
}

#[test]
fn every_run_has_the_interactions_that_its_labels_name() {
    for number in RUNS {
        let contexts: Vec<Vec<Context>> =
            run(&Capture::read(number)).activities.iter().map(|activity| activity.contexts()).collect();
        let hand = Side::Right as u16;
        let held = Context([hand, BOX, 0, 0]);
        let at = |place| [Context([hand, BOX, BOX, place]), Context([0, 0, BOX, place])];
        let ([on_shelf, left_on_shelf], [on_table, left_on_table]) = (at(SHELF), at(TABLE));
        let nominal = vec![on_shelf, held, on_table, left_on_table, on_table, held, on_shelf, left_on_shelf];
        assert_eq!(contexts, [nominal], "run {number}");
    }
}

#[test]
fn a_run_that_was_not_taught_is_right() {
    assert_eq!(judged_right(|run| run), all());
}

#[test]
fn a_bench_that_is_turned_is_no_anomaly() {
    assert_eq!(judged_right(Capture::turned), all());
}

#[test]
fn half_the_speed_is_no_anomaly() {
    assert_eq!(judged_right(Capture::half_speed), all());
}

#[test]
fn a_second_half_that_is_missing_is_an_anomaly() {
    assert_eq!(judged_right(Capture::without_second_half), none());
}

#[test]
fn halves_in_reverse_order_are_an_anomaly() {
    assert_eq!(judged_right(Capture::halves_swapped), none());
}

#[test]
fn a_way_back_that_is_cut_short_is_an_anomaly() {
    assert_eq!(judged_right(Capture::cut_short), none());
}
