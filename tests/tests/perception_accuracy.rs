//! The short form of the measurement of perception's accuracy.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::process::Command;

#[test]
fn a_clip_is_measured_and_its_hand_and_markers_are_found() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let output = Command::new(env!("CARGO_BIN_EXE_perception_accuracy"))
        .args(["detected", "--every", "15", "tests/footage/p1_J1_r1.mp4"])
        .current_dir(root)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let table = String::from_utf8(output.stdout).unwrap();
    let [titles, clip, all] = table.lines().collect::<Vec<_>>()[..] else { panic!("{table}") };
    assert!(titles.trim_start().starts_with("clip"), "{table}");
    let cells: Vec<&str> = clip.split_whitespace().collect();
    assert_eq!(cells[..2], ["p1_J1_r1", "25"], "{table}");
    let share = |column: usize| cells[column].trim_end_matches('%').parse::<f64>().unwrap();
    // Every 15th frame comes after a gap, so palm detection finds the hand again in each of them.
    assert!(share(2) > 80.0, "hand: {table}");
    assert!(share(10) > 95.0, "markers: {table}");
    assert_eq!(clip.replacen("p1_J1_r1", "     all", 1), all, "{table}");
}
