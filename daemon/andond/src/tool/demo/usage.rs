//! What a process has used, from /proc.

use std::fs;

/// Processor time and memory of a process.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::tool) struct Usage {
    /// Seconds of processor time since its start.
    pub(in crate::tool) cpu_s: f64,
    /// Memory of its own that is resident, in MiB.
    pub(in crate::tool) own_mib: f64,
    /// Shared memory that it has touched, in MiB.
    pub(in crate::tool) shared_mib: f64,
}

impl Usage {
    /// Adds a process that ran after the others: time adds up, memory does not.
    pub(in crate::tool) fn add(&mut self, other: Self) {
        self.cpu_s += other.cpu_s;
        self.own_mib = self.own_mib.max(other.own_mib);
        self.shared_mib = self.shared_mib.max(other.shared_mib);
    }
}

/// What the process has used so far; zero when it has ended.
pub(in crate::tool) fn of(pid: u32) -> Usage {
    let stat = fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    let status = fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    Usage {
        cpu_s: ticks(&stat) / rustix::param::clock_ticks_per_second() as f64,
        own_mib: mib(&status, "RssAnon:"),
        shared_mib: mib(&status, "RssShmem:"),
    }
}

/// User and system time: fields 14 and 15 of proc(5). The name in field 2 may hold spaces and ends with a parenthesis.
fn ticks(stat: &str) -> f64 {
    let after_name = stat.rsplit_once(')').map_or("", |(_, rest)| rest);
    after_name.split_whitespace().skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum()
}

fn mib(status: &str, key: &str) -> f64 {
    let line = status.lines().find_map(|line| line.strip_prefix(key));
    line.and_then(|rest| rest.split_whitespace().next()?.parse::<f64>().ok()).unwrap_or(0.0) / 1024.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_with_spaces_and_parentheses_does_not_shift_the_fields() {
        let stat = "42 (a (b) c) S 1 1 1 0 -1 0 0 0 0 0 250 50 0 0 20 0";
        assert_eq!(ticks(stat), 300.0);
    }

    #[test]
    fn this_process_has_used_memory() {
        assert!(of(std::process::id()).own_mib > 0.0);
        assert_eq!(of(u32::MAX), Usage::default());
    }
}
