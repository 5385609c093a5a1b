//! What killed processes leave behind, and what iceoryx2 0.10.0 cannot remove of it by itself.
//!
//! A process may be killed at any moment, and a steward also while it removes what another one left behind. That leaves one of three
//! states, which iceoryx2 never leaves again by itself:
//!
//! | what is left | what iceoryx2 makes of it | what removes it |
//! |---|---|---|
//! | shared memory without a size, which it gets just after its name | whoever opens it waits for the size, for ever, and first of all the steward | [`remove`], [`remove_unsized_services`] |
//! | the description of a service, without its shared part, which is removed before it | a service that is being created for ever | [`remove_incomplete`] |
//! | a dead node without its details, which are removed before the node | it looks for the node where the default configuration would have it, each time in vain | [`remove_nameless`] |

use crate::channel::Channel;
use crate::error::Error;
use crate::service::service_name;
use crate::station::{Member, SHM, Station, Transport, member};
use iceoryx2::identifiers::UniqueNodeId;
use iceoryx2::node::{DeadNodeView, Node as IceNode, NodeState, NodeView};
use iceoryx2::prelude::*;
use std::fs;
use std::io;
use std::iter;
use std::os::unix::fs::MetadataExt;
use std::path::{Path as StdPath, PathBuf};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// The removal of a dead node takes a few milliseconds.
const LOOK_AGAIN: Duration = Duration::from_millis(1);

/// A process that died without leaving its station.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Death {
    /// Who died; `None` for a process that died before it had given its name.
    pub member: Option<Member>,
    /// Whether everything that it left behind has been removed. If not, the next [`crate::Steward::poll`] tries again.
    pub removed: bool,
}

/// Removes what the dead have left behind, one after the other. Where processors are scarce, that takes longer than a role may be silent. A removal
/// that is not finished goes on while its steward does something else.
#[derive(Debug, Default)]
pub(crate) struct Reaper {
    underway: Option<Removal>,
}

impl Reaper {
    /// Who has died, and whether what they had is removed. Waits at most so long for a removal: what is not finished then is told later.
    pub(crate) fn reap(&mut self, node: &IceNode<Transport>, patience: Duration) -> Vec<Death> {
        let began = Instant::now();
        let mut deaths = Vec::new();
        // The dead are listed once nothing is underway: a node of which half is removed would be listed without its name.
        let others = iter::once_with(|| dead(node)).flatten();
        let others = others.map(|view| Removal::start(node.config(), view));
        for mut removal in self.underway.take().into_iter().chain(others) {
            if let Some(death) = removal.wait(began, patience) {
                deaths.push(death);
            } else {
                self.underway = Some(removal);
                break;
            }
        }
        deaths
    }
}

fn dead(node: &IceNode<Transport>) -> Vec<DeadNodeView<Transport>> {
    let mut dead = Vec::new();
    // A list that cannot be read now is read again 100 ms later.
    let _ = IceNode::<Transport>::list(node.config(), |state| {
        if let NodeState::Dead(view) = state {
            dead.push(view);
        }
        CallbackProgression::Continue
    });
    dead
}

/// Removes a dead node with everything that it had, on a thread. Meanwhile its owner removes the connections of its ports that have no size. The dead
/// was making them, or a process that is killed only now. A live one loses nothing: the other end is dead.
#[derive(Debug)]
struct Removal {
    config: Config,
    member: Option<Member>,
    ports: Vec<String>,
    /// Without a thread nothing is removed now.
    thread: Option<JoinHandle<bool>>,
}

impl Removal {
    fn start(config: &Config, view: DeadNodeView<Transport>) -> Self {
        remove_incomplete_tags(config, view.id());
        let member = view.details().as_ref().map(member);
        let ports = ports(config, view.id());
        let (has_name, its_config) = (member.is_some(), config.clone());
        let remove = move || {
            if has_name {
                view.try_remove_stale_resources().is_ok()
            } else {
                remove_nameless(&its_config, view.id()).is_ok()
            }
        };
        let thread = thread::Builder::new().spawn(remove).ok();
        Self { config: config.clone(), member, ports, thread }
    }

    /// What became of it; `None` where it is not finished so long after `began`.
    fn wait(&mut self, began: Instant, patience: Duration) -> Option<Death> {
        while self.thread.as_ref().is_some_and(|thread| !thread.is_finished()) {
            remove_unsized(&self.config, |name| {
                name.split(['_', '.']).any(|end| self.ports.iter().any(|port| port == end))
            });
            if began.elapsed() >= patience {
                return None;
            }
            thread::sleep(LOOK_AGAIN);
        }
        let removed = self.thread.take().is_some_and(|thread| thread.join().unwrap_or(false));
        Some(Death { member: self.member.take(), removed })
    }
}

/// A station that ends sweeps what is left, when nobody else removes anything.
impl Drop for Removal {
    fn drop(&mut self) {
        let _ = self.wait(Instant::now(), Duration::MAX);
    }
}

fn node_folder(config: &Config) -> PathBuf {
    PathBuf::from(config.global.node_dir().to_string())
}

/// Removes a dead node without details. Its services and ports were removed before its details.
fn remove_nameless(config: &Config, node: &UniqueNodeId) -> io::Result<()> {
    let id = node.value().to_string();
    for entry in fs::read_dir(node_folder(config))? {
        let entry = entry?;
        if !entry.file_name().to_string_lossy().contains(&id) {
            continue;
        }
        if entry.file_type()?.is_dir() {
            fs::remove_dir_all(entry.path())?;
        } else {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

/// Removes the tags that a dead node was making when it was killed. iceoryx2 overlooks them, and then fails to remove the
/// directory that holds them. It forgets where the node belongs and reports it dead for ever. A node makes a tag before it makes what the
/// tag is for, so nothing else is lost with an incomplete tag.
fn remove_incomplete_tags(config: &Config, node: &UniqueNodeId) {
    remove_incomplete_files(&node_folder(config).join(node.value().to_string()));
}

/// Removes what a steward was making when it was killed. Only the one steward may call this, before it makes anything. Nobody else makes services,
/// and what all processes share besides is a counter, which may begin again.
pub(crate) fn remove_unsized_services(config: &Config) {
    let made = [config.global.service.dynamic_config_storage_suffix, config.global.node.global_mgmt_suffix];
    let made = made.map(|suffix| suffix.to_string());
    remove_unsized(config, |name| made.iter().any(|suffix| name.ends_with(suffix)));
}

/// Removes the station's shared memory that has no size and such a name.
fn remove_unsized(config: &Config, is_meant: impl Fn(&str) -> bool) {
    let prefix = config.global.prefix.to_string();
    let Ok(entries) = fs::read_dir(SHM) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let is_meant = name.strip_prefix(&prefix).is_some_and(&is_meant);
        if is_meant && entry.metadata().is_ok_and(|meta| meta.len() == 0) {
            // What cannot be removed now is tried again the next time.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// The numbers of a node's ports, which are in the names of all that belongs to them.
fn ports(config: &Config, node: &UniqueNodeId) -> Vec<String> {
    let suffix = config.global.node.port_tag_suffix.to_string();
    let Ok(tags) = fs::read_dir(node_folder(config).join(node.value().to_string())) else {
        return Vec::new();
    };
    let names = tags.flatten().map(|tag| tag.file_name().to_string_lossy().into_owned());
    let numbers = names.filter_map(|name| Some(name.strip_suffix(&suffix)?.rsplit('_').next()?.to_owned()));
    numbers.collect()
}

/// Removes the files of a directory that are not complete: iceoryx2 makes a file read-only once it is complete.
fn remove_incomplete_files(directory: &StdPath) {
    let Ok(entries) = fs::read_dir(directory) else { return };
    for entry in entries.flatten() {
        if entry.metadata().is_ok_and(|meta| meta.is_file() && meta.mode() & 0o200 != 0) {
            // What cannot be removed now is tried again the next time.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Removes those services of a channel whose shared part is missing or was never finished. Only the one steward may call this: it
/// alone creates services.
///
/// # Errors
/// [`Error::ServiceUnreadable`] for a service that says nothing of its shared part: a process may be using it, so it stays.
pub(crate) fn remove_incomplete(
    node: &IceNode<Transport>,
    station: &Station,
    channel: Channel,
    pattern: MessagingPattern,
) -> Result<(), Error> {
    remove_incomplete_files(StdPath::new(&node.config().global.service_dir().to_string()));
    for back in [false, true] {
        // A name that iceoryx2 refuses is the name of no service.
        let Ok(name) = service_name(station, channel, back) else { continue };
        match Transport::details(&name, node.config(), pattern) {
            Ok(Some(details)) if details.dynamic_details.is_none() => force_remove(node, &name, pattern),
            Ok(_) => (),
            Err(why) => {
                let members = station.members_text();
                return Err(Error::ServiceUnreadable { channel, why: format!("{why:?}"), members });
            }
        }
    }
    Ok(())
}

/// Removes a service without a shared part.
#[allow(unsafe_code)]
fn force_remove(node: &IceNode<Transport>, name: &ServiceName, pattern: MessagingPattern) {
    // SAFETY: no other process may use the service. Every process that uses one has opened its shared part and is registered in it. The shared part
    // is removed only when nobody is registered any more. So nobody uses this service, whose shared part was just seen to be missing or unfinished.
    // Nobody begins to use it now either, because only a steward completes or creates a service. This process holds the lock of the one steward, and
    // it creates nothing until this call returns. What cannot be removed now is tried again by the next attempt to create the channel.
    let _ = unsafe { node.force_remove_service(name, pattern) };
}
