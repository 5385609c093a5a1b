//! The functions that the fuzzer calls, and the tests with bytes from fixed seeds. Whatever the bytes are, nothing may panic, hang or use unlimited
//! memory, and the verdicts must be consistent.
//!
//! The targets in `tests/fuzz` include this module by its path, so that they build without the rest of this crate.

mod couple_stream;
mod files;
mod ledger;

pub use couple_stream::couple_stream;
pub use files::{job_file, seal, track_file};

/// The bytes of one input, which are consumed from the front. Missing bytes are 0.
struct Input<'b>(&'b [u8]);

impl Input<'_> {
    fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        *first
    }

    /// A number below `count`.
    fn below(&mut self, count: u8) -> u8 {
        self.byte() % count
    }

    fn word(&mut self) -> u64 {
        u64::from_le_bytes(std::array::from_fn(|_| self.byte()))
    }

    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}
