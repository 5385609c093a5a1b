//! What can go wrong, where, and what to do about it.

use crate::channel::Channel;
use std::io;
use std::path::PathBuf;

/// Every fault of this crate. The text is for the technician: it names the place and the remedy.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The name of a station cannot be a part of file and unit names.
    #[error("station name {name:?}: allowed are 1 to {most} of a-z, 0-9 and '-'")]
    StationName {
        /// The name.
        name: String,
        /// Most bytes.
        most: usize,
    },
    /// Sockets live under the root and the kernel allows 107 bytes for their paths.
    #[error("root directory {root:?} has {len} characters: at most {most} work, choose a shorter one")]
    RootTooLong {
        /// The directory.
        root: PathBuf,
        /// Its length in bytes.
        len: usize,
        /// Most bytes.
        most: usize,
    },
    /// A relative path would mean something else in every process.
    #[error("root directory {root:?} is not an absolute path in plain ASCII")]
    RootNotAbsolute {
        /// The directory.
        root: PathBuf,
    },
    /// The root cannot be made or written to.
    #[error(
        "root directory {root:?} is not usable: {source}; let systemd make it (RuntimeDirectory=) or choose one that user can write to"
    )]
    RootNotWritable {
        /// The directory.
        root: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The station is another user's, whose shared memory this one cannot share.
    #[error(
        "station {station}: {root:?} belongs to another user than this process (user {own}); run this as the user of the station's units: `sudo -u andon ...`"
    )]
    OtherUser {
        /// The station.
        station: String,
        /// Its directory.
        root: PathBuf,
        /// The number of this process's user.
        own: u32,
    },
    /// The root has been removed or replaced while in use: from now on newcomers would not find the others.
    #[error(
        "root directory {root:?} was removed or replaced while in use (a cleaner of temporary files?): restart all roles of this station"
    )]
    RootVanished {
        /// The directory.
        root: PathBuf,
    },
    /// A full /dev/shm is a SIGBUS later: refused now.
    #[error(
        "/dev/shm has {free_mib} MiB free and this station needs {needed_mib} MiB: free some, enlarge it (mount -o remount,size=...) or lower the frame size"
    )]
    NoRoom {
        /// Free now.
        free_mib: u64,
        /// What all channels take when full.
        needed_mib: u64,
    },
    /// /dev/shm could not be looked at.
    #[error("/dev/shm cannot be read: {0}; is it mounted?")]
    SharedMemory(io::Error),
    /// There is a steward already.
    #[error("station {station} has a steward already (it holds {lock:?}): one is enough")]
    StewardRunning {
        /// The station.
        station: String,
        /// The lock file.
        lock: PathBuf,
    },
    /// No steward, or it is not ready.
    #[error(
        "station {station}: no channel {channel} after {waited_ms} ms; start the steward (`andond run steward`) and look at its log"
    )]
    NoSteward {
        /// The station.
        station: String,
        /// The channel.
        channel: Channel,
        /// How long it was tried.
        waited_ms: u128,
    },
    /// Writer and reader are different builds.
    #[error(
        "channel {channel}: this build has layout {ours}, the running station has {theirs}; stop every role of the station (held by: {members}), install one version, start again"
    )]
    LayoutMismatch {
        /// The channel.
        channel: Channel,
        /// Layout of this build.
        ours: String,
        /// Layout that is there.
        theirs: String,
        /// Processes that are alive in the station.
        members: String,
    },
    /// Another process writes this channel.
    #[error(
        "channel {channel} has as many {port} as it allows (members: {members}); stop the one that is too many"
    )]
    TooManyPorts {
        /// The channel.
        channel: Channel,
        /// "writers" or "readers".
        port: &'static str,
        /// Processes that are alive in the station.
        members: String,
    },
    /// A frame is larger than the steward made room for.
    #[error(
        "a frame of {bytes} bytes is larger than the {most} that the steward made room for: raise camera.width and camera.height and start the station again"
    )]
    FrameTooLarge {
        /// The frame.
        bytes: usize,
        /// Most bytes.
        most: usize,
    },
    /// The header of a frame promises more bytes than came.
    #[error("frame {seq}: its header promises {promised} bytes, {bytes} came")]
    FrameTorn {
        /// Its number.
        seq: u64,
        /// By the header.
        promised: usize,
        /// In the slice.
        bytes: usize,
    },
    /// Sending without waiting for room first, in paced mode.
    #[error("channel {channel} is paced and its reader has not caught up: call wait_for_room before send")]
    NoRoomYet {
        /// The channel.
        channel: Channel,
    },
    /// More ports than one wait can watch.
    #[error("{ports} ports in one wait, {most} fit")]
    TooManyToWaitFor {
        /// Ports given.
        ports: usize,
        /// Most.
        most: usize,
    },
    /// A stop was asked for while a port was being opened.
    #[error("asked to stop while opening channel {0}")]
    Stopped(Channel),
    /// The signal handler or the wait itself failed.
    #[error("{what}: {source}")]
    System {
        /// What was tried.
        what: &'static str,
        /// Why it failed.
        source: io::Error,
    },
    /// iceoryx2 refused; the text is its own word for it.
    #[error("channel {channel}: {what} failed: {why}")]
    Transport {
        /// The channel.
        channel: Channel,
        /// What was tried.
        what: &'static str,
        /// iceoryx2's word.
        why: String,
    },
    /// iceoryx2 could not set up this process.
    #[error(
        "station {station}: this process could not join: {why}; is {root:?} writable for this user, and the same user everywhere?"
    )]
    Join {
        /// The station.
        station: String,
        /// The directory.
        root: PathBuf,
        /// iceoryx2's word.
        why: String,
    },
}

impl Error {
    pub(crate) fn transport(channel: Channel, what: &'static str, why: impl std::fmt::Debug) -> Self {
        Self::Transport { channel, what, why: format!("{why:?}") }
    }

    pub(crate) fn system(what: &'static str, source: impl Into<io::Error>) -> Self {
        Self::System { what, source: source.into() }
    }
}
