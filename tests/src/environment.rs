//! What a test takes from the environment: a test runs in its short form unless it is told otherwise.
//!
//! A test that works by chance asks for [`seed`], which another run draws anew; `tests/setup/side_by_side.py`, and so `make test`, draws one for
//! all its programs. What must never be, and not only seldom, is tried with [`known_and_drawn`] seeds.

use std::cell::Cell;
use std::collections::hash_map::RandomState;
use std::hash::BuildHasher;
use std::sync::OnceLock;

/// Drawn seeds are less than this, so that people can type them.
const SEEDS: u64 = 100_000;

/// The number in this variable, or the default.
///
/// # Panics
/// If it is not a number.
pub fn number(name: &str, default: u64) -> u64 {
    number_in(name).unwrap_or(default)
}

fn number_in(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|value| value.parse().expect("a number"))
}

/// The seed in `ANDON_SEED`, or else one that is drawn once for this process. A test that fails says it.
///
/// # Panics
/// If it is not a number.
pub fn seed() -> u64 {
    static SEED: OnceLock<u64> = OnceLock::new();
    thread_local!(static IS_SAID: Cell<bool> = const { Cell::new(false) });
    let seed = *SEED.get_or_init(|| number_in("ANDON_SEED").unwrap_or_else(drawn));
    // Each test has a thread of its own, and what it prints is shown if it fails.
    if !IS_SAID.replace(true) {
        println!("ANDON_SEED={seed} repeats this draw");
    }
    seed
}

/// A seed that has always been tried, and the drawn one.
///
/// The first one tells whether a change has broken what held before. The second one finds what no run has tried yet. Its failure is a fault as well,
/// and `ANDON_SEED` shows whether it is an old one.
pub fn known_and_drawn(known: u64) -> [u64; 2] {
    [known, seed()]
}

/// One in this many, from a drawn one on: a case that takes minutes is tried by one run in turn. `ANDON_EVERY=1` tries all.
pub fn one_in<T>(default: u64, all: Vec<T>) -> Vec<T> {
    let [every, skipped] = turn(default);
    all.into_iter().skip(skipped as usize).step_by(every as usize).collect()
}

/// As [`one_in`]: which share is tried, one in how many, and how many come before the first.
pub fn turn(default: u64) -> [u64; 2] {
    let every = number("ANDON_EVERY", default).max(1);
    [every, seed() % every]
}

/// A number that no one has chosen.
fn drawn() -> u64 {
    RandomState::new().hash_one(std::process::id()) % SEEDS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_tests_of_a_process_have_one_seed() {
        let seeds: Vec<u64> = (0..4).map(|_| std::thread::spawn(seed).join().expect("no panic")).collect();
        assert_eq!(seeds, [seed(); 4]);
        assert_eq!(known_and_drawn(71), [71, seed()]);
    }

    #[test]
    fn each_is_tried_by_one_draw_in_as_many() {
        let first = seed() % 3;
        assert_eq!(one_in(3, (0..7).collect()), (0..7).filter(|each| each % 3 == first).collect::<Vec<_>>());
    }

    #[test]
    fn other_processes_draw_other_seeds() {
        let drawn: std::collections::BTreeSet<u64> = (0..20).map(|_| drawn()).collect();
        assert!(drawn.len() > 15 && drawn.iter().all(|seed| *seed < SEEDS), "{drawn:?}");
    }
}
