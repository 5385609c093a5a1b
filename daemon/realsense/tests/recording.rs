//! A recording that the SDK's own recorder has made, through the real SDK (`make test` runs it with the features that it needs).
//!
//! `tests/realsense/make_bag.py` computes it from a clip and its ground truth. The `.colour`, `.depth` and `.json` files beside it, written
//! without the SDK, hold what must come out again.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use andon_realsense::frame::{Distortion, FrameInfo, PixelFormat};
use andon_realsense::settings::{Origin, Settings};
use andon_realsense::{Error, Source};
use serde_json::Value;

/// The clip's frames from `FIRST` on: the polisher is in the hand and rubs the brick.
const FIRST: usize = 100;
const FRAMES: usize = 20;
const COLOUR_BYTES: usize = 640 * 480 * 3;
const DEPTH_BYTES: usize = 640 * 480 * 2;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The recording, which is made once for all tests of this file.
fn bag() -> &'static Path {
    static BAG: OnceLock<PathBuf> = OnceLock::new();
    BAG.get_or_init(|| {
        let root = repository();
        let bag =
            Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("recording-{}.bag", std::process::id()));
        let made = Command::new("python3")
            .arg(root.join("tests/realsense/make_bag.py"))
            .arg(root.join("tests/footage/p1_none_r1.mp4"))
            .arg(root.join("tests/footage/p1_none_r1.truth.jsonl"))
            .arg(&bag)
            .args(["--first", &FIRST.to_string(), "--frames", &FRAMES.to_string()])
            .status()
            .unwrap();
        assert!(made.success(), "make_bag.py has failed, see above");
        bag
    })
}

fn settings(file: &Path) -> Settings {
    let origin = Origin::Recording(file.into());
    Settings { library: repository().join("target/runtime/realsense"), origin, depth: true }
}

/// A frame as a reader of the channel `frame` receives it.
struct Read {
    info: FrameInfo,
    bytes: Vec<u8>,
}

/// Plays until the end.
fn play(source: &mut Source) -> Vec<Read> {
    let mut frames = Vec::new();
    while let Some(frame) = source.next_frame().unwrap() {
        let mut bytes = vec![0; frame.info().bytes()];
        assert_eq!(frame.write_to(&mut bytes).unwrap(), bytes.len());
        frames.push(Read { info: *frame.info(), bytes });
    }
    frames
}

fn play_once() -> Vec<Read> {
    play(&mut Source::open(&settings(bag())).unwrap())
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn every_frame_comes_out_once_with_the_bytes_that_went_in() {
    let (colour, depth) = (fs::read(bag().with_extension("colour")), fs::read(bag().with_extension("depth")));
    let (colour, depth) = (colour.unwrap(), depth.unwrap());
    let frames = play_once();
    let numbers: Vec<u64> = frames.iter().map(|frame| frame.info.number).collect();
    assert_eq!(numbers, (0..FRAMES as u64).collect::<Vec<_>>());
    for frame in &frames {
        let k = frame.info.number as usize;
        assert!(
            frame.bytes[..COLOUR_BYTES] == colour[k * COLOUR_BYTES..][..COLOUR_BYTES],
            "colour of frame {k}"
        );
        assert!(frame.bytes[COLOUR_BYTES..] == depth[k * DEPTH_BYTES..][..DEPTH_BYTES], "depth of frame {k}");
        assert_eq!(frame.info.dropped, 0);
    }
}

#[test]
fn sizes_optics_and_depth_unit_are_those_of_the_camera() {
    let wanted = json(&bag().with_extension("json"));
    let info = play_once()[0].info;
    assert_eq!((info.colour.width, info.colour.height, info.colour.stride), (640, 480, 1920));
    assert_eq!(info.colour.format, PixelFormat::Rgb8);
    assert_eq!(info.colour.intrinsics.distortion, Distortion::BrownConrady);
    let depth = info.depth.unwrap();
    assert_eq!((depth.plane.width, depth.plane.height, depth.plane.stride), (640, 480, 1280));
    assert_eq!(depth.plane.format, PixelFormat::Z16);
    assert_eq!(f64::from(depth.unit_m) as f32, number(&wanted["unit_m"]) as f32);
    for (name, intrinsics) in [("colour", info.colour.intrinsics), ("depth", depth.plane.intrinsics)] {
        for axis in 0..2 {
            assert_eq!(intrinsics.focal[axis], number(&wanted[name]["focal"][axis]) as f32, "{name}");
            assert_eq!(intrinsics.centre[axis], number(&wanted[name]["centre"][axis]) as f32, "{name}");
        }
    }
    for row in 0..3 {
        let translation = number(&wanted["translation_m"][row]) as f32;
        assert_eq!(depth.colour_from_depth.translation_m[row], translation);
        for column in 0..3 {
            let element = number(&wanted["rotation"][row][column]) as f32;
            assert_eq!(depth.colour_from_depth.rotation[row][column], element, "row {row}, column {column}");
        }
    }
}

/// The ground truth says where each marker is in the colour picture and how high it lies. The depth pixel that the extrinsics lead to must show that
/// height. A part's plate is some 15 depth pixels wide. An error of the extrinsics by one centimetre, or a transposed rotation, leads beside it.
#[test]
fn depth_lies_under_the_colour_pixel_that_the_extrinsics_lead_to() {
    let truth = fs::read_to_string(repository().join("tests/footage/p1_none_r1.truth.jsonl")).unwrap();
    let truth: Vec<Value> = truth.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let camera_height = number(&truth[0]["camera"]["height_m"]);
    let mut checked = 0;
    for frame in play_once() {
        let line = &truth[1 + FIRST + frame.info.number as usize];
        for object in line["objects"].as_array().unwrap() {
            let height = number(&object["p"][2]);
            let corners: Vec<[f64; 2]> = object["marker_px"]
                .as_array()
                .unwrap()
                .iter()
                .map(|p| [number(&p[0]), number(&p[1])])
                .collect();
            let middle = [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 4.0);
            let seen = depth_at(&frame, middle, camera_height - height);
            // Noise of the disparity at this distance is 2.4 mm; 4 sigma.
            assert!((seen - (camera_height - height)).abs() < 0.010, "{} at {height}: {seen}", object["id"]);
            checked += 1;
        }
    }
    assert_eq!(checked, 3 * FRAMES);
}

/// Depth in metres where a point that is `distance` from the colour camera and at `pixel` of its picture is for the depth camera. The median of 5 x 5
/// pixels that have depth.
fn depth_at(frame: &Read, pixel: [f64; 2], distance: f64) -> f64 {
    let (colour, depth) = (frame.info.colour.intrinsics, frame.info.depth.unwrap());
    let axis = |k: usize| (pixel[k] - f64::from(colour.centre[k])) / f64::from(colour.focal[k]) * distance;
    let between = depth.colour_from_depth;
    let moved: Vec<f64> = [axis(0), axis(1), distance]
        .iter()
        .zip(between.translation_m)
        .map(|(p, t)| p - f64::from(t))
        .collect();
    // The inverse of a rotation is its transpose.
    let in_depth =
        [0, 1, 2].map(|k| (0..3).map(|row| f64::from(between.rotation[row][k]) * moved[row]).sum::<f64>());
    let optics = depth.plane.intrinsics;
    let at = [0, 1].map(|k| {
        (in_depth[k] / in_depth[2] * f64::from(optics.focal[k]) + f64::from(optics.centre[k])).round()
            as usize
    });
    let mut steps: Vec<u16> = (at[1] - 2..=at[1] + 2)
        .flat_map(|row| (at[0] - 2..=at[0] + 2).map(move |column| COLOUR_BYTES + (row * 640 + column) * 2))
        .map(|byte| u16::from_le_bytes([frame.bytes[byte], frame.bytes[byte + 1]]))
        .filter(|&steps| steps > 0)
        .collect();
    steps.sort_unstable();
    f64::from(steps[steps.len() / 2]) * f64::from(depth.unit_m)
}

#[test]
fn source_time_begins_at_zero_and_keeps_the_rate_of_the_recording() {
    let frames = play_once();
    for (k, frame) in frames.iter().enumerate() {
        let wanted = (k as f64 * 1e9 / 30.0) as u64;
        assert!(frame.info.source_ns.abs_diff(wanted) < 1000, "frame {k}: {}", frame.info.source_ns);
    }
    assert!(frames.windows(2).all(|pair| pair[1].info.captured_ns > pair[0].info.captured_ns));
}

#[test]
fn the_end_is_told_once_and_for_all() {
    let mut source = Source::open(&settings(bag())).unwrap();
    play(&mut source);
    for _ in 0..3 {
        assert!(source.next_frame().unwrap().is_none());
    }
}

/// The SDK reads ahead and waits for its frames to be taken. A test that hangs here shows that it is not let go.
#[test]
fn a_recording_can_be_left_before_its_end_and_played_again() {
    for taken in 0..4 {
        let mut source = Source::open(&settings(bag())).unwrap();
        for number in 0..taken {
            assert_eq!(source.next_frame().unwrap().unwrap().info().number, number);
        }
    }
    assert_eq!(play_once().len(), FRAMES);
}

#[test]
fn a_reader_that_pauses_misses_nothing() {
    let mut source = Source::open(&settings(bag())).unwrap();
    assert_eq!(source.next_frame().unwrap().unwrap().info().number, 0);
    // In this time the SDK would read the whole recording if it did not wait.
    std::thread::sleep(std::time::Duration::from_millis(500));
    assert_eq!(play(&mut source).len(), FRAMES - 1);
}

#[test]
fn without_depth_a_frame_is_its_colour() {
    let mut source = Source::open(&Settings { depth: false, ..settings(bag()) }).unwrap();
    let frames = play(&mut source);
    assert_eq!(frames.len(), FRAMES);
    assert!(frames.iter().all(|frame| frame.info.depth.is_none() && frame.bytes.len() == COLOUR_BYTES));
}

#[test]
fn a_recording_that_is_not_there_is_told_before_it_is_played() {
    let why = Source::open(&settings(Path::new("no/such.bag"))).err().unwrap();
    assert!(matches!(why, Error::NoRecording { .. }), "{why:?}");
    assert!(why.to_string().contains("no/such.bag"), "{why}");
}

#[test]
fn a_file_that_is_no_recording_is_told_with_its_name() {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("no-recording.bag");
    fs::write(&file, "not a bag").unwrap();
    let why = Source::open(&settings(&file)).err().unwrap();
    assert!(matches!(why, Error::Recording { .. }), "{why:?}");
    assert!(why.to_string().contains("no-recording.bag"), "{why}");
}
