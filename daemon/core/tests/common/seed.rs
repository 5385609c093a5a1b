//! The seeds of properties that must never fail: one that has always been tried, and a drawn one.

use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestRunner};
use std::collections::hash_map::RandomState;
use std::hash::BuildHasher;

/// The seed that has always been tried.
const KNOWN: u64 = 1;

/// Drawn seeds are less than this, so that people can type them.
const SEEDS: u64 = 100_000;

/// Tries the property so often with [`KNOWN`] and so often with a drawn seed, and panics with the seed of the first failure.
/// `PROPTEST_RNG_SEED` and `PROPTEST_CASES` choose other numbers.
pub(crate) fn with_known_and_drawn_seed<S: Strategy>(
    cases: u32,
    strategy: &S,
    property: impl Fn(S::Value) -> Result<(), TestCaseError>,
) {
    let usual = ProptestConfig::default();
    let drawn = match usual.rng_seed {
        RngSeed::Fixed(chosen) => chosen,
        RngSeed::Random => RandomState::new().hash_one(0) % SEEDS,
    };
    let cases = if std::env::var_os("PROPTEST_CASES").is_some() { usual.cases } else { cases };
    for seed in [KNOWN, drawn] {
        let rng_seed = RngSeed::Fixed(seed);
        let config = ProptestConfig { failure_persistence: None, rng_seed, cases, ..usual.clone() };
        if let Err(failed) = TestRunner::new(config).run(strategy, &property) {
            panic!("PROPTEST_RNG_SEED={seed}: {failed}");
        }
    }
}
