//! The two clocks of the wire.

use rustix::time::{ClockId, clock_gettime};
use std::time::SystemTime;

/// CLOCK_MONOTONIC in nanoseconds: the same in every process of this machine.
pub fn monotonic_ns() -> u64 {
    let now = clock_gettime(ClockId::Monotonic);
    u64::try_from(now.tv_sec).unwrap_or(0) * 1_000_000_000 + u64::try_from(now.tv_nsec).unwrap_or(0)
}

/// Nanoseconds since 1970 UTC; 0 before.
pub fn utc_ns() -> u64 {
    let since_1970 = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    // 2^64 ns end in 2554.
    since_1970.as_nanos() as u64
}
