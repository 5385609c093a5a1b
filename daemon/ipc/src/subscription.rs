//! What all readers share: a subscriber that is recreated when a connection could not be made, losses and events.

use crate::channel::Channel;
use crate::connection::Alarm;
use crate::error::Error;
use crate::event;
use crate::loss::{Arrival, LossCounter};
use crate::service::{Attempt, Header, Payload, PublishSubscribe, Refused, Services};
use crate::station::Transport;
use crate::wait::{Departure, Wake, sealed};
use iceoryx2::port::ReceiveError;
use iceoryx2::port::listener::Listener;
use iceoryx2::port::notifier::Notifier;
use iceoryx2::port::subscriber::{Subscriber, SubscriberCreateError};
use iceoryx2::sample::Sample;
use shm_schemas::{RoleId, Stamp};
use std::os::fd::BorrowedFd;

/// The receiving end of a channel: payload `P` with header `H`.
#[derive(Debug)]
pub(crate) struct Subscription<P: Payload + ?Sized, H: Header> {
    /// `None` while it could not be recreated.
    subscriber: Option<Subscriber<Transport, P, H>>,
    inbound: Inbound,
    alarm: Alarm,
    services: Services<PublishSubscribe<P, H>>,
}

impl<P: Payload + ?Sized, H: Header> Subscription<P, H> {
    /// Subscribes; gives the services back where that must be tried again.
    pub(crate) fn new(
        services: Services<PublishSubscribe<P, H>>,
        channel: Channel,
        role: RoleId,
    ) -> Result<Self, Refused<PublishSubscribe<P, H>>> {
        let alarm = Alarm::default();
        let make = || {
            let listener = listen(&services, channel)?;
            let subscriber = subscribe(&services, channel, &alarm)?;
            Ok((subscriber, Inbound::announce(&services, channel, role, listener)?))
        };
        match make() {
            Ok((subscriber, inbound)) => Ok(Self { subscriber: Some(subscriber), inbound, alarm, services }),
            Err(attempt) => Err((services, attempt)),
        }
    }

    /// The oldest message that waits and has not come before. `receive` is iceoryx2's own, which has one for each kind of payload.
    pub(crate) fn take(
        &mut self,
        receive: impl Fn(&Subscriber<Transport, P, H>) -> Result<Option<Sample<Transport, P, H>>, ReceiveError>,
        stamp: impl Fn(&Sample<Transport, P, H>) -> &Stamp,
    ) -> Result<Option<Sample<Transport, P, H>>, Error> {
        loop {
            let received = self.subscriber.as_ref().map_or(Ok(None), &receive);
            let received = received.map_err(|e| Error::transport(self.inbound.channel, "receiving", e))?;
            let Some(sample) = received else {
                self.inbound.found_empty()?;
                self.repair()?;
                return Ok(None);
            };
            if self.inbound.took(stamp(&sample))? {
                return Ok(Some(sample));
            }
        }
    }

    /// What came and what was lost.
    pub(crate) fn losses(&self) -> &LossCounter {
        &self.inbound.losses
    }

    /// Recreates the subscriber at the next poll, although iceoryx2 has not said that a connection could not be made.
    pub(crate) fn recreate(&mut self) {
        self.alarm.raise();
    }

    /// Recreates the subscriber after a connection could not be made. What the others had delivered has been taken by then.
    fn repair(&mut self) -> Result<(), Error> {
        if !self.alarm.is_due() {
            return Ok(());
        }
        // The old one first: the channel may have no place for both.
        self.subscriber = None;
        match subscribe(&self.services, self.inbound.channel, &self.alarm) {
            Ok(subscriber) => {
                self.subscriber = Some(subscriber);
                self.inbound.announce_again()
            }
            Err(_) => {
                self.alarm.raise();
                Ok(())
            }
        }
    }
}

impl<P: Payload + ?Sized, H: Header> sealed::Poll for Subscription<P, H> {
    fn poll(&mut self) -> Result<Option<Wake>, Error> {
        // Events first: a message that is sent after this look raises another event.
        self.inbound.handle_events()?;
        let pending = self.subscriber.as_ref().map_or(Ok(false), Subscriber::has_samples);
        let pending =
            pending.map_err(|e| Error::transport(self.inbound.channel, "looking for messages", e))?;
        if !pending {
            self.repair()?;
        }
        self.inbound.poll(pending)
    }

    fn fd(&self) -> BorrowedFd<'_> {
        event::fd(&self.inbound.listener)
    }
}

fn subscribe<P: Payload + ?Sized, H: Header>(
    services: &Services<PublishSubscribe<P, H>>,
    channel: Channel,
    alarm: &Alarm,
) -> Result<Subscriber<Transport, P, H>, Attempt> {
    let builder = services.messages.subscriber_builder().set_degradation_handler(alarm.handler());
    builder.create().map_err(|e| subscriber_refused(channel, e))
}

/// What every reader has besides its subscriber: losses and events.
#[derive(Debug)]
struct Inbound {
    channel: Channel,
    role: RoleId,
    listener: Listener<Transport>,
    notifier: Notifier<Transport>,
    losses: LossCounter,
    gone: Option<Departure>,
    /// A writer has come up since this reader was complete: everything it sends was sent in the time of this reader.
    writer_came_up: bool,
    /// The writer must hear when the queue is empty: since it last heard so, something was taken or a writer came up.
    owes_caught_up: bool,
}

/// The listener of [`Inbound`], which must exist before the subscriber: what is sent from now on wakes this reader.
fn listen<M>(services: &Services<M>, channel: Channel) -> Result<Listener<Transport>, Attempt> {
    let listener = services.forward.listener_builder().create();
    listener.map_err(|e| Attempt::Failed(Error::transport(channel, "creating a listener", e)))
}

impl Inbound {
    /// Completes a reader, after its subscriber: creating the notifier announces it.
    fn announce<M>(
        services: &Services<M>,
        channel: Channel,
        role: RoleId,
        listener: Listener<Transport>,
    ) -> Result<Self, Attempt> {
        let notifier = services.back.notifier_builder().create();
        let notifier =
            notifier.map_err(|e| Attempt::Failed(Error::transport(channel, "creating a notifier", e)))?;
        let mut inbound = Self {
            channel,
            role,
            listener,
            notifier,
            losses: LossCounter::default(),
            gone: None,
            writer_came_up: false,
            owes_caught_up: true,
        };
        // A writer that came up while this reader was being made may have sent something before the reader was complete.
        inbound.handle_events().map_err(Attempt::Failed)?;
        inbound.writer_came_up = false;
        Ok(inbound)
    }

    /// Tells why to wake up, if there is a reason. `pending` says whether messages wait.
    fn poll(&mut self, pending: bool) -> Result<Option<Wake>, Error> {
        if pending {
            return Ok(Some(Wake::Sample));
        }
        self.found_empty()?;
        let departure = self.gone.take();
        Ok(departure.map(|departure| Wake::WriterGone { channel: self.channel, departure }))
    }

    /// Handles every event that has come.
    fn handle_events(&mut self) -> Result<(), Error> {
        let (gone, owes, came_up) = (&mut self.gone, &mut self.owes_caught_up, &mut self.writer_came_up);
        event::drain(&self.listener, self.channel, |id| match id {
            event::UP => {
                *gone = None;
                *owes = true;
                *came_up = true;
            }
            event::GONE => *gone = Some(Departure::Stopped),
            event::DEAD => *gone = Some(Departure::Died),
            _ => (),
        })
    }

    /// The subscriber was recreated: the writer hands its history to those that come up.
    fn announce_again(&mut self) -> Result<(), Error> {
        self.owes_caught_up = true;
        event::notify(&self.notifier, self.channel, event::UP)
    }

    /// The queue is empty: tells the writer if it may be waiting for that.
    fn found_empty(&mut self) -> Result<(), Error> {
        if self.owes_caught_up {
            self.owes_caught_up = false;
            event::notify(&self.notifier, self.channel, event::caught_up(self.role))?;
        }
        Ok(())
    }

    /// A message was taken from the queue. False when it had come before.
    fn took(&mut self, stamp: &Stamp) -> Result<bool, Error> {
        self.owes_caught_up = true;
        // With several writers nobody knows which of them came up.
        let one_writer = self.channel.qos().writers == 1;
        if one_writer && !self.losses.knows(stamp.epoch) {
            self.handle_events()?;
        }
        let from_start = one_writer && (self.writer_came_up || self.losses.received > 0);
        Ok(self.losses.note(stamp, from_start) == Arrival::New)
    }
}

/// Tells whether to try again after iceoryx2 has refused a subscriber.
fn subscriber_refused(channel: Channel, error: SubscriberCreateError) -> Attempt {
    match error {
        // One of them may be dead, and the steward has not removed it yet.
        SubscriberCreateError::ExceedsMaxSupportedSubscribers => Attempt::Again(Some("readers")),
        other => Attempt::Failed(Error::transport(channel, "creating a reader", other)),
    }
}
