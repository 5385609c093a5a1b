//! RealSense recordings, played by the real processes. `make test` builds the feature that this needs.
//!
//! `tests/realsense/make_bag.py` makes a recording of a clip and its ground truth with the SDK's own recorder. The `.colour`, `.depth` and `.json`
//! files beside it, written without the SDK, are what must come out.
#![allow(clippy::unwrap_used, clippy::panic)]

mod support;

use shm_schemas::{DepthFormat, VerdictLevel as Level, VerdictOutcome as Outcome, flag};
use support::{Clip, MetricLine, Read, capture, count, number};

/// The polisher is in the hand and rubs the brick.
const RUBBING: Clip = Clip { name: "p1_none_r1", first: 100, frames: 20 };
/// The polisher is taken, rubs the brick with six strokes and is put down.
const POLISHING: Clip = Clip { name: "p1_none_r1", first: 20, frames: 280 };
/// The same with three strokes.
const HALF_DONE: Clip = Clip { name: "p1_J1_r1", first: 20, frames: 210 };

const COLOUR_BYTES: usize = 640 * 480 * 3;
const DEPTH_BYTES: usize = 640 * 480 * 2;

#[test]
fn every_byte_of_a_recording_is_on_the_channel_with_the_optics_and_the_times_of_the_camera() {
    let bag = RUBBING.bag();
    let (colour, depth) = (bag.pixels("colour"), bag.pixels("depth"));
    let (played, end) = bag.play();
    for (k, Read { header, bytes }) in played.iter().enumerate() {
        assert_eq!(bytes[..COLOUR_BYTES], colour[k * COLOUR_BYTES..][..COLOUR_BYTES], "colour {k}");
        assert_eq!(bytes[COLOUR_BYTES..], depth[k * DEPTH_BYTES..][..DEPTH_BYTES], "depth {k}");
        assert!(header.source_ns.abs_diff(k as u64 * 1_000_000_000 / 30) < 1000, "{k}: {}", header.source_ns);
        assert_eq!((header.dropped, header.flags), (0, flag::PACED));
    }
    assert!(
        played.windows(2).all(|pair| pair[1].header.stamp.captured_ns > pair[0].header.stamp.captured_ns)
    );
    let end = end.expect("the end of the file is flagged");
    assert_eq!(end.flags, flag::END_OF_STREAM | flag::PACED);
    assert!(end.source_ns > played.last().unwrap().header.source_ns);

    let (header, wanted) = (played[0].header, bag.calibration());
    assert_eq!((header.width, header.height, header.stride), (640, 480, 1920));
    assert_eq!((header.depth_width, header.depth_height, header.depth_stride), (640, 480, 1280));
    assert_eq!(header.depth_format, DepthFormat::Z16.code());
    assert_eq!(header.depth_unit_m, number(&wanted["unit_m"]) as f32);
    for (name, optics) in [("colour", header.colour), ("depth", header.depth)] {
        let [focal, centre] =
            ["focal", "centre"].map(|key| [0, 1].map(|k| number(&wanted[name][key][k]) as f32));
        assert_eq!(([optics.fx, optics.fy], [optics.cx, optics.cy]), (focal, centre), "{name}");
    }
}

/// The ground truth has the position of each marker in the colour picture, and its height.
#[test]
fn the_extrinsics_on_the_channel_lead_from_a_marker_to_its_depth() {
    let bag = RUBBING.bag();
    let (played, _) = bag.play();
    let mut checked = 0;
    for (k, read) in played.iter().enumerate() {
        for (pixel, distance) in bag.markers(k) {
            let seen = read.depth_at(pixel, distance);
            // The noise of the disparity at this distance is 2.4 mm; 4 sigma.
            assert!((seen - distance).abs() < 0.010, "{seen} m instead of {distance} m");
            checked += 1;
        }
    }
    assert_eq!(checked, 3 * RUBBING.frames);
}

#[test]
fn a_recording_in_a_loop_goes_on_in_time() {
    let bag = RUBBING.bag();
    let mut line = capture(&bag, true);
    let (played, end) = line.frames(3 * RUBBING.frames);
    assert!(end.is_none());
    for pair in played.windows(2) {
        let step_ns = pair[1].header.source_ns - pair[0].header.source_ns;
        assert!((20_000_000..=80_000_000).contains(&step_ns), "{step_ns} ns between two frames");
    }
}

#[test]
fn a_camera_that_no_station_runs_is_opened_to_look_through_it() {
    let bag = RUBBING.only_bag();
    let text = MetricLine::new(&bag, None).looks();
    assert!(text.starts_with("the camera of line: 640 x 480 pixels"), "{text}");
    assert!(text.contains("brick       its marker is "), "{text}");
}

#[test]
fn in_metric_mode_a_job_is_taught_from_one_recording_and_three_strokes_of_six_are_found_in_another() {
    let whole = POLISHING.only_bag();
    let mut teacher = MetricLine::new(&whole, None);
    let (tracks, frames) = teacher.record(POLISHING.frames);
    let mut tips = frames.iter().flat_map(|frame| &frame.hands).flat_map(|hand| hand.tips);
    assert!(tips.any(|[_, _, height]| height > 0.0), "in the plane every height is zero");
    let job = teacher.teach(&tracks);

    let same = MetricLine::new(&whole, Some(&job)).judge();
    assert!(
        count(&same, Level::Iu, Outcome::Ok) >= 2 && count(&same, Level::Iu, Outcome::Anomaly) == 0,
        "{same:?}"
    );
    assert_eq!(count(&same, Level::Job, Outcome::Ok), 1, "{same:?}");
    let half = MetricLine::new(&HALF_DONE.only_bag(), Some(&job)).judge();
    assert!(count(&half, Level::Iu, Outcome::Anomaly) >= 1, "{half:?}");
    assert_eq!(count(&half, Level::Job, Outcome::Anomaly), 1, "{half:?}");
}
