//! Times of day for people: of this machine's time zone unless UTC is asked for.

use andon_ipc::{MonotonicTime, UtcTime};
use jiff::Timestamp;
use jiff::tz::TimeZone;

/// Tells times.
#[derive(Clone, Debug)]
pub(super) struct Clock(TimeZone);

impl Clock {
    pub(super) fn new(utc: bool) -> Self {
        Self(if utc { TimeZone::UTC } else { TimeZone::system() })
    }

    /// The time of day to the second.
    pub(super) fn time(&self, utc_ns: u64) -> String {
        self.format(utc_ns, "%H:%M:%S")
    }

    /// The time of day at which the monotonic clock showed this.
    pub(super) fn time_of(&self, then: MonotonicTime) -> String {
        self.time(UtcTime::at(then).nanoseconds())
    }

    /// Date and time to the second.
    pub(super) fn date_time(&self, utc_ns: u64) -> String {
        self.format(utc_ns, "%Y-%m-%d %H:%M:%S")
    }

    /// In whichever of two forms the span asks for, so that a picture has room for it.
    pub(super) fn mark(&self, utc_ns: u64, span_ns: u64) -> String {
        const DAY_NS: u64 = 86_400_000_000_000;
        self.format(utc_ns, if span_ns > 2 * DAY_NS { "%m-%d" } else { "%H:%M" })
    }

    /// What the times are: the offset from UTC, now.
    pub(super) fn zone(&self) -> String {
        if self.0 == TimeZone::UTC {
            return "UTC".to_owned();
        }
        let now = Timestamp::now().to_zoned(self.0.clone());
        format!("local time, UTC{}", now.strftime("%:z"))
    }

    /// As a number where it is beyond the calendar.
    fn format(&self, utc_ns: u64, format: &str) -> String {
        Timestamp::from_nanosecond(utc_ns.into()).map_or_else(
            |_| utc_ns.to_string(),
            |time| time.to_zoned(self.0.clone()).strftime(format).to_string(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_that_of_the_zone_and_of_utc_on_request() {
        let noon = 1_780_000_000_000_000_000;
        assert_eq!(Clock::new(true).date_time(noon), "2026-05-28 20:26:40");
        let east = Clock(TimeZone::fixed(jiff::tz::offset(2)));
        assert_eq!((east.time(noon).as_str(), east.mark(noon, 0).as_str()), ("22:26:40", "22:26"));
        assert_eq!(east.mark(noon, u64::MAX), "05-28");
        assert_eq!((Clock::new(true).zone(), east.zone()), ("UTC".into(), "local time, UTC+02:00".into()));
    }
}
