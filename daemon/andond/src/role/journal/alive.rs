//! When the journal itself was down. It hears of everybody else by their health. Its own signs of life are in a file of the station's directory, from
//! which its next start sees how long there were none. They end with the line, as that directory does.

use std::path::PathBuf;
use std::time::Duration;

use andon_host::config::Config;
use andon_ipc::{Heartbeat, MonotonicTime};
use shm_schemas::RoleId;

use crate::outage::Outage;

/// The file: the newest sign of life, in nanoseconds of the monotonic clock.
const FILE: &str = "journal.alive";

pub(super) struct Alive {
    file: PathBuf,
    deadline: Duration,
    /// The newest sign of life, of this start or of the one before it.
    newest: Option<MonotonicTime>,
    is_new: bool,
}

impl Alive {
    pub(super) fn new(config: &Config) -> Self {
        let file = config.root().join(FILE);
        let read = std::fs::read_to_string(&file).ok();
        Self {
            newest: read.and_then(|text| text.parse().ok()).map(MonotonicTime::from_nanoseconds),
            deadline: Heartbeat::silence(config.health.deadline(RoleId::Journal).unwrap_or_default()),
            is_new: true,
            file,
        }
    }

    /// A sign of life, to be given in every turn. Tells of a time without any: before this start, or because the role stood still.
    pub(super) fn beat(&mut self, now: MonotonicTime) -> Option<Outage> {
        let is_first = std::mem::take(&mut self.is_new);
        let newest = self.newest.filter(|newest| *newest <= now);
        let silence = newest.map(|newest| now.since(newest));
        if is_first || silence.is_none_or(|silence| silence >= Heartbeat::PERIOD) {
            self.newest = Some(now);
            // Where it cannot be written, the next start says nothing: nobody knows then.
            let _ = std::fs::write(&self.file, now.nanoseconds().to_string());
        }
        let began = newest.filter(|_| is_first || silence.is_some_and(|silence| silence > self.deadline))?;
        Some(Outage { role: RoleId::Journal, began, ended: Some(now) })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn at(ms: u64) -> MonotonicTime {
        MonotonicTime::from_nanoseconds(ms * 1_000_000)
    }

    #[test]
    fn a_start_tells_how_long_nobody_wrote_and_the_first_of_a_line_tells_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let mut config = Config::default();
        (config.station.root, config.station.name) = (folder.path().into(), "line".into());
        std::fs::create_dir_all(config.root()).unwrap();
        let mut first = Alive::new(&config);
        assert_eq!(first.beat(at(1000)), None);
        assert_eq!(first.beat(at(1600)), None);
        assert_eq!(first.beat(at(1700)), None, "too soon for another sign of life");
        let mut second = Alive::new(&config);
        let outage = second.beat(at(9000)).unwrap();
        assert_eq!(
            (outage.began, outage.ended, outage.why().as_str()),
            (at(1600), Some(at(9000)), "journal was down")
        );
        assert_eq!(second.beat(at(9500)), None);
        let stood_still = second.beat(at(20_000)).unwrap();
        assert_eq!((stood_still.began, stood_still.ended), (at(9500), Some(at(20_000))));
        // A clock that has begun again knows nothing of what was before.
        assert_eq!(Alive::new(&config).beat(at(10)), None);
    }
}
