//! Writing messages of fixed size, in place.

use crate::channel::{Channel, ChannelMessage};
use crate::clock::MonotonicTime;
use crate::connection::Alarm;
use crate::error::Error;
use crate::event;
use crate::pace::Pace;
use crate::service::{Attempt, Messages, Services};
use crate::station::Transport;
use crate::wait::{LOOK_AGAIN, Wake, sealed};
use iceoryx2::port::listener::Listener;
use iceoryx2::port::notifier::Notifier;
use iceoryx2::port::publisher::{Publisher, PublisherCreateError};
use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::prelude::*;
use iceoryx2::sample_mut::SampleMut;
use shm_schemas::{RoleId, Stamp};
use std::ops::{Deref, DerefMut};
use std::os::fd::BorrowedFd;
use std::time::Instant;

/// What every writer has besides its publisher: numbers, events and pace.
#[derive(Debug)]
pub(crate) struct Outbound {
    channel: Channel,
    notifier: Notifier<Transport>,
    listener: Listener<Transport>,
    pace: Pace,
    epoch: u64,
    seq: u64,
    /// When readers that came up were looked for.
    looked: Instant,
}

impl Outbound {
    pub(crate) fn new<M>(services: &Services<M>, channel: Channel) -> Result<Self, Attempt> {
        let failed = |what, why: String| Attempt::Failed(Error::Transport { channel, what, why });
        // The listener first: readers answer at once when they hear that the notifier came up.
        let listener = services.back.listener_builder().create();
        let listener = listener.map_err(|e| failed("creating a listener", format!("{e:?}")))?;
        let notifier =
            services.forward.notifier_builder().default_event_id(EventId::new(event::SAMPLE)).create();
        let notifier = notifier.map_err(|e| failed("creating a notifier", format!("{e:?}")))?;
        Ok(Self {
            channel,
            notifier,
            listener,
            pace: Pace::live(),
            epoch: MonotonicTime::now().nanoseconds(),
            seq: 0,
            looked: Instant::now(),
        })
    }

    pub(crate) fn follow(&mut self, readers: &[RoleId]) {
        self.pace.follow(readers, self.channel.qos().burst);
    }

    /// Numbers the next message.
    pub(crate) fn stamp(&self, stamp: &mut Stamp) {
        stamp.epoch = self.epoch;
        stamp.seq = self.seq + 1;
        stamp.sent_ns = MonotonicTime::now().nanoseconds();
    }

    /// Refuses to send a message that a paced reader might lose.
    pub(crate) fn check_room(&self) -> Result<(), Error> {
        if self.pace.has_room() { Ok(()) } else { Err(Error::NoRoomYet { channel: self.channel }) }
    }

    /// Counts a message that was sent and wakes the readers.
    pub(crate) fn sent(&mut self) -> Result<(), Error> {
        self.seq += 1;
        self.pace.sent();
        event::notify(&self.notifier, self.channel, event::SAMPLE)
    }

    /// Readers may have something that they were not woken for.
    pub(crate) fn wake_readers(&self) -> Result<(), Error> {
        event::notify(&self.notifier, self.channel, event::SAMPLE)
    }

    /// Handles what readers have said. `connect` hands the history to those that came up.
    pub(crate) fn poll(&mut self, connect: impl FnOnce() -> Result<(), Error>) -> Result<(), Error> {
        let mut came_up = false;
        let pace = &mut self.pace;
        event::drain(&self.listener, self.channel, |id| match event::caught_up_by(id) {
            Some(role) => pace.caught_up(role),
            None => came_up |= id == event::UP,
        })?;
        // A reader whose event could not be delivered gets the history all the same. It looks by itself as often.
        if came_up || self.looked.elapsed() >= LOOK_AGAIN {
            self.looked = Instant::now();
            connect()?;
        }
        if came_up {
            // Those that came up may have the history now.
            self.wake_readers()?;
        }
        Ok(())
    }

    /// After `poll`: whether one more message may be sent. `poll` has drained the events that must be forgotten: those that were
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

    pub(crate) fn epoch(&self) -> u64 {
        self.epoch
    }
}

/// Tells whether to try again after iceoryx2 has refused a publisher.
pub(crate) fn publisher_refused(channel: Channel, error: PublisherCreateError) -> Attempt {
    match error {
        // One of them may be dead, and the steward has not removed it yet.
        PublisherCreateError::ExceedsMaxSupportedPublishers => Attempt::Again(Some("writers")),
        other => Attempt::Failed(Error::transport(channel, "creating a writer", other)),
    }
}

/// Writes messages of type `T` on its channel.
#[derive(Debug)]
pub struct Writer<T: ChannelMessage> {
    // The publisher is dropped before the notifier, whose departure the readers hear.
    publisher: Publisher<Transport, T, ()>,
    outbound: Outbound,
    alarm: Alarm,
    services: Services<Messages<T>>,
}

/// A message being filled in the place where its readers will read it. At first it is `T::default()`. If it is dropped, it was never
/// sent.
#[derive(Debug)]
pub struct Loan<T: ChannelMessage>(SampleMut<Transport, T, ()>);

impl<T: ChannelMessage> Loan<T> {
    /// Rests on the same frame as `source`, the message from which this one follows.
    pub fn follow(&mut self, source: &Stamp) {
        let stamp = self.stamp_mut();
        stamp.frame_seq = source.frame_seq;
        stamp.captured_ns = source.captured_ns;
    }
}

impl<T: ChannelMessage> Deref for Loan<T> {
    type Target = T;
    fn deref(&self) -> &T {
        self.0.payload()
    }
}

impl<T: ChannelMessage> DerefMut for Loan<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.0.payload_mut()
    }
}

impl<T: ChannelMessage> Writer<T> {
    /// Makes a writer; gives the services back where that must be tried again.
    pub(crate) fn new(services: Services<Messages<T>>) -> Result<Self, (Services<Messages<T>>, Attempt)> {
        let alarm = Alarm::default();
        let make = || {
            let builder = services.messages.publisher_builder().max_loaned_samples(T::CHANNEL.qos().loans);
            let publisher = builder.set_degradation_handler(alarm.handler()).create();
            let publisher = publisher.map_err(|e| publisher_refused(T::CHANNEL, e))?;
            Ok((publisher, Outbound::new(&services, T::CHANNEL)?))
        };
        match make() {
            Ok((publisher, outbound)) => Ok(Self { publisher, outbound, alarm, services }),
            Err(attempt) => Err((services, attempt)),
        }
    }

    fn reconnect(&mut self) -> Result<(), Error> {
        if self.alarm.reconnect(&self.publisher, &self.services) {
            self.outbound.wake_readers()
        } else {
            Ok(())
        }
    }

    /// From now on this writer waits for the readers of these roles: before each [`Writer::send`], [`crate::Node::wait_for_room`]
    /// must have returned [`Wake::Room`]. Only for sources that can wait; `pace` tells why. No roles make it live again.
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

    /// Epoch and `seq` of the newest message that was sent; `seq` is 0 before the first.
    pub fn newest(&self) -> (u64, u64) {
        (self.outbound.epoch(), self.outbound.seq())
    }

    /// Numbers the message, sends it and wakes the readers. Returns its `seq`.
    ///
    /// # Errors
    /// [`Error::NoRoomYet`] when the writer is paced and nobody waited for room; [`Error::Transport`].
    pub fn send(&mut self, mut loan: Loan<T>) -> Result<u64, Error> {
        self.outbound.check_room()?;
        self.outbound.stamp(loan.stamp_mut());
        loan.0.send().map_err(|e| self.outbound.error("sending", e))?;
        self.outbound.sent()?;
        self.reconnect()?;
        Ok(self.outbound.seq())
    }
}

impl<T: ChannelMessage> sealed::Poll for Writer<T> {
    fn poll(&mut self) -> Result<Option<Wake>, Error> {
        let publisher = &self.publisher;
        self.outbound.poll(|| {
            publisher.update_connections().map_err(|e| Error::transport(T::CHANNEL, "connecting a reader", e))
        })?;
        self.reconnect()?;
        Ok(None)
    }

    fn fd(&self) -> BorrowedFd<'_> {
        self.outbound.fd()
    }
}

impl<T: ChannelMessage> sealed::Room for Writer<T> {
    fn make_room(&mut self) -> Result<bool, Error> {
        sealed::Poll::poll(self)?;
        Ok(self.outbound.make_room())
    }
}
