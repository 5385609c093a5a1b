//! When a role was down, by its health: for the journal and for those who follow a station.

use std::time::Duration;

use andon_host::config::Config;
use andon_ipc::{Heartbeat, MonotonicTime};
use shm_schemas::{Health, RoleId, RoleState};

/// What was noticed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Outage {
    /// Who.
    pub(crate) role: RoleId,
    /// Its last sign of life.
    pub(crate) began: MonotonicTime,
    /// Its first sign of work after that; `None` while it is down.
    pub(crate) ended: Option<MonotonicTime>,
}

impl Outage {
    /// Why the line did not watch.
    #[must_use]
    pub(crate) fn why(&self) -> String {
        format!("{} was down", self.role.name())
    }
}

/// Watches the roles that a station needs. A role that has not run yet since this began is starting, not down.
#[derive(Debug)]
pub(crate) struct Outages {
    roles: Vec<Watched>,
}

#[derive(Debug)]
struct Watched {
    role: RoleId,
    deadline: Duration,
    /// The start of the role that was heard last, and its last sign of work; `None` until it has worked.
    alive: Option<(u64, MonotonicTime)>,
    down_since: Option<MonotonicTime>,
}

impl Outages {
    /// Watches every role of the station but the one that watches.
    #[must_use]
    pub(crate) fn new(config: &Config, own: RoleId) -> Self {
        let watched = |role: RoleId| Watched {
            role,
            deadline: Heartbeat::silence(config.health.deadline(role).unwrap_or_default()),
            alive: None,
            down_since: None,
        };
        Self { roles: config.roles().into_iter().filter(|role| *role != own).map(watched).collect() }
    }

    /// Takes what a role says of itself; tells when an outage has ended, also one that was too short to be noticed before.
    pub(crate) fn receive(&mut self, health: &Health) -> Option<Outage> {
        let watched = self.roles.iter_mut().find(|watched| watched.role.code() == health.role)?;
        let works = matches!(
            RoleState::try_from(health.state),
            Ok(RoleState::Running | RoleState::Waiting | RoleState::Finished | RoleState::Fault)
        );
        if !works {
            return None;
        }
        let (start, now) = (health.stamp.epoch, MonotonicTime::sent(&health.stamp));
        // Messages of two starts are in no order between them. The last words of the old one may come after the first of the new one.
        if watched.alive.is_some_and(|(_, newest)| now < newest) {
            return None;
        }
        let before = watched.alive.replace((start, now));
        let restarted = before.filter(|(known, _)| *known != start).map(|(_, last)| last);
        let began = watched.down_since.take().or(restarted)?;
        Some(Outage { role: watched.role, began, ended: Some(now) })
    }

    /// The roles that have just been found to be down.
    pub(crate) fn look(&mut self, now: MonotonicTime) -> Vec<Outage> {
        let mut found = Vec::new();
        for watched in &mut self.roles {
            let Some((_, last)) = watched.alive.filter(|_| watched.down_since.is_none()) else { continue };
            if now.since(last) > watched.deadline {
                watched.down_since = Some(last);
                found.push(Outage { role: watched.role, began: last, ended: None });
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn at(s: u64) -> MonotonicTime {
        MonotonicTime::from_nanoseconds(s * 1_000_000_000)
    }

    fn health(role: RoleId, start: u64, state: RoleState, s: u64) -> Health {
        let mut health = Health { role: role.code(), state: state.code(), ..Health::default() };
        (health.stamp.epoch, health.stamp.sent_ns) = (start, s * 1_000_000_000);
        health
    }

    fn outages() -> Outages {
        Outages::new(&Config::default(), RoleId::Journal)
    }

    #[test]
    fn a_role_that_falls_silent_is_down_from_its_last_sign_of_life_until_it_works_again() {
        let mut outages = outages();
        assert_eq!(outages.look(at(100)), [], "nobody has come up yet");
        assert_eq!(outages.receive(&health(RoleId::Encode, 1, RoleState::Running, 100)), None);
        assert_eq!(outages.look(at(100)), []);
        let down = Outage { role: RoleId::Encode, began: at(100), ended: None };
        assert_eq!(outages.look(at(103)), [down]);
        assert_eq!(outages.look(at(104)), [], "it is told once");
        assert_eq!(outages.receive(&health(RoleId::Encode, 2, RoleState::Starting, 127)), None);
        let over = outages.receive(&health(RoleId::Encode, 2, RoleState::Running, 128)).unwrap();
        assert_eq!((over.began, over.ended), (at(100), Some(at(128))));
        assert_eq!(over.why(), "encode was down");
    }

    #[test]
    fn a_role_that_starts_again_unnoticed_was_down_all_the_same() {
        let mut outages = outages();
        outages.receive(&health(RoleId::Judge, 1, RoleState::Running, 100));
        let over = outages.receive(&health(RoleId::Judge, 2, RoleState::Running, 101)).unwrap();
        assert_eq!((over.began, over.ended), (at(100), Some(at(101))));
    }

    #[test]
    fn an_outage_is_told_once_although_words_of_the_old_start_come_after_those_of_the_new_one() {
        let mut outages = outages();
        outages.receive(&health(RoleId::Encode, 1, RoleState::Running, 100));
        assert_eq!(outages.look(at(103)).len(), 1);
        assert!(outages.receive(&health(RoleId::Encode, 2, RoleState::Running, 105)).is_some());
        assert_eq!(outages.receive(&health(RoleId::Encode, 1, RoleState::Running, 101)), None);
        assert_eq!(outages.receive(&health(RoleId::Encode, 2, RoleState::Running, 106)), None);
        assert_eq!(outages.look(at(106)), []);
    }

    #[test]
    fn who_watches_does_not_watch_itself() {
        let mut outages = outages();
        outages.receive(&health(RoleId::Journal, 1, RoleState::Running, 100));
        assert_eq!(outages.look(at(200)), []);
    }
}
