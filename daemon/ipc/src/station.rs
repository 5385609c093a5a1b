//! A station: one bench with a name and a directory of its own, so that one PC can serve several.

use crate::channel::{Channel, message_bytes};
use crate::error::Error;
use iceoryx2::node::{Node as IceNode, NodeState, NodeView};
use iceoryx2::prelude::*;
use rustix::fs::{FallocateFlags, fallocate, statvfs};
use shm_schemas::STATION_BYTES;
use std::fs;
use std::io;
use std::os::unix::fs::{DirBuilderExt, MetadataExt};
use std::path::{Path as StdPath, PathBuf};
use std::time::Duration;

/// Maximum length of a root. The kernel allows 107 bytes for the path of a socket, and iceoryx2 appends up to 46 for prefix, id and suffix. Two
/// remain.
const MAX_ROOT_BYTES: usize = 59;

/// Where Linux keeps shared memory.
pub(crate) const SHM: &str = "/dev/shm";

/// Every member holds it shared. A process that gets it exclusively is alone in the station.
pub(crate) const MEMBERS_LOCK: &str = "members.lock";

/// What queues, services and events take besides the messages: 11 MiB were measured with every port in use; rounded up.
const MANAGEMENT_BYTES: u64 = 16 << 20;

/// How long iceoryx2 waits for another process to finish creating a service. Creation takes under 1 ms; a creator that
/// was killed never finishes.
const CREATION_TIMEOUT: Duration = Duration::from_millis(300);

/// iceoryx2's transport between processes, in the variant whose ports may be handed to another thread. A C program may open its reader in one thread
/// and read in another. The variant for one thread would save an uncontended lock per call.
pub(crate) type Transport = ipc_threadsafe::Service;

/// The name and the directory of a station. Making one opens nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Station {
    name: String,
    root: PathBuf,
}

/// Whether a station may have this name: 1 to [`STATION_BYTES`] of a-z, 0-9 and '-'.
pub fn is_station_name(name: &str) -> bool {
    let allowed = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-';
    (1..=STATION_BYTES).contains(&name.len()) && name.bytes().all(allowed)
}

/// What the steward makes room for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Maximum size of a frame in bytes, colour and depth together.
    pub frame_bytes: usize,
}

impl Default for Limits {
    /// 1920 x 1080 RGB and 1280 x 720 depth, the largest pictures that a RealSense D4xx gives at 30 Hz.
    fn default() -> Self {
        Self { frame_bytes: 1920 * 1080 * 3 + 1280 * 720 * 2 }
    }
}

/// A process that has joined a station.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Member {
    /// Name of its role.
    pub name: String,
    /// Process id.
    pub pid: u32,
}

impl std::fmt::Display for Member {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} (pid {})", self.name, self.pid)
    }
}

impl Station {
    /// The station `name` under `/run/andon/<name>`.
    ///
    /// # Errors
    /// [`Error::StationName`] when the name is empty, too long or not made of `a-z`, `0-9`, `-`.
    pub fn new(name: &str) -> Result<Self, Error> {
        Self::under(name, &StdPath::new("/run/andon").join(name))
    }

    /// The station `name` under another root: for tests and demonstrations without the rights of root.
    ///
    /// # Errors
    /// As [`Station::new`], and [`Error::RootTooLong`], [`Error::RootNotAbsolute`].
    pub fn under(name: &str, root: &StdPath) -> Result<Self, Error> {
        if !is_station_name(name) {
            return Err(Error::StationName { name: name.into(), max: STATION_BYTES });
        }
        let text = root.to_str().filter(|text| text.is_ascii() && root.is_absolute());
        let Some(text) = text else {
            return Err(Error::RootNotAbsolute { root: root.into() });
        };
        if text.len() > MAX_ROOT_BYTES {
            return Err(Error::RootTooLong { root: root.into(), len: text.len(), max: MAX_ROOT_BYTES });
        }
        Ok(Self { name: name.into(), root: root.into() })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its directory.
    pub fn root(&self) -> &StdPath {
        &self.root
    }

    /// Whether its directory is there and belongs to the user of this process. Only its owner can read shared memory here: the user
    /// root would join, hear nothing, and leave files that the steward cannot remove.
    pub(crate) fn is_ours(&self) -> Result<bool, Error> {
        let own = rustix::process::geteuid().as_raw();
        let other = || Error::OtherUser { station: self.name.clone(), root: self.root.clone(), own };
        match fs::metadata(&self.root) {
            Ok(root) if root.uid() == own => Ok(root.is_dir()),
            Ok(_) => Err(other()),
            Err(error) if error.kind() == io::ErrorKind::PermissionDenied => Err(other()),
            Err(_) => Ok(false),
        }
    }

    /// The processes that have joined and are alive; none when the list cannot be read.
    pub fn members(&self) -> Vec<Member> {
        let mut members = Vec::new();
        let Ok(config) = self.config() else { return members };
        let _ = IceNode::<Transport>::list(&config, |state| {
            if let NodeState::Alive(node) = state {
                members.extend(node.details().as_ref().map(member));
            }
            CallbackProgression::Continue
        });
        members
    }

    /// The members, for error texts.
    pub(crate) fn members_text(&self) -> String {
        let members: Vec<String> = self.members().iter().map(Member::to_string).collect();
        if members.is_empty() { "nobody".into() } else { members.join(", ") }
    }

    /// What the names of this station's files in /dev/shm begin with. It depends on the root, so that stations with the
    /// same name under different roots never meet.
    pub fn shm_prefix(&self) -> String {
        // FNV-1a, as for the layouts: it only has to distinguish directories.
        let fold = |hash: u32, byte: u8| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        let hash = self.root.as_os_str().as_encoded_bytes().iter().copied().fold(0x811c_9dc5, fold);
        format!("andon_{}_{hash:08x}_", self.name)
    }

    /// The settings of iceoryx2 for this station. Only the steward removes dead nodes, so that each death is reported once.
    pub(crate) fn config(&self) -> Result<Config, Error> {
        let refused = |why: String| Error::Join { station: self.name.clone(), root: self.root.clone(), why };
        let root =
            Path::new(self.root.as_os_str().as_encoded_bytes()).map_err(|e| refused(format!("{e:?}")))?;
        let prefix = FileName::new(self.shm_prefix().as_bytes()).map_err(|e| refused(format!("{e:?}")))?;
        let mut config = Config::default();
        config.global.set_root_path(&root);
        config.global.prefix = prefix;
        config.global.creation_timeout = CREATION_TIMEOUT;
        config.global.service.cleanup_dead_nodes_on_open = false;
        config.global.node.cleanup_dead_nodes_on_creation = false;
        config.global.node.cleanup_dead_nodes_on_destruction = false;
        Ok(config)
    }

    /// Whether any process has joined, dead ones that nobody has removed not counted.
    pub fn is_in_use(&self) -> bool {
        let lock = fs::File::options().read(true).open(self.root.join(MEMBERS_LOCK));
        lock.is_ok_and(|lock| lock.try_lock().is_err())
    }

    /// Makes the root and checks that this user can write to it.
    pub(crate) fn make_root(&self) -> Result<(), Error> {
        let probe = self.root.join(format!(".write-probe-{}", std::process::id()));
        fs::DirBuilder::new()
            .recursive(true)
            .mode(0o700)
            .create(&self.root)
            .and_then(|()| fs::write(&probe, b""))
            .and_then(|()| fs::remove_file(&probe))
            .map_err(|source| Error::RootNotWritable { root: self.root.clone(), source })
    }

    /// Device and inode of the root, which another directory under the same path does not share.
    pub(crate) fn root_identity(&self) -> io::Result<(u64, u64)> {
        fs::metadata(&self.root).map(|meta| (meta.dev(), meta.ino()))
    }

    /// Refuses when /dev/shm cannot hold every channel when it is full. What this station holds already counts as free.
    pub(crate) fn check_room(&self, limits: Limits) -> Result<(), Error> {
        let needed = needed_bytes(limits);
        let stat = statvfs(SHM).map_err(|e| Error::SharedMemory(e.into()))?;
        let free = stat.f_bavail.saturating_mul(stat.f_frsize);
        let held = self.held_bytes().map_err(Error::SharedMemory)?;
        if free.saturating_add(held) < needed {
            return Err(Error::NoRoom { free_mib: free >> 20, needed_mib: needed >> 20 });
        }
        Ok(())
    }

    /// Takes the memory of every file of this station in /dev/shm for good. Otherwise the kernel takes it at the first write, and ends the
    /// process with SIGBUS where there is none left.
    ///
    /// # Errors
    /// [`Error::NoRoom`] when /dev/shm is full.
    pub(crate) fn reserve(&self) -> Result<(), Error> {
        let prefix = self.shm_prefix();
        // What cannot be listed or opened now belongs to somebody who is making or removing it.
        for entry in fs::read_dir(SHM).map_err(Error::SharedMemory)?.flatten() {
            if !entry.file_name().as_encoded_bytes().starts_with(prefix.as_bytes()) {
                continue;
            }
            let is_whole = |meta: &fs::Metadata| meta.blocks() * 512 >= meta.len();
            let Some(bytes) = entry.metadata().ok().filter(|meta| !is_whole(meta)).map(|meta| meta.len())
            else {
                continue;
            };
            let Ok(file) = fs::File::options().read(true).write(true).open(entry.path()) else { continue };
            if fallocate(&file, FallocateFlags::empty(), 0, bytes) == Err(rustix::io::Errno::NOSPC) {
                let free = statvfs(SHM).map_or(0, |stat| stat.f_bavail.saturating_mul(stat.f_frsize));
                return Err(Error::NoRoom { free_mib: free >> 20, needed_mib: (bytes >> 20).max(1) });
            }
        }
        Ok(())
    }

    fn held_bytes(&self) -> io::Result<u64> {
        let prefix = self.shm_prefix();
        let mut held = 0;
        for entry in fs::read_dir(SHM)? {
            let entry = entry?;
            if entry.file_name().as_encoded_bytes().starts_with(prefix.as_bytes()) {
                // A file that is gone by now holds nothing. st_blocks counts blocks of 512 bytes on every file system.
                held += entry.metadata().map_or(0, |meta| meta.blocks() * 512);
            }
        }
        Ok(held)
    }
}

pub(crate) fn member(details: &iceoryx2::node::NodeDetails) -> Member {
    Member {
        name: details.name().as_str().to_owned(),
        pid: u32::try_from(details.process_id().value()).unwrap_or(0),
    }
}

/// Bytes of all channels when they are full.
fn needed_bytes(limits: Limits) -> u64 {
    let channels = Channel::ALL.iter().map(|&channel| {
        let qos = channel.qos();
        // 64 covers iceoryx2's own header and alignment of each message.
        let chunk = message_bytes(channel, limits.frame_bytes).saturating_add(64) as u64;
        chunk.saturating_mul((qos.chunks() * qos.writers) as u64)
    });
    channels.fold(MANAGEMENT_BYTES, u64::saturating_add)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_name_that_cannot_be_a_unit_name_is_refused() {
        for name in ["", "Bench", "a/b", "bench 1", "seventeen-letters"] {
            assert!(matches!(Station::new(name), Err(Error::StationName { .. })), "{name:?}");
        }
        assert!(Station::new("sixteen-letters-").is_ok());
    }

    #[test]
    fn a_root_that_leaves_no_space_for_socket_names_is_refused() {
        let long = format!("/{}", "r".repeat(MAX_ROOT_BYTES));
        assert!(matches!(
            Station::under("bench", StdPath::new(&long)),
            Err(Error::RootTooLong { len: 60, .. })
        ));
        assert!(Station::under("bench", StdPath::new(&long[..MAX_ROOT_BYTES])).is_ok());
        assert!(matches!(Station::under("bench", StdPath::new("run")), Err(Error::RootNotAbsolute { .. })));
    }

    #[test]
    fn the_same_name_under_another_root_is_another_station() {
        let a = Station::under("bench", StdPath::new("/tmp/a")).unwrap();
        let b = Station::under("bench", StdPath::new("/tmp/b")).unwrap();
        assert_ne!(a.shm_prefix(), b.shm_prefix());
    }

    #[test]
    fn a_station_of_another_user_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let mine = Station::under("bench", folder.path()).unwrap();
        assert!(mine.is_ours().unwrap());
        // Only root may give a directory away. Any other user is not root, to whom `/` belongs.
        let given = std::os::unix::fs::chown(folder.path(), Some(1), Some(1)).is_ok();
        let theirs = if given { mine } else { Station::under("bench", StdPath::new("/")).unwrap() };
        assert!(matches!(theirs.is_ours(), Err(Error::OtherUser { .. })));
    }

    #[test]
    fn a_station_that_is_not_there_yet_is_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        assert!(!Station::under("bench", &folder.path().join("later")).unwrap().is_ours().unwrap());
    }
}
