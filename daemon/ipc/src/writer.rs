//! Writing messages of fixed size, in place.

use crate::channel::{Carried, Channel};
use crate::clock::monotonic_ns;
use crate::error::Error;
use crate::event;
use crate::node::{Attempt, MessageServices};
use crate::pace::Pace;
use crate::service::Services;
use crate::wait::{Wake, sealed};
use iceoryx2::port::listener::Listener;
use iceoryx2::port::notifier::Notifier;
use iceoryx2::port::publisher::{Publisher, PublisherCreateError};
use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::prelude::*;
use iceoryx2::sample_mut::SampleMut;
use shm_schemas::{RoleId, Stamp};
use std::ops::{Deref, DerefMut};
use std::os::fd::BorrowedFd;

/// What every writer has beside its publisher: numbers, events and pace.
#[derive(Debug)]
pub(crate) struct Outbound {
    channel: Channel,
    notifier: Notifier<ipc::Service>,
    listener: Listener<ipc::Service>,
    pace: Pace,
    epoch: u64,
    seq: u64,
}

impl Outbound {
    pub(crate) fn new<M>(services: &Services<M>, channel: Channel) -> Result<Self, Attempt> {
        let failed = |what, why: String| Attempt::Failed(Error::Transport { channel, what, why });
        // The listener first: readers that hear the notifier come up answer at once.
        let listener = services.back.listener_builder().create();
        let listener = listener.map_err(|e| failed("creating a listener", format!("{e:?}")))?;
        let notifier =
            services.forward.notifier_builder().default_event_id(EventId::new(event::SAMPLE)).create();
        let notifier = notifier.map_err(|e| failed("creating a notifier", format!("{e:?}")))?;
        Ok(Self { channel, notifier, listener, pace: Pace::live(), epoch: monotonic_ns(), seq: 0 })
    }

    pub(crate) fn follow(&mut self, readers: &[RoleId]) {
        self.pace.follow(readers, self.channel.qos().burst);
    }

    /// Numbers the next message.
    pub(crate) fn stamp(&self, stamp: &mut Stamp) {
        stamp.epoch = self.epoch;
        stamp.seq = self.seq + 1;
        stamp.sent_ns = monotonic_ns();
    }

    /// Refuses before anything is sent that a paced reader might lose.
    pub(crate) fn check_room(&self) -> Result<(), Error> {
        if self.pace.has_room() { Ok(()) } else { Err(Error::NoRoomYet { channel: self.channel }) }
    }

    /// After a message was sent: counts it and wakes the readers.
    pub(crate) fn sent(&mut self) -> Result<(), Error> {
        self.seq += 1;
        self.pace.sent();
        event::notify(&self.notifier, self.channel, event::SAMPLE)
    }

    /// Deals with what readers have said; `connect` hands the history to those that came up.
    pub(crate) fn tend(&mut self, connect: impl FnOnce() -> Result<(), Error>) -> Result<(), Error> {
        let mut came_up = false;
        let pace = &mut self.pace;
        event::drain(&self.listener, self.channel, |id| match event::caught_up_by(id) {
            Some(role) => pace.caught_up(role),
            None => came_up |= id == event::UP,
        })?;
        if came_up {
            connect()?;
            // There may be history now.
            event::notify(&self.notifier, self.channel, event::SAMPLE)?;
        }
        Ok(())
    }

    /// After `tend`: whether one more may be sent. The events that `tend` drained are the ones to forget: they were
    /// raised before the burst that may begin now.
    pub(crate) fn make_room(&mut self) -> bool {
        if self.pace.may_begin() {
            self.pace.begin();
        }
        self.pace.has_room()
    }

    pub(crate) fn fd(&self) -> BorrowedFd<'_> {
        event::fd(&self.listener)
    }

    pub(crate) fn error(&self, what: &'static str, why: impl std::fmt::Debug) -> Error {
        Error::transport(self.channel, what, why)
    }

    pub(crate) fn seq(&self) -> u64 {
        self.seq
    }
}

/// Turns iceoryx2's refusal of a publisher into a reason to try again or not.
pub(crate) fn publisher_refused(channel: Channel, error: PublisherCreateError) -> Attempt {
    match error {
        // Perhaps a dead one that the steward has not removed yet.
        PublisherCreateError::ExceedsMaxSupportedPublishers => Attempt::Again(Some("writers")),
        other => Attempt::Failed(Error::transport(channel, "creating a writer", other)),
    }
}

/// Writes messages of type `T` on its channel.
#[derive(Debug)]
pub struct Writer<T: Carried> {
    // The publisher goes before the notifier, whose departure tells the readers.
    publisher: Publisher<ipc::Service, T, ()>,
    outbound: Outbound,
}

/// A message being filled, where its readers will read it. It begins zeroed, as `T::default()`. Dropped, it was never sent.
#[derive(Debug)]
pub struct Loan<T: Carried>(SampleMut<ipc::Service, T, ()>);

impl<T: Carried> Loan<T> {
    /// Takes over which frame the message rests on from the message that it follows from.
    pub fn follow(&mut self, source: &Stamp) {
        let stamp = self.stamp_mut();
        stamp.frame_seq = source.frame_seq;
        stamp.captured_ns = source.captured_ns;
    }
}

impl<T: Carried> Deref for Loan<T> {
    type Target = T;
    fn deref(&self) -> &T {
        self.0.payload()
    }
}

impl<T: Carried> DerefMut for Loan<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.0.payload_mut()
    }
}

impl<T: Carried> Writer<T> {
    pub(crate) fn new(services: &MessageServices<T>) -> Result<Self, Attempt> {
        let publisher = services
            .messages
            .publisher_builder()
            .max_loaned_samples(T::CHANNEL.qos().loans)
            .create()
            .map_err(|e| publisher_refused(T::CHANNEL, e))?;
        Ok(Self { publisher, outbound: Outbound::new(services, T::CHANNEL)? })
    }

    /// From now on waits for the readers of these roles: before each [`Writer::send`], [`crate::Node::wait_for_room`]
    /// must have said [`Wake::Room`]. For sources that can wait; nobody else, see `pace`.
    pub fn follow(&mut self, readers: &[RoleId]) {
        self.outbound.follow(readers);
    }

    /// A place for one message in shared memory.
    ///
    /// # Errors
    /// [`Error::Transport`] when more loans are open than the channel has.
    pub fn loan(&self) -> Result<Loan<T>, Error> {
        let sample = self.publisher.loan_uninit().map_err(|e| self.outbound.error("loaning", e))?;
        Ok(Loan(sample.write_payload(T::default())))
    }

    /// Numbers the message, sends it and wakes the readers. Returns its `seq`.
    ///
    /// # Errors
    /// [`Error::NoRoomYet`] when the writer is paced and was not waited for; [`Error::Transport`].
    pub fn send(&mut self, mut loan: Loan<T>) -> Result<u64, Error> {
        self.outbound.check_room()?;
        self.outbound.stamp(loan.stamp_mut());
        loan.0.send().map_err(|e| self.outbound.error("sending", e))?;
        self.outbound.sent()?;
        Ok(self.outbound.seq())
    }
}

impl<T: Carried> sealed::Tend for Writer<T> {
    fn tend(&mut self) -> Result<Option<Wake>, Error> {
        let publisher = &self.publisher;
        self.outbound.tend(|| {
            publisher.update_connections().map_err(|e| Error::transport(T::CHANNEL, "connecting a reader", e))
        })?;
        Ok(None)
    }

    fn fd(&self) -> BorrowedFd<'_> {
        self.outbound.fd()
    }
}

impl<T: Carried> sealed::Room for Writer<T> {
    fn make_room(&mut self) -> Result<bool, Error> {
        sealed::Tend::tend(self)?;
        Ok(self.outbound.make_room())
    }
}
