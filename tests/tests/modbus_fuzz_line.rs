//! The short form of `make modbus-fuzz`.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::process::Command;

#[test]
fn random_bytes_at_the_modbus_side_are_counted_and_harm_neither_it_nor_a_good_client() {
    let report = concat!(env!("CARGO_TARGET_TMPDIR"), "/modbus_fuzz.json");
    let output = Command::new(env!("CARGO_BIN_EXE_modbus_fuzz")).args(["5", "3", report]).output().unwrap();
    let said =
        format!("{}\n{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{said}");
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap();
    assert!(report["frames"].as_u64().unwrap() >= 1000, "{report}");
    assert!(report["refused_and_counted"].as_u64().unwrap() >= 100, "{report}");
    assert_eq!(report["good_requests_not_served"], 0, "{report}");
}
