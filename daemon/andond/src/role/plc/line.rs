//! How the line is, by the health of its roles. Silence is never ready.

use std::time::Duration;

use andon_ipc::{Heartbeat, MonotonicTime};
use andon_plc::handshake::{Fault, Line};
use shm_schemas::{Health, RoleId, RoleState};

use crate::config::Config;
use crate::log::code;
use crate::sight;

/// The newest health of each role that the line needs, in the order of the data path: the first that is not well is
/// the cause.
pub(super) struct Watch {
    roles: Vec<Seen>,
    /// When a writer was last found gone. Who it was shows by who is not heard from then on.
    gone: MonotonicTime,
    was_ready: bool,
}

struct Seen {
    role: RoleId,
    deadline: Duration,
    newest: Option<Health>,
}

impl Watch {
    /// Expects every role that the configuration needs.
    pub(super) fn new(config: &Config) -> Self {
        let seen = |role| {
            // One beat may be late.
            let deadline = config.health.deadline(role)?.max(2 * Heartbeat::PERIOD);
            Some(Seen { role, deadline, newest: None })
        };
        let mut roles: Vec<Seen> = config.roles().into_iter().filter_map(seen).collect();
        // It carries no data: another role names the cause better.
        roles.sort_by_key(|seen| seen.role == RoleId::Steward);
        Self { roles, gone: MonotonicTime::default(), was_ready: false }
    }

    /// A role told how it is.
    pub(super) fn heard(&mut self, health: &Health) {
        if let Some(seen) = self.roles.iter_mut().find(|seen| seen.role.code() == health.role) {
            // One that came back at once has been gone all the same.
            if seen.newest.is_some_and(|known| known.stamp.epoch != health.stamp.epoch) {
                self.gone = self.gone.max(sent(health));
            }
            seen.newest = Some(*health);
        }
    }

    /// Some role has gone.
    pub(super) fn gone(&mut self, now: MonotonicTime) {
        self.gone = now;
    }

    /// How the line is now.
    pub(super) fn line(&mut self, now: MonotonicTime) -> Line {
        let line = self.roles.iter().map(|seen| seen.line(now, self.gone)).find(|line| *line != Line::Ready);
        match line {
            None => {
                self.was_ready = true;
                Line::Ready
            }
            // Before everything has been there once, what is missing is still coming.
            Some(Line::Fault { fault: Fault::Role, .. }) if !self.was_ready => Line::Starting,
            Some(line) => line,
        }
    }
}

impl Seen {
    fn line(&self, now: MonotonicTime, gone: MonotonicTime) -> Line {
        let missing = Line::Fault { fault: Fault::Role, detail: code::ROLE_DIED.number };
        let Some(health) = &self.newest else { return missing };
        let sent = sent(health);
        if sent < gone || now.since(sent) > self.deadline {
            return missing;
        }
        let detail = health.last_error;
        match RoleState::try_from(health.state) {
            Ok(RoleState::Running) => match sight::trouble_of(health).and_then(sight::code) {
                Some(code) => Line::Fault { fault: Fault::Sight, detail: code.number },
                None => Line::Ready,
            },
            Ok(RoleState::Starting | RoleState::Finished) => Line::Starting,
            Ok(RoleState::Waiting) if self.role == RoleId::Perceive => {
                Line::Fault { fault: Fault::Camera, detail: code::CAMERA_GONE.number }
            }
            Ok(RoleState::Fault) if self.role == RoleId::Capture => {
                Line::Fault { fault: Fault::Camera, detail }
            }
            Ok(RoleState::Fault) if self.role == RoleId::Journal => {
                Line::Fault { fault: Fault::Journal, detail }
            }
            Ok(RoleState::Waiting | RoleState::Fault) | Err(_) => Line::Fault { fault: Fault::Role, detail },
        }
    }
}

fn sent(health: &Health) -> MonotonicTime {
    MonotonicTime::from_nanoseconds(health.stamp.sent_ns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use shm_schemas::Sight;

    const S: u64 = 1_000_000_000;

    fn at(nanoseconds: u64) -> MonotonicTime {
        MonotonicTime::from_nanoseconds(nanoseconds)
    }

    fn health(role: RoleId, state: RoleState, sent_ns: u64) -> Health {
        let mut health = Health { role: role.code(), state: state.code(), ..Health::default() };
        health.stamp.sent_ns = sent_ns;
        health
    }

    /// Everyone is well at 10 s.
    fn well() -> Watch {
        let mut watch = Watch::new(&Config::default());
        for role in [
            RoleId::Capture,
            RoleId::Perceive,
            RoleId::Encode,
            RoleId::Judge,
            RoleId::Journal,
            RoleId::Steward,
        ] {
            watch.heard(&health(role, RoleState::Running, 10 * S));
        }
        watch
    }

    fn fault_of(line: Line) -> Option<Fault> {
        match line {
            Line::Fault { fault, .. } => Some(fault),
            Line::Starting | Line::Ready => None,
        }
    }

    #[test]
    fn a_line_is_ready_when_every_role_has_said_so_and_starting_before() {
        let mut watch = Watch::new(&Config::default());
        assert_eq!(watch.line(at(S)), Line::Starting);
        assert_eq!(well().line(at(10 * S)), Line::Ready);
    }

    #[test]
    fn a_role_that_falls_silent_is_a_fault() {
        let mut watch = well();
        assert_eq!(watch.line(at(10 * S)), Line::Ready);
        assert_eq!(fault_of(watch.line(at(12 * S))), Some(Fault::Role));
    }

    #[test]
    fn after_a_departure_everyone_must_be_heard_again() {
        let mut watch = well();
        assert_eq!(watch.line(at(10 * S)), Line::Ready);
        watch.gone(at(10 * S + 1));
        assert_eq!(fault_of(watch.line(at(10 * S + 2))), Some(Fault::Role));
        for role in RoleId::ALL {
            watch.heard(&health(*role, RoleState::Running, 10 * S + 3));
        }
        assert_eq!(watch.line(at(10 * S + 4)), Line::Ready);
    }

    #[test]
    fn a_role_that_comes_back_unnoticed_has_been_gone() {
        let mut watch = well();
        assert_eq!(watch.line(at(10 * S)), Line::Ready);
        let mut again = health(RoleId::Steward, RoleState::Running, 10 * S + 1);
        again.stamp.epoch = 7;
        watch.heard(&again);
        assert_eq!(fault_of(watch.line(at(10 * S + 2))), Some(Fault::Role));
    }

    #[test]
    fn the_first_role_of_the_data_path_that_is_not_well_is_named() {
        let mut watch = well();
        assert_eq!(watch.line(at(10 * S)), Line::Ready);
        watch.heard(&health(RoleId::Perceive, RoleState::Waiting, 10 * S));
        watch.heard(&health(RoleId::Encode, RoleState::Waiting, 10 * S));
        assert_eq!(fault_of(watch.line(at(10 * S))), Some(Fault::Camera));
    }

    #[test]
    fn a_journal_that_cannot_write_is_a_fault_of_the_journal() {
        let mut watch = well();
        watch.heard(&health(RoleId::Journal, RoleState::Fault, 10 * S));
        assert_eq!(fault_of(watch.line(at(10 * S))), Some(Fault::Journal));
    }

    #[test]
    fn a_camera_that_is_missing_is_a_fault_of_the_camera() {
        let mut watch = well();
        watch.heard(&health(RoleId::Capture, RoleState::Fault, 10 * S));
        assert_eq!(fault_of(watch.line(at(10 * S))), Some(Fault::Camera));
    }

    #[test]
    fn a_line_that_does_not_see_its_bench_is_not_ready_and_says_why_until_it_sees_again() {
        let mut watch = well();
        assert_eq!(watch.line(at(10 * S)), Line::Ready);
        for (sight, detail) in [
            (Sight::Black, code::PICTURE_BLACK.number),
            (Sight::TooFewFrames, code::TOO_FEW_FRAMES.number),
            (Sight::NoMarkers, code::MARKERS_FOREIGN.number),
        ] {
            let mut health = health(RoleId::Perceive, RoleState::Running, 10 * S);
            health.sight = sight.code();
            watch.heard(&health);
            assert_eq!(watch.line(at(10 * S)), Line::Fault { fault: Fault::Sight, detail });
        }
        let mut health = health(RoleId::Perceive, RoleState::Running, 10 * S);
        health.sight = Sight::Clear.code();
        watch.heard(&health);
        assert_eq!(watch.line(at(10 * S)), Line::Ready);
    }

    #[test]
    fn a_recording_that_has_ended_is_no_fault_and_not_ready() {
        let mut watch = well();
        watch.heard(&health(RoleId::Perceive, RoleState::Finished, 10 * S));
        assert_eq!(watch.line(at(10 * S)), Line::Starting);
    }
}
