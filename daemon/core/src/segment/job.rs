//! The segmentation of both hands, and the job that they share.

use super::{Event, Segmenter};
use crate::capacity::HANDS;
use crate::config::{Method, MethodFault};
use crate::couple::Couples;
use crate::input::Side;

/// Segments the couples of both hands.
#[derive(Clone, Debug)]
pub struct JobSegmenter {
    hands: [Segmenter; HANDS],
}

impl JobSegmenter {
    /// Starts idle.
    ///
    /// # Errors
    /// If a constant is out of its range.
    pub fn new(method: &Method) -> Result<Self, MethodFault> {
        Ok(Self { hands: [Segmenter::new(Side::Right, method)?, Segmenter::new(Side::Left, method)?] })
    }

    /// Takes the next couples.
    pub fn step(&mut self, couples: &Couples, emit: &mut impl FnMut(Event)) {
        for (hand, couple) in self.hands.iter_mut().zip(&couples.hands) {
            hand.step(couple, emit);
        }
    }

    /// Ends the job by command, or at the end of a recording, at the newest couples.
    pub fn finish(&mut self, emit: &mut impl FnMut(Event)) {
        let _ = emit;
    }
}
