//! The short form of the measurement of perception's accuracy.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::environment;
use std::process::Command;

/// The table that `perception_accuracy detected` prints, line by line.
fn table(arguments: &[&str]) -> Vec<String> {
    rows("detected", arguments)
}

/// What a subcommand of `perception_accuracy` prints, line by line.
fn rows(subcommand: &str, arguments: &[&str]) -> Vec<String> {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let output = Command::new(env!("CARGO_BIN_EXE_perception_accuracy"))
        .arg(subcommand)
        .args(arguments)
        .current_dir(root)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect()
}

/// The shares of the frames in which the hand was found, and of the visible markers that were, in percent.
fn found(row: &str) -> [f64; 2] {
    let cells: Vec<&str> = row.split_whitespace().collect();
    [2, 10].map(|column| cells[column].trim_end_matches('%').parse().unwrap())
}

#[test]
fn a_clip_is_measured_and_its_hand_and_markers_are_found() {
    let table = table(&["--every", "15", "tests/footage/p1_J1_r1.mp4"]);
    let [titles, clip, all] = &table[..] else { panic!("{table:?}") };
    assert!(titles.trim_start().starts_with("clip"), "{table:?}");
    let cells: Vec<&str> = clip.split_whitespace().collect();
    assert_eq!(cells[..2], ["p1_J1_r1", "25"], "{table:?}");
    let [hand, markers] = found(clip);
    // Every 15th frame comes after a gap, so palm detection finds the hand again in each of them.
    assert!(hand > 80.0, "hand: {table:?}");
    assert!(markers > 95.0, "markers: {table:?}");
    assert_eq!(&clip.replacen("p1_J1_r1", "     all", 1), all, "{table:?}");
}

/// What was done to the picture, what should be said of it within two seconds, and what was said. A draw tries one in three of what can be done.
#[test]
fn the_line_says_what_it_cannot_see_and_cries_no_wolf() {
    let [every, skip] = environment::turn(3).map(|number| number.to_string());
    let table = rows("sight", &["--every", &every, "--skip", &skip, "tests/footage/p2_none_r1.mp4"]);
    let (summary, rows) = table.split_last().unwrap();
    let troubles = |row: &&String| !row.contains("| nothing | nothing |");
    assert!(rows.iter().filter(troubles).count() >= 5, "{table:#?}");
    assert!(summary.starts_with("0 of "), "{table:#?}");
}

/// Every second frame of a clip of each person. A hand counts as found where its landmarks lie on the true ones, in the frames that
/// truly show most of a hand.
#[test]
fn hand_and_markers_are_found_in_noise_and_in_the_dark() {
    for (filter, min_hand) in [
        ("noise=alls=10:allf=t", 98.0),
        ("noise=alls=20:allf=t", 95.0),
        ("eq=brightness=-0.25", 95.0),
        ("eq=gamma=0.4", 95.0),
    ] {
        let clips = ["tests/footage/p1_J1_r1.mp4", "tests/footage/p2_J1_r1.mp4"];
        let table = table(&["--every", "2", "--filter", filter, clips[0], clips[1]]);
        let [hand, markers] = found(table.last().unwrap());
        assert!(hand >= min_hand, "{filter}: hand: {table:#?}");
        assert!(markers >= 97.0, "{filter}: markers: {table:#?}");
    }
}
