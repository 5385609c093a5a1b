//! A member of the station that reads what the line sends.

use super::PATIENCE;
use andon_ipc::{MonotonicTime, Node, Reader, Station, Stop};
use shm_schemas::{Health, JudgePhase, Judging, RoleId, RoleState, Verdict};
use std::time::{Duration, Instant};

/// Reads verdicts and health and keeps them.
pub struct Watcher {
    node: Node,
    verdict_reader: Reader<Verdict>,
    health_reader: Reader<Health>,
    judging_reader: Reader<Judging>,
    /// Every verdict so far, in the order of sending.
    pub verdicts: Vec<Verdict>,
    /// The newest health of each role.
    pub healths: Vec<Health>,
    /// What the judge has said last of itself.
    pub judging: Option<Judging>,
}

impl Watcher {
    /// Joins a station whose steward may still be starting.
    pub fn join(station: &Station) -> Self {
        let node = Node::open(station, RoleId::Tool, PATIENCE, &Stop::new().unwrap()).unwrap();
        let (verdict_reader, health_reader) = (node.reader().unwrap(), node.reader().unwrap());
        let judging_reader = node.reader().unwrap();
        let (verdicts, healths, judging) = (Vec::new(), Vec::new(), None);
        Self { node, verdict_reader, health_reader, judging_reader, verdicts, healths, judging }
    }

    /// Waits until something comes, for at most `patience`, and takes all of it.
    pub fn listen(&mut self, patience: Duration) {
        let (verdicts, healths) = (&mut self.verdict_reader, &mut self.health_reader);
        self.node.wait(&mut [verdicts, healths, &mut self.judging_reader], patience).unwrap();
        // Health first: a verdict that the judge sent before its newest health is then there to be taken.
        while let Some(health) = self.health_reader.take().unwrap() {
            self.healths.retain(|known| known.role != health.role);
            self.healths.push(*health);
        }
        while let Some(verdict) = self.verdict_reader.take().unwrap() {
            self.verdicts.push(*verdict);
        }
        while let Some(judging) = self.judging_reader.take().unwrap() {
            self.judging = Some(*judging);
        }
    }

    /// When the judge has said last how it is, on the monotonic clock, and whether it watches a job.
    pub fn watches(&self) -> Option<(u64, bool)> {
        let judging = self.judging.as_ref()?;
        let watches = judging.is_enabled != 0 && judging.phase != JudgePhase::NoJob.code();
        Some((judging.stamp.sent_ns, watches))
    }

    /// What the judge has said last that it does.
    pub fn phase(&self) -> Option<JudgePhase> {
        JudgePhase::try_from(self.judging.as_ref()?.phase).ok()
    }

    /// Listens until the condition holds; panics with its name after [`PATIENCE`].
    pub fn until(&mut self, what: &str, mut holds: impl FnMut(&Self) -> bool) {
        let until = Instant::now() + PATIENCE;
        while !holds(self) {
            assert!(
                Instant::now() < until,
                "waited in vain for {what}; health: {:?}",
                self.describe_health()
            );
            self.listen(Duration::from_millis(100));
        }
    }

    /// Listens until the recording has been judged to its end and every verdict on it has come. Returns their number.
    pub fn until_judged(&mut self) -> u64 {
        self.until("the judge's end", |watcher| watcher.is(RoleId::Judge, RoleState::Finished));
        let sent = self.health(RoleId::Judge).unwrap().sent;
        self.until("all verdicts", |watcher| watcher.verdicts.len() as u64 == sent);
        sent
    }

    /// The newest health of a role.
    pub fn health(&self, role: RoleId) -> Option<&Health> {
        self.healths.iter().find(|health| health.role == role.code())
    }

    /// Whether this is the newest state of the role.
    pub fn is(&self, role: RoleId, state: RoleState) -> bool {
        self.health(role).is_some_and(|health| health.state == state.code())
    }

    /// Whether the role runs as this process, by a health of the last second.
    pub fn runs(&self, role: RoleId, pid: u32) -> bool {
        let lately = |sent_ns| {
            MonotonicTime::now().since(MonotonicTime::from_nanoseconds(sent_ns)) < Duration::from_secs(1)
        };
        self.health(role).is_some_and(|health| {
            health.pid == pid && health.state == RoleState::Running.code() && lately(health.stamp.sent_ns)
        })
    }

    /// Epoch and `seq` of every verdict so far.
    pub fn verdict_keys(&self) -> Vec<(u64, u64)> {
        self.verdicts.iter().map(|verdict| (verdict.stamp.epoch, verdict.stamp.seq)).collect()
    }

    /// Epoch and `seq` of the newest verdict.
    pub fn newest_verdict_key(&self) -> Option<(u64, u64)> {
        self.verdicts.last().map(|verdict| (verdict.stamp.epoch, verdict.stamp.seq))
    }

    /// Keeps the memory of a program that listens for hours small.
    pub fn forget_all_but_newest(&mut self) {
        let from = self.verdicts.len().saturating_sub(1);
        self.verdicts.drain(..from);
    }

    /// The newest health of each role, in words.
    pub fn describe_health(&self) -> Vec<String> {
        let describe = |health: &Health| {
            let state = RoleState::try_from(health.state).map_or("?", RoleState::name);
            let role = RoleId::try_from(health.role).map_or("?", RoleId::name);
            format!("{role} {state} (pid {}, last code {})", health.pid, health.last_error)
        };
        self.healths.iter().map(describe).collect()
    }
}

/// The role of this name.
pub fn role_id(name: &str) -> RoleId {
    RoleId::ALL.iter().copied().find(|role| role.name().eq_ignore_ascii_case(name)).unwrap()
}
