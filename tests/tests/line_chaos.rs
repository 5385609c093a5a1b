//! The short form of `make chaos`.
#![allow(clippy::unwrap_used)]

use andon_tests::environment;
use andon_tests::measure::short_form;

#[test]
fn a_line_whose_roles_are_killed_and_stopped_at_random_heals_and_accounts_for_every_verdict() {
    let path = concat!(env!("CARGO_TARGET_TMPDIR"), "/chaos.json");
    let seed = environment::seed().to_string();
    let report = short_form(env!("CARGO_BIN_EXE_chaos"), &["25", &seed, path]);
    assert!(report["kills"].as_u64().unwrap() >= 25, "{report}");
    assert_eq!(report["ready_drops_seen"], report["disturbances"], "{report}");
    let jobs = |outcome: &str| report["verdicts"]["jobs"][outcome].as_u64().unwrap();
    assert!(jobs("ok") >= 1 && jobs("anomaly") >= 1, "{report}");
}
