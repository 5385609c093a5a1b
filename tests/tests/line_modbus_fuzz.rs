//! The short form of `make modbus-fuzz`.
#![allow(clippy::unwrap_used)]

use andon_tests::environment;
use andon_tests::measure::short_form;

#[test]
fn random_bytes_at_the_modbus_side_are_counted_and_harm_neither_it_nor_a_good_client() {
    let path = concat!(env!("CARGO_TARGET_TMPDIR"), "/modbus_fuzz.json");
    let seed = environment::seed().to_string();
    let report = short_form(env!("CARGO_BIN_EXE_modbus_fuzz"), &["5", &seed, path]);
    assert!(report["frames"].as_u64().unwrap() >= 1000, "{report}");
    assert!(report["refused_and_counted"].as_u64().unwrap() >= 100, "{report}");
    assert_eq!(report["good_requests_not_served"], 0, "{report}");
}
