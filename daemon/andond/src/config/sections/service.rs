//! The sections `[journal]`, `[plc]`, `[health]` and `[log]`: what serves the line.

use crate::config::keys::Keys;
use crate::config::value::{several, within, words};
use crate::log::Level;
use std::net::{IpAddr, Ipv4Addr};
use std::path::PathBuf;

/// `[journal]`: where verdicts are kept.
#[derive(Clone, Debug, PartialEq)]
pub struct Journal {
    /// The database; see [`crate::config::Config::journal_path`].
    pub path: Option<PathBuf>,
    /// Verdicts that are older are removed, days.
    pub keep_days: u32,
    /// The oldest verdicts are removed when the database is larger, MB.
    pub keep_mb: u32,
}

impl Default for Journal {
    fn default() -> Self {
        // A year covers the time in which a complaint about a product comes back; 20 verdicts a minute in two shifts
        // are some 5 million a year, 200 bytes each.
        Self { path: None, keep_days: 365, keep_mb: 1024 }
    }
}

impl Journal {
    pub(in crate::config) fn keys(&mut self, k: &mut impl Keys) {
        k.optional(
            "path",
            &mut self.path,
            (),
            r#""/var/lib/andon/bench1.sqlite""#,
            "The database of all verdicts. Without it /var/lib/andon/NAME.sqlite, NAME being the station's.",
        );
        k.key("keep_days", &mut self.keep_days, within(1, 36_500, "days"), "Older verdicts are removed.");
        k.key(
            "keep_mb",
            &mut self.keep_mb,
            within(10, 1_000_000, "MB"),
            "When the database grows over this the oldest verdicts are removed.",
        );
    }
}

/// `[plc]`: the Modbus TCP server.
#[derive(Clone, Debug, PartialEq)]
pub struct Plc {
    /// Whether it runs.
    pub enable: bool,
    /// The address that it listens on.
    pub bind: IpAddr,
    /// The port that it listens on.
    pub port: u16,
    /// The clients that may connect.
    pub allow: Vec<IpAddr>,
    /// Whether clients may write the control words.
    pub writes: bool,
}

impl Default for Plc {
    fn default() -> Self {
        let loopback = IpAddr::V4(Ipv4Addr::LOCALHOST);
        // Modbus' own port, 502, needs a right that the unit does without.
        Self { enable: false, bind: loopback, port: 1502, allow: vec![loopback], writes: false }
    }
}

impl Plc {
    pub(in crate::config) fn keys(&mut self, k: &mut impl Keys) {
        k.key("enable", &mut self.enable, (), "Whether the Modbus TCP server runs.");
        k.key(
            "bind",
            &mut self.bind,
            (),
            "The address that it listens on: that of the network card at the PLC, or 0.0.0.0 for all of them.",
        );
        k.key(
            "port",
            &mut self.port,
            within(1, 65_535, ""),
            "The TCP port. Modbus' own is 502; a port under 1024 needs a right that the unit says how to give.",
        );
        k.key(
            "allow",
            &mut self.allow,
            several(0, 32, ()),
            "The clients that may connect; all others are refused and counted. The unit's IPAddressAllow= must name \
             them too (systemctl edit andon-plc@NAME).",
        );
        k.key(
            "writes",
            &mut self.writes,
            (),
            "Whether clients may write the control words. Without it they can only read.",
        );
    }
}

/// `[health]`: when a role counts as stuck. Times in ms without progress, after which a role is unhealthy, `ready`
/// drops at the PLC and the log says so.
#[derive(Clone, Debug, PartialEq)]
pub struct Health {
    /// Deadline of `capture`.
    pub capture_deadline_ms: u32,
    /// Deadline of `perceive`.
    pub perceive_deadline_ms: u32,
    /// Deadline of `encode`.
    pub encode_deadline_ms: u32,
    /// Deadline of `judge`.
    pub judge_deadline_ms: u32,
    /// Deadline of `journal`.
    pub journal_deadline_ms: u32,
    /// Deadline of `plc`.
    pub plc_deadline_ms: u32,
}

impl Default for Health {
    fn default() -> Self {
        Self {
            capture_deadline_ms: 1000,
            perceive_deadline_ms: 1000,
            encode_deadline_ms: 1000,
            judge_deadline_ms: 1000,
            // A commit to a slow disk takes this long when the disk is busy.
            journal_deadline_ms: 3000,
            plc_deadline_ms: 1000,
        }
    }
}

impl Health {
    /// The deadlines with the names of their keys, in the order of the data path.
    pub(in crate::config) fn deadlines(&mut self) -> [(&'static str, &mut u32); 6] {
        [
            ("capture_deadline_ms", &mut self.capture_deadline_ms),
            ("perceive_deadline_ms", &mut self.perceive_deadline_ms),
            ("encode_deadline_ms", &mut self.encode_deadline_ms),
            ("judge_deadline_ms", &mut self.judge_deadline_ms),
            ("journal_deadline_ms", &mut self.journal_deadline_ms),
            ("plc_deadline_ms", &mut self.plc_deadline_ms),
        ]
    }

    pub(in crate::config) fn keys(&mut self, k: &mut impl Keys) {
        for (name, deadline) in self.deadlines() {
            k.key(
                name,
                deadline,
                within(100, 60_000, "ms"),
                "Without progress for this long the role is unhealthy and `ready` drops.",
            );
        }
    }
}

words!(Level {
    Level::Error = "error",
    Level::Warn = "warn",
    Level::Info = "info",
    Level::Debug = "debug",
    Level::Trace = "trace",
});

/// `[log]`: how much is logged.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// The least grave messages that are logged.
    pub level: Level,
}

impl Log {
    pub(in crate::config) fn keys(&mut self, k: &mut impl Keys) {
        k.key(
            "level",
            &mut self.level,
            (),
            "The least grave messages that are logged: info is a transition, debug an IU, trace a frame. The variable \
             ANDON_LOG overrides it.",
        );
    }
}
