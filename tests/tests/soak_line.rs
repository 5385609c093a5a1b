//! The short form of `make soak`.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::process::Command;

#[test]
fn a_line_at_full_speed_keeps_its_memory_and_journals_every_verdict() {
    let report = concat!(env!("CARGO_TARGET_TMPDIR"), "/soak.json");
    let output = Command::new(env!("CARGO_BIN_EXE_soak")).args(["30000", report]).output().unwrap();
    let said =
        format!("{}\n{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{said}");
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap();
    assert!(report["frames"].as_u64().unwrap() >= 30_000, "{report}");
    assert_eq!(report["verdicts_sent"], report["journal_rows"], "{report}");
}
