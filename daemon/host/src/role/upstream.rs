//! From end to end: holds what has come on a role's input against what the role before it says it has sent.
//!
//! The ports notice a connection that could not be made. This notices whatever else keeps a reader deaf, by its effect.

use std::time::{Duration, Instant};

use andon_ipc::{Error, MonotonicTime, Node, Reader};
use shm_schemas::{Health, RoleId};

use super::input::Input;

/// How often it looks.
const LOOK: Duration = Duration::from_millis(100);

/// A reader that is behind for this long and hears nothing is deaf: a message takes a millisecond.
const DEAF: Duration = Duration::from_secs(1);

/// A health that is older than this was sent by a role that is gone: what it had sent last went with it.
const STALE: Duration = Duration::from_secs(2);

/// The role before this one on its data channel.
pub(super) struct Upstream {
    role: RoleId,
    health: Reader<Health>,
    looked: Instant,
    sent: Sent,
}

impl Upstream {
    /// `None` for a role that takes nothing from another.
    pub(super) fn of(node: &Node) -> Result<Option<Self>, Error> {
        let role = match node.role() {
            RoleId::Perceive => RoleId::Capture,
            RoleId::Encode => RoleId::Perceive,
            RoleId::Judge => RoleId::Encode,
            RoleId::Journal => RoleId::Judge,
            RoleId::Plc => RoleId::Journal,
            RoleId::Record => RoleId::Perceive,
            RoleId::Steward
            | RoleId::Capture
            | RoleId::Metrics
            | RoleId::Board
            | RoleId::Executor
            | RoleId::Tool => return Ok(None),
        };
        Ok(Some(Self { role, health: node.reader()?, looked: Instant::now(), sent: Sent::default() }))
    }

    pub(super) fn role(&self) -> RoleId {
        self.role
    }

    /// To be called when the input is empty. How many messages are known to be missing, when it is deaf.
    pub(super) fn missing(&mut self, node: &Node, input: &impl Input) -> Result<Option<u64>, Error> {
        if self.looked.elapsed() < LOOK {
            return Ok(None);
        }
        self.looked = Instant::now();
        // It waits for nothing: this takes the events that have come, which nobody else does.
        node.wait(&mut [&mut self.health], Duration::ZERO)?;
        while let Some(health) = self.health.take()? {
            if health.role == self.role.code() {
                self.sent.update(&health, input.has_history());
            }
        }
        let has = input.newest_of(self.sent.epoch);
        Ok(self.sent.missing(has, MonotonicTime::now()))
    }
}

/// What the role before this one has sent by its newest health, and since when that is more than has come.
#[derive(Debug, Default)]
struct Sent {
    epoch: u64,
    newest: u64,
    /// What was sent before this reader was there, and of which the writer keeps nothing.
    before: u64,
    said: MonotonicTime,
    /// The newest that had come when this fell behind, and when that was.
    behind: Option<(u64, MonotonicTime)>,
}

impl Sent {
    fn update(&mut self, health: &Health, has_history: bool) {
        self.said = MonotonicTime::sent(&health.stamp);
        if health.sent_epoch != self.epoch {
            self.epoch = health.sent_epoch;
            self.before = if has_history { 0 } else { health.sent };
            self.behind = None;
        }
        self.newest = health.sent;
    }

    /// How many are missing, once nothing has come for too long although more was sent.
    fn missing(&mut self, has: u64, now: MonotonicTime) -> Option<u64> {
        let missing = self.newest.saturating_sub(has.max(self.before));
        if missing == 0 || now.since(self.said) > STALE {
            self.behind = None;
            return None;
        }
        match self.behind {
            Some((had, since)) if had == has => {
                let is_deaf = now.since(since) >= DEAF;
                if is_deaf {
                    // The new connection gets as long.
                    self.behind = Some((has, now));
                }
                is_deaf.then_some(missing)
            }
            _ => {
                self.behind = Some((has, now));
                None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    fn at(ms: u64) -> MonotonicTime {
        MonotonicTime::from_nanoseconds(ms * MS)
    }

    fn health(epoch: u64, sent: u64, ms: u64) -> Health {
        let mut health = Health { sent_epoch: epoch, sent, ..Health::default() };
        health.stamp.sent_ns = ms * MS;
        health
    }

    #[test]
    fn a_reader_that_hears_nothing_while_more_is_sent_is_deaf_and_one_that_hears_is_not() {
        let mut sent = Sent::default();
        sent.update(&health(7, 40, 10_000), true);
        assert_eq!(sent.missing(0, at(10_000)), None);
        assert_eq!(sent.missing(0, at(10_900)), None, "it may be on its way");
        assert_eq!(sent.missing(0, at(11_000)), Some(40));
        assert_eq!(sent.missing(0, at(11_100)), None, "the new connection gets as long");
        assert_eq!(sent.missing(40, at(12_000)), None);
        sent.update(&health(7, 41, 12_500), true);
        assert_eq!(sent.missing(40, at(12_500)), None);
        assert_eq!(sent.missing(41, at(13_600)), None);
    }

    #[test]
    fn what_comes_late_but_comes_is_not_deaf() {
        let mut sent = Sent::default();
        for n in 1..50 {
            sent.update(&health(7, 10 * n, 500 * n), true);
            assert_eq!(sent.missing(10 * n - 9, at(500 * n + 10)), None);
        }
    }

    #[test]
    fn what_was_sent_before_this_reader_was_there_is_not_expected_of_a_writer_that_keeps_nothing() {
        let mut sent = Sent::default();
        sent.update(&health(7, 40, 10_000), false);
        assert_eq!(sent.missing(0, at(10_000)), None);
        sent.update(&health(7, 40, 11_500), false);
        assert_eq!(sent.missing(0, at(11_500)), None);
        sent.update(&health(7, 42, 11_600), false);
        assert_eq!(sent.missing(0, at(11_600)), None);
        assert_eq!(sent.missing(0, at(12_600)), Some(2));
    }

    #[test]
    fn what_a_role_that_is_gone_had_sent_last_is_not_waited_for() {
        let mut sent = Sent::default();
        sent.update(&health(7, 40, 10_000), true);
        assert_eq!(sent.missing(39, at(10_500)), None);
        assert_eq!(sent.missing(39, at(12_100)), None);
        sent.update(&health(8, 1, 12_200), true);
        assert_eq!(sent.missing(1, at(13_500)), None);
    }
}
