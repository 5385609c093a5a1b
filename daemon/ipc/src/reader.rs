//! Reading messages of fixed size, in place.

use crate::channel::ChannelMessage;
use crate::error::Error;
use crate::service::{Messages, Refused, Services};
use crate::station::Transport;
use crate::subscription::Subscription;
use crate::wait::{Wake, sealed};
use iceoryx2::sample::Sample as IceSample;
use shm_schemas::RoleId;
use std::ops::Deref;
use std::os::fd::BorrowedFd;

/// Reads messages of type `T` from its channel.
#[derive(Debug)]
pub struct Reader<T: ChannelMessage>(Subscription<T, ()>);

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
    pub(crate) fn new(services: Services<Messages<T>>, role: RoleId) -> Result<Self, Refused<Messages<T>>> {
        Subscription::new(services, T::CHANNEL, role).map(Self)
    }

    /// The oldest message that waits.
    ///
    /// # Errors
    /// [`Error::Transport`] when too many samples are held.
    pub fn take(&mut self) -> Result<Option<Sample<T>>, Error> {
        let sample = self.0.take(|subscriber| subscriber.receive(), |sample| sample.payload().stamp())?;
        Ok(sample.map(Sample))
    }

    /// The newest `seq` of this epoch of the writer that has come; 0 where none has.
    pub fn newest_of(&self, epoch: u64) -> u64 {
        self.0.losses().newest_of(epoch)
    }

    /// Connects again at the next poll, although iceoryx2 has not said that one could not be made. What was lost
    /// meanwhile is counted, and what the writer still has comes.
    pub fn reconnect(&mut self) {
        self.0.recreate();
    }

    /// Messages received.
    pub fn received(&self) -> u64 {
        self.0.losses().received
    }

    /// Messages that were sent while this reader was there and that it did not get in time.
    pub fn lost(&self) -> u64 {
        self.0.losses().lost
    }

    /// How often the writer has started again since the first message.
    pub fn restarts(&self) -> u32 {
        self.0.losses().restarts
    }
}

impl<T: ChannelMessage> sealed::Poll for Reader<T> {
    fn poll(&mut self) -> Result<Option<Wake>, Error> {
        self.0.poll()
    }

    fn fd(&self) -> BorrowedFd<'_> {
        self.0.fd()
    }
}
