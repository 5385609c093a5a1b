//! Tests that need more than one crate, and their equipment.
//!
//! # Where a new test goes
//!
//! A test goes to the lowest place at which what it tests can be seen:
//!
//! | what it tests | where it goes |
//! |---|---|
//! | one module | `mod tests` in that file, or `tests.rs` beside it when it is long |
//! | the public interface of one crate | `tests/` of that crate |
//! | several crates in one process, without roles | `tests/tests/core_*`, `learn_*`: named after the crate that does the work |
//! | the channels, between processes of `ipc_peer` | `tests/tests/ipc_*` |
//! | the real roles as processes, or a command that needs a station | `tests/tests/line_*`, on the equipment of [`line`] |
//! | the repository itself: manifests, units | `tests/tests`, named after what is tested |
//! | the installed package on a bare machine | `tests/nspawn/checks.py` |
//!
//! What takes minutes, or ends in figures instead of a yes or no, is a program in `tests/src/bin` with a target in the `Makefile`. If it
//! can also fail, it has a short form in `tests/tests`, which every `cargo test` runs.
//!
//! The name of a test is the sentence that holds. No test asserts how long something takes: a wait that ends in a
//! panic is longer than any machine needs.
//!
//! # Tests that work by chance
//!
//! What may differ from one draw to another is a rate, and its test a bar under it, see [`rate`]. The draw is that of [`environment::seed`], another
//! one in each run of `make test`, which prints it: `ANDON_SEED=n PROPTEST_RNG_SEED=n make test` repeats it. What must never be, such as an
//! accusation for what was not seen, is tried with a known seed and the drawn one. It fails with the first case of either. Such a failure is a fault
//! to be mended, also where an older version has it; it is no reason to draw again.
#![forbid(unsafe_code)]

pub mod browser;
pub mod deletion;
pub mod environment;
pub mod fuzz;
pub mod line;
pub mod measure;
pub mod python;
pub mod shim;
pub mod simulator;
pub mod station;
pub mod workers;

pub use andon_rate as rate;
