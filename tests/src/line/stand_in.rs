//! The place of a role that does not run.

use super::Line;
use andon_ipc::{ChannelMessage, Node, Stop, Wake, Writer};
use shm_schemas::RoleId;
use std::time::Duration;

/// Whatever must happen sooner or later has happened by then; only a test that fails waits for so long.
const PATIENCE: Duration = Duration::from_secs(60);

/// Joins the station in the place of a role.
pub fn stand_in(line: &Line, role: RoleId) -> Node {
    Node::open(&line.station, role, PATIENCE, &Stop::new().unwrap()).unwrap()
}

/// A writer in the place of a role.
pub struct Sender<T: ChannelMessage> {
    node: Node,
    /// The writer itself.
    pub writer: Writer<T>,
}

impl<T: ChannelMessage> Sender<T> {
    /// It waits for these readers, so that nothing is lost, not even before they are there.
    pub fn new(line: &Line, role: RoleId, readers: &[RoleId]) -> Self {
        let node = stand_in(line, role);
        let mut writer = node.writer().unwrap();
        writer.follow(readers);
        Self { node, writer }
    }

    /// Sends a message. Panics where the readers take nothing for a minute.
    pub fn send(&mut self, fill: impl FnOnce(&mut T)) {
        assert!(self.send_within(PATIENCE, fill), "the readers take nothing");
    }

    /// Sends a message. False where the readers take nothing for so long.
    pub fn send_within(&mut self, patience: Duration, fill: impl FnOnce(&mut T)) -> bool {
        let has_room = self.node.wait_for_room(&mut self.writer, patience).unwrap() == Wake::Room;
        if has_room {
            let mut message = self.writer.loan().unwrap();
            fill(&mut message);
            self.writer.send(message).unwrap();
        }
        has_room
    }
}
