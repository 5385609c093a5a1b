//! What killed processes leave behind, and what iceoryx2 0.10.0 cannot remove of it by itself.
//!
//! A steward may be killed while it removes what another one left behind. Two states come of that which iceoryx2 never leaves:
//!
//! | what is left | what iceoryx2 makes of it | here |
//! |---|---|---|
//! | the description of a service, without the shared part that goes before it | a service that is for ever being created | [`remove_half_made`] |
//! | a dead node without its details, which go before the node | looks for the node where the default configuration has it, in vain, every time | [`remove_nameless`] |

use crate::channel::Channel;
use crate::service::service_name;
use crate::station::{Station, member};
use crate::steward::Death;
use iceoryx2::identifiers::UniqueNodeId;
use iceoryx2::node::{Node as IceNode, NodeState, NodeView};
use iceoryx2::prelude::*;
use std::fs;
use std::io;
use std::os::unix::fs::MetadataExt;
use std::path::{Path as StdPath, PathBuf};

/// Removes every dead node with all that it had.
pub(crate) fn bury(node: &IceNode<ipc::Service>) -> Vec<Death> {
    let mut dead = Vec::new();
    // A list that cannot be read now is read 100 ms later.
    let _ = IceNode::<ipc::Service>::list(node.config(), |state| {
        if let NodeState::Dead(view) = state {
            dead.push(view);
        }
        CallbackProgression::Continue
    });
    dead.into_iter()
        .map(|view| {
            remove_half_made_tags(node.config(), view.id());
            let member = view.details().as_ref().map(member);
            let removed = if member.is_some() {
                view.try_remove_stale_resources().is_ok()
            } else {
                remove_nameless(node.config(), view.id()).is_ok()
            };
            Death { member, removed }
        })
        .collect()
}

fn node_folder(config: &Config) -> PathBuf {
    PathBuf::from(config.global.node_dir().to_string())
}

/// Removes a dead node without details: its services and ports were removed before these.
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

/// Removes the tags that a dead node was just making when it was killed. iceoryx2 overlooks them, fails to remove the
/// directory that they are in, forgets where the node belongs and reports it dead for ever. A node makes a tag before what
/// the tag is for, so nothing else is lost with a half-made one.
fn remove_half_made_tags(config: &Config, node: &UniqueNodeId) {
    remove_half_made_files(&node_folder(config).join(node.value().to_string()));
}

/// Removes the files of a directory that are not complete: iceoryx2 takes the right to write away when they are.
fn remove_half_made_files(directory: &StdPath) {
    let Ok(entries) = fs::read_dir(directory) else { return };
    for entry in entries.flatten() {
        if entry.metadata().is_ok_and(|meta| meta.is_file() && meta.mode() & 0o200 != 0) {
            // What cannot be removed now is tried again at the next look.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Removes the services of a channel that are not complete. Only for the one steward: nobody else makes services.
#[allow(unsafe_code)]
pub(crate) fn remove_half_made(
    node: &IceNode<ipc::Service>,
    station: &Station,
    channel: Channel,
    pattern: MessagingPattern,
) {
    remove_half_made_files(StdPath::new(&node.config().global.service_dir().to_string()));
    for back in [false, true] {
        let Ok(name) = service_name(station, channel, back) else { continue };
        let details = ipc::Service::details(&name, node.config(), pattern);
        let complete = details.is_ok_and(|details| details.is_some_and(|it| it.dynamic_details.is_some()));
        if !complete {
            // SAFETY: a service that is not complete cannot be opened, so nobody uses it.
            let _ = unsafe { node.force_remove_service(&name, pattern) };
        }
    }
}
