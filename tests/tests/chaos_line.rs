//! The short form of `make chaos`.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::process::Command;

#[test]
fn a_line_whose_roles_are_killed_and_stopped_at_random_heals_and_accounts_for_every_verdict() {
    let report = concat!(env!("CARGO_TARGET_TMPDIR"), "/chaos.json");
    let output = Command::new(env!("CARGO_BIN_EXE_chaos")).args(["25", "7", report]).output().unwrap();
    let said =
        format!("{}\n{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{said}");
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap();
    assert!(report["kills"].as_u64().unwrap() >= 25, "{report}");
    assert_eq!(report["ready_drops_seen"], report["disturbances"], "{report}");
}
