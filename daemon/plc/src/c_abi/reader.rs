//! The reader behind the C functions, in safe Rust.

use std::path::Path;
use std::time::{Duration, Instant};

use andon_ipc::{Error, Node, Reader, Station, Stop, Wake};
use shm_schemas::{RoleId, Verdict};

use super::types::{AndonResult, AndonStatus};

/// A reader of the verdict channel of one station.
pub struct AndonReader {
    reader: Reader<Verdict>,
    node: Node,
    writer_gone: bool,
}

// The header lets a reader go from one thread to another between calls.
const fn assert_send<T: Send>() {}
const _: () = assert_send::<AndonReader>();

/// What a wait ended with.
pub(super) enum Next {
    Verdict(Verdict),
    WriterGone,
    Nothing,
}

impl AndonReader {
    pub(super) fn open(root: Option<&str>, station: &str, patience: Duration) -> Result<Self, Error> {
        let station = match root {
            Some(root) => Station::under(station, Path::new(root))?,
            None => Station::new(station)?,
        };
        // Nobody requests this stop: signals belong to the program, and no handler is installed here.
        let stop = Stop::new()?;
        let node = Node::open(&station, RoleId::Plc, patience, &stop)?;
        let reader = node.reader()?;
        Ok(Self { reader, node, writer_gone: false })
    }

    /// Looks first, and waits only when nothing is there.
    pub(super) fn next(&mut self, timeout: Duration) -> Result<Next, Error> {
        let until = Instant::now() + timeout;
        loop {
            if let Some(sample) = self.reader.take()? {
                self.writer_gone = false;
                return Ok(Next::Verdict(*sample));
            }
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(Next::Nothing);
            }
            match self.node.wait(&mut [&mut self.reader], left)? {
                Wake::WriterGone { .. } => {
                    self.writer_gone = true;
                    return Ok(Next::WriterGone);
                }
                Wake::DeadlineMissed | Wake::Stop => return Ok(Next::Nothing),
                Wake::Sample | Wake::Room => {}
            }
        }
    }

    pub(super) fn status(&self) -> AndonStatus {
        AndonStatus {
            received: self.reader.received(),
            lost: self.reader.lost(),
            restarts: self.reader.restarts(),
            writer_gone: self.writer_gone.into(),
            ..Default::default()
        }
    }
}

/// The number for C. The text goes to `andon_last_error`.
pub(super) fn code(error: &Error) -> AndonResult {
    match error {
        Error::StationName { .. } | Error::RootTooLong { .. } | Error::RootNotAbsolute { .. } => {
            AndonResult::Station
        }
        Error::NoSteward { .. } => AndonResult::NoSteward,
        Error::LayoutMismatch { .. } => AndonResult::OtherBuild,
        Error::TooManyPorts { .. } => AndonResult::TooManyReaders,
        _ => AndonResult::System,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use andon_ipc::Channel;

    #[test]
    fn a_station_of_another_version_and_a_failing_system_have_their_own_numbers() {
        let channel = Channel::Verdict;
        let [ours, theirs, members] = ["a", "b", ""].map(String::from);
        assert_eq!(code(&Error::LayoutMismatch { channel, ours, theirs, members }), AndonResult::OtherBuild);
        assert_eq!(code(&Error::SharedMemory(std::io::Error::other("none"))), AndonResult::System);
    }
}
