//! The reader behind the C functions, in safe Rust.

use std::path::Path;
use std::time::{Duration, Instant};

use andon_ipc::{Channel, Error, MonotonicTime, Node, Port, Reader, Station, Stop, Wake};
use shm_schemas::{Health, Judging, RoleId, Verdict};

use super::line::Line;
use super::types::{AndonResult, AndonStatus};

/// A reader of the verdict channel of one station.
pub struct AndonReader {
    reader: Reader<Verdict>,
    judging: Reader<Judging>,
    health: Reader<Health>,
    line: Line,
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
        let (reader, judging, health) = (node.reader()?, node.reader()?, node.reader()?);
        Ok(Self { reader, judging, health, line: Line::default(), node, writer_gone: false })
    }

    /// Looks first, and waits only when nothing is there. Events are heard with a timeout of 0 too: a cyclic task has no other.
    pub(super) fn next(&mut self, timeout: Duration) -> Result<Next, Error> {
        let until = Instant::now() + timeout;
        loop {
            if let Some(sample) = self.reader.take()? {
                self.writer_gone = false;
                return Ok(Next::Verdict(*sample));
            }
            let left = until.saturating_duration_since(Instant::now());
            let ports = &mut [&mut self.reader as &mut dyn Port, &mut self.judging, &mut self.health];
            match self.node.wait(ports, left)? {
                Wake::WriterGone { channel: Channel::Verdict, .. } => {
                    self.writer_gone = true;
                    return Ok(Next::WriterGone);
                }
                Wake::DeadlineMissed | Wake::Stop => return Ok(Next::Nothing),
                Wake::Sample | Wake::Room | Wake::WriterGone { .. } => self.update_line()?,
            }
        }
    }

    /// Takes what the judge and the roles say of themselves.
    fn update_line(&mut self) -> Result<(), Error> {
        while let Some(judging) = self.judging.take()? {
            self.line.judging(&judging);
        }
        while let Some(health) = self.health.take()? {
            self.line.health(&health);
        }
        Ok(())
    }

    pub(super) fn status(&mut self) -> Result<AndonStatus, Error> {
        self.update_line()?;
        Ok(AndonStatus {
            received: self.reader.received(),
            lost: self.reader.lost(),
            restarts: self.reader.restarts(),
            writer_gone: self.writer_gone.into(),
            ready: (!self.writer_gone && self.line.is_ready(MonotonicTime::now())).into(),
            ..Default::default()
        })
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

    #[test]
    fn a_station_of_another_version_and_a_failing_system_have_their_own_numbers() {
        let channel = Channel::Verdict;
        let [ours, theirs, members] = ["a", "b", ""].map(String::from);
        assert_eq!(code(&Error::LayoutMismatch { channel, ours, theirs, members }), AndonResult::OtherBuild);
        assert_eq!(code(&Error::SharedMemory(std::io::Error::other("none"))), AndonResult::System);
    }
}
