//! Frames in, feature couples out, on the grid of `rate_hz` and `persist_frames` late.

use super::Couples;
use super::grid::Grid;
use super::scene::Scene;
use crate::capacity::OBJECTS;
use crate::config::{Method, MethodFault};
use crate::input::Frame;
use crate::object::ObjectShape;

/// Why an encoder cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unusable {
    /// A constant is out of its range.
    #[error(transparent)]
    Method(MethodFault),
    /// More objects than [`OBJECTS`].
    #[error(
        "{given} objects are more than the {OBJECTS} that one bench may have: leave out those that no hand touches"
    )]
    TooManyObjects {
        /// Shapes given.
        given: usize,
    },
    /// Two shapes have the same id.
    #[error("object id {id} is used twice: give every object an id of its own")]
    DuplicateObject {
        /// The id.
        id: u16,
    },
    /// A shape has id 0, no interaction point, or a point or distance that is not finite.
    #[error(
        "object {id} needs an id of at least 1 and at least one interaction point, and all its points and distances in \
         finite metres"
    )]
    ObjectShape {
        /// The id.
        id: u16,
    },
}

/// Why a frame was refused. A refused frame has changed nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    /// Its time is that of the newest frame.
    #[error("the frame has the same time as the one before: the times of frames must increase")]
    Repeated,
    /// It is older than the newest frame.
    #[error("the frame is older than the one before: frames must come in the order of their times")]
    Late,
}

/// Makes the couples of both hands from frames.
///
/// The couple of a frame is emitted once the frame `persist_frames` later is known. By then a contact that began in it has lasted long enough to be
/// believed. Velocity and acceleration come from a window centred on it. So contacts and motion have their true time, without phase lag.
///
/// Not seen is not known. While a hand or an object is not seen, its contacts neither begin nor end, and its motion is unknown. Each couple says what
/// was seen, assumed and unseen, and whether so little was seen that its context is doubtful.
///
/// Frames that are missing on the grid, or in which nobody was watching ([`Frame::is_unseen`]), are filled with frames in which nothing was seen. Of a
/// longer gap only `blind_ms` and one frame more are filled: one step emits at most `blind_ms * rate_hz + persist_frames + 2` couples.
///
/// A hand or an object is left out if it repeats one of its frame. So is one with an unknown id or a coordinate that is not finite.
#[derive(Clone, Debug)]
pub struct Encoder {
    grid: Grid,
    scene: Scene,
    /// `persist_frames`.
    delay: usize,
    /// How many of the newest frames of the grid wait for their couples to be emitted, at most `delay`.
    pending: usize,
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
        for (index, shape) in shapes.iter().enumerate() {
            let id = shape.id;
            let points = shape
                .interaction_points
                .iter()
                .chain(shape.contact_regions.iter().flat_map(|met| &met.points));
            let is_finite = points.flatten().all(|value| value.is_finite());
            let is_near = shape.contact_regions.iter().all(|met| met.contact.is_valid());
            let is_placed = shape.start.is_none_or(|start| start.is_valid());
            if id == 0 || shape.interaction_points.is_empty() || !is_finite || !is_near || !is_placed {
                return Err(Unusable::ObjectShape { id });
            }
            if shapes[..index].iter().any(|other| other.id == id) {
                return Err(Unusable::DuplicateObject { id });
            }
        }
        Ok(Self {
            grid: Grid::new(method.period_ns()),
            scene: Scene::new(method, shapes),
            delay: method.persist_frames.into(),
            pending: 0,
        })
    }

    /// Takes one frame and emits the couples that it completes: none, one, or several where frames were missing.
    ///
    /// # Errors
    /// If the frame is late or repeated.
    pub fn step(&mut self, frame: &Frame, emit: &mut impl FnMut(Couples)) -> Result<(), Refused> {
        let known_ns = frame.captured_ns;
        let steps = self.grid.step(known_ns)?;
        if steps > 0 {
            self.fill(steps, known_ns, emit);
            self.push(known_ns, Some(frame).filter(|frame| !frame.is_unseen), known_ns, emit);
        }
        Ok(())
    }

    /// Whether the newest frame that was taken calls each hand by the name of the other one, as a tracker does for some frames.
    pub fn are_hands_swapped(&self) -> bool {
        self.scene.are_hands_swapped()
    }

    /// Ends the recording: emits the couples that are still delayed. The next frame starts a new recording.
    pub fn flush(&mut self, emit: &mut impl FnMut(Couples)) {
        let known_ns = self.scene.newest_ns();
        while self.pending > 0 {
            self.emit_oldest(known_ns, emit);
        }
        self.scene.clear();
        self.grid.clear();
    }

    /// Fills the frames that are missing before the one that is `steps` after the newest.
    fn fill(&mut self, steps: u64, next_ns: u64, emit: &mut impl FnMut(Couples)) {
        let max = u64::from(self.scene.blind_frames) + 1;
        let missing = steps - 1;
        let before_ns = self.scene.newest_ns();
        let apart = u128::from(next_ns - before_ns);
        for frame in 1..=missing.min(max) {
            // Never past the next frame, whatever the jitter: less than `apart`, so it fits.
            let even = (apart * u128::from(frame) / u128::from(steps)) as u64;
            let captured_ns = before_ns + even.min(frame * self.grid.period_ns());
            self.push(captured_ns, None, next_ns, emit);
        }
        if missing >= max {
            self.grid.anchor(next_ns);
        }
    }

    fn push(&mut self, at_ns: u64, frame: Option<&Frame>, known_ns: u64, emit: &mut impl FnMut(Couples)) {
        self.scene.push(at_ns, frame);
        self.pending += 1;
        if self.pending > self.delay {
            self.emit_oldest(known_ns, emit);
        }
    }

    fn emit_oldest(&mut self, known_ns: u64, emit: &mut impl FnMut(Couples)) {
        self.pending -= 1;
        emit(self.scene.couples(self.pending, known_ns));
    }
}
