//! How many cases a property is tried with, and with which seed.

use proptest::prelude::ProptestConfig;
use proptest::test_runner::RngSeed;

/// The seed that has always been tried.
pub(crate) const KNOWN: u64 = 1;

/// As many cases of this seed; `PROPTEST_CASES` chooses another number.
pub(crate) fn with(cases: u32, seed: u64) -> ProptestConfig {
    let usual = ProptestConfig::default();
    let cases = if std::env::var_os("PROPTEST_CASES").is_some() { usual.cases } else { cases };
    ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(seed), cases, ..usual }
}

/// The seed that `PROPTEST_RNG_SEED` chooses.
pub(crate) fn chosen_seed() -> Option<u64> {
    match ProptestConfig::default().rng_seed {
        RngSeed::Fixed(chosen) => Some(chosen),
        RngSeed::Random => None,
    }
}

/// The suite has a seed of its own, so that it fails or passes always; `PROPTEST_RNG_SEED` and `PROPTEST_CASES` try others and more.
pub(crate) fn many_cases() -> ProptestConfig {
    with(10_000, chosen_seed().unwrap_or(KNOWN))
}
