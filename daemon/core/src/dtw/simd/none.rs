//! Processors without a SIMD path.

use super::Border;
use crate::couple::Motion;
use crate::dtw::row::Row;
use crate::dtw::symbols::{Content, Order, Symbols, Tables};

/// Uninhabited: this target has no SIMD path.
#[derive(Clone, Debug)]
pub(crate) enum Simd {}

impl Simd {
    pub(crate) fn new(_: &Tables) -> Option<Self> {
        None
    }

    pub(crate) fn read(&self, _: &Tables, _: &[Motion], _: Order, _: &mut Symbols) -> Content {
        match *self {}
    }

    pub(crate) fn advance(&self, _: &Tables, _: &Motion, _: &Symbols, _: usize, _: &mut Row) -> Option<i32> {
        match *self {}
    }

    pub(crate) fn last_cell(
        &self,
        _: (&Symbols, usize),
        _: (&Symbols, usize),
        _: i32,
        _: &mut Border,
    ) -> Option<i32> {
        match *self {}
    }
}
