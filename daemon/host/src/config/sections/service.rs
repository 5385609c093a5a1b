//! The sections `[journal]`, `[plc]`, `[metrics]`, `[health]` and `[log]`: what serves the line.

use crate::config::keys::Keys;
use crate::config::value::{several, within, words};
use crate::log::Level;
use andon_plc::registers::WordOrder;
use std::net::{IpAddr, Ipv4Addr};
use std::path::PathBuf;
use std::time::Duration;

use shm_schemas::RoleId;

/// `[journal]`: where verdicts are kept.
#[derive(Clone, Debug, PartialEq)]
pub struct Journal {
    /// The database; see [`crate::config::Config::journal_path`].
    pub path: Option<PathBuf>,
    /// Age at which verdicts are removed, days.
    pub keep_days: u32,
    /// Size of the database from which on the oldest verdicts are removed, MB.
    pub keep_mb: u32,
}

impl Default for Journal {
    fn default() -> Self {
        // A year covers the time in which a complaint about a product comes back. 20 verdicts a minute in two shifts are some 5 million a year, 200
        // bytes each.
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
            "The database of all verdicts. Without it the database is /var/lib/andon/NAME.sqlite, with the station's name.",
        );
        k.key(
            "keep_days",
            &mut self.keep_days,
            within(1, 36_500, "days"),
            "Verdicts that are older are removed, once the PLC and every other consumer has acknowledged them.",
        );
        k.key(
            "keep_mb",
            &mut self.keep_mb,
            within(10, 1_000_000, "MB"),
            "When the database grows larger, the oldest verdicts are removed, acknowledged or not.",
        );
    }
}

words!(WordOrder {
    WordOrder::Big = "big",
    WordOrder::Little = "little",
});

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
    /// The clients that may write; see [`Plc::commanders`].
    pub commanders: Vec<IpAddr>,
    /// In which order the two or four registers of a longer value lie.
    pub word_order: WordOrder,
}

impl Default for Plc {
    fn default() -> Self {
        let loopback = IpAddr::V4(Ipv4Addr::LOCALHOST);
        // The standard port of Modbus, 502, needs a privilege that the unit does without.
        Self {
            enable: false,
            bind: loopback,
            port: 1502,
            allow: vec![loopback],
            writes: false,
            commanders: Vec::new(),
            word_order: WordOrder::Big,
        }
    }
}

impl Plc {
    /// The clients that may write: those that are named, or the only one that may connect.
    #[must_use]
    pub fn commanders(&self) -> &[IpAddr] {
        if self.commanders.is_empty() { &self.allow } else { &self.commanders }
    }

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
            "The TCP port. The standard port of Modbus is 502; a port below 1024 needs a privilege, and the unit says \
             how to grant it.",
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
            "Whether a client may write the control words. Without it all can only read.",
        );
        k.key(
            "commanders",
            &mut self.commanders,
            several(0, 32, ()),
            "The clients of plc.allow that may write; all others only read. With none named it is the only one of plc.allow. \
             Where there are two, such as a PLC and a panel, each sets and clears its own bits by the registers \
             control_set and control_clear.",
        );
        k.key(
            "word_order",
            &mut self.word_order,
            (),
            "Which register of a value of two or four registers is the first: the most significant (big) or the least \
             significant (little). Inside a register Modbus is always big-endian.",
        );
    }
}

/// `[metrics]`: numbers for a monitoring system.
#[derive(Clone, Debug, PartialEq)]
pub struct Metrics {
    /// Whether they are served.
    pub enable: bool,
    /// The address that is listened on.
    pub bind: IpAddr,
    /// The port that is listened on.
    pub port: u16,
}

impl Default for Metrics {
    fn default() -> Self {
        // Nobody else uses this port in the list of Prometheus's exporters.
        Self { enable: false, bind: IpAddr::V4(Ipv4Addr::LOCALHOST), port: 9464 }
    }
}

impl Metrics {
    pub(in crate::config) fn keys(&mut self, k: &mut impl Keys) {
        k.key(
            "enable",
            &mut self.enable,
            (),
            "Whether the metrics can be fetched, as OpenMetrics from http://BIND:PORT/metrics. Everybody who can connect can read \
             them.",
        );
        k.key(
            "bind",
            &mut self.bind,
            (),
            "The address that is listened on. For one that is not this machine's own the unit's IPAddressAllow= must name the \
             clients (systemctl edit andon-metrics@NAME).",
        );
        k.key(
            "port",
            &mut self.port,
            within(1, 65_535, ""),
            "The TCP port. Each station of a PC needs one of its own.",
        );
    }
}

/// `[health]`: when a role counts as stuck. Times in ms without a sign of life, after which `ready` drops at the PLC. The
/// role `plc` watches the others and has no deadline here: the PLC sees by the server's own life counter whether it runs.
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
    /// Deadline of `steward`.
    pub steward_deadline_ms: u32,
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
            steward_deadline_ms: 1000,
        }
    }
}

impl Health {
    /// How long a role may give no sign of life; `None` for one that has no deadline.
    pub fn deadline(&self, role: RoleId) -> Option<Duration> {
        let deadline_ms = match role {
            RoleId::Capture => self.capture_deadline_ms,
            RoleId::Perceive => self.perceive_deadline_ms,
            RoleId::Encode => self.encode_deadline_ms,
            RoleId::Judge => self.judge_deadline_ms,
            RoleId::Journal => self.journal_deadline_ms,
            RoleId::Steward => self.steward_deadline_ms,
            _ => return None,
        };
        Some(Duration::from_millis(deadline_ms.into()))
    }

    /// The deadlines with the names of their keys, in the order of the data path.
    pub(in crate::config) fn deadlines(&mut self) -> [(&'static str, &mut u32); 6] {
        [
            ("capture_deadline_ms", &mut self.capture_deadline_ms),
            ("perceive_deadline_ms", &mut self.perceive_deadline_ms),
            ("encode_deadline_ms", &mut self.encode_deadline_ms),
            ("judge_deadline_ms", &mut self.judge_deadline_ms),
            ("journal_deadline_ms", &mut self.journal_deadline_ms),
            ("steward_deadline_ms", &mut self.steward_deadline_ms),
        ]
    }

    pub(in crate::config) fn keys(&mut self, k: &mut impl Keys) {
        for (name, deadline) in self.deadlines() {
            k.key(
                name,
                deadline,
                // A role gives two signs of life per second, and one of them may be late.
                within(1000, 60_000, "ms"),
                "When the role gives no sign of life for this long, `ready` drops at the PLC.",
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
    /// The lowest level that is logged.
    pub level: Level,
}

impl Log {
    pub(in crate::config) fn keys(&mut self, k: &mut impl Keys) {
        k.key(
            "level",
            &mut self.level,
            (),
            "The lowest level that is logged: info is a transition, debug an IU, trace a frame. The variable ANDON_LOG \
             overrides it.",
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_role_has_the_deadline_of_its_own_key() {
        let mut health = Health::default();
        for (index, (_, deadline_ms)) in (0..).zip(health.deadlines()) {
            *deadline_ms = 100 + index;
        }
        let keys = health.deadlines().map(|(key, _)| key);
        for (index, key) in (0..).zip(keys) {
            let role = RoleId::ALL.iter().find(|role| key == format!("{}_deadline_ms", role.name()));
            let deadline = role.and_then(|role| health.deadline(*role));
            assert_eq!(deadline, Some(Duration::from_millis(100 + index)), "{key}");
        }
    }
}
