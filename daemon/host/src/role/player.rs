//! Plays a recording as if its source were live, or as fast as its readers go. Films and pictures become frames, track files detections.

use std::time::Duration;

use andon_ipc::{FrameLoan, Loan, MonotonicTime, Port, SourceTime};
use shm_schemas::{Detections, Stamp, flag};

use super::cycle::{Cycle, Role, Turn};
use super::output::{Output, Publish};
use super::{CycleError, Failure, WAIT};
use crate::config::{Camera, Speed};
use crate::log::{code, log};

/// A recording that is read from its beginning to its end, each message into the place where its readers will read it.
pub trait Recording<L> {
    /// What is damaged, or ends the role.
    type Error: Failure;

    /// Bytes of a message.
    fn message_bytes(&self) -> usize;

    /// From one message to the next at the recording's nominal rate.
    fn interval(&self) -> Duration;

    /// Writes the next message and gives its time since the first; `None` after the last.
    ///
    /// # Errors
    /// What is damaged, with its place.
    fn next(&mut self, message: &mut L) -> Result<Option<Duration>, Self::Error>;
}

/// A message of a recording, as far as the player writes it.
pub trait Played {
    /// Writes what it depends on, its time, and its flags beside those that it has.
    fn put(&mut self, stamp: &Stamp, time: SourceTime, flags: u32);
}

impl Played for FrameLoan {
    fn put(&mut self, stamp: &Stamp, time: SourceTime, flags: u32) {
        let header = self.header_mut();
        header.stamp.captured_ns = stamp.captured_ns;
        header.source_ns = time.nanoseconds();
        header.flags |= flags;
    }
}

impl Played for Loan<Detections> {
    fn put(&mut self, stamp: &Stamp, time: SourceTime, flags: u32) {
        self.follow(stamp);
        self.source_ns = time.nanoseconds();
        self.flags |= flags;
    }
}

/// The role that plays a recording. `open` opens it for every round.
pub struct Player<W, R, O> {
    output: Output<W>,
    open: O,
    repeat: bool,
    /// Of every message: [`flag::PACED`] where the player goes as fast as its readers.
    flags: u32,
    round: Option<Round<R>>,
    /// When the round began.
    round_began: SourceTime,
    /// Messages played so far.
    played: u64,
    has_ended: bool,
}

/// One time through the recording.
struct Round<R> {
    recording: R,
    began: MonotonicTime,
    /// Time of the newest message since the first of the round.
    newest: Duration,
}

impl<W, R, O> Player<W, R, O>
where
    W: Publish<Loan: Played>,
    R: Recording<W::Loan>,
    O: FnMut(&mut W) -> Result<R, R::Error>,
{
    /// A player that has not opened its recording.
    pub fn new(output: Output<W>, camera: &Camera, open: O) -> Self {
        Self {
            output,
            open,
            repeat: camera.repeat,
            flags: if camera.speed == Speed::Max { flag::PACED } else { 0 },
            round: None,
            round_began: SourceTime::default(),
            played: 0,
            has_ended: false,
        }
    }

    fn is_paced(&self) -> bool {
        self.flags & flag::PACED != 0
    }

    fn play(&mut self, mut round: Round<R>, cycle: &mut Cycle<'_>) -> Result<Turn, R::Error> {
        cycle.rest_on(Stamp::default(), self.flags);
        let mut message = self.output.loan(round.recording.message_bytes())?;
        let Some(time) = round.recording.next(&mut message)? else {
            // Once more from the start, as if the source had gone on.
            self.round_began = self.round_began + round.newest + round.recording.interval();
            return if self.repeat { Ok(Turn::Idle) } else { Ok(self.end(cycle)?) };
        };
        round.newest = time;
        let due = round.began + time;
        if !self.is_paced() && !cycle.wait_until(due)? {
            return Ok(Turn::Idle);
        }
        self.output.wait_for_room(cycle)?;
        // A message counts as captured when it is due, so that its latencies compare with those of a camera.
        let captured = if self.is_paced() { MonotonicTime::now() } else { due };
        self.publish(message, captured, self.round_began + time, cycle)?;
        self.round = Some(round);
        Ok(Turn::Stepped)
    }

    /// Says that nothing follows.
    fn end(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, CycleError> {
        self.flags |= flag::END_OF_STREAM;
        self.output.wait_for_room(cycle)?;
        let message = self.output.loan(0)?;
        self.publish(message, MonotonicTime::now(), self.round_began, cycle)?;
        log!(code::RECORDING_ENDED, "the recording is at its end");
        self.has_ended = true;
        Ok(Turn::Stepped)
    }

    fn publish(
        &mut self,
        mut message: W::Loan,
        captured: MonotonicTime,
        time: SourceTime,
        cycle: &mut Cycle<'_>,
    ) -> Result<(), CycleError> {
        self.played += 1;
        let captured_ns = captured.nanoseconds();
        let stamp = Stamp { frame_seq: self.played, captured_ns, ..Stamp::default() };
        cycle.rest_on(stamp, self.flags);
        message.put(&stamp, time, self.flags);
        self.output.send_loan(cycle, message)
    }
}

impl<W, R, O> Role for Player<W, R, O>
where
    W: Publish<Loan: Played>,
    R: Recording<W::Loan>,
    O: FnMut(&mut W) -> Result<R, R::Error>,
{
    type Error = R::Error;
    const INPUT_IS_STEADY: bool = false;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        vec![self.output.port()]
    }

    /// The recording's own time is waited for in the turn. At its end the player stays, until everybody has heard of it.
    fn patience(&self) -> Duration {
        if self.has_ended { WAIT } else { Duration::ZERO }
    }

    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, R::Error> {
        if self.has_ended {
            return Ok(Turn::Idle);
        }
        if let Some(round) = self.round.take() {
            return self.play(round, cycle);
        }
        let recording = (self.open)(self.output.writer())?;
        self.round = Some(Round { recording, began: MonotonicTime::now(), newest: Duration::ZERO });
        Ok(Turn::Idle)
    }
}
