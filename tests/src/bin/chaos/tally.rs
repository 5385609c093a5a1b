//! What was done and what came of it.

use std::fmt::Write as _;

#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) steady_kills: u64,
    pub(crate) startup_kills: u64,
    pub(crate) stops: u64,
    pub(crate) restarts: u64,
    pub(crate) disturbances: u64,
    pub(crate) ready_drops: u64,
    /// From the last start of a role to its first step.
    pub(crate) recoveries_ms: Vec<f64>,
    pub(crate) ended_by_itself: Vec<String>,
}

impl Tally {
    pub(crate) fn kills(&self) -> u64 {
        self.steady_kills + self.startup_kills
    }

    /// All of it as one JSON object, with what else is to be told.
    pub(crate) fn report(mut self, rest: &[(&str, String)]) -> String {
        self.recoveries_ms.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let last = self.recoveries_ms.len().saturating_sub(1) as f64;
            self.recoveries_ms.get((last * share).round() as usize).copied().unwrap_or(0.0)
        };
        let over_1_s = self.recoveries_ms.iter().filter(|&&ms| ms > 1000.0).count();
        let mut text = format!(
            "{{\n  \"kills\": {},\n  \"kills_while_starting\": {},\n  \"stops\": {},\n  \"restarts\": {},\n  \
             \"disturbances\": {},\n  \"ready_drops_seen\": {},\n  \"recoveries\": {},\n  \
             \"recovery_ms\": {{ \"p50\": {:.1}, \"p99\": {:.1}, \"max\": {:.1}, \"over_1_s\": {over_1_s} }},\n  \
             \"ended_by_itself\": {:?}",
            self.kills(),
            self.startup_kills,
            self.stops,
            self.restarts,
            self.disturbances,
            self.ready_drops,
            self.recoveries_ms.len(),
            at(0.50),
            at(0.99),
            at(1.0),
            self.ended_by_itself,
        );
        for (name, value) in rest {
            // Writing to a `String` cannot fail.
            let _ = write!(text, ",\n  \"{name}\": {value}");
        }
        text + "\n}\n"
    }
}
