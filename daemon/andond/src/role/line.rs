//! The state of the line, from the health of its roles. A role that is silent is never ready.

use std::time::Duration;

use andon_board::Ill;
use andon_host::config::Config;
use andon_host::log::code;
use andon_ipc::{Heartbeat, MonotonicTime};
use andon_plc::handshake::{Fault, Line};
use rustix::io::Errno;
use rustix::process::{Pid, test_kill_process};
use shm_schemas::{Health, RoleId, RoleState, Sight};

use crate::sight;

/// The newest health of each role that the line needs, in the order of the data path: the first unhealthy role is the cause.
pub(super) struct LineHealth {
    roles: Vec<RoleHealth>,
    /// When a process left of which it is not known yet whether the line needs it.
    left: Option<MonotonicTime>,
    /// When the newest departure of one that it needs was noticed. Which one left shows by who sends no health after that.
    departure: MonotonicTime,
    /// A role that has started again since the last look: it is reported once, even if everybody has been heard since.
    restarted: Option<RoleId>,
    was_ready: bool,
    /// The first role that keeps the line from being ready, and what is the matter with it.
    culprit: Option<(RoleId, Ill)>,
}

/// A role of the line is not there.
const MISSING: Line = Line::Fault { fault: Fault::Role, detail: code::ROLE_DIED.number };

struct RoleHealth {
    role: RoleId,
    deadline: Duration,
    newest: Option<Health>,
}

impl LineHealth {
    /// Expects every role that the configuration needs.
    pub(super) fn new(config: &Config) -> Self {
        let expected = |role| {
            let deadline = Heartbeat::silence(config.health.deadline(role)?);
            Some(RoleHealth { role, deadline, newest: None })
        };
        let mut roles: Vec<RoleHealth> = config.roles().into_iter().filter_map(expected).collect();
        // The steward carries no data: another role names the cause better.
        roles.sort_by_key(|expected| expected.role == RoleId::Steward);
        let departure = MonotonicTime::default();
        Self { roles, left: None, departure, restarted: None, was_ready: false, culprit: None }
    }

    /// Takes the health that a role has sent.
    pub(super) fn received(&mut self, health: &Health) {
        if let Some(role) = self.roles.iter_mut().find(|role| role.role.code() == health.role) {
            // A role that restarts between two messages has departed all the same.
            if role.newest.is_some_and(|known| known.stamp.epoch != health.stamp.epoch) {
                self.departure = self.departure.max(MonotonicTime::sent(&health.stamp));
                self.restarted = Some(role.role);
            }
            role.newest = Some(*health);
        }
    }

    /// Some role has departed: one of the line, or one that no verdict needs, as `record`.
    pub(super) fn departed(&mut self, now: MonotonicTime) {
        self.left = Some(now);
    }

    /// Looks whether who has left is one of the line. A process leaves its channels a moment before it is gone, so it is looked for some time.
    fn look_for_departed(&mut self, now: MonotonicTime) {
        let Some(left) = self.left else { return };
        if self.roles.iter().any(RoleHealth::is_gone) {
            (self.departure, self.left) = (left, None);
        } else if now.since(left) > LEAVING {
            self.left = None;
        }
    }

    /// The state of the line now.
    pub(super) fn line(&mut self, now: MonotonicTime) -> Line {
        self.look_for_departed(now);
        if let Some(role) = self.restarted.take().filter(|_| self.was_ready) {
            self.culprit = Some((role, Ill::Restarted));
            return MISSING;
        }
        let departure = self.departure;
        let unhealthy = self
            .roles
            .iter()
            .map(|role| (role.role, role.line(now, departure)))
            .find(|(_, (line, _))| *line != Line::Ready);
        self.culprit = unhealthy.and_then(|(role, (_, ill))| Some((role, ill?)));
        match unhealthy.map(|(_, (line, _))| line) {
            None => {
                self.was_ready = true;
                Line::Ready
            }
            // Until every role has been ready once, a missing role is still starting.
            Some(Line::Fault { fault: Fault::Role, .. }) if !self.was_ready => Line::Starting,
            Some(line) => line,
        }
    }

    /// Whether a role is at the end of its recording.
    pub(super) fn has_ended(&self) -> bool {
        self.newest().any(|health| health.state == RoleState::Finished.code())
    }

    /// Whether nothing before the judge keeps the line from being ready, and the judge lives and has not judged yet. One without a job never does.
    pub(super) fn has_idle_judge(&self) -> bool {
        matches!(self.culprit, Some((RoleId::Judge, Ill::Starting | Ill::Waiting)))
    }

    /// What is wrong with what `perceive` sees of its bench.
    pub(super) fn trouble(&self) -> Option<Sight> {
        self.newest().find_map(sight::trouble_of)
    }

    fn newest(&self) -> impl Iterator<Item = &Health> {
        self.roles.iter().filter_map(|role| role.newest.as_ref())
    }

    /// Which role keeps the line from being ready, and what is the matter with it.
    pub(super) const fn culprit(&self) -> Option<(RoleId, Ill)> {
        self.culprit
    }

    /// The same in the words of the log.
    pub(super) fn cause(&self) -> String {
        match self.culprit {
            None => String::new(),
            // It is noticed before it is known which: all roles are silent until they are heard again.
            Some((_, Ill::Gone)) => GONE.to_owned(),
            Some((role, ill)) => format!("{} {}", role.name(), words(ill)),
        }
    }
}

const GONE: &str = "a process of the line has gone, and `andond status` says which";

/// What is said of a role after its name.
const fn words(ill: Ill) -> &'static str {
    match ill {
        Ill::Restarted => "has started again",
        Ill::Unheard => "has not been heard yet",
        Ill::Gone => GONE,
        Ill::Silent => "gives no sign of life",
        Ill::Blind => "does not see its bench: its log says why",
        Ill::Starting => "is starting",
        Ill::Ended => "is at the end of its recording",
        Ill::NoFrames => "gets no frames",
        Ill::Waiting => "runs and gets nothing, or too late",
        Ill::Unable => "cannot work: its log says why",
        Ill::Unwritten => "cannot write: its log says why",
        Ill::OtherVersion => "is of another version",
    }
}

/// A process that has left its channels is gone by then. One that is not, and silent, is found by its deadline.
const LEAVING: Duration = Duration::from_secs(1);

impl RoleHealth {
    /// Whether its process is not there any more, as far as it was heard.
    fn is_gone(&self) -> bool {
        self.newest.is_some_and(|health| !lives(health.pid))
    }

    /// The state of the line as far as this role determines it, and what is the matter with the role.
    fn line(&self, now: MonotonicTime, departure: MonotonicTime) -> (Line, Option<Ill>) {
        let Some(health) = &self.newest else { return (MISSING, Some(Ill::Unheard)) };
        let sent = MonotonicTime::sent(&health.stamp);
        if sent < departure {
            return (MISSING, Some(Ill::Gone));
        }
        if now.since(sent) > self.deadline {
            return (MISSING, Some(Ill::Silent));
        }
        let fault = |fault| Line::Fault { fault, detail: health.last_error };
        let (line, ill) = match RoleState::try_from(health.state) {
            Ok(RoleState::Running) => match sight::trouble_of(health).and_then(sight::code) {
                Some(code) => (Line::Fault { fault: Fault::Sight, detail: code.number }, Ill::Blind),
                None => return (Line::Ready, None),
            },
            Ok(RoleState::Starting) => (Line::Starting, Ill::Starting),
            Ok(RoleState::Finished) => (Line::Starting, Ill::Ended),
            Ok(RoleState::Waiting) if self.role == RoleId::Perceive => {
                let detail = code::CAMERA_GONE.number;
                (Line::Fault { fault: Fault::Camera, detail }, Ill::NoFrames)
            }
            Ok(RoleState::Waiting) => (fault(Fault::Role), Ill::Waiting),
            Ok(RoleState::Fault) => match self.role {
                RoleId::Capture => (fault(Fault::Camera), Ill::Unable),
                RoleId::Journal => (fault(Fault::Journal), Ill::Unwritten),
                _ => (fault(Fault::Role), Ill::Unable),
            },
            Err(_) => (fault(Fault::Role), Ill::OtherVersion),
        };
        (line, Some(ill))
    }
}

/// Whether there is a process of this number. One that this user may not signal is there.
fn lives(pid: u32) -> bool {
    let pid = i32::try_from(pid).ok().and_then(Pid::from_raw);
    pid.is_some_and(|pid| test_kill_process(pid) != Err(Errno::SRCH))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::path::Path;

    const S: u64 = 1_000_000_000;

    fn at(nanoseconds: u64) -> MonotonicTime {
        MonotonicTime::from_nanoseconds(nanoseconds)
    }

    fn health(role: RoleId, state: RoleState, sent_ns: u64) -> Health {
        let mut health = Health { role: role.code(), state: state.code(), ..Health::default() };
        health.stamp.sent_ns = sent_ns;
        health
    }

    /// Every role is healthy at 10 s.
    fn healthy() -> LineHealth {
        let mut line = LineHealth::new(&Config::default());
        for &role in RoleId::ALL {
            line.received(&health(role, RoleState::Running, 10 * S));
        }
        line
    }

    fn fault_of(line: Line) -> Option<Fault> {
        match line {
            Line::Fault { fault, .. } => Some(fault),
            Line::Starting | Line::Ready => None,
        }
    }

    #[test]
    fn a_line_is_ready_when_every_role_runs_and_starting_before() {
        let mut line = LineHealth::new(&Config::default());
        assert_eq!(line.line(at(S)), Line::Starting);
        assert_eq!(healthy().line(at(10 * S)), Line::Ready);
    }

    #[test]
    fn a_role_that_falls_silent_is_a_fault() {
        let mut line = healthy();
        assert_eq!(line.line(at(10 * S)), Line::Ready);
        assert_eq!(fault_of(line.line(at(12 * S))), Some(Fault::Role));
    }

    #[test]
    fn each_role_is_missed_after_the_deadline_of_its_own_key() {
        let folder = tempfile::tempdir().unwrap();
        let station = folder.path().join("station.toml");
        let demo = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/stations/demo.toml"));
        for role in RoleId::ALL.iter().filter(|role| Config::default().health.deadline(**role).is_some()) {
            let key = format!("[health]\n{}_deadline_ms = 7000\n", role.name());
            std::fs::write(&station, key).unwrap();
            let mut line = LineHealth::new(&Config::load(&[demo, station.as_path()]).unwrap());
            line.received(&health(*role, RoleState::Running, 10 * S));
            for other in RoleId::ALL.iter().filter(|other| *other != role) {
                line.received(&health(*other, RoleState::Running, 17 * S));
            }
            assert_eq!(line.line(at(17 * S)), Line::Ready, "{role:?}");
            assert_eq!(fault_of(line.line(at(17 * S + 1))), Some(Fault::Role), "{role:?}");
            assert_eq!(line.cause(), format!("{} gives no sign of life", role.name()));
        }
    }

    #[test]
    fn the_cause_names_the_role_and_tells_one_that_waits_from_one_that_is_gone() {
        let mut line = healthy();
        assert_eq!(line.line(at(10 * S)), Line::Ready);
        line.received(&health(RoleId::Judge, RoleState::Waiting, 10 * S));
        assert_eq!(fault_of(line.line(at(10 * S))), Some(Fault::Role));
        assert_eq!(line.cause(), "judge runs and gets nothing, or too late");
        assert_eq!(fault_of(line.line(at(14 * S))), Some(Fault::Role));
        assert!(line.cause().ends_with("gives no sign of life"), "{}", line.cause());
    }

    #[test]
    fn after_a_departure_every_role_must_send_health_again() {
        let mut line = healthy();
        assert_eq!(line.line(at(10 * S)), Line::Ready);
        line.departed(at(10 * S + 1));
        assert_eq!(fault_of(line.line(at(10 * S + 2))), Some(Fault::Role));
        for role in RoleId::ALL {
            line.received(&health(*role, RoleState::Running, 10 * S + 3));
        }
        assert_eq!(line.line(at(10 * S + 4)), Line::Ready);
    }

    #[test]
    fn who_leaves_and_is_needed_by_no_verdict_is_no_fault_of_the_line() {
        let mut line = LineHealth::new(&Config::default());
        for &role in RoleId::ALL {
            let health = health(role, RoleState::Running, 10 * S);
            line.received(&Health { pid: std::process::id(), ..health });
        }
        assert_eq!(line.line(at(10 * S)), Line::Ready);
        line.departed(at(10 * S + 1));
        assert_eq!(line.line(at(10 * S + 2)), Line::Ready);
        // This time it is the judge, whose process is seen to be gone a moment later.
        let mut process = std::process::Command::new("true").spawn().unwrap();
        line.received(&Health { pid: process.id(), ..health(RoleId::Judge, RoleState::Running, 10 * S) });
        line.departed(at(10 * S + 3));
        process.wait().unwrap();
        assert_eq!(fault_of(line.line(at(10 * S + 4))), Some(Fault::Role));
        assert_eq!(line.cause(), GONE);
    }

    #[test]
    fn a_role_that_restarts_unnoticed_has_departed() {
        let mut line = healthy();
        assert_eq!(line.line(at(10 * S)), Line::Ready);
        let mut restarted = health(RoleId::Steward, RoleState::Running, 10 * S + 1);
        restarted.stamp.epoch = 7;
        line.received(&restarted);
        // By the time of the look everybody has been heard again.
        for role in RoleId::ALL.iter().filter(|role| **role != RoleId::Steward) {
            line.received(&health(*role, RoleState::Running, 10 * S + 2));
        }
        assert_eq!(fault_of(line.line(at(10 * S + 3))), Some(Fault::Role));
        assert_eq!(line.cause(), "steward has started again");
        assert_eq!(line.line(at(10 * S + 4)), Line::Ready);
    }

    #[test]
    fn the_first_unhealthy_role_of_the_data_path_is_named() {
        let mut line = healthy();
        assert_eq!(line.line(at(10 * S)), Line::Ready);
        line.received(&health(RoleId::Perceive, RoleState::Waiting, 10 * S));
        line.received(&health(RoleId::Encode, RoleState::Waiting, 10 * S));
        assert_eq!(fault_of(line.line(at(10 * S))), Some(Fault::Camera));
    }

    #[test]
    fn a_journal_that_cannot_write_is_a_fault_of_the_journal() {
        let mut line = healthy();
        line.received(&health(RoleId::Journal, RoleState::Fault, 10 * S));
        assert_eq!(fault_of(line.line(at(10 * S))), Some(Fault::Journal));
    }

    #[test]
    fn a_camera_that_is_missing_is_a_fault_of_the_camera() {
        let mut line = healthy();
        line.received(&health(RoleId::Capture, RoleState::Fault, 10 * S));
        assert_eq!(fault_of(line.line(at(10 * S))), Some(Fault::Camera));
    }

    #[test]
    fn a_line_that_does_not_see_its_bench_is_not_ready_and_says_why_until_it_sees_again() {
        let mut line = healthy();
        assert_eq!(line.line(at(10 * S)), Line::Ready);
        for (sight, detail) in [
            (Sight::Black, code::PICTURE_BLACK.number),
            (Sight::TooFewFrames, code::TOO_FEW_FRAMES.number),
            (Sight::NoMarkers, code::MARKERS_FOREIGN.number),
        ] {
            let mut health = health(RoleId::Perceive, RoleState::Running, 10 * S);
            health.sight = sight.code();
            line.received(&health);
            assert_eq!(line.line(at(10 * S)), Line::Fault { fault: Fault::Sight, detail });
            assert_eq!(line.trouble(), Some(sight));
        }
        let mut health = health(RoleId::Perceive, RoleState::Running, 10 * S);
        health.sight = Sight::Clear.code();
        line.received(&health);
        assert_eq!((line.line(at(10 * S)), line.trouble()), (Line::Ready, None));
    }

    #[test]
    fn a_judge_that_lives_and_has_not_judged_is_idle_and_one_that_is_silent_or_gone_is_not() {
        let mut line = LineHealth::new(&Config::default());
        for &role in RoleId::ALL.iter().filter(|role| **role != RoleId::Judge) {
            line.received(&health(role, RoleState::Running, 10 * S));
        }
        assert_eq!((line.line(at(10 * S)), line.has_idle_judge()), (Line::Starting, false), "not heard yet");
        for state in [RoleState::Starting, RoleState::Waiting] {
            line.received(&health(RoleId::Judge, state, 10 * S));
            assert_eq!((line.line(at(10 * S)), line.has_idle_judge()), (Line::Starting, true), "{state:?}");
        }
        line.received(&health(RoleId::Perceive, RoleState::Starting, 10 * S));
        assert_eq!((line.line(at(10 * S)), line.has_idle_judge()), (Line::Starting, false), "another starts");
        for &role in RoleId::ALL.iter().filter(|role| **role != RoleId::Judge) {
            line.received(&health(role, RoleState::Running, 14 * S));
        }
        assert_eq!((line.line(at(14 * S)), line.has_idle_judge()), (Line::Starting, false), "it is silent");
    }

    #[test]
    fn a_recording_that_has_ended_is_no_fault_and_not_ready() {
        let mut line = healthy();
        assert!(!line.has_ended());
        line.received(&health(RoleId::Perceive, RoleState::Finished, 10 * S));
        assert!(line.line(at(10 * S)) == Line::Starting && line.has_ended());
    }
}
