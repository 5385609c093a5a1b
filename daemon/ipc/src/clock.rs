//! The clocks of the wire, each with a type of its own. So a time of one is never taken for a time of another.
//!
//! Messages carry all of them as plain nanoseconds (`sent_ns`, `source_ns`, `decided_utc_ns`): wire types hold numbers only.

use rustix::time::{ClockId, clock_gettime};
use shm_schemas::Stamp;
use std::ops::Add;
use std::time::{Duration, SystemTime};

const NS_PER_S: u64 = 1_000_000_000;

/// A time on CLOCK_MONOTONIC, which is the same in every process of this machine and cannot be set. For latencies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct MonotonicTime(u64);

impl MonotonicTime {
    /// The time now.
    pub fn now() -> Self {
        let now = clock_gettime(ClockId::Monotonic);
        // Neither is negative: this clock counts from the start of the machine.
        Self(u64::try_from(now.tv_sec).unwrap_or(0) * NS_PER_S + u64::try_from(now.tv_nsec).unwrap_or(0))
    }

    /// When a message was sent.
    pub const fn sent(stamp: &Stamp) -> Self {
        Self(stamp.sent_ns)
    }
}

/// A time of the source: of a recording since its first frame, of a camera that of CLOCK_MONOTONIC. The method computes with it, so that
/// a replay at any speed gives the same verdicts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct SourceTime(u64);

/// What times can do from which durations are computed.
macro_rules! measurable {
    ($($time:ident, such as $field:literal;)*) => { $(
        impl $time {
            #[doc = concat!("A time out of a message, such as `", $field, "`.")]
            pub const fn from_nanoseconds(nanoseconds: u64) -> Self {
                Self(nanoseconds)
            }

            /// The time as messages carry it.
            pub const fn nanoseconds(self) -> u64 {
                self.0
            }

            /// How much later this is than `earlier`; zero where it is not later.
            pub const fn since(self, earlier: Self) -> Duration {
                Duration::from_nanos(self.0.saturating_sub(earlier.0))
            }
        }

        impl Add<Duration> for $time {
            type Output = Self;

            /// 2^64 ns are 584 years; a later sum becomes that.
            fn add(self, duration: Duration) -> Self {
                Self(self.0.saturating_add(u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)))
            }
        }
    )* };
}

measurable! {
    MonotonicTime, such as "Stamp::captured_ns";
    SourceTime, such as "FrameHeader::source_ns";
}

/// A time of the calendar, in nanoseconds since 1970 UTC. It may jump when the machine's clock is set. For people.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct UtcTime(u64);

impl UtcTime {
    /// The time now; 1970 where the machine's clock is set to an earlier year.
    pub fn now() -> Self {
        let since_1970 = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        // 2^64 ns end in 2554.
        Self(since_1970.as_nanos() as u64)
    }

    /// The time at which the monotonic clock showed this, by what both clocks show now.
    pub fn at(then: MonotonicTime) -> Self {
        let ago = MonotonicTime::now().since(then);
        // 2^64 ns are 584 years.
        Self(Self::now().0.saturating_sub(ago.as_nanos() as u64))
    }

    /// The time as messages carry it, such as `Verdict::decided_utc_ns`.
    pub const fn nanoseconds(self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_duration_between_two_times_is_never_negative() {
        let early = MonotonicTime::from_nanoseconds(5);
        let late = early + Duration::from_nanos(7);
        assert_eq!(late.since(early), Duration::from_nanos(7));
        assert_eq!(early.since(late), Duration::ZERO);
    }
}
