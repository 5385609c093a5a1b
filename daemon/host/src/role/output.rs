//! What a role publishes: a writer that goes at the pace of the source.

use andon_ipc::{ChannelMessage, Error, FrameLoan, FrameWriter, Loan, Paced, Port, Writer};
use shm_schemas::{MessageId, RoleId};

use super::CycleError;
use super::cycle::Cycle;

/// A writer with its pace. Live, it never waits; where the source waits for its readers, so does everything that follows from it.
pub struct Output<W> {
    writer: W,
    /// The roles that this output waits for when it is paced: the next on the data path, or none.
    followed: &'static [RoleId],
    is_paced: bool,
    /// Whether it is the role's data channel, whose messages health counts.
    is_counted: bool,
}

impl<W: Publish> Output<W> {
    /// `followed` is the next role on the data path; where it is empty, the output never waits.
    pub fn new(writer: W, followed: &'static [RoleId]) -> Self {
        Self { writer, followed, is_paced: false, is_counted: true }
    }

    /// A channel beside the data path: it never waits, and health does not count its messages.
    pub fn beside(writer: W) -> Self {
        Self { writer, followed: &[], is_paced: false, is_counted: false }
    }

    /// For [`super::Role::ports`].
    pub fn port(&mut self) -> &mut dyn Port {
        &mut self.writer
    }

    /// The writer.
    pub fn writer(&mut self) -> &mut W {
        &mut self.writer
    }

    /// A place for one message. `bytes` is the length of a frame; other messages have their own.
    ///
    /// # Errors
    /// The station's shared memory.
    pub fn loan(&self, bytes: usize) -> Result<W::Loan, CycleError> {
        Ok(self.writer.loan(bytes)?)
    }

    /// Waits until there is room for one more message. What is loaned may be filled before that: the next message of a recording is read
    /// while its reader works on the one before.
    ///
    /// # Errors
    /// [`CycleError::Stopped`] and [`CycleError::NoProgress`] while it waits; the station's shared memory.
    pub fn wait_for_room(&mut self, cycle: &mut Cycle<'_>) -> Result<(), CycleError> {
        let is_paced = cycle.is_paced() && !self.followed.is_empty();
        if is_paced != self.is_paced {
            self.is_paced = is_paced;
            self.writer.follow(if is_paced { self.followed } else { &[] });
        }
        // A live writer always has room, and what is sent while the role stops must not be refused.
        if self.is_paced {
            cycle.wait_for_room(&mut self.writer)?;
        }
        Ok(())
    }

    /// Sends what was loaned, for which there is room.
    ///
    /// # Errors
    /// The station's shared memory.
    pub fn send_loan(&mut self, cycle: &mut Cycle<'_>, loan: W::Loan) -> Result<(), CycleError> {
        self.writer.send(loan)?;
        if self.is_counted {
            cycle.liveness().sent(self.writer.newest());
        }
        Ok(())
    }
}

impl<T: ChannelMessage> Output<Writer<T>> {
    /// Sends one message, which depends on the newest message taken.
    ///
    /// # Errors
    /// As [`Output::wait_for_room`].
    pub fn send(&mut self, cycle: &mut Cycle<'_>, fill: impl FnOnce(&mut T)) -> Result<(), CycleError> {
        self.wait_for_room(cycle)?;
        let mut message = self.loan(size_of::<T>())?;
        message.follow(cycle.stamp());
        fill(&mut message);
        self.send_loan(cycle, message)
    }
}

/// The two kinds of writers that a station has.
pub trait Publish: Paced + Port + Sized {
    /// A message being filled.
    type Loan;

    /// See [`Writer::follow`].
    fn follow(&mut self, readers: &[RoleId]);

    /// See [`FrameWriter::loan`].
    ///
    /// # Errors
    /// The station's shared memory.
    fn loan(&self, bytes: usize) -> Result<Self::Loan, Error>;

    /// See [`Writer::send`].
    ///
    /// # Errors
    /// The station's shared memory.
    fn send(&mut self, loan: Self::Loan) -> Result<u64, Error>;

    /// See [`Writer::newest`].
    fn newest(&self) -> MessageId;
}

impl<T: ChannelMessage> Publish for Writer<T> {
    type Loan = Loan<T>;

    fn follow(&mut self, readers: &[RoleId]) {
        Writer::follow(self, readers);
    }

    fn loan(&self, _bytes: usize) -> Result<Loan<T>, Error> {
        Writer::loan(self)
    }

    fn send(&mut self, loan: Loan<T>) -> Result<u64, Error> {
        Writer::send(self, loan)
    }

    fn newest(&self) -> MessageId {
        Writer::newest(self)
    }
}

impl Publish for FrameWriter {
    type Loan = FrameLoan;

    fn follow(&mut self, readers: &[RoleId]) {
        FrameWriter::follow(self, readers);
    }

    fn loan(&self, bytes: usize) -> Result<FrameLoan, Error> {
        FrameWriter::loan(self, bytes)
    }

    fn send(&mut self, loan: FrameLoan) -> Result<u64, Error> {
        FrameWriter::send(self, loan)
    }

    fn newest(&self) -> MessageId {
        FrameWriter::newest(self)
    }
}
