//! Frames in, feature couples out, on the grid of `rate_hz` and `persist_frames` late.

use super::Couples;
use super::grid::{Grid, Place};
use super::scene::Scene;
use crate::capacity::OBJECTS;
use crate::config::{Method, MethodFault};
use crate::input::{Frame, ObjectShape};

/// Why an encoder cannot be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unusable {
    /// A constant is out of its range.
    Method(MethodFault),
    /// More objects than [`OBJECTS`].
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

impl core::fmt::Display for Unusable {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Method(fault) => fault.fmt(f),
            Self::TooManyObjects { given } => {
                write!(
                    f,
                    "{given} objects are more than the {OBJECTS} of one bench: leave out what no hand touches"
                )
            }
            Self::DoubledObject { id } => {
                write!(f, "object id {id} is there twice: give every object its own")
            }
            Self::ObjectShape { id } => {
                write!(
                    f,
                    "object {id} needs an id from 1 and at least one interaction point in finite metres"
                )
            }
        }
    }
}

impl core::error::Error for Unusable {}

/// Why a frame was refused. It has been counted, and changed nothing else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refused {
    /// Its time is that of the newest frame.
    Repeated,
    /// It is older than the newest frame.
    Late,
}

impl core::fmt::Display for Refused {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Repeated => {
                "the frame has the time of the one before: frames must come with times that increase"
            }
            Self::Late => {
                "the frame is older than the one before: frames must come in the order of their times"
            }
        })
    }
}

impl core::error::Error for Refused {}

/// What has happened to the frames so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Frames that were taken onto the grid.
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

/// Makes the couples of both hands from frames.
///
/// The couple of a frame is emitted when the frame `persist_frames` later is known. By then a contact that began in it has held long
/// enough to be believed, and velocity and acceleration come from a window that is centred on it: contacts
/// and motion lie at their true time, without phase lag, for one stated delay.
///
/// What is not seen is held at its last pose; a hidden object that a hand holds moves with the hand. Once a hand, or an object,
/// has been out of sight for longer than `blind_ms`, the couples whose context rests on it are not `sighted`, it
/// begins no new contact, and the contacts of a hand end `persist_frames` later.
///
/// Frames that are missing on the grid are filled by holding. Of a gap longer than `blind_ms` only that much and one frame is
/// filled, so that what was going on ends with a couple that is not sighted; then the encoder starts anew after the gap. One
/// step thus emits at most `blind_ms * rate_hz + persist_frames + 2` couples.
#[derive(Clone, Debug)]
pub struct Encoder {
    grid: Grid,
    scene: Scene,
    /// `persist_frames`.
    delay: usize,
    /// Newest frames of the grid whose couples have not been emitted, at most `delay`.
    pending: usize,
    counts: Counts,
}

impl Encoder {
    /// Starts before the first frame.
    ///
    /// # Errors
    /// If a constant or a shape cannot be used.
    pub fn new(method: Method, shapes: &[ObjectShape]) -> Result<Self, Unusable> {
        method.check().map_err(Unusable::Method)?;
        if shapes.len() > OBJECTS {
            return Err(Unusable::TooManyObjects { given: shapes.len() });
        }
        for (place, shape) in shapes.iter().enumerate() {
            let id = shape.id;
            let points = &shape.interaction_points;
            if id == 0 || points.is_empty() || !points.iter().flatten().all(|value| value.is_finite()) {
                return Err(Unusable::ObjectShape { id });
            }
            if shapes[..place].iter().any(|other| other.id == id) {
                return Err(Unusable::DoubledObject { id });
            }
        }
        Ok(Self {
            grid: Grid::new(method.rate_hz),
            scene: Scene::new(method, shapes),
            delay: method.persist_frames.into(),
            pending: 0,
            counts: Counts::default(),
        })
    }

    /// Takes one frame and emits the couples that it makes known: none, one, or several where frames were missing.
    ///
    /// # Errors
    /// If the frame is late or repeated.
    pub fn step(&mut self, frame: &Frame, emit: &mut impl FnMut(Couples)) -> Result<(), Refused> {
        let known_ns = frame.captured_ns;
        let place = self.grid.place(known_ns).inspect_err(|refused| match refused {
            Refused::Repeated => self.counts.repeated += 1,
            Refused::Late => self.counts.late += 1,
        })?;
        match place {
            Place::Surplus => {
                self.counts.surplus += 1;
                return Ok(());
            }
            Place::First => {}
            Place::Steps(steps) => self.fill(steps, known_ns, emit),
        }
        self.counts.taken += 1;
        self.push(known_ns, Some(frame), known_ns, emit);
        Ok(())
    }

    /// The recording has ended: emits the couples that are still delayed. A frame after it starts anew.
    pub fn flush(&mut self, emit: &mut impl FnMut(Couples)) {
        self.drain(self.scene.newest_ns(), emit);
        self.grid.clear();
    }

    /// What has happened to the frames so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Fills the frames that are missing before the one that is `steps` after the newest.
    fn fill(&mut self, steps: u64, next_ns: u64, emit: &mut impl FnMut(Couples)) {
        let most = u64::from(self.scene.blind_frames()) + 1;
        let missing = steps - 1;
        let before_ns = self.scene.newest_ns();
        let apart = u128::from(next_ns - before_ns);
        for frame in 1..=missing.min(most) {
            // Never past the next frame, whatever the jitter: less than `apart`, so it fits.
            let even = (apart * u128::from(frame) / u128::from(steps)) as u64;
            let captured_ns = before_ns + even.min(frame * self.grid.period_ns());
            self.counts.held += 1;
            self.push(captured_ns, None, next_ns, emit);
        }
        if missing >= most {
            self.counts.gaps += 1;
            self.drain(next_ns, emit);
            self.grid.anchor(next_ns);
        }
    }

    fn push(
        &mut self,
        captured_ns: u64,
        frame: Option<&Frame>,
        known_ns: u64,
        emit: &mut impl FnMut(Couples),
    ) {
        self.counts.left_out += self.scene.push(captured_ns, frame);
        self.pending += 1;
        if self.pending > self.delay {
            self.emit_oldest(known_ns, emit);
        }
    }

    /// Emits what is delayed, and forgets all that was seen.
    fn drain(&mut self, known_ns: u64, emit: &mut impl FnMut(Couples)) {
        while self.pending > 0 {
            self.emit_oldest(known_ns, emit);
        }
        self.scene.clear();
    }

    fn emit_oldest(&mut self, known_ns: u64, emit: &mut impl FnMut(Couples)) {
        self.pending -= 1;
        let hands = self.scene.couples(self.pending);
        emit(Couples { captured_ns: hands[0].captured_ns, known_ns, hands });
    }
}
