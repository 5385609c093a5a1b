//! Watches whether a camera sends frames at the configured rate.

use std::time::Duration;

use andon_ipc::MonotonicTime;

/// Long enough that one late frame does not matter, short enough that a technician still remembers what was changed.
const WINDOW: Duration = Duration::from_secs(5);

/// A camera is slow below this share of the configured rate. In the dark, automatic exposure halves the rate; jitter costs a few frames in
/// a hundred.
const SLOW_SHARE: f64 = 0.8;

/// Counts the frames in a window of time.
pub(crate) struct RateWatch {
    configured_hz: f64,
    began: Option<MonotonicTime>,
    frames: u32,
    slow: bool,
}

impl RateWatch {
    pub(crate) fn new(configured_hz: f64) -> Self {
        Self { configured_hz, began: None, frames: 0, slow: false }
    }

    /// Counts a frame. Returns the rate when it has just become too low.
    pub(crate) fn frame(&mut self, now: MonotonicTime) -> Option<f64> {
        let began = *self.began.get_or_insert(now);
        let elapsed = now.since(began);
        if elapsed < WINDOW {
            self.frames += 1;
            return None;
        }
        let rate_hz = f64::from(self.frames) / elapsed.as_secs_f64();
        (self.began, self.frames) = (Some(now), 1);
        let is_slow = rate_hz < SLOW_SHARE * self.configured_hz;
        let has_become_slow = is_slow && !self.slow;
        self.slow = is_slow;
        has_become_slow.then_some(rate_hz)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is reported while a camera sends at this rate for `for_s` seconds.
    fn reported(watch: &mut RateWatch, from_s: u64, for_s: u64, rate_hz: u64) -> Vec<f64> {
        let frames =
            (0..for_s * rate_hz).map(|frame| from_s * 1_000_000_000 + frame * 1_000_000_000 / rate_hz);
        frames.filter_map(|ns| watch.frame(MonotonicTime::from_nanoseconds(ns))).collect()
    }

    #[test]
    fn a_camera_that_halves_its_rate_is_reported_once_until_it_has_recovered() {
        let mut watch = RateWatch::new(30.0);
        assert_eq!(reported(&mut watch, 0, 20, 30), [0.0; 0]);
        let slow = reported(&mut watch, 20, 30, 15);
        assert!(slow.len() == 1 && slow[0] < 24.0, "{slow:?}");
        assert_eq!(reported(&mut watch, 50, 20, 30), [0.0; 0]);
        assert_eq!(reported(&mut watch, 70, 20, 15).len(), 1);
    }
}
