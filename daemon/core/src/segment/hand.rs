//! The segmentation of one hand.

use super::Event;
use crate::config::{Method, MethodFault};
use crate::couple::{Context, Couple};
use crate::input::Side;

/// Segments the couples of one hand.
#[derive(Clone, Debug)]
pub struct Segmenter {
    side: Side,
}

impl Segmenter {
    /// Starts idle.
    ///
    /// # Errors
    /// If a constant is out of its range.
    pub fn new(side: Side, method: &Method) -> Result<Self, MethodFault> {
        method.check()?;
        Ok(Self { side })
    }

    /// Takes the next couple of this hand.
    pub fn step(&mut self, couple: &Couple, emit: &mut impl FnMut(Event)) {
        let _ = (couple, emit, self.side);
    }

    /// The activity has matched a nominal one to its end: its first object touched again begins a new one, unless in one of
    /// the contexts that it `goes_on_with`.
    pub fn activity_matched(&mut self, goes_on_with: &[Context]) {
        let _ = goes_on_with;
    }

    /// Ends what is open at `ended_ns`.
    pub fn finish(&mut self, ended_ns: u64, emit: &mut impl FnMut(Event)) {
        let _ = (ended_ns, emit);
    }
}
