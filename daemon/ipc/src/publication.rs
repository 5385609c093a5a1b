//! What all writers share: a publisher whose connections are tried again, numbers, events and pace.

use crate::channel::Channel;
use crate::clock::MonotonicTime;
use crate::connection::Alarm;
use crate::error::Error;
use crate::event;
use crate::pace::Pace;
use crate::service::{Attempt, Header, Payload, PublishSubscribe, Refused, Services};
use crate::station::Transport;
use crate::wait::{LOOK_AGAIN, Wake, sealed};
use iceoryx2::port::listener::Listener;
use iceoryx2::port::notifier::Notifier;
use iceoryx2::port::publisher::{Publisher, PublisherCreateError};
use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::prelude::*;
use iceoryx2::sample_mut::SampleMut;
use iceoryx2::service::port_factory::publisher::PortFactoryPublisher;
use shm_schemas::{MessageId, RoleId, Stamp};
use std::fmt::Debug;
use std::os::fd::BorrowedFd;
use std::time::Instant;

/// The sending end of a channel: payload `P` with header `H`.
#[derive(Debug)]
pub(crate) struct Publication<P: Payload + ?Sized, H: Header> {
    // The publisher is dropped before the notifier, whose departure the readers hear.
    publisher: Publisher<Transport, P, H>,
    outbound: Outbound,
    alarm: Alarm,
    services: Services<PublishSubscribe<P, H>>,
}

impl<P: Payload + ?Sized, H: Header> Publication<P, H> {
    /// Publishes; gives the services back where that must be tried again. `configure` sets what only this kind of payload has.
    pub(crate) fn new(
        services: Services<PublishSubscribe<P, H>>,
        channel: Channel,
        configure: impl FnOnce(
            PortFactoryPublisher<'_, Transport, P, H>,
        ) -> PortFactoryPublisher<'_, Transport, P, H>,
    ) -> Result<Self, Refused<PublishSubscribe<P, H>>> {
        let alarm = Alarm::default();
        let make = || {
            let listener = listen(&services, channel)?;
            let builder = configure(services.messages.publisher_builder());
            let builder = builder.max_loaned_samples(channel.qos().loans);
            let publisher = builder.set_degradation_handler(alarm.handler()).create();
            let publisher = publisher.map_err(|e| publisher_refused(channel, e))?;
            Ok((publisher, Outbound::new(&services, channel, listener)?))
        };
        match make() {
            Ok((publisher, outbound)) => Ok(Self { publisher, outbound, alarm, services }),
            Err(attempt) => Err((services, attempt)),
        }
    }

    /// For loans, which iceoryx2 has one method for each kind of payload.
    pub(crate) fn publisher(&self) -> &Publisher<Transport, P, H> {
        &self.publisher
    }

    /// From now on this writer waits for the readers of these roles.
    pub(crate) fn follow(&mut self, readers: &[RoleId]) {
        self.outbound.follow(readers);
    }

    /// Numbers the next message. Refuses one that a paced reader might lose.
    pub(crate) fn number(&self, stamp: &mut Stamp) -> Result<(), Error> {
        self.outbound.check_room()?;
        self.outbound.stamp(stamp);
        Ok(())
    }

    /// Sends the message that was numbered and wakes the readers. Returns its `seq`.
    pub(crate) fn send(&mut self, message: SampleMut<Transport, P, H>) -> Result<u64, Error> {
        message.send().map_err(|e| self.error("sending", e))?;
        self.outbound.sent()?;
        self.reconnect()?;
        Ok(self.outbound.seq)
    }

    /// The newest message that was sent; its `seq` is 0 before the first.
    pub(crate) fn newest(&self) -> MessageId {
        MessageId { epoch: self.outbound.epoch, seq: self.outbound.seq }
    }

    /// What went wrong on this channel.
    pub(crate) fn error(&self, what: &'static str, why: impl Debug) -> Error {
        Error::transport(self.outbound.channel, what, why)
    }

    fn reconnect(&mut self) -> Result<(), Error> {
        if self.alarm.reconnect(&self.publisher, &self.services) {
            self.outbound.wake_readers()
        } else {
            Ok(())
        }
    }
}

impl<P: Payload + ?Sized, H: Header> sealed::Poll for Publication<P, H> {
    fn poll(&mut self) -> Result<Option<Wake>, Error> {
        let (publisher, channel) = (&self.publisher, self.outbound.channel);
        self.outbound.poll(|| {
            publisher.update_connections().map_err(|e| Error::transport(channel, "connecting a reader", e))
        })?;
        self.reconnect()?;
        Ok(None)
    }

    fn fd(&self) -> BorrowedFd<'_> {
        event::fd(&self.outbound.listener)
    }
}

impl<P: Payload + ?Sized, H: Header> sealed::Room for Publication<P, H> {
    fn make_room(&mut self) -> Result<bool, Error> {
        sealed::Poll::poll(self)?;
        Ok(self.outbound.make_room())
    }
}

/// What every writer has besides its publisher: numbers, events and pace.
#[derive(Debug)]
struct Outbound {
    channel: Channel,
    notifier: Notifier<Transport>,
    listener: Listener<Transport>,
    pace: Pace,
    epoch: u64,
    seq: u64,
    /// When readers that came up were looked for.
    looked: Instant,
}

/// The listener of [`Outbound`], which must exist before the publisher. A reader that comes up after that one has looked for readers is heard. After
/// the listener comes the notifier, whose coming readers answer at once.
fn listen<M>(services: &Services<M>, channel: Channel) -> Result<Listener<Transport>, Attempt> {
    let listener = services.back.listener_builder().create();
    listener.map_err(|e| Attempt::Failed(Error::transport(channel, "creating a listener", e)))
}

impl Outbound {
    fn new<M>(
        services: &Services<M>,
        channel: Channel,
        listener: Listener<Transport>,
    ) -> Result<Self, Attempt> {
        let notifier =
            services.forward.notifier_builder().default_event_id(EventId::new(event::SAMPLE)).create();
        let notifier =
            notifier.map_err(|e| Attempt::Failed(Error::transport(channel, "creating a notifier", e)))?;
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

    fn follow(&mut self, readers: &[RoleId]) {
        self.pace.follow(readers, self.channel.qos().burst);
    }

    /// Numbers the next message.
    fn stamp(&self, stamp: &mut Stamp) {
        stamp.epoch = self.epoch;
        stamp.seq = self.seq + 1;
        stamp.sent_ns = MonotonicTime::now().nanoseconds();
    }

    /// Refuses to send a message that a paced reader might lose.
    fn check_room(&self) -> Result<(), Error> {
        if self.pace.has_room() { Ok(()) } else { Err(Error::NoRoomYet { channel: self.channel }) }
    }

    /// Counts a message that was sent and wakes the readers.
    fn sent(&mut self) -> Result<(), Error> {
        self.seq += 1;
        self.pace.sent();
        event::notify(&self.notifier, self.channel, event::SAMPLE)
    }

    /// Readers may have something that they were not woken for.
    fn wake_readers(&self) -> Result<(), Error> {
        event::notify(&self.notifier, self.channel, event::SAMPLE)
    }

    /// Handles what readers have said. `connect` hands the history to those that came up.
    fn poll(&mut self, connect: impl FnOnce() -> Result<(), Error>) -> Result<(), Error> {
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
    fn make_room(&mut self) -> bool {
        if self.pace.may_begin() {
            self.pace.begin();
        }
        self.pace.has_room()
    }
}

/// Tells whether to try again after iceoryx2 has refused a publisher.
fn publisher_refused(channel: Channel, error: PublisherCreateError) -> Attempt {
    match error {
        // One of them may be dead, and the steward has not removed it yet.
        PublisherCreateError::ExceedsMaxSupportedPublishers => Attempt::Again(Some("writers")),
        other => Attempt::Failed(Error::transport(channel, "creating a writer", other)),
    }
}
