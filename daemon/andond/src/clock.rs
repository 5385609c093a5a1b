//! Times of day for people: of this machine's time zone unless UTC is asked for. A time has its offset from UTC where that is another one than now,
//! which the head of a table has. In the night in which clocks go back, an hour comes twice.

use andon_ipc::{MonotonicTime, UtcTime};
use jiff::Timestamp;
use jiff::tz::{Offset, TimeZone};

/// Tells times.
#[derive(Clone, Debug)]
pub(crate) struct Clock {
    zone: TimeZone,
    /// The offset of every time that has none.
    offset: Offset,
}

impl Clock {
    pub(crate) fn new(utc: bool) -> Self {
        Self::of(if utc { TimeZone::UTC } else { TimeZone::system() }, Timestamp::now())
    }

    fn of(zone: TimeZone, now: Timestamp) -> Self {
        let offset = zone.to_offset(now);
        Self { zone, offset }
    }

    /// The time of day to the second.
    pub(crate) fn time(&self, utc_ns: u64) -> String {
        self.format(utc_ns, "%H:%M:%S")
    }

    /// The time of day at which the monotonic clock showed this.
    pub(crate) fn time_of(&self, then: MonotonicTime) -> String {
        self.time(UtcTime::at(then).nanoseconds())
    }

    /// Date and time to the second.
    pub(crate) fn date_time(&self, utc_ns: u64) -> String {
        self.format(utc_ns, "%Y-%m-%d %H:%M:%S")
    }

    /// In whichever of two forms the span asks for, so that a picture has room for it.
    pub(crate) fn mark(&self, utc_ns: u64, span_ns: u64) -> String {
        const DAY_NS: u64 = 86_400_000_000_000;
        self.format(utc_ns, if span_ns > 2 * DAY_NS { "%m-%d" } else { "%H:%M" })
    }

    /// What the times are: the offset from UTC, now.
    pub(crate) fn zone(&self) -> String {
        if self.zone == TimeZone::UTC {
            return "UTC".to_owned();
        }
        format!("local time, UTC{}", signed(self.offset))
    }

    /// As a number where it is beyond the calendar.
    fn format(&self, utc_ns: u64, format: &str) -> String {
        Timestamp::from_nanosecond(utc_ns.into()).map_or_else(
            |_| utc_ns.to_string(),
            |time| {
                let time = time.to_zoned(self.zone.clone());
                let offset = if time.offset() == self.offset { String::new() } else { signed(time.offset()) };
                time.strftime(format).to_string() + &offset
            },
        )
    }
}

/// As in +02:00.
fn signed(offset: Offset) -> String {
    let minutes = offset.seconds() / 60;
    let sign = if minutes < 0 { '-' } else { '+' };
    format!("{sign}{:02}:{:02}", minutes.abs() / 60, minutes.abs() % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_that_of_the_zone_and_of_utc_on_request() {
        let noon = 1_780_000_000_000_000_000;
        assert_eq!(Clock::new(true).date_time(noon), "2026-05-28 20:26:40");
        let east = Clock::of(TimeZone::fixed(jiff::tz::offset(2)), Timestamp::UNIX_EPOCH);
        assert_eq!((east.time(noon).as_str(), east.mark(noon, 0).as_str()), ("22:26:40", "22:26"));
        assert_eq!(east.mark(noon, u64::MAX), "05-28");
        assert_eq!((Clock::new(true).zone(), east.zone()), ("UTC".into(), "local time, UTC+02:00".into()));
    }

    /// From 3:00 to 2:00 on 25 October 2026.
    #[test]
    fn an_hour_that_comes_twice_is_told_with_its_offset_the_time_that_is_not_that_of_the_head() {
        let zone = TimeZone::posix("CET-1CEST,M3.5.0,M10.5.0/3").unwrap_or(TimeZone::UTC);
        let second = |text: &str| text.parse::<Timestamp>().map_or(0, |time| time.as_second());
        let at = |text: &str| 1_000_000_000 * second(text) as u64;
        let told = |clock: &Clock| {
            ["2026-10-25T00:30:00Z", "2026-10-25T01:30:00Z"].map(|text| clock.date_time(at(text)))
        };
        let before = Clock::of(
            zone.clone(),
            Timestamp::from_second(second("2026-10-24T12:00:00Z")).unwrap_or_default(),
        );
        assert_eq!(before.zone(), "local time, UTC+02:00");
        assert_eq!(told(&before), ["2026-10-25 02:30:00", "2026-10-25 02:30:00+01:00"]);
        let after =
            Clock::of(zone, Timestamp::from_second(second("2026-10-26T12:00:00Z")).unwrap_or_default());
        assert_eq!(after.zone(), "local time, UTC+01:00");
        assert_eq!(told(&after), ["2026-10-25 02:30:00+02:00", "2026-10-25 02:30:00"]);
        assert_eq!(after.time(at("2026-10-25T00:30:00Z")), "02:30:00+02:00");
    }
}
