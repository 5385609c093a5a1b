//! Reading messages of fixed size, in place.

use crate::channel::{Channel, ChannelMessage};
use crate::connection::Alarm;
use crate::error::Error;
use crate::event;
use crate::loss::{Arrival, LossCounter};
use crate::service::{Attempt, Messages, Services};
use crate::station::Transport;
use crate::wait::{Departure, Wake, sealed};
use iceoryx2::port::listener::Listener;
use iceoryx2::port::notifier::Notifier;
use iceoryx2::port::subscriber::{Subscriber, SubscriberCreateError};
use iceoryx2::sample::Sample as IceSample;
use shm_schemas::{RoleId, Stamp};
use std::ops::Deref;
use std::os::fd::BorrowedFd;

/// What every reader has besides its subscriber: losses and events.
#[derive(Debug)]
pub(crate) struct Inbound {
    channel: Channel,
    role: RoleId,
    listener: Listener<Transport>,
    notifier: Notifier<Transport>,
    pub(crate) losses: LossCounter,
    gone: Option<Departure>,
    /// A writer has come up since this reader was complete: everything it sends was sent in the time of this reader.
    writer_came_up: bool,
    /// The writer must hear when the queue is empty: since it last heard so, something was taken or a writer came up.
    owes_caught_up: bool,
}

/// The listener of [`Inbound`], which must exist before the subscriber: what is sent from now on wakes this reader.
pub(crate) fn listen<M>(services: &Services<M>, channel: Channel) -> Result<Listener<Transport>, Attempt> {
    let listener = services.forward.listener_builder().create();
    listener.map_err(|e| Attempt::Failed(Error::transport(channel, "creating a listener", e)))
}

impl Inbound {
    /// Completes a reader, after its subscriber: creating the notifier announces it.
    pub(crate) fn announce<M>(
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
        inbound.hear().map_err(Attempt::Failed)?;
        inbound.writer_came_up = false;
        Ok(inbound)
    }

    /// Tells why to wake up, if there is a reason. `pending` says whether messages wait.
    pub(crate) fn poll(&mut self, pending: bool) -> Result<Option<Wake>, Error> {
        if pending {
            return Ok(Some(Wake::Sample));
        }
        self.found_empty()?;
        let departure = self.gone.take();
        Ok(departure.map(|departure| Wake::WriterGone { channel: self.channel, departure }))
    }

    /// Handles every event that has come.
    pub(crate) fn hear(&mut self) -> Result<(), Error> {
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

    /// The subscriber was made anew: the writer hands its history to those that come up.
    pub(crate) fn announce_again(&mut self) -> Result<(), Error> {
        self.owes_caught_up = true;
        event::notify(&self.notifier, self.channel, event::UP)
    }

    /// The queue is empty: tells the writer if it may be waiting for that.
    pub(crate) fn found_empty(&mut self) -> Result<(), Error> {
        if self.owes_caught_up {
            self.owes_caught_up = false;
            event::notify(&self.notifier, self.channel, event::caught_up(self.role))?;
        }
        Ok(())
    }

    /// A message was taken from the queue. False when it had come before.
    pub(crate) fn took(&mut self, stamp: &Stamp) -> Result<bool, Error> {
        self.owes_caught_up = true;
        // With several writers nobody knows which of them came up.
        let one_writer = self.channel.qos().writers == 1;
        if one_writer && !self.losses.knows(stamp.epoch) {
            self.hear()?;
        }
        let from_start = one_writer && (self.writer_came_up || self.losses.received > 0);
        Ok(self.losses.note(stamp, from_start) == Arrival::New)
    }

    pub(crate) fn fd(&self) -> BorrowedFd<'_> {
        event::fd(&self.listener)
    }
}

/// Tells whether to try again after iceoryx2 has refused a subscriber.
pub(crate) fn subscriber_refused(channel: Channel, error: SubscriberCreateError) -> Attempt {
    match error {
        // One of them may be dead, and the steward has not removed it yet.
        SubscriberCreateError::ExceedsMaxSupportedSubscribers => Attempt::Again(Some("readers")),
        other => Attempt::Failed(Error::transport(channel, "creating a reader", other)),
    }
}

/// Reads messages of type `T` from its channel.
#[derive(Debug)]
pub struct Reader<T: ChannelMessage> {
    /// `None` while it could not be made anew.
    subscriber: Option<Subscriber<Transport, T, ()>>,
    inbound: Inbound,
    alarm: Alarm,
    services: Services<Messages<T>>,
}

/// A message, read where its writer filled it. Dropping it gives the place back to the writer. A reader may hold as many as the
/// `borrowed` of its channel at the same time.
#[derive(Debug)]
pub struct Sample<T: ChannelMessage>(IceSample<Transport, T, ()>);

impl<T: ChannelMessage> Deref for Sample<T> {
    type Target = T;
    fn deref(&self) -> &T {
        self.0.payload()
    }
}

impl<T: ChannelMessage> Reader<T> {
    /// Makes a reader; gives the services back where that must be tried again.
    pub(crate) fn new(
        services: Services<Messages<T>>,
        role: RoleId,
    ) -> Result<Self, (Services<Messages<T>>, Attempt)> {
        let alarm = Alarm::default();
        let make = || {
            let listener = listen(&services, T::CHANNEL)?;
            let subscriber = Self::subscribe(&services, &alarm)?;
            Ok((subscriber, Inbound::announce(&services, T::CHANNEL, role, listener)?))
        };
        match make() {
            Ok((subscriber, inbound)) => Ok(Self { subscriber: Some(subscriber), inbound, alarm, services }),
            Err(attempt) => Err((services, attempt)),
        }
    }

    fn subscribe(
        services: &Services<Messages<T>>,
        alarm: &Alarm,
    ) -> Result<Subscriber<Transport, T, ()>, Attempt> {
        let builder = services.messages.subscriber_builder().set_degradation_handler(alarm.handler());
        builder.create().map_err(|e| subscriber_refused(T::CHANNEL, e))
    }

    /// Makes the subscriber anew after a connection could not be made. What the others had delivered has been taken by then.
    fn repair(&mut self) -> Result<(), Error> {
        if !self.alarm.is_due() {
            return Ok(());
        }
        // The old one first: the channel may have no place for both.
        self.subscriber = None;
        match Self::subscribe(&self.services, &self.alarm) {
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

    fn receive(&mut self) -> Result<Option<IceSample<Transport, T, ()>>, Error> {
        let Some(subscriber) = &self.subscriber else { return Ok(None) };
        subscriber.receive().map_err(|e| Error::transport(T::CHANNEL, "receiving", e))
    }

    /// The oldest message that waits.
    ///
    /// # Errors
    /// [`Error::Transport`] when too many samples are held.
    pub fn take(&mut self) -> Result<Option<Sample<T>>, Error> {
        loop {
            let Some(sample) = self.receive()? else {
                self.inbound.found_empty()?;
                self.repair()?;
                return Ok(None);
            };
            if self.inbound.took(sample.payload().stamp())? {
                return Ok(Some(Sample(sample)));
            }
        }
    }

    /// The newest `seq` of this epoch of the writer that has come; 0 where none has.
    pub fn newest_of(&self, epoch: u64) -> u64 {
        self.inbound.losses.newest_of(epoch)
    }

    /// Makes the connection anew with the next look, although iceoryx2 has not said that one could not be made. What was lost
    /// meanwhile is counted, and what the writer still has comes.
    pub fn make_anew(&mut self) {
        self.alarm.raise();
    }

    /// Messages received.
    pub fn received(&self) -> u64 {
        self.inbound.losses.received
    }

    /// Messages that were sent while this reader was there and that it did not get in time.
    pub fn lost(&self) -> u64 {
        self.inbound.losses.lost
    }

    /// How often the writer has started again since the first message.
    pub fn restarts(&self) -> u32 {
        self.inbound.losses.restarts
    }
}

impl<T: ChannelMessage> sealed::Poll for Reader<T> {
    fn poll(&mut self) -> Result<Option<Wake>, Error> {
        // Events first: a message that is sent after this look raises another event.
        self.inbound.hear()?;
        let pending = self.subscriber.as_ref().map_or(Ok(false), Subscriber::has_samples);
        let pending = pending.map_err(|e| Error::transport(T::CHANNEL, "looking for messages", e))?;
        if !pending {
            self.repair()?;
        }
        self.inbound.poll(pending)
    }

    fn fd(&self) -> BorrowedFd<'_> {
        self.inbound.fd()
    }
}
