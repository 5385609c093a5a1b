//! The short form of `make soak`.
#![allow(clippy::unwrap_used)]

use andon_tests::measure::short_form;

#[test]
fn a_line_at_full_speed_keeps_its_memory_and_journals_every_verdict() {
    let path = concat!(env!("CARGO_TARGET_TMPDIR"), "/soak.json");
    let report = short_form(env!("CARGO_BIN_EXE_soak"), &["30000", path]);
    assert!(report["frames"].as_u64().unwrap() >= 30_000, "{report}");
    assert_eq!(report["verdicts_sent"], report["journal_rows"], "{report}");
}
