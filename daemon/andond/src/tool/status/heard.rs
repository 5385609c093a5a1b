//! What the roles and the judge say of themselves while `andond status` listens.

use std::time::{Duration, Instant};

use andon_ipc::{Heartbeat, MonotonicTime, Node, Reader, Wake};
use shm_schemas::{Health, Judging, RoleId};

use crate::tool::ToolError;
use crate::tool::demo::usage;

/// A role that runs is heard within this time: three beats.
const LISTEN: Duration = Duration::from_millis(3 * Heartbeat::PERIOD.as_millis() as u64);

/// Processor time is counted in hundredths of a second: over this time a share of a core is exact to two percent.
const MEASURE: Duration = Duration::from_millis(500);

/// The newest of everything that was sent meanwhile.
pub(super) struct Heard {
    health: Vec<Health>,
    pub(super) judging: Option<Judging>,
    /// Role and share of a core.
    cores: Vec<(u8, f64)>,
}

impl Heard {
    /// Listens until everyone was heard, or for [`LISTEN`].
    pub(super) fn listen(node: &Node, roles: &[RoleId]) -> Result<Self, ToolError> {
        let mut reader: Reader<Health> = node.reader()?;
        let mut judge: Reader<Judging> = node.reader()?;
        let mut heard = Self { health: Vec::new(), judging: None, cores: Vec::new() };
        // Role, processor time so far, and when that was read.
        let mut before: Vec<(u8, f64, Instant)> = Vec::new();
        let (began, began_ns) = (Instant::now(), MonotonicTime::now().nanoseconds());
        let all = |heard: &Self| roles.iter().all(|role| heard.newest(*role).is_some());
        while began.elapsed() < LISTEN && !(all(&heard) && heard.judging.is_some()) {
            if node.wait(&mut [&mut reader, &mut judge], Heartbeat::PERIOD)? == Wake::Stop {
                break;
            }
            while let Some(health) = reader.take()? {
                // The history may hold messages of roles that have ended.
                if health.stamp.sent_ns < began_ns {
                    continue;
                }
                if before.iter().all(|(role, ..)| *role != health.role) {
                    before.push((health.role, usage::of(health.pid).cpu_s, Instant::now()));
                }
                heard.health.retain(|known| known.role != health.role);
                heard.health.push(*health);
            }
            while let Some(state) = judge.take()? {
                heard.judging = (state.stamp.sent_ns >= began_ns).then_some(*state).or(heard.judging);
            }
        }
        heard.measure(&before);
        Ok(heard)
    }

    /// How much processor time each role has used since it was heard first.
    fn measure(&mut self, before: &[(u8, f64, Instant)]) {
        let newest = before.iter().map(|(_, _, at)| at.elapsed()).min().unwrap_or(MEASURE);
        std::thread::sleep(MEASURE.saturating_sub(newest));
        for (role, cpu_s, at) in before {
            let Some(health) = self.health.iter().find(|health| health.role == *role) else { continue };
            let now_s = usage::of(health.pid).cpu_s;
            // Without a time it has ended, or this user may not look.
            if now_s > 0.0 {
                self.cores.push((*role, (now_s - cpu_s).max(0.0) / at.elapsed().as_secs_f64()));
            }
        }
    }

    pub(super) fn newest(&self, role: RoleId) -> Option<&Health> {
        self.health.iter().find(|health| health.role == role.code())
    }

    /// The share of a core that a role uses; more than 1 where it has several threads at work.
    pub(super) fn core_share(&self, role: RoleId) -> Option<f64> {
        self.cores.iter().find(|(of, _)| *of == role.code()).map(|(_, share)| *share)
    }
}
