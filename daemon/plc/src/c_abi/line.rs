//! Whether the line could judge a part now, by what its roles say of themselves.

use std::time::Duration;

use andon_ipc::{Heartbeat, MonotonicTime};
use shm_schemas::{Health, Judging, RoleId, RoleState, Sight};

use crate::handshake::watches;

/// Without one of these nothing is judged, or nothing is kept.
const NEEDED: [RoleId; 4] = [RoleId::Perceive, RoleId::Encode, RoleId::Judge, RoleId::Journal];

/// The newest word of everybody.
#[derive(Debug, Default)]
pub(super) struct Line {
    judging: Option<Judging>,
    healths: Vec<Health>,
}

impl Line {
    pub(super) fn judging(&mut self, judging: &Judging) {
        self.judging = Some(*judging);
    }

    pub(super) fn health(&mut self, health: &Health) {
        self.healths.retain(|known| known.role != health.role);
        self.healths.push(*health);
    }

    /// Every role that is needed, and the camera where there is one, runs, the line sees its bench, and the judge watches a job.
    /// Silence is never ready.
    pub(super) fn is_ready(&self, now: MonotonicTime) -> bool {
        let runs = |health: &Health| {
            health.state == RoleState::Running.code()
                && now.since(MonotonicTime::sent(&health.stamp)) <= deadline(health)
                && sees(health)
        };
        let of = |role: RoleId| self.healths.iter().find(|health| health.role == role.code());
        NEEDED.into_iter().all(|role| of(role).is_some_and(runs))
            && of(RoleId::Capture).is_none_or(runs)
            && self.judging.as_ref().is_some_and(|judging| watches(judging, now.nanoseconds()))
    }
}

/// How long the role may be silent: it says how the station is configured.
fn deadline(health: &Health) -> Duration {
    Heartbeat::silence(Duration::from_millis(health.deadline_ms.into()))
}

/// Whether the role reports no trouble with the line's sight: only perceive says anything of it, and 0 before it has looked.
fn sees(health: &Health) -> bool {
    health.sight == 0 || health.sight == Sight::Clear.code()
}

#[cfg(test)]
mod tests {
    use super::*;
    use shm_schemas::JudgePhase;

    const S: u64 = 1_000_000_000;

    fn at(nanoseconds: u64) -> MonotonicTime {
        MonotonicTime::from_nanoseconds(nanoseconds)
    }

    fn health(role: RoleId, state: RoleState) -> Health {
        let mut health = Health { role: role.code(), state: state.code(), ..Health::default() };
        health.stamp.sent_ns = 10 * S;
        health
    }

    fn watching() -> Judging {
        let mut judging =
            Judging { phase: JudgePhase::Waiting.code(), is_enabled: 1, job_id: 1, ..Judging::default() };
        judging.stamp.sent_ns = 10 * S;
        judging
    }

    fn well() -> Line {
        let mut line = Line::default();
        NEEDED.into_iter().for_each(|role| line.health(&health(role, RoleState::Running)));
        line.judging(&watching());
        line
    }

    #[test]
    fn a_line_is_ready_when_everyone_has_said_so_lately() {
        assert!(!Line::default().is_ready(at(0)));
        assert!(well().is_ready(at(11 * S)));
        assert!(!well().is_ready(at(11 * S + 1)), "silence");
    }

    #[test]
    fn a_role_may_be_silent_for_as_long_as_the_station_is_configured_and_the_judge_s_state_for_two_seconds() {
        let mut line = Line::default();
        for role in NEEDED {
            line.health(&Health { deadline_ms: 3000, ..health(role, RoleState::Running) });
        }
        line.judging(&watching());
        assert!(line.is_ready(at(12 * S)));
        assert!(!line.is_ready(at(12 * S + 1)), "the judge says nothing of itself");
        let mut judging = watching();
        judging.stamp.sent_ns = 13 * S;
        line.judging(&judging);
        assert!(line.is_ready(at(13 * S)));
        assert!(!line.is_ready(at(13 * S + 1)));
    }

    #[test]
    fn a_role_that_does_not_run_and_a_judge_that_does_not_watch_are_not_ready() {
        for role in NEEDED.into_iter().chain([RoleId::Capture]) {
            let mut line = well();
            line.health(&health(role, RoleState::Waiting));
            assert!(!line.is_ready(at(10 * S)), "{role:?}");
        }
        for judging in [
            Judging { is_enabled: 0, ..watching() },
            Judging { phase: JudgePhase::NoJob.code(), ..watching() },
        ] {
            let mut line = well();
            line.judging(&judging);
            assert!(!line.is_ready(at(10 * S)));
        }
    }

    #[test]
    fn a_line_that_does_not_see_its_bench_is_not_ready_until_it_sees_again() {
        let mut line = well();
        for sight in Sight::ALL.iter().filter(|sight| **sight != Sight::Clear) {
            line.health(&Health { sight: sight.code(), ..health(RoleId::Perceive, RoleState::Running) });
            assert!(!line.is_ready(at(10 * S)), "{sight:?}");
        }
        line.health(&Health { sight: Sight::Clear.code(), ..health(RoleId::Perceive, RoleState::Running) });
        assert!(line.is_ready(at(10 * S)));
    }
}
