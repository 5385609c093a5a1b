//! Waiting: for messages, for room, for the wish to stop; always with a deadline, and the answer says why it ended.

use crate::channel::Channel;
use crate::error::Error;
use crate::stop::{Stop, timespec};
use rustix::event::{PollFd, PollFlags, poll};
use std::io;
use std::os::fd::BorrowedFd;
use std::time::{Duration, Instant};

/// Ports in one wait: no role has more than its input, its output, commands and health.
const PORTS: usize = 8;

/// Blocked for so long, a wait looks at its ports again. Nothing is found unless two notifiers of one listener met in
/// the one interleaving that `event::drain` cannot put right; then it costs this much once instead of the message.
const LOOK_AGAIN: Duration = Duration::from_millis(250);

/// Why a wait ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wake {
    /// At least one reader has a message.
    Sample,
    /// The paced writer may send one more.
    Room,
    /// A writer has gone and everything that it sent has been taken. Said once for each departure.
    WriterGone {
        /// Its channel.
        channel: Channel,
        /// How it left.
        departure: Departure,
    },
    /// The time is over.
    DeadlineMissed,
    /// A stop was asked for.
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

/// Something that [`crate::Node::wait`] can wait at: every reader and writer of this crate.
pub trait Port: sealed::Tend {}

impl<T: sealed::Tend> Port for T {}

/// A writer that can be made to wait for its readers.
pub trait Paced: sealed::Room {}

impl<T: sealed::Room> Paced for T {}

pub(crate) mod sealed {
    use super::{BorrowedFd, Error, Wake};

    pub trait Tend {
        /// Deals with every event that has come. Says what there is to wake up for.
        fn tend(&mut self) -> Result<Option<Wake>, Error>;
        /// Becomes readable when an event comes.
        fn fd(&self) -> BorrowedFd<'_>;
    }

    pub trait Room: Tend {
        /// Whether one more may be sent; begins the next burst if it may.
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
            if let Some(wake) = port.tend()? {
                return Ok(wake);
            }
        }
        let mut fds = [stop.fd(); PORTS + 1];
        let watched = fds.get_mut(1..=ports.len());
        let Some(watched) = watched else {
            return Err(Error::TooManyToWaitFor { ports: ports.len(), most: PORTS });
        };
        for (fd, port) in watched.iter_mut().zip(ports.iter()) {
            *fd = port.fd();
        }
        if !block(&fds, until)? {
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

/// Sleeps until a descriptor is readable or it is time to look again. False when the time is over.
fn block(fds: &[BorrowedFd<'_>], until: Instant) -> Result<bool, Error> {
    let left = until.saturating_duration_since(Instant::now());
    if left.is_zero() {
        return Ok(false);
    }
    let Some(first) = fds.first() else { return Ok(false) };
    // Places that no port takes watch the first descriptor once more, which changes nothing.
    let mut polls: [PollFd<'_>; PORTS + 1] =
        std::array::from_fn(|i| PollFd::from_borrowed_fd(*fds.get(i).unwrap_or(first), PollFlags::IN));
    match poll(&mut polls, Some(&timespec(left.min(LOOK_AGAIN)))) {
        Ok(_) => Ok(true),
        // A signal that is not ours to handle: look again.
        Err(error) if io::Error::from(error).kind() == io::ErrorKind::Interrupted => Ok(true),
        Err(error) => Err(Error::system("waiting for events", error)),
    }
}
