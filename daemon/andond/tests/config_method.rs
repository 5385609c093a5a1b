//! Keys of `[method]` do in a recording what they promise, and the configuration allows only what the method takes.
#![allow(clippy::unwrap_used)]

use andon_core::input::{Frame, Hand, Object, Point, Side, Space};
use andon_core::object::ObjectShape;
use andon_host::config::{Config, reference};
use andon_learn::recording::{Header, Landmarks, NamedObject, write};
use serde_json::Value;
use std::path::Path;
use std::process::Command;

const TOOL: u16 = 5;
const PART: u16 = 6;

const RATE_HZ: f32 = 30.0;

/// One frame: where the finger tips of the right hand are on the x axis, if it is seen. It also has where the tool and the part are.
type Scene = (Option<f32>, f32, f32);

fn frame(index: usize, (hand, tool, part): Scene) -> Frame {
    let captured_ns = (index as f64 * 1e9 / f64::from(RATE_HZ)) as u64;
    let mut frame = Frame { captured_ns, ..Frame::default() };
    frame.hands.extend(hand.map(|x| {
        let at = |y: f32| -> Point { [x, y, 0.0] };
        Hand {
            side: Side::Right,
            score: 1.0,
            wrist: at(-0.17),
            middle_knuckle: at(-0.08),
            tips: [at(0.0); 3],
        }
    }));
    for (id, x) in [(TOOL, tool), (PART, part)] {
        let object = Object { id, position: [x, 0.0, 0.0], orientation: [1.0, 0.0, 0.0, 0.0] };
        frame.objects.push(object).unwrap();
    }
    frame
}

/// A track file of `seconds`; `scene` says what is where at each time.
fn record(file: &Path, seconds: f32, scene: impl Fn(f32) -> Scene) {
    let object = |(id, name): (u16, &str)| {
        let interaction_points = [[0.0; 3]].into_iter().collect();
        let shape = ObjectShape { id, interaction_points, ..ObjectShape::default() };
        NamedObject { name: name.to_owned(), shape }
    };
    let header = Header {
        rate_hz: RATE_HZ,
        space: Space::Plane,
        hands: vec![Side::Right],
        landmarks: Landmarks::Five,
        objects: [(TOOL, "tool"), (PART, "part")].map(object).into(),
    };
    let frames: Vec<Frame> =
        (0..(seconds * RATE_HZ) as usize).map(|index| frame(index, scene(index as f32 / RATE_HZ))).collect();
    write(&mut std::fs::File::create(file).unwrap(), &header, &frames).unwrap();
}

/// A station with these keys of `[method]`.
fn station(keys: &str) -> String {
    format!(
        "[station]\nname = \"bench1\"\n[camera]\nrate_hz = 240\n[[objects]]\nid = {TOOL}\nname = \"tool\"\nmarker_side_m = 0.03\n\
         [method]\n{keys}\n"
    )
}

/// What `andond segment` finds on one level of a recording with these keys of `[method]`.
fn segmented(folder: &Path, keys: &str, level: &str) -> Vec<Value> {
    std::fs::write(folder.join("station.toml"), station(keys)).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_andond"))
        .args(["segment", "--json", "-c", "station.toml", "recording.tracks.jsonl"])
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(output.status.success(), "{keys}: {}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let events = text.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    events.filter(|event| event["level"] == level).collect()
}

/// The events of one level of the same recording with each of two texts for `[method]`.
fn each_gives(keys: [&str; 2], level: &str, seconds: f32, scene: impl Fn(f32) -> Scene) -> [Vec<Value>; 2] {
    let folder = tempfile::tempdir().unwrap();
    record(&folder.path().join("recording.tracks.jsonl"), seconds, scene);
    keys.map(|keys| segmented(folder.path(), keys, level))
}

fn contexts(events: &[Value]) -> Vec<[u64; 4]> {
    events.iter().map(|event| serde_json::from_value(event["context"].clone()).unwrap()).collect()
}

fn ended_s(events: &[Value]) -> f64 {
    events.last().unwrap()["ended_s"].as_f64().unwrap()
}

/// From 0 to 1 within a second from `begin_s` on, without a jerk.
fn eased(t: f32, begin_s: f32) -> f32 {
    let part = (t - begin_s).clamp(0.0, 1.0);
    part * part * (3.0 - 2.0 * part)
}

/// The hand holds the tool at this place.
fn carried(x: f32, part: f32) -> Scene {
    (Some(x), x, part)
}

const AT_TOOL: [u64; 4] = [1, TOOL as u64, 0, 0];
const TOOL_AT_PART: [u64; 4] = [1, TOOL as u64, TOOL as u64, PART as u64];

#[test]
fn a_hand_touches_what_it_rests_at_within_hand_contact_on_m() {
    let keys = ["hand_contact_on_m = 0.06\nhand_contact_off_m = 0.06", "hand_contact_on_m = 0.03"];
    // It comes from far away and rests at 5 cm.
    let [near, far] = each_gives(keys, "iu", 4.0, |t| (Some(0.3 - 0.25 * eased(t, 0.5)), 0.0, 1.0));
    assert_eq!((contexts(&near), contexts(&far)), (vec![AT_TOOL], vec![]));
}

#[test]
fn a_hand_that_drifts_away_has_left_beyond_hand_contact_off_m() {
    let keys = ["hand_contact_off_m = 0.045", "hand_contact_off_m = 0.07"];
    // It goes at 2 cm/s, which is no leaving, from 1 s to 4 s and stays at 6 cm.
    let drift = |t: f32| (Some(0.02 * (t - 1.0).clamp(0.0, 3.0)), 0.0, 1.0);
    let [left, stays] = each_gives(keys, "iu", 6.0, drift);
    // At 3.25 s it is 4.5 cm away.
    assert!((ended_s(&left) - 3.25).abs() < 0.1, "{left:?}");
    assert!(ended_s(&stays) > 5.9, "{stays:?}");
}

#[test]
fn two_objects_touch_within_object_contact_on_m() {
    let keys = ["object_contact_on_m = 0.03", "object_contact_on_m = 0.06\nobject_contact_off_m = 0.06"];
    // The tool is carried to within 5 cm of the part.
    let [apart, together] = each_gives(keys, "iu", 4.0, |t| carried(0.25 * eased(t, 1.0), 0.3));
    assert_eq!((contexts(&apart), contexts(&together)), (vec![AT_TOOL], vec![AT_TOOL, TOOL_AT_PART]));
}

#[test]
fn two_objects_have_parted_beyond_object_contact_off_m() {
    let keys = ["object_contact_off_m = 0.045", "object_contact_off_m = 0.07"];
    // The tool is carried away from the part, to 6 cm.
    let [parted, together] = each_gives(keys, "iu", 4.0, |t| carried(0.06 * eased(t, 1.0), 0.0));
    assert_eq!((contexts(&parted), contexts(&together)), (vec![TOOL_AT_PART, AT_TOOL], vec![TOOL_AT_PART]));
}

#[test]
fn what_is_slower_than_rest_speed_m_s_has_no_motion() {
    let keys = ["rest_speed_m_s = 0.03", "rest_speed_m_s = 0.2"];
    // The tool is carried at 10 cm/s.
    let [moves, rests] = each_gives(keys, "eru", 4.0, |t| carried(0.1 * (t - 1.0).clamp(0.0, 2.0), 1.0));
    assert!(moves.len() > 1, "{moves:?}");
    assert_eq!(rests.len(), 1, "{rests:?}");
}

#[test]
fn what_accelerates_less_than_dead_band_m_s2_has_a_constant_speed() {
    let keys = ["dead_band_m_s2 = 0.25", "dead_band_m_s2 = 5"];
    // The tool is carried 30 cm within a second, which takes up to 1.8 m/s².
    let [accelerates, constant] = each_gives(keys, "eru", 4.0, |t| carried(0.3 * eased(t, 1.0), 1.0));
    // At rest, on its way, at rest.
    assert_eq!(constant.len(), 3, "{constant:?}");
    assert!(accelerates.len() > 3, "{accelerates:?}");
}

#[test]
fn a_motion_that_is_shorter_than_half_of_filter_frames_is_filtered_out() {
    let keys = ["filter_frames = 1", "filter_frames = 31"];
    // The tool is carried to and fro, 9 frames each way.
    let [all, filtered] = each_gives(keys, "eru", 4.0, |t| {
        carried(0.05 * (t * std::f32::consts::TAU * RATE_HZ / 18.0).sin(), 1.0)
    });
    assert!(all.len() > 10 && filtered.len() < all.len() / 2, "{} and {}", all.len(), filtered.len());
}

#[test]
fn a_job_ends_when_no_hand_was_seen_for_idle_end_ms_and_the_bench_was_changed() {
    let keys = ["idle_end_ms = 1000", "idle_end_ms = 4000"];
    // The hand goes from the tool and is not seen from 3 s to 7 s; meanwhile the tool is put elsewhere. Then the hand comes to it.
    let tool = |t: f32| if t < 4.0 { 0.0 } else { 0.2 };
    let hand = |t: f32| if t < 4.0 { -0.3 * eased(t, 1.0) } else { 0.2 };
    let scene = |t: f32| ((!(3.0..7.0).contains(&t)).then(|| hand(t)), tool(t), 1.0);
    let [two, one] = each_gives(keys, "job", 9.0, scene).map(|jobs| jobs.len());
    assert_eq!((two, one), (2, 1));
}

/// The lowest and the highest value of each key of `[method]`, as the reference states them.
fn limits() -> Vec<(String, [String; 2])> {
    let reference = reference();
    let method = reference.split("[method]").nth(1).unwrap().split("\n# ----").next().unwrap();
    let mut found = Vec::new();
    let mut limits = None;
    for line in method.lines() {
        if let Some((_, range)) = line.split_once(" number from ") {
            let words: Vec<&str> = range.split_whitespace().collect();
            limits = Some([words[0], words[2].trim_end_matches('.')].map(str::to_owned));
        } else if let Some((key, _)) = line.split_once(" = ").filter(|_| !line.starts_with('#')) {
            found.push((key.to_owned(), limits.take().unwrap()));
        }
    }
    found
}

/// With these every value of every other key agrees.
const OTHERS: [(&str, &str); 8] = [
    ("rate_hz", "60"),
    ("hand_contact_on_m", "0.001"),
    ("hand_contact_off_m", "0.5"),
    ("object_contact_on_m", "0.001"),
    ("object_contact_off_m", "0.5"),
    ("persist_frames", "1"),
    ("blind_ms", "400"),
    ("idle_end_ms", "600000"),
];

#[test]
fn what_the_configuration_allows_the_method_takes() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("station.toml");
    let limits = limits();
    assert_eq!(limits.len(), 12, "{limits:?}");
    for (key, value) in limits.into_iter().flat_map(|(key, values)| values.map(|value| (key.clone(), value)))
    {
        let others = OTHERS.iter().filter(|(other, _)| *other != key);
        let others: String = others.map(|(key, value)| format!("{key} = {value}\n")).collect();
        std::fs::write(&file, station(&format!("{key} = {value}\n{others}"))).unwrap();
        let method = Config::load_to_learn(&[&file]).unwrap().method();
        assert_eq!(method.check(), Ok(()), "{key} = {value}");
    }
}
