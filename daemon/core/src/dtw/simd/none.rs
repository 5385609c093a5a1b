//! Processors without a SIMD path.

use crate::couple::Motion;
use crate::dtw::cost::IntegerCosts;
use crate::dtw::row::Row;
use crate::dtw::symbols::Symbols;

/// Uninhabited: this target has no SIMD path.
#[derive(Clone, Debug)]
pub(crate) enum Simd {}

impl Simd {
    pub(crate) fn new(_: &IntegerCosts) -> Option<Self> {
        None
    }

    pub(crate) fn read(&self, _: &[Motion], _: &mut Symbols) {
        match *self {}
    }

    pub(crate) fn advance(&self, _: &Motion, _: &Symbols, _: &mut Row) -> Option<i32> {
        match *self {}
    }
}
