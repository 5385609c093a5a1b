//! Processors without a SIMD path.

use crate::couple::Motion;
use crate::dtw::row::Row;
use crate::dtw::symbols::{Symbols, Tables};

/// Uninhabited: this target has no SIMD path.
#[derive(Clone, Debug)]
pub(crate) enum Simd {}

impl Simd {
    pub(crate) fn new(_: &Tables) -> Option<Self> {
        None
    }

    pub(crate) fn advance(&self, _: &Tables, _: &Motion, _: &Symbols, _: usize, _: &mut Row) -> Option<i32> {
        match *self {}
    }
}
