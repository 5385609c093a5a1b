//! What the demo reads while a clip runs: the same channels as a PLC and a technician.

use std::time::{Duration, Instant};

use andon_ipc::{Error, Node, Reader, Wake};
use shm_schemas::{Couples, Detections, Health, RoleId, RoleState, Verdict, flag};

use crate::tool::ToolError;

/// The readers of the demo.
pub(super) struct Channels {
    pub(super) detections: Reader<Detections>,
    pub(super) couples: Reader<Couples>,
    pub(super) verdicts: Reader<Verdict>,
    pub(super) health: Reader<Health>,
}

/// All that came over the channels while one clip ran.
#[derive(Default)]
pub(super) struct Received {
    pub(super) detections: Vec<Detections>,
    pub(super) couples: Vec<Couples>,
    pub(super) verdicts: Vec<Verdict>,
    /// When the end of the stream came, on the clock of [`andon_ipc::MonotonicTime`].
    ended_ns: Option<u64>,
    /// The judge has sent everything that follows from the clip.
    pub(super) finished: bool,
    /// Newest health of every role, by its number.
    pub(super) health: Vec<Health>,
}

impl Channels {
    pub(super) fn open(node: &Node) -> Result<Self, Error> {
        Ok(Self {
            detections: node.reader()?,
            couples: node.reader()?,
            verdicts: node.reader()?,
            health: node.reader()?,
        })
    }

    /// Waits for messages and takes all of them. False when a stop was asked for.
    pub(super) fn listen(
        &mut self,
        node: &Node,
        received: &mut Received,
        patience: Duration,
    ) -> Result<bool, Error> {
        let ports: &mut [&mut dyn andon_ipc::Port] =
            &mut [&mut self.detections, &mut self.couples, &mut self.verdicts, &mut self.health];
        if node.wait(ports, patience)? == Wake::Stop {
            return Ok(false);
        }
        while let Some(detections) = self.detections.take()? {
            if detections.flags & flag::END_OF_STREAM == 0 {
                received.detections.push(*detections);
            }
        }
        while let Some(couples) = self.couples.take()? {
            if couples.flags & flag::END_OF_STREAM != 0 {
                received.ended_ns = Some(couples.stamp.sent_ns);
            } else {
                received.couples.push(*couples);
            }
        }
        while let Some(health) = self.health.take()? {
            received.note(&health);
        }
        // Last: what the judge sent before it reported that it had finished has arrived by now.
        while let Some(verdict) = self.verdicts.take()? {
            received.verdicts.push(*verdict);
        }
        Ok(true)
    }

    /// Waits until every one of the roles has given a sign of life; the roles that have not. `check` is asked meanwhile whether all run.
    pub(super) fn wait_for(
        &mut self,
        node: &Node,
        roles: &[RoleId],
        patience: Duration,
        check: &mut dyn FnMut() -> Result<(), ToolError>,
    ) -> Result<Vec<RoleId>, ToolError> {
        let began = Instant::now();
        let mut received = Received::default();
        let missing = |received: &Received| -> Vec<RoleId> {
            let there = |role: &RoleId| received.health.iter().any(|health| health.role == role.code());
            roles.iter().copied().filter(|role| !there(role)).collect()
        };
        while !missing(&received).is_empty() && began.elapsed() < patience {
            if !self.listen(node, &mut received, Duration::from_millis(100))? {
                break;
            }
            check()?;
        }
        check()?;
        Ok(missing(&received))
    }
}

impl Received {
    fn note(&mut self, health: &Health) {
        let judge = health.role == RoleId::Judge.code() && health.state == RoleState::Finished.code();
        if judge && self.ended_ns.is_some_and(|ended_ns| health.stamp.sent_ns > ended_ns) {
            self.finished = true;
        }
        match self.health.iter_mut().find(|known| known.role == health.role) {
            Some(known) => *known = *health,
            None => self.health.push(*health),
        }
    }
}
