//! JSON lines on the times in which nobody watched, between those of the verdicts.

use andon_ipc::UtcTime;
use serde::Serialize;

use crate::outage::Outage;
use crate::sight::{self, SightChange};

/// A time in which nobody watched the bench. Its `kind` tells it from a verdict; times are nanoseconds since 1970, UTC.
#[derive(Debug, Serialize)]
#[serde(tag = "kind")]
pub(crate) enum NotWatchingLine {
    /// The line stopped seeing its bench, or sees it again: `sight` is then `Clear`, without code, meaning and remedy.
    Sight {
        utc_ns: u64,
        sight: &'static str,
        code: Option<&'static str>,
        meaning: Option<&'static str>,
        remedy: Option<&'static str>,
    },
    /// A role is down, or was until `ended_utc_ns`.
    Outage { role: &'static str, began_utc_ns: u64, ended_utc_ns: Option<u64> },
}

impl NotWatchingLine {
    /// The line of a change at this time.
    pub(crate) fn of_sight(change: SightChange, at: UtcTime) -> Self {
        let code = change.now.and_then(sight::code);
        Self::Sight {
            utc_ns: at.nanoseconds(),
            sight: change.now.unwrap_or(shm_schemas::Sight::Clear).name(),
            code: code.map(|code| code.name),
            meaning: code.map(|code| code.meaning),
            remedy: code.map(|code| code.remedy),
        }
    }

    /// The line of an outage.
    pub(crate) fn of_outage(outage: &Outage) -> Self {
        Self::Outage {
            role: outage.role.name(),
            began_utc_ns: UtcTime::at(outage.began).nanoseconds(),
            ended_utc_ns: outage.ended.map(|ended| UtcTime::at(ended).nanoseconds()),
        }
    }
}
