//! Detects steps of the machine's clock: verdicts carry UTC times, and whoever reads them must know when these jumped.

use andon_host::log::{code, log};
use andon_ipc::{MonotonicTime, UtcTime};

/// A time service that slews moves the clock by half a millisecond per second; a second between two looks is a step.
const STEP_NS: i128 = 1_000_000_000;

/// Compares UTC with the monotonic clock, which nobody can set.
pub(super) struct ClockWatch {
    /// UTC minus monotonic time at the last look, in nanoseconds.
    offset_ns: i128,
}

impl ClockWatch {
    pub(super) fn new() -> Self {
        Self { offset_ns: offset_ns() }
    }

    /// Looks at both clocks, and logs a step since the last look.
    pub(super) fn look(&mut self) {
        if let Some(step_ns) = self.step(offset_ns()) {
            log!(code::CLOCK_STEPPED, "the clock was stepped by {:+.1} s", step_ns as f64 / 1e9);
        }
    }

    /// How far the clock was stepped since the last look. Drift is not a step.
    fn step(&mut self, offset_ns: i128) -> Option<i128> {
        let step_ns = offset_ns - std::mem::replace(&mut self.offset_ns, offset_ns);
        (step_ns.abs() >= STEP_NS).then_some(step_ns)
    }
}

fn offset_ns() -> i128 {
    i128::from(UtcTime::now().nanoseconds()) - i128::from(MonotonicTime::now().nanoseconds())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_forward_and_back_is_reported_once_each_and_drift_is_not() {
        let mut watch = ClockWatch { offset_ns: 0 };
        assert_eq!(watch.step(400_000_000), None, "drift");
        assert_eq!(watch.step(3_600_400_000_000), Some(3_600_000_000_000));
        assert_eq!(watch.step(3_600_400_000_000), None);
        assert_eq!(watch.step(400_000_000), Some(-3_600_000_000_000));
    }
}
