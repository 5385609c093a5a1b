//! How many cases a property of the whole method is tried with.

use proptest::prelude::ProptestConfig;
use proptest::test_runner::RngSeed;

/// The suite has a seed of its own, so that it fails or passes always; `PROPTEST_RNG_SEED` and `PROPTEST_CASES` try others and more.
pub(crate) fn many_cases() -> ProptestConfig {
    let (default, failure_persistence) = (ProptestConfig::default(), None);
    let rng_seed = match default.rng_seed {
        RngSeed::Random => RngSeed::Fixed(1),
        chosen => chosen,
    };
    let cases = if std::env::var_os("PROPTEST_CASES").is_some() { default.cases } else { 10_000 };
    ProptestConfig { failure_persistence, rng_seed, cases, ..default }
}
