//! The request to stop, which every wait sees at once.

use crate::error::Error;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use signal_hook::consts::{SIGINT, SIGTERM};
use std::io::{self, Write};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Whether a stop was requested. Clones share one answer, and a request cannot be taken back.
///
/// It is a socket that becomes readable, not a flag. A wait would sleep through a signal that arrives after it looked at the flag and before it
/// blocks.
#[derive(Clone, Debug)]
pub struct Stop(Arc<Pair>);

#[derive(Debug)]
struct Pair {
    readable: UnixStream,
    write: UnixStream,
}

impl Stop {
    /// A stop that only [`Stop::request`] requests.
    ///
    /// # Errors
    /// [`Error::System`] when the process has no file descriptors left.
    pub fn new() -> Result<Self, Error> {
        let (readable, write) = UnixStream::pair().map_err(|e| Error::system("making a socket pair", e))?;
        // A signal handler must never block, and one byte is enough.
        write.set_nonblocking(true).map_err(|e| Error::system("making a socket non-blocking", e))?;
        Ok(Self(Arc::new(Pair { readable, write })))
    }

    /// A stop that SIGTERM and SIGINT request, for the whole process.
    ///
    /// # Errors
    /// [`Error::System`] when the handlers cannot be installed.
    pub fn on_signals() -> Result<Self, Error> {
        let stop = Self::new()?;
        for signal in [SIGTERM, SIGINT] {
            let write = stop.0.write.try_clone().map_err(|e| Error::system("copying a socket", e))?;
            signal_hook::low_level::pipe::register(signal, write)
                .map_err(|e| Error::system("installing a signal handler", e))?;
        }
        Ok(stop)
    }

    /// Requests a stop.
    pub fn request(&self) {
        // A full socket means that a stop was requested before.
        let _ = (&self.0.write).write(&[1]);
    }

    /// Whether a stop was requested.
    pub fn requested(&self) -> bool {
        self.wait(Duration::ZERO)
    }

    /// Waits for a request, at most for `patience`, and tells whether there was one.
    pub fn wait(&self, patience: Duration) -> bool {
        let until = Instant::now() + patience;
        loop {
            let mut fds = [PollFd::new(&self.0.readable, PollFlags::IN)];
            let left = timespec(until.saturating_duration_since(Instant::now()));
            match poll(&mut fds, Some(&left)) {
                Ok(ready) => return ready > 0,
                Err(error) if io::Error::from(error).kind() == io::ErrorKind::Interrupted => (),
                // Only a bad argument is left as a cause, and there is none: stopping is the safe answer.
                Err(_) => return true,
            }
        }
    }

    pub(crate) fn fd(&self) -> BorrowedFd<'_> {
        self.0.readable.as_fd()
    }
}

/// The duration for `poll`; one that is too long for the type becomes its maximum.
pub(crate) fn timespec(duration: Duration) -> Timespec {
    Timespec {
        tv_sec: i64::try_from(duration.as_secs()).unwrap_or(i64::MAX),
        tv_nsec: i64::from(duration.subsec_nanos()),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_clone_sees_the_request_and_it_stays() {
        let stop = Stop::new().unwrap();
        let other = stop.clone();
        assert!(!other.requested());
        stop.request();
        assert!(other.requested());
        assert!(other.requested());
    }
}
