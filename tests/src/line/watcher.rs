//! What can be heard of a line on its channels.

use andon_ipc::{Node, Reader, Station, Stop, monotonic_ns};
use shm_schemas::{Health, RoleId, RoleState, Verdict};
use std::time::{Duration, Instant};

/// For whatever must happen sooner or later; only a test that fails waits for so long.
const PATIENCE: Duration = Duration::from_secs(60);

/// Reads verdicts and health.
pub struct Watcher {
    node: Node,
    verdicts: Reader<Verdict>,
    health: Reader<Health>,
    /// Every verdict so far.
    pub heard: Vec<Verdict>,
    /// The newest health of each role.
    pub newest: Vec<Health>,
}

impl Watcher {
    /// Joins a station whose steward may still be starting.
    pub fn join(station: &Station) -> Self {
        let node = Node::open(station, RoleId::Tool, PATIENCE, &Stop::new().unwrap()).unwrap();
        let (verdicts, health) = (node.reader().unwrap(), node.reader().unwrap());
        Self { node, verdicts, health, heard: Vec::new(), newest: Vec::new() }
    }

    /// Listens for at most so long, or until something comes.
    pub fn listen(&mut self, patience: Duration) {
        self.node.wait(&mut [&mut self.verdicts, &mut self.health], patience).unwrap();
        // Health last: what a role sent before it said how it is has been taken by then, or comes with the next look.
        while let Some(health) = self.health.take().unwrap() {
            self.newest.retain(|known| known.role != health.role);
            self.newest.push(*health);
        }
        while let Some(verdict) = self.verdicts.take().unwrap() {
            self.heard.push(*verdict);
        }
    }

    /// Listens until this is so; panics after a minute.
    pub fn until(&mut self, what: &str, mut is_so: impl FnMut(&Self) -> bool) {
        let until = Instant::now() + PATIENCE;
        while !is_so(self) {
            assert!(Instant::now() < until, "waited in vain for {what}; health: {:?}", self.words());
            self.listen(Duration::from_millis(100));
        }
    }

    /// Listens until the recording has been judged to its end and every verdict on it was heard; how many they are.
    pub fn until_judged(&mut self) -> u64 {
        self.until("the judge's end", |watcher| watcher.is(RoleId::Judge, RoleState::Finished));
        let sent = self.health(RoleId::Judge).unwrap().sent;
        self.until("all verdicts", |watcher| watcher.heard.len() as u64 == sent);
        sent
    }

    /// The newest health of a role.
    pub fn health(&self, role: RoleId) -> Option<&Health> {
        self.newest.iter().find(|health| health.role == role.code())
    }

    /// Whether a role said this of itself.
    pub fn is(&self, role: RoleId, state: RoleState) -> bool {
        self.health(role).is_some_and(|health| health.state == state.code())
    }

    /// Whether the role runs as this process, and has said so lately.
    pub fn runs(&self, role: RoleId, pid: u32) -> bool {
        let lately = monotonic_ns().saturating_sub(1_000_000_000);
        self.health(role).is_some_and(|health| {
            health.pid == pid && health.state == RoleState::Running.code() && health.stamp.sent_ns > lately
        })
    }

    /// Epoch and `seq` of the newest verdict.
    pub fn heard_newest(&self) -> Option<(u64, u64)> {
        self.heard.last().map(|verdict| (verdict.stamp.epoch, verdict.stamp.seq))
    }

    /// For whoever listens for hours.
    pub fn forget_all_but_newest(&mut self) {
        let from = self.heard.len().saturating_sub(1);
        self.heard.drain(..from);
    }

    /// What each role said of itself.
    pub fn words(&self) -> Vec<String> {
        let word = |health: &Health| {
            let state = RoleState::try_from(health.state).map_or("?", RoleState::name);
            let role = RoleId::try_from(health.role).map_or("?", RoleId::name);
            format!("{role} {state} (pid {}, last code {})", health.pid, health.last_error)
        };
        self.newest.iter().map(word).collect()
    }
}

/// The number of a role by its name.
pub fn role_id(name: &str) -> RoleId {
    RoleId::ALL.iter().copied().find(|role| role.name().eq_ignore_ascii_case(name)).unwrap()
}
