//! The seeds of properties that must never fail: one that has always been tried, and a drawn one.

use super::cases::{self, KNOWN};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use std::collections::hash_map::RandomState;
use std::hash::BuildHasher;

/// Drawn seeds are less than this, so that people can type them.
const SEEDS: u64 = 100_000;

/// Tries the property so often with [`KNOWN`] and so often with a drawn seed, and panics with the seed of the first failure.
/// `PROPTEST_RNG_SEED` and `PROPTEST_CASES` choose other numbers.
pub(crate) fn with_known_and_drawn_seed<S: Strategy>(
    cases: u32,
    strategy: &S,
    property: impl Fn(S::Value) -> Result<(), TestCaseError>,
) {
    let drawn = cases::chosen_seed().unwrap_or_else(|| RandomState::new().hash_one(0) % SEEDS);
    for seed in [KNOWN, drawn] {
        if let Err(failed) = TestRunner::new(cases::with(cases, seed)).run(strategy, &property) {
            panic!("PROPTEST_RNG_SEED={seed}: {failed}");
        }
    }
}
