//! A process that has joined a station: it opens ports and waits for them.

use crate::channel::{Channel, ChannelMessage, layout_text};
use crate::error::Error;
use crate::frame::{FrameReader, FrameWriter};
use crate::reader::Reader;
use crate::service::{Attempt, Provide, Refusal, other_build};
use crate::station::{Station, Transport};
use crate::steward::{enter, join};
use crate::stop::Stop;
use crate::wait::{Paced, Port, Wake, wait, wait_for_room};
use crate::writer::Writer;
use iceoryx2::node::Node as IceNode;
use iceoryx2::prelude::*;
use shm_schemas::{FrameHeader, Layout, RoleId};
use std::fs::File;
use std::time::{Duration, Instant};

/// The pause between two attempts to open what is not there yet. Only used while starting.
const TRY_AGAIN: Duration = Duration::from_millis(10);

/// A member of a station. Ports keep what they need: a node may be dropped before its ports.
#[derive(Debug)]
pub struct Node {
    node: IceNode<Transport>,
    station: Station,
    role: RoleId,
    patience: Duration,
    deadline: Option<Duration>,
    stop: Stop,
    configuration: u64,
    root_identity: (u64, u64),
    _members_lock: File,
}

impl Node {
    /// Joins a station. Its steward may still be starting: this waits for at most `patience`, and so does opening a port.
    ///
    /// # Errors
    /// [`Error::NoSteward`] when the root does not appear in time, [`Error::Join`], [`Error::RootNotWritable`],
    /// [`Error::OtherUser`], [`Error::Stopped`].
    pub fn open(station: &Station, role: RoleId, patience: Duration, stop: &Stop) -> Result<Self, Error> {
        set_log_level(LogLevel::Error); // what matters below that level is returned as an error
        let started = Instant::now();
        while !station.is_ours()? {
            give_up(station, Channel::Health, started, patience)?;
            if stop.wait(TRY_AGAIN) {
                return Err(Error::Stopped(Channel::Health));
            }
        }
        let members_lock = enter(station, |_| Ok(()))?;
        let node = join(station, role.name())?;
        let (station, stop) = (station.clone(), stop.clone());
        let root_identity = station
            .root_identity()
            .map_err(|source| Error::RootNotWritable { root: station.root().into(), source })?;
        Ok(Self {
            node,
            station,
            role,
            patience,
            deadline: None,
            stop,
            configuration: 0,
            root_identity,
            _members_lock: members_lock,
        })
    }

    /// Says with which configuration this process runs, as a hash, for its health.
    #[must_use]
    pub fn with_configuration(self, configuration: u64) -> Self {
        Self { configuration, ..self }
    }

    /// The hash of the configuration; 0 where none was given.
    pub fn configuration(&self) -> u64 {
        self.configuration
    }

    /// Whether the station is still the one that was joined. A process that starts after its directory was removed is in another.
    ///
    /// # Errors
    /// [`Error::RootVanished`] when the root is no longer the directory that was joined.
    pub fn check_root(&self) -> Result<(), Error> {
        if self.station.root_identity().ok() == Some(self.root_identity) {
            return Ok(());
        }
        Err(Error::RootVanished { root: self.station.root().into() })
    }

    /// Says in every sign of life how long this role may give none.
    #[must_use]
    pub fn with_deadline(self, deadline: Option<Duration>) -> Self {
        Self { deadline, ..self }
    }

    /// How long this role may give no sign of life; `None` where it has no deadline.
    pub fn deadline(&self) -> Option<Duration> {
        self.deadline
    }

    /// The station.
    pub fn station(&self) -> &Station {
        &self.station
    }

    /// The role that it was opened with.
    pub fn role(&self) -> RoleId {
        self.role
    }

    /// The stop that ends its waits.
    pub fn stop(&self) -> &Stop {
        &self.stop
    }

    /// A reader of `T`'s channel. It gets the history of the channel if the writer is there.
    ///
    /// # Errors
    /// [`Error::NoSteward`], [`Error::LayoutMismatch`], [`Error::TooManyPorts`], [`Error::Stopped`],
    /// [`Error::NoRoom`], [`Error::Transport`].
    pub fn reader<T: ChannelMessage>(&self) -> Result<Reader<T>, Error> {
        let services = self.services::<_, T>(T::CHANNEL)?;
        self.make(T::CHANNEL, services, |services| Reader::new(services, self.role))
    }

    /// The writer of `T`'s channel. It is live: it never waits for its readers. If its predecessor was killed, this waits
    /// until the steward has removed that one.
    ///
    /// # Errors
    /// As [`Node::reader`].
    pub fn writer<T: ChannelMessage>(&self) -> Result<Writer<T>, Error> {
        let services = self.services::<_, T>(T::CHANNEL)?;
        self.make(T::CHANNEL, services, Writer::new)
    }

    /// A reader of the channel `frame`.
    ///
    /// # Errors
    /// As [`Node::reader`].
    pub fn frame_reader(&self) -> Result<FrameReader, Error> {
        let services = self.services::<_, FrameHeader>(Channel::Frame)?;
        self.make(Channel::Frame, services, |services| FrameReader::new(services, self.role))
    }

    /// The writer of the channel `frame`. It is live.
    ///
    /// # Errors
    /// As [`Node::reader`].
    pub fn frame_writer(&self) -> Result<FrameWriter, Error> {
        let services = self.services::<_, FrameHeader>(Channel::Frame)?;
        self.make(Channel::Frame, services, FrameWriter::new)
    }

    /// Blocks until one of the ports has something to say, `patience` is over or a stop is requested. Writers belong
    /// in here as well: this is where they answer readers that come up.
    ///
    /// # Errors
    /// [`Error::TooManyToWaitFor`], [`Error::System`], [`Error::Transport`].
    pub fn wait(&self, ports: &mut [&mut dyn Port], patience: Duration) -> Result<Wake, Error> {
        wait(ports, patience, &self.stop)
    }

    /// Blocks until a paced writer may send one more message: [`Wake::Room`]. A live writer always may.
    ///
    /// # Errors
    /// As [`Node::wait`].
    pub fn wait_for_room(&self, writer: &mut impl Paced, patience: Duration) -> Result<Wake, Error> {
        wait_for_room(writer, patience, &self.stop)
    }

    /// Makes a port, which takes the services with it.
    fn make<S, P>(
        &self,
        channel: Channel,
        services: S,
        make: impl Fn(S) -> Result<P, (S, Attempt)>,
    ) -> Result<P, Error> {
        let mut services = Some(services);
        let port = self.retry(channel, || {
            // It is there: each attempt that failed has given it back.
            let taken = services.take().ok_or(Attempt::Again(None))?;
            make(taken).map_err(|(given_back, attempt)| {
                services = Some(given_back);
                attempt
            })
        })?;
        self.station.reserve()?;
        Ok(port)
    }

    fn services<S: Provide, T: Layout>(&self, channel: Channel) -> Result<S, Error> {
        self.retry(channel, || match S::open(&self.node, &self.station) {
            Ok(services) => Ok(services),
            // The steward is creating it, or removes what is left of it and creates it again.
            Err(Refusal::NotYet | Refusal::Incomplete(_)) => Err(Attempt::Again(None)),
            Err(Refusal::OtherBuild) => {
                Err(Attempt::Failed(other_build(&self.station, channel, layout_text::<T>())))
            }
            Err(Refusal::Broken(why)) => Err(Attempt::Failed(Error::transport(channel, "opening", why))),
        })
    }

    fn retry<R>(
        &self,
        channel: Channel,
        mut attempt: impl FnMut() -> Result<R, Attempt>,
    ) -> Result<R, Error> {
        let started = Instant::now();
        loop {
            match attempt() {
                Ok(result) => return Ok(result),
                Err(Attempt::Failed(error)) => return Err(error),
                Err(Attempt::Again(Some(port))) if started.elapsed() >= self.patience => {
                    return Err(Error::TooManyPorts { channel, port, members: self.station.members_text() });
                }
                Err(Attempt::Again(_)) => give_up(&self.station, channel, started, self.patience)?,
            }
            if self.stop.wait(TRY_AGAIN) {
                return Err(Error::Stopped(channel));
            }
        }
    }
}

fn give_up(station: &Station, channel: Channel, started: Instant, patience: Duration) -> Result<(), Error> {
    let waited = started.elapsed();
    if waited < patience {
        return Ok(());
    }
    Err(Error::NoSteward { station: station.name().into(), channel, waited_ms: waited.as_millis() })
}
