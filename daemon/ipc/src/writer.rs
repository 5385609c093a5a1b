//! Writing messages of fixed size, in place.

use crate::channel::ChannelMessage;
use crate::error::Error;
use crate::publication::Publication;
use crate::service::{Messages, Refused, Services};
use crate::station::Transport;
use crate::wait::{Wake, sealed};
use iceoryx2::sample_mut::SampleMut;
use shm_schemas::{MessageId, RoleId, Stamp};
use std::ops::{Deref, DerefMut};
use std::os::fd::BorrowedFd;

/// Writes messages of type `T` on its channel.
#[derive(Debug)]
pub struct Writer<T: ChannelMessage>(Publication<T, ()>);

/// A message being filled in the place where its readers will read it. At first it is `T::default()`. If it is dropped, it was never
/// sent.
#[derive(Debug)]
pub struct Loan<T: ChannelMessage>(SampleMut<Transport, T, ()>);

impl<T: ChannelMessage> Loan<T> {
    /// Depends on the same frame as `source`, the message from which this one follows.
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
    pub(crate) fn new(services: Services<Messages<T>>) -> Result<Self, Refused<Messages<T>>> {
        Publication::new(services, T::CHANNEL, |builder| builder).map(Self)
    }

    /// From now on this writer waits for the readers of these roles: before each [`Writer::send`], [`crate::Node::wait_for_room`]
    /// must have returned [`Wake::Room`]. Only for sources that can wait; `pace` tells why. No roles make it live again.
    pub fn follow(&mut self, readers: &[RoleId]) {
        self.0.follow(readers);
    }

    /// A place for one message in shared memory.
    ///
    /// # Errors
    /// [`Error::Transport`] when more loans are open than the channel has.
    pub fn loan(&self) -> Result<Loan<T>, Error> {
        let sample = self.0.publisher().loan_uninit().map_err(|e| self.0.error("loaning", e))?;
        Ok(Loan(sample.write_payload(T::default())))
    }

    /// The newest message that was sent; its `seq` is 0 before the first.
    pub fn newest(&self) -> MessageId {
        self.0.newest()
    }

    /// Numbers the message, sends it and wakes the readers. Returns its `seq`.
    ///
    /// # Errors
    /// [`Error::NoRoomYet`] when the writer is paced and nobody waited for room; [`Error::Transport`].
    pub fn send(&mut self, mut loan: Loan<T>) -> Result<u64, Error> {
        self.0.number(loan.stamp_mut())?;
        self.0.send(loan.0)
    }
}

impl<T: ChannelMessage> sealed::Poll for Writer<T> {
    fn poll(&mut self) -> Result<Option<Wake>, Error> {
        self.0.poll()
    }

    fn fd(&self) -> BorrowedFd<'_> {
        self.0.fd()
    }
}

impl<T: ChannelMessage> sealed::Room for Writer<T> {
    fn make_room(&mut self) -> Result<bool, Error> {
        self.0.make_room()
    }
}
