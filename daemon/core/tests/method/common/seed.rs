//! The seeds of properties that must never fail: one that has always been tried, and a drawn one.

use super::cases::{self, KNOWN};
use andon_rate::Rate;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use std::collections::hash_map::RandomState;
use std::hash::BuildHasher;
use std::ops::Range;

/// Drawn seeds are less than this, so that people can type them.
const SEEDS: u64 = 100_000;

/// The seed that `PROPTEST_RNG_SEED` chooses, or else a drawn one.
pub(crate) fn drawn() -> u64 {
    cases::chosen_seed().unwrap_or_else(|| RandomState::new().hash_one(0) % SEEDS)
}

/// As many seeds for what may differ from one draw to another. `PROPTEST_RNG_SEED` chooses where they begin.
pub(crate) fn drawn_seeds(count: u32) -> Range<u32> {
    let seed = drawn();
    println!("PROPTEST_RNG_SEED={seed} repeats this draw");
    // Two seeds have none in common.
    let first = (seed % SEEDS) as u32 * count;
    first..first + count
}

/// The seeds of what must never be: as many that have always been tried, and as many drawn ones.
pub(crate) fn known_and_drawn_seeds(count: u32) -> impl Iterator<Item = u32> {
    (0..count).chain(drawn_seeds(count))
}

/// Tries the property so often with [`KNOWN`] and so often with a drawn seed, and panics with the seed of the first failure.
/// `PROPTEST_RNG_SEED` and `PROPTEST_CASES` choose other numbers.
pub(crate) fn with_known_and_drawn_seed<S: Strategy>(
    cases: u32,
    strategy: &S,
    property: impl Fn(S::Value) -> Result<(), TestCaseError>,
) {
    for seed in [KNOWN, drawn()] {
        if let Err(failed) = TestRunner::new(cases::with(cases, seed)).run(strategy, &property) {
            panic!("PROPTEST_RNG_SEED={seed}: {failed}");
        }
    }
}

/// What is wrong of the cases of a seed, as [`wrong_cases`] says it, is never so of the known seed, and of a drawn one with no more than this share.
pub(crate) fn hardly_ever(rate: f64, what: &str, wrong: impl Fn(u64) -> (Vec<String>, usize)) {
    let (of_known, _) = wrong(KNOWN);
    assert!(of_known.is_empty(), "{of_known:#?}");
    let seed = drawn();
    let (of_drawn, cases) = wrong(seed);
    println!("PROPTEST_RNG_SEED={seed} repeats this draw: {of_drawn:#?}");
    Rate::new(of_drawn.len(), cases).expect_at_most(rate, what);
}

/// What is said of the cases of this seed that are wrong, of as many cases, and their number.
pub(crate) fn wrong_cases<S: Strategy>(
    cases: u32,
    seed: u64,
    strategy: &S,
    wrong: impl Fn(S::Value) -> Option<String>,
) -> (Vec<String>, usize) {
    let config = cases::with(cases, seed);
    let cases = config.cases as usize;
    let mut runner = TestRunner::new(config);
    let next = || strategy.new_tree(&mut runner).unwrap().current();
    (std::iter::repeat_with(next).take(cases).filter_map(wrong).collect(), cases)
}
