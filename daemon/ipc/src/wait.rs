//! Waiting for messages, for room and for the request to stop. Every wait has a deadline and tells why it ended.

use crate::channel::Channel;
use crate::error::Error;
use crate::stop::{Stop, timespec};
use rustix::event::{PollFd, PollFlags, poll};
use std::io;
use std::os::fd::BorrowedFd;
use std::time::{Duration, Instant};

/// Maximum number of ports in one wait: the role `record` watches every channel.
const MAX_PORTS: usize = Channel::ALL.len();

/// A wait that has blocked for this long looks at its ports again. It finds nothing unless two notifiers of one listener met in the one interleaving
/// that `event::drain` cannot repair. Then a message is late by this much, once, instead of lost.
pub(crate) const LOOK_AGAIN: Duration = Duration::from_millis(250);

/// Why a wait ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wake {
    /// At least one reader has a message.
    Sample,
    /// The paced writer may send one more message.
    Room,
    /// A writer has left and everything that it sent has been taken. Told once per departure.
    WriterGone {
        /// Its channel.
        channel: Channel,
        /// How it left.
        departure: Departure,
    },
    /// The deadline has passed.
    DeadlineMissed,
    /// A stop was requested.
    Stop,
}

/// How a writer left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Departure {
    /// In good order.
    Stopped,
    /// It was found dead.
    Died,
}

/// What [`crate::Node::wait`] can wait for: every reader and writer of this crate.
pub trait Port: sealed::Poll {}

impl<T: sealed::Poll> Port for T {}

/// A writer that can wait for its readers.
pub trait Paced: sealed::Room {}

impl<T: sealed::Room> Paced for T {}

pub(crate) mod sealed {
    use super::{BorrowedFd, Error, Wake};

    pub trait Poll {
        /// Handles every event that has come, and tells why to wake up, if there is a reason.
        fn poll(&mut self) -> Result<Option<Wake>, Error>;
        /// The descriptor that becomes readable when an event comes.
        fn fd(&self) -> BorrowedFd<'_>;
    }

    pub trait Room: Poll {
        /// Whether one more message may be sent. Begins the next burst if one may begin.
        fn make_room(&mut self) -> Result<bool, Error>;
    }
}

pub(crate) fn wait(ports: &mut [&mut dyn Port], patience: Duration, stop: &Stop) -> Result<Wake, Error> {
    let until = Instant::now() + patience;
    loop {
        if stop.requested() {
            return Ok(Wake::Stop);
        }
        for port in ports.iter_mut() {
            if let Some(wake) = port.poll()? {
                return Ok(wake);
            }
        }
        let mut fds = [stop.fd(); MAX_PORTS + 1];
        let watched = fds.get_mut(1..=ports.len());
        let Some(watched) = watched else {
            return Err(Error::TooManyToWaitFor { ports: ports.len(), max: MAX_PORTS });
        };
        for (fd, port) in watched.iter_mut().zip(ports.iter()) {
            *fd = port.fd();
        }
        // As many as were just written.
        if !block(fds.get(..=ports.len()).unwrap_or(&fds), until)? {
            return Ok(Wake::DeadlineMissed);
        }
    }
}

pub(crate) fn wait_for_room(
    writer: &mut impl sealed::Room,
    patience: Duration,
    stop: &Stop,
) -> Result<Wake, Error> {
    let until = Instant::now() + patience;
    loop {
        if stop.requested() {
            return Ok(Wake::Stop);
        }
        if writer.make_room()? {
            return Ok(Wake::Room);
        }
        if !block(&[stop.fd(), writer.fd()], until)? {
            return Ok(Wake::DeadlineMissed);
        }
    }
}

/// Sleeps until a descriptor is readable or it is time to look again. False when the deadline has passed.
fn block(fds: &[BorrowedFd<'_>], until: Instant) -> Result<bool, Error> {
    let left = until.saturating_duration_since(Instant::now());
    if left.is_zero() {
        return Ok(false);
    }
    let Some(first) = fds.first() else { return Ok(false) };
    // Entries that no port needs are not watched: they only fill the array.
    let mut polls: [PollFd<'_>; MAX_PORTS + 1] =
        std::array::from_fn(|i| PollFd::from_borrowed_fd(*fds.get(i).unwrap_or(first), PollFlags::IN));
    let watched = polls.get_mut(..fds.len()).unwrap_or_default();
    match poll(watched, Some(&timespec(left.min(LOOK_AGAIN)))) {
        Ok(_) => Ok(true),
        // A signal that somebody else handles: look again.
        Err(error) if io::Error::from(error).kind() == io::ErrorKind::Interrupted => Ok(true),
        Err(error) => Err(Error::system("waiting for events", error)),
    }
}
