//! What was done and what came of it.

use std::fmt::Write as _;

/// How long a role took to come back.
pub(crate) struct Recovery {
    /// The role, and what was done to it.
    pub(crate) what: String,
    /// From its last start to its first step.
    pub(crate) ms: f64,
    /// Processes that ran or waited for a processor, on average over the last minute.
    pub(crate) load: f64,
}

impl Recovery {
    fn is_over(&self, most_ms: f64) -> bool {
        self.ms > most_ms
    }

    fn words(&self) -> String {
        format!("{}: {:.0} ms, load average {:.1}", self.what, self.ms, self.load)
    }
}

#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) steady_kills: u64,
    pub(crate) startup_kills: u64,
    pub(crate) stops: u64,
    pub(crate) restarts: u64,
    pub(crate) disturbances: u64,
    pub(crate) ready_drops: u64,
    /// What the PLC did not notice.
    pub(crate) unseen: Vec<String>,
    pub(crate) recoveries: Vec<Recovery>,
    pub(crate) ended_by_itself: Vec<String>,
}

impl Tally {
    pub(crate) fn kills(&self) -> u64 {
        self.steady_kills + self.startup_kills
    }

    /// Whether every role came back within so long.
    pub(crate) fn all_within(&self, most_ms: f64) -> bool {
        !self.recoveries.iter().any(|recovery| recovery.is_over(most_ms))
    }

    /// All of it as one JSON object, with what else is to be told.
    pub(crate) fn report(mut self, rest: &[(&str, String)]) -> String {
        self.recoveries.sort_by(|a, b| a.ms.total_cmp(&b.ms));
        let at = |share: f64| {
            let last = self.recoveries.len().saturating_sub(1) as f64;
            self.recoveries.get((last * share).round() as usize).map_or(0.0, |recovery| recovery.ms)
        };
        let loads = || self.recoveries.iter().map(|recovery| recovery.load);
        let mean_load = loads().sum::<f64>() / self.recoveries.len().max(1) as f64;
        let slow: Vec<String> =
            self.recoveries.iter().filter(|recovery| recovery.is_over(1000.0)).map(Recovery::words).collect();
        let mut text = format!(
            "{{\n  \"kills\": {},\n  \"kills_while_starting\": {},\n  \"stops\": {},\n  \"restarts\": {},\n  \
             \"disturbances\": {},\n  \"ready_drops_seen\": {},\n  \"ready_drops_unseen\": {:?},\n  \"recoveries\": {},\n  \
             \"recovery_ms\": {{ \"p50\": {:.1}, \"p99\": {:.1}, \"max\": {:.1}, \"over_1_s\": {slow:?} }},\n  \
             \"load_average\": {{ \"mean\": {mean_load:.1}, \"max\": {:.1} }},\n  \
             \"ended_by_itself\": {:?}",
            self.kills(),
            self.startup_kills,
            self.stops,
            self.restarts,
            self.disturbances,
            self.ready_drops,
            self.unseen,
            self.recoveries.len(),
            at(0.50),
            at(0.99),
            at(1.0),
            loads().fold(0.0, f64::max),
            self.ended_by_itself,
        );
        for (name, value) in rest {
            // Writing to a `String` cannot fail.
            let _ = write!(text, ",\n  \"{name}\": {value}");
        }
        text + "\n}\n"
    }
}

/// The load average of the last minute, as the kernel tells it.
pub(crate) fn load_average() -> f64 {
    let told = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    told.split(' ').next().and_then(|minute| minute.parse().ok()).unwrap_or(f64::NAN)
}
