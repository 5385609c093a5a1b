//! The metrics themselves. Their names are an interface: dashboards read them.

use std::path::Path;
use std::time::Duration;

use andon_ipc::{Heartbeat, MonotonicTime};
use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::{Registry, Unit};
use shm_schemas::{Health, RoleId, RoleState, Verdict, VerdictLevel, VerdictOutcome};

/// Upper bounds of the latencies, seconds: from one frame at 100 Hz to the second after which a line counts as stuck.
const BOUNDS_S: [f64; 10] = [0.01, 0.02, 0.03, 0.05, 0.075, 0.1, 0.2, 0.3, 0.5, 1.0];

/// One label and its value.
type Label = [(&'static str, &'static str); 1];
/// Two of them.
type Labels = [(&'static str, &'static str); 2];

/// Where on the data path a latency ends.
#[derive(Clone, Copy)]
pub(super) enum Stage {
    Detections,
    Couples,
    Verdict,
}

impl Stage {
    const fn name(self) -> &'static str {
        match self {
            Self::Detections => "detections",
            Self::Couples => "couples",
            Self::Verdict => "verdict",
        }
    }
}

/// All metrics, and what they were made from.
pub(super) struct Counts {
    registry: Registry,
    captured: Counter,
    processed: Counter,
    skipped: Counter,
    lost: Family<Label, Counter>,
    refused: Family<Label, Counter>,
    restarts: Family<Label, Counter>,
    running: Family<Label, Gauge>,
    verdicts: Family<Labels, Counter>,
    latency: Family<Label, Histogram>,
    ready: Gauge,
    disk_free: Family<Label, Gauge>,
    journal: Gauge,
    /// The newest health of each role, which counts from its start.
    newest: Vec<Health>,
}

impl Counts {
    pub(super) fn new(station: &str) -> Self {
        let labels = [("station".into(), station.to_owned().into())];
        let mut counts = Self {
            registry: Registry::with_prefix_and_labels("andon", labels.into_iter()),
            captured: Counter::default(),
            processed: Counter::default(),
            skipped: Counter::default(),
            lost: Family::default(),
            refused: Family::default(),
            restarts: Family::default(),
            running: Family::default(),
            verdicts: Family::default(),
            latency: Family::new_with_constructor(|| Histogram::new(BOUNDS_S)),
            ready: Gauge::default(),
            disk_free: Family::default(),
            journal: Gauge::default(),
            newest: Vec::new(),
        };
        counts.register();
        counts
    }

    fn register(&mut self) {
        let r = &mut self.registry;
        let captured = "Frames from the camera or the recording";
        r.register("frames_captured", captured, self.captured.clone());
        r.register(
            "frames_processed",
            "Frames in which hands and objects were looked for",
            self.processed.clone(),
        );
        let skipped = "Frames that perceive did not process while it ran, or that the camera itself lost";
        r.register("frames_skipped", skipped, self.skipped.clone());
        r.register(
            "messages_lost",
            "Messages that a role did not get in time, or skipped",
            self.lost.clone(),
        );
        r.register(
            "messages_refused",
            "Messages and requests that a role could not use",
            self.refused.clone(),
        );
        r.register("role_restarts", "Starts of a role after its first", self.restarts.clone());
        let running = "1 while the role says that it works, or that its recording has ended";
        r.register("role_running", running, self.running.clone());
        r.register("verdicts", "Verdicts by level and outcome", self.verdicts.clone());
        let latency = "From the capture of a frame to the message that depends on it";
        r.register_with_unit("latency", latency, Unit::Seconds, self.latency.clone());
        r.register("ready", "1 while the line could judge a part", self.ready.clone());
        let disk = "Room on the disk of the journal, and in shared memory";
        r.register_with_unit("disk_free", disk, Unit::Bytes, self.disk_free.clone());
        r.register_with_unit("journal_size", "Size of the journal", Unit::Bytes, self.journal.clone());
    }

    /// A role has said how it is.
    pub(super) fn health(&mut self, health: &Health) {
        let Ok(role) = RoleId::try_from(health.role) else { return };
        let known = self.newest.iter().position(|known| known.role == health.role);
        let before = known.map(|index| self.newest.swap_remove(index));
        self.newest.push(*health);
        let is_restart = before.is_some_and(|before| before.stamp.epoch != health.stamp.epoch);
        // Each start of a role counts from 0.
        let before = before.filter(|_| !is_restart).unwrap_or_default();
        let label = [("role", role.name())];
        self.restarts.get_or_create(&label).inc_by(is_restart.into());
        self.lost.get_or_create(&label).inc_by(health.losses.saturating_sub(before.losses));
        self.refused.get_or_create(&label).inc_by(health.refused.saturating_sub(before.refused));
        let works = [RoleState::Running.code(), RoleState::Finished.code()].contains(&health.state);
        self.running.get_or_create(&label).set(works.into());
        let frames = health.steps.saturating_sub(before.steps);
        match role {
            RoleId::Capture => {
                self.captured.inc_by(frames);
            }
            RoleId::Perceive => {
                self.processed.inc_by(frames);
                self.skipped.inc_by(health.losses.saturating_sub(before.losses));
            }
            _ => {}
        }
    }

    pub(super) fn verdict(&self, verdict: &Verdict) {
        let level = verdict.level().map_or("unknown", VerdictLevel::name);
        let outcome = verdict.outcome().map_or("unknown", VerdictOutcome::name);
        self.verdicts.get_or_create(&[("level", level), ("outcome", outcome)]).inc();
    }

    pub(super) fn latency(&self, stage: Stage, latency: Option<Duration>) {
        if let Some(latency) = latency {
            self.latency.get_or_create(&[("stage", stage.name())]).observe(latency.as_secs_f64());
        }
    }

    /// How the line is now. A role that is gone does not say so itself.
    pub(super) fn ready(&self, is_ready: bool, now: MonotonicTime) {
        self.ready.set(is_ready.into());
        let is_silent = |health: &&Health| {
            let deadline = Heartbeat::silence(Duration::from_millis(health.deadline_ms.into()));
            now.since(MonotonicTime::sent(&health.stamp)) > deadline
        };
        for health in self.newest.iter().filter(is_silent) {
            if let Ok(role) = RoleId::try_from(health.role) {
                self.running.get_or_create(&[("role", role.name())]).set(0);
            }
        }
    }

    /// Looks how much room is left. What cannot be asked for keeps its number.
    pub(super) fn disk(&self, journal: &Path) {
        let folder = journal.parent().unwrap_or(Path::new("/"));
        for (of, folder) in [("journal", folder), ("shared_memory", Path::new("/dev/shm"))] {
            if let Ok(found) = rustix::fs::statvfs(folder) {
                let free = i64::try_from(found.f_bavail.saturating_mul(found.f_frsize)).unwrap_or(i64::MAX);
                self.disk_free.get_or_create(&[("of", of)]).set(free);
            }
        }
        let mut log = journal.as_os_str().to_owned();
        log.push("-wal");
        let size = |path: &Path| std::fs::metadata(path).map_or(0, |found| found.len());
        self.journal.set(i64::try_from(size(journal) + size(Path::new(&log))).unwrap_or(i64::MAX));
    }

    /// All of it as OpenMetrics text.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        // Writing to a `String` cannot fail.
        let _ = encode(&mut text, &self.registry);
        text
    }
}
