//! The short form of the measurement of shipped clips as a worse camera or a slower machine shows them.
#![allow(clippy::unwrap_used)]

use std::process::Command;

#[test]
fn no_correct_clip_is_accused_and_no_faulty_one_right_with_few_frames_noise_or_compression() {
    let cases: [(&str, &[&str]); 2] = [
        ("p2_none_r3", &["10/s", "5/s", "3/s", "noise 10", "crf 40"]),
        ("p1_J1_r1", &["7.5/s", "noise 20, smoothed"]),
    ];
    for (clip, changes) in cases {
        let mut command = Command::new(env!("CARGO_BIN_EXE_degraded_clips"));
        command.arg(format!("tests/footage/{clip}.mp4"));
        command.args(changes.iter().flat_map(|change| ["--change", change]));
        let output = command.current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).output().unwrap();
        let table = String::from_utf8_lossy(&output.stdout);
        let rows = table.lines().filter(|row| row.starts_with(clip)).count();
        assert_eq!(rows, changes.len(), "{table}{}", String::from_utf8_lossy(&output.stderr));
        assert!(output.status.success() && table.ends_with("0 wrong\n"), "{table}");
    }
}
