//! What the demo reads while a clip runs: the same channels as a PLC and a technician.

use std::time::{Duration, Instant};

use andon_ipc::{Error, Node, Reader, Wake};
use shm_schemas::{Couples, Detections, Health, RoleId, RoleState, Verdict, flag};

/// The readers of the demo.
pub(super) struct Channels {
    pub(super) detections: Reader<Detections>,
    pub(super) couples: Reader<Couples>,
    pub(super) verdicts: Reader<Verdict>,
    pub(super) health: Reader<Health>,
}

/// All that came over the channels while one clip ran.
#[derive(Default)]
pub(super) struct Heard {
    pub(super) detections: Vec<Detections>,
    pub(super) couples: Vec<Couples>,
    pub(super) verdicts: Vec<Verdict>,
    /// When the end of the stream came by, on the clock of [`andon_ipc::monotonic_ns`].
    ended_ns: Option<u64>,
    /// The judge has said everything that follows from the clip.
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

    /// Waits for news and takes all of it. False when a stop was asked for.
    pub(super) fn listen(
        &mut self,
        node: &Node,
        heard: &mut Heard,
        patience: Duration,
    ) -> Result<bool, Error> {
        let ports: &mut [&mut dyn andon_ipc::Port] =
            &mut [&mut self.detections, &mut self.couples, &mut self.verdicts, &mut self.health];
        if node.wait(ports, patience)? == Wake::Stop {
            return Ok(false);
        }
        while let Some(detections) = self.detections.take()? {
            if detections.flags & flag::END_OF_STREAM == 0 {
                heard.detections.push(*detections);
            }
        }
        while let Some(couples) = self.couples.take()? {
            if couples.flags & flag::END_OF_STREAM != 0 {
                heard.ended_ns = Some(couples.stamp.sent_ns);
            } else {
                heard.couples.push(*couples);
            }
        }
        while let Some(health) = self.health.take()? {
            heard.note(&health);
        }
        // Last: what the judge sent before it said that it had finished is here by now.
        while let Some(verdict) = self.verdicts.take()? {
            heard.verdicts.push(*verdict);
        }
        Ok(true)
    }

    /// Waits until every one of the roles has said that it is there.
    pub(super) fn wait_for(
        &mut self,
        node: &Node,
        roles: &[RoleId],
        patience: Duration,
    ) -> Result<Vec<RoleId>, Error> {
        let began = Instant::now();
        let mut heard = Heard::default();
        let missing = |heard: &Heard| -> Vec<RoleId> {
            let there = |role: &RoleId| heard.health.iter().any(|health| health.role == role.code());
            roles.iter().copied().filter(|role| !there(role)).collect()
        };
        while !missing(&heard).is_empty() && began.elapsed() < patience {
            if !self.listen(node, &mut heard, Duration::from_millis(100))? {
                break;
            }
        }
        Ok(missing(&heard))
    }
}

impl Heard {
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
