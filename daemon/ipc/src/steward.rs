//! The steward: it owns every service of a station and removes what dead processes leave behind. It carries no data.

use crate::channel::{Channel, ChannelMessage, layout_text};
use crate::error::Error;
use crate::leftovers::{self, Death, Reaper};
use crate::service::{Frames, Messages, Provide, Refusal, Services, other_build};
use crate::station::{Limits, MEMBERS_LOCK, Station, Transport};
use iceoryx2::node::Node as IceNode;
use iceoryx2::prelude::*;
use shm_schemas::{
    AccountKept, AccountUpdate, Audit, Command, Couples, Detections, FilmPiece, FrameHeader, Health,
    Journalled, Judging, Layout, Printed, Task, Verdict,
};
use std::fs::{self, File, TryLockError};
use std::io;
use std::thread;
use std::time::Duration;

/// The period of [`Steward::poll`]: the longest time until a reader hears that its writer was killed.
pub const POLL_PERIOD: Duration = Duration::from_millis(100);

/// How long [`Steward::poll`] waits for a removal. Its caller must give signs of life meanwhile.
const REMOVAL_PATIENCE: Duration = POLL_PERIOD;

/// Once per second.
const POLLS_PER_RESERVATION: u32 = 10;

/// The steward holds it exclusively.
const STEWARD_LOCK: &str = "steward.lock";

/// Attempts to create a channel. Each removes one leftover, and a channel has three services.
const ATTEMPTS: u32 = 8;

/// Owns the services of a station while it lives. When it is dropped, the services remain for those who have them open; if nobody
/// has, everything is removed.
#[derive(Debug)]
pub struct Steward {
    // Fields are dropped in this order, as they must be: removals, services, node, locks.
    reaper: Reaper,
    _services: AllServices,
    node: IceNode<Transport>,
    station: Station,
    root_identity: (u64, u64),
    polls: u32,
    _last_one_out: LastOneOut,
    _steward_lock: File,
}

/// The steward's share of the members' lock. If nobody else has one when this is dropped, everything is removed.
#[derive(Debug)]
struct LastOneOut {
    lock: File,
    station: Station,
}

impl Drop for LastOneOut {
    fn drop(&mut self) {
        if self.lock.try_lock().is_ok() {
            // What cannot be removed now is removed at the next start.
            let _ = sweep(&self.station);
        }
    }
}

#[derive(Debug)]
struct AllServices {
    _frame: Services<Frames>,
    _detections: Services<Messages<Detections>>,
    _couple: Services<Messages<Couples>>,
    _verdict: Services<Messages<Verdict>>,
    _account: Services<Messages<AccountUpdate>>,
    _kept: Services<Messages<AccountKept>>,
    _journalled: Services<Messages<Journalled>>,
    _health: Services<Messages<Health>>,
    _command: Services<Messages<Command>>,
    _judging: Services<Messages<Judging>>,
    _audit: Services<Messages<Audit>>,
    _task: Services<Messages<Task>>,
    _printed: Services<Messages<Printed>>,
    _film: Services<Messages<FilmPiece>>,
}

impl Steward {
    /// Creates the root and all services of a station, or takes over those that are in use.
    ///
    /// When nobody else is in the station, it first removes whatever killed processes have left.
    ///
    /// # Errors
    /// [`Error::RootNotWritable`], [`Error::NoRoom`], [`Error::StewardRunning`], [`Error::LayoutMismatch`] when members
    /// of another build are alive, [`Error::ServiceUnreadable`], [`Error::Join`], [`Error::Transport`].
    pub fn create(station: &Station, limits: Limits) -> Result<Self, Error> {
        set_log_level(LogLevel::Error); // what matters below that level is returned as an error
        station.make_root()?;
        let steward_lock = lock_as_steward(station)?;
        let last_one_out = LastOneOut { lock: enter(station, sweep)?, station: station.clone() };
        station.check_room(limits)?;
        let root_identity = station.root_identity().map_err(|e| not_writable(station, e))?;
        leftovers::remove_unsized_services(&station.config()?);
        let node = join(station, "steward")?;
        let mut reaper = Reaper::default();
        reaper.reap(&node, Duration::MAX);
        let services = AllServices {
            _frame: create::<_, FrameHeader>(&node, station, limits, Channel::Frame)?,
            _detections: create_messages(&node, station, limits)?,
            _couple: create_messages(&node, station, limits)?,
            _verdict: create_messages(&node, station, limits)?,
            _account: create_messages(&node, station, limits)?,
            _kept: create_messages(&node, station, limits)?,
            _journalled: create_messages(&node, station, limits)?,
            _health: create_messages(&node, station, limits)?,
            _command: create_messages(&node, station, limits)?,
            _judging: create_messages(&node, station, limits)?,
            _audit: create_messages(&node, station, limits)?,
            _task: create_messages(&node, station, limits)?,
            _printed: create_messages(&node, station, limits)?,
            _film: create_messages(&node, station, limits)?,
        };
        station.reserve()?;
        Ok(Self {
            reaper,
            _services: services,
            node,
            station: station.clone(),
            root_identity,
            polls: 0,
            _last_one_out: last_one_out,
            _steward_lock: steward_lock,
        })
    }

    /// Removes what dead members left behind, which wakes their readers, and reports who died. It takes about 0.1 ms when
    /// nobody did, and should be called every [`POLL_PERIOD`]. A removal that takes longer than that is told by a later call.
    ///
    /// # Errors
    /// [`Error::RootVanished`] when the root is no longer the directory in which the station was created.
    pub fn poll(&mut self) -> Result<Vec<Death>, Error> {
        if self.station.root_identity().ok() != Some(self.root_identity) {
            return Err(Error::RootVanished { root: self.station.root().into() });
        }
        self.polls = self.polls.wrapping_add(1);
        if self.polls.is_multiple_of(POLLS_PER_RESERVATION) {
            // Of connections that were made since: each port has reserved its own. Where there is no room now, there may be later.
            let _ = self.station.reserve();
        }
        Ok(self.reaper.reap(&self.node, REMOVAL_PATIENCE))
    }
}

fn create_messages<T: ChannelMessage>(
    node: &IceNode<Transport>,
    station: &Station,
    limits: Limits,
) -> Result<Services<Messages<T>>, Error> {
    create::<_, T>(node, station, limits, T::CHANNEL)
}

/// Creates the services of one channel. The lock says that there is no other steward, and only stewards create services. An incomplete one was left
/// by a steward that was killed.
fn create<S: Provide, T: Layout>(
    node: &IceNode<Transport>,
    station: &Station,
    limits: Limits,
    channel: Channel,
) -> Result<S, Error> {
    let mut last = String::new();
    for _ in 0..ATTEMPTS {
        match S::create(node, station, limits) {
            Ok(services) => return Ok(services),
            Err(Refusal::Incomplete(pattern)) => {
                last = format!("an incomplete {pattern:?} service was left");
                leftovers::remove_incomplete(node, station, channel, pattern)?;
            }
            Err(Refusal::NotYet) => {
                // Its last user is removing it, which takes a few system calls.
                last = "the service is being removed".into();
                thread::sleep(Duration::from_millis(20));
            }
            Err(Refusal::OtherBuild) => {
                let ours = format!("{} for frames of {} bytes", layout_text::<T>(), limits.frame_bytes);
                return Err(other_build(station, channel, ours));
            }
            Err(Refusal::Broken(why)) => return Err(Error::transport(channel, "creating", why)),
        }
    }
    Err(Error::transport(channel, "creating", last))
}

/// Joins as an iceoryx2 node that handles no signals.
pub(crate) fn join(station: &Station, name: &str) -> Result<IceNode<Transport>, Error> {
    let refused =
        |why: String| Error::Join { station: station.name().into(), root: station.root().into(), why };
    let name = NodeName::new(name).map_err(|e| refused(format!("{e:?}")))?;
    NodeBuilder::new()
        .name(&name)
        .config(&station.config()?)
        .signal_handling_mode(SignalHandlingMode::Disabled)
        .create::<Transport>()
        .map_err(|e| refused(format!("{e:?}")))
}

/// Takes the members' lock shared. If nobody else has it, calls `when_alone` first.
pub(crate) fn enter(
    station: &Station,
    when_alone: impl FnOnce(&Station) -> io::Result<()>,
) -> Result<File, Error> {
    let path = station.root().join(MEMBERS_LOCK);
    let lock = File::options().create(true).append(true).open(path).map_err(|e| not_writable(station, e))?;
    if lock.try_lock().is_ok() {
        when_alone(station).map_err(|e| not_writable(station, e))?;
    }
    // Another process has it exclusively for no longer than a sweep.
    lock.lock_shared().map_err(|e| not_writable(station, e))?;
    Ok(lock)
}

fn lock_as_steward(station: &Station) -> Result<File, Error> {
    let path = station.root().join(STEWARD_LOCK);
    let lock = File::options().create(true).append(true).open(&path).map_err(|e| not_writable(station, e))?;
    match lock.try_lock() {
        Ok(()) => Ok(lock),
        Err(TryLockError::WouldBlock) => {
            Err(Error::StewardRunning { station: station.name().into(), lock: path })
        }
        Err(TryLockError::Error(e)) => Err(not_writable(station, e)),
    }
}

fn not_writable(station: &Station, source: io::Error) -> Error {
    Error::RootNotWritable { root: station.root().into(), source }
}

/// Removes everything but the locks. Only for a process that is alone in the station.
fn sweep(station: &Station) -> io::Result<()> {
    for entry in fs::read_dir(station.root())? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            fs::remove_dir_all(entry.path())?;
        } else if !entry.file_name().as_encoded_bytes().ends_with(b".lock") {
            fs::remove_file(entry.path())?;
        }
    }
    let prefix = station.shm_prefix();
    for entry in fs::read_dir("/dev/shm")? {
        let entry = entry?;
        if entry.file_name().as_encoded_bytes().starts_with(prefix.as_bytes()) {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}
