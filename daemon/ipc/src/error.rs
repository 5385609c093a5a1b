//! What can go wrong, where, and what to do about it.

use crate::channel::Channel;
use std::io;
use std::path::PathBuf;

/// Every error of this crate. The text is for the technician: it names the place and the remedy.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The name of a station cannot be a part of file and unit names.
    #[error("station name {name:?}: a name has 1 to {max} characters of a-z, 0-9 and '-'")]
    StationName {
        /// The name.
        name: String,
        /// Maximum number of bytes.
        max: usize,
    },
    /// Sockets lie under the root, and the kernel allows 107 bytes for their paths.
    #[error("root directory {root:?} has {len} characters and may have {max}: choose a shorter one")]
    RootTooLong {
        /// The directory.
        root: PathBuf,
        /// Its length in bytes.
        len: usize,
        /// Maximum number of bytes.
        max: usize,
    },
    /// A relative path would mean something else in every process.
    #[error("root directory {root:?} is not an absolute path in ASCII: choose one that is")]
    RootNotAbsolute {
        /// The directory.
        root: PathBuf,
    },
    /// The root cannot be made or written to.
    #[error(
        "root directory {root:?} is not usable: {source}; let systemd make it (RuntimeDirectory=) or choose one that this user can write to"
    )]
    RootNotWritable {
        /// The directory.
        root: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The station belongs to another user, whose shared memory this one cannot open.
    #[error(
        "station {station}: {root:?} does not belong to the user of this process (user {own}); run this as the user of the station's units: `sudo -u andon ...`"
    )]
    OtherUser {
        /// The station.
        station: String,
        /// Its directory.
        root: PathBuf,
        /// The number of the user of this process.
        own: u32,
    },
    /// The root was removed or replaced while in use: a process that starts from now on would not find the others.
    #[error(
        "root directory {root:?} was removed or replaced while in use; keep cleaners of temporary files away from it, and restart every role of the station"
    )]
    RootVanished {
        /// The directory.
        root: PathBuf,
    },
    /// A /dev/shm that fills up later ends a process with SIGBUS, so the steward refuses to start.
    #[error(
        "/dev/shm has {free_mib} MiB free and this station needs {needed_mib} MiB: free some, enlarge it (mount -o remount,size=...) or lower the frame size"
    )]
    NoRoom {
        /// What is free now.
        free_mib: u64,
        /// What all channels take when they are full.
        needed_mib: u64,
    },
    /// /dev/shm could not be read.
    #[error("/dev/shm cannot be read: {0}; is it mounted?")]
    SharedMemory(io::Error),
    /// There is a steward already.
    #[error("station {station} has a steward already (it holds {lock:?}): a station has one")]
    StewardRunning {
        /// The station.
        station: String,
        /// The lock file.
        lock: PathBuf,
    },
    /// There is no steward, or it is not ready.
    #[error(
        "station {station}: no steward has opened the channel {channel} within {waited_ms} ms; start it (`systemctl start andon-steward@{station}`, or `andond run steward`) and look at its log"
    )]
    NoSteward {
        /// The station.
        station: String,
        /// The channel.
        channel: Channel,
        /// How long this process waited.
        waited_ms: u128,
    },
    /// Writer and reader are different builds.
    #[error(
        "channel {channel}: this build has layout {ours}, the running station {theirs}; stop every role of the station (held by: {members}), install one version, start again"
    )]
    LayoutMismatch {
        /// The channel.
        channel: Channel,
        /// Layout of this build.
        ours: String,
        /// Layout of the running station.
        theirs: String,
        /// Processes that are alive in the station.
        members: String,
    },
    /// iceoryx2 cannot use the service and cannot say whether somebody else does.
    #[error(
        "channel {channel}: the description of its service cannot be read ({why}); stop every role of the station (members: {members}), then start the steward, which removes it"
    )]
    ServiceUnreadable {
        /// The channel.
        channel: Channel,
        /// iceoryx2's word.
        why: String,
        /// Processes that are alive in the station.
        members: String,
    },
    /// All ports of a kind are taken.
    #[error(
        "channel {channel} has as many {port} as it allows (members of the station: {members}); stop one that is not needed"
    )]
    TooManyPorts {
        /// The channel.
        channel: Channel,
        /// "writers" or "readers".
        port: &'static str,
        /// Processes that are alive in the station.
        members: String,
    },
    /// The steward made room for smaller frames only.
    #[error(
        "a frame of {bytes} bytes is larger than the {max} that the steward made room for: raise camera.width and camera.height and start the station again"
    )]
    FrameTooLarge {
        /// Size of the frame.
        bytes: usize,
        /// Maximum number of bytes.
        max: usize,
    },
    /// The header of a frame promises more bytes than the frame has.
    #[error(
        "frame {seq}: its header promises {promised} bytes and it has {bytes}: writer and reader are different builds, install one version"
    )]
    FrameTorn {
        /// Its number.
        seq: u64,
        /// Bytes by the header.
        promised: usize,
        /// Bytes of the frame.
        bytes: usize,
    },
    /// A paced writer was told to send without waiting for room first.
    #[error("channel {channel} is paced and its reader has not caught up: call wait_for_room before send")]
    NoRoomYet {
        /// The channel.
        channel: Channel,
    },
    /// One wait cannot watch that many ports.
    #[error("one wait was given {ports} ports and can watch {max}: wait for fewer")]
    TooManyToWaitFor {
        /// Ports given.
        ports: usize,
        /// Maximum number of ports.
        max: usize,
    },
    /// A stop was requested while a port was being opened.
    #[error("a stop was requested while channel {0} was being opened")]
    Stopped(Channel),
    /// The operating system refused a call.
    #[error("{what}: {source}")]
    System {
        /// What was tried.
        what: &'static str,
        /// Why it failed.
        source: io::Error,
    },
    /// iceoryx2 refused; `why` is its own word for it.
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
