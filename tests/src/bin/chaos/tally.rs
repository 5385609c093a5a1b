//! What was done to the line, and what came of it.

use andon_tests::measure::percentile;
use serde_json::{Value, json};

/// How long a role took to come back.
pub(crate) struct Recovery {
    /// The role, and what was done to it.
    pub(crate) what: String,
    /// From its last start to its first step.
    pub(crate) ms: f64,
    /// The load average of the last minute: processes that ran or waited for a processor.
    pub(crate) load: f64,
}

impl Recovery {
    fn describe(&self) -> String {
        format!("{}: {:.0} ms, load average {:.1}", self.what, self.ms, self.load)
    }
}

#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) steady_kills: u64,
    pub(crate) startup_kills: u64,
    pub(crate) stops: u64,
    pub(crate) restarts: u64,
    /// The PLC's own program.
    pub(crate) program_kills: u64,
    pub(crate) recorder_kills: u64,
    /// Kills of the recorder after which the PLC saw `ready` drop, which it must not.
    pub(crate) needless_drops: Vec<String>,
    pub(crate) disturbances: u64,
    pub(crate) ready_drops: u64,
    /// Disturbances after which the PLC did not see `ready` drop.
    pub(crate) unseen: Vec<String>,
    /// For how long the worker was left alone until a job came out as it must, in seconds.
    pub(crate) calm_s: Vec<f64>,
    /// What it was left alone for in vain.
    pub(crate) in_vain: Vec<String>,
    pub(crate) recoveries: Vec<Recovery>,
    pub(crate) ended_by_itself: Vec<String>,
}

impl Tally {
    pub(crate) fn kills(&self) -> u64 {
        self.steady_kills + self.startup_kills
    }

    /// Of a hundred recoveries, 99 took at most so long.
    pub(crate) fn p99_ms(&self) -> f64 {
        percentile(&mut self.recovery_ms(), 99)
    }

    fn recovery_ms(&self) -> Vec<f64> {
        self.recoveries.iter().map(|recovery| recovery.ms).collect()
    }

    fn slower_than(&self, max_ms: f64) -> Vec<String> {
        self.recoveries.iter().filter(|recovery| recovery.ms > max_ms).map(Recovery::describe).collect()
    }

    /// All of it as a JSON object.
    pub(crate) fn json(&self) -> Value {
        let mut ms = self.recovery_ms();
        let loads: Vec<f64> = self.recoveries.iter().map(|recovery| recovery.load).collect();
        json!({
            "kills": self.kills(),
            "kills_while_starting": self.startup_kills,
            "stops": self.stops,
            "restarts": self.restarts,
            "kills_of_the_plc_s_program": self.program_kills,
            "kills_of_the_recorder": self.recorder_kills,
            "disturbances": self.disturbances,
            "ready_drops_seen": self.ready_drops,
            "ready_drops_unseen": self.unseen,
            "calms": self.calm_s.len(),
            "calm_s": { "p50": percentile(&mut self.calm_s.clone(), 50), "max": percentile(&mut self.calm_s.clone(), 100) },
            "recoveries": self.recoveries.len(),
            "recovery_ms": {
                "p50": percentile(&mut ms, 50),
                "p99": percentile(&mut ms, 99),
                "max": percentile(&mut ms, 100),
                "over_600_ms": self.slower_than(600.0),
            },
            "load_average": {
                "mean": loads.iter().sum::<f64>() / loads.len().max(1) as f64,
                "max": loads.iter().copied().fold(0.0, f64::max),
            },
            "ended_by_itself": self.ended_by_itself,
        })
    }
}

/// The kernel's load average of the last minute.
pub(crate) fn load_average() -> f64 {
    let text = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    text.split(' ').next().and_then(|minute| minute.parse().ok()).unwrap_or(f64::NAN)
}
