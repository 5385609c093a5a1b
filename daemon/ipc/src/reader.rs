//! Reading messages of fixed size, in place.

use crate::channel::{Channel, ChannelMessage};
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
    subscriber: Subscriber<Transport, T, ()>,
    inbound: Inbound,
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
    pub(crate) fn new(services: &Services<Messages<T>>, role: RoleId) -> Result<Self, Attempt> {
        let listener = listen(services, T::CHANNEL)?;
        let subscriber =
            services.messages.subscriber_builder().create().map_err(|e| subscriber_refused(T::CHANNEL, e))?;
        Ok(Self { subscriber, inbound: Inbound::announce(services, T::CHANNEL, role, listener)? })
    }

    /// The oldest message that waits.
    ///
    /// # Errors
    /// [`Error::Transport`] when too many samples are held.
    pub fn take(&mut self) -> Result<Option<Sample<T>>, Error> {
        loop {
            let sample = self.subscriber.receive();
            let sample = sample.map_err(|e| Error::transport(T::CHANNEL, "receiving", e))?;
            let Some(sample) = sample else {
                self.inbound.found_empty()?;
                return Ok(None);
            };
            if self.inbound.took(sample.payload().stamp())? {
                return Ok(Some(Sample(sample)));
            }
        }
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
        let pending = self.subscriber.has_samples();
        let pending = pending.map_err(|e| Error::transport(T::CHANNEL, "looking for messages", e))?;
        self.inbound.poll(pending)
    }

    fn fd(&self) -> BorrowedFd<'_> {
        self.inbound.fd()
    }
}
