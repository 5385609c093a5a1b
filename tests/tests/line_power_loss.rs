//! The short form of `make power-loss`.
#![allow(clippy::unwrap_used)]

use andon_tests::environment;
use andon_tests::measure::short_form;

#[test]
fn what_was_confirmed_is_there_after_a_loss_of_power_at_any_moment() {
    let path = concat!(env!("CARGO_TARGET_TMPDIR"), "/power_loss.json");
    let seed = environment::seed().to_string();
    let report = short_form(env!("CARGO_BIN_EXE_power_loss"), &["25", &seed, path]);
    let count = |key: &str| report[key].as_u64().unwrap();
    assert!(count("sectors_lost") > 0 && count("acknowledgements_confirmed") > 0, "{report}");
}
