//! Whether a camera gives the frames that it was asked for.

use std::time::Duration;

/// Long enough that a late frame does not count, short enough that a technician still knows what was changed.
const WINDOW: Duration = Duration::from_secs(5);

/// Under this share of the rate a camera is slow. In the dark, automatic exposure halves the rate; jitter takes a few
/// frames of a hundred.
const SHARE: f64 = 0.8;

/// Counts frames against the clock.
pub(super) struct RateWatch {
    asked_hz: f64,
    began_ns: Option<u64>,
    frames: u32,
    slow: bool,
}

impl RateWatch {
    pub(super) fn new(asked_hz: f64) -> Self {
        Self { asked_hz, began_ns: None, frames: 0, slow: false }
    }

    /// A frame has come. The rate, where it has just begun to be too low.
    pub(super) fn frame(&mut self, now_ns: u64) -> Option<f64> {
        let began_ns = *self.began_ns.get_or_insert(now_ns);
        let lasted = Duration::from_nanos(now_ns.saturating_sub(began_ns));
        if lasted < WINDOW {
            self.frames += 1;
            return None;
        }
        let rate_hz = f64::from(self.frames) / lasted.as_secs_f64();
        (self.began_ns, self.frames) = (Some(now_ns), 1);
        let is_slow = rate_hz < SHARE * self.asked_hz;
        let begins = is_slow && !self.slow;
        self.slow = is_slow;
        begins.then_some(rate_hz)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is told of so many seconds at a rate, from a time on.
    fn told(watch: &mut RateWatch, from_s: u64, for_s: u64, rate_hz: u64) -> Vec<f64> {
        let frames =
            (0..for_s * rate_hz).map(|frame| from_s * 1_000_000_000 + frame * 1_000_000_000 / rate_hz);
        frames.filter_map(|ns| watch.frame(ns)).collect()
    }

    #[test]
    fn a_camera_that_halves_its_rate_is_told_once_until_it_has_recovered() {
        let mut watch = RateWatch::new(30.0);
        assert_eq!(told(&mut watch, 0, 20, 30), [0.0; 0]);
        let slow = told(&mut watch, 20, 30, 15);
        assert!(slow.len() == 1 && slow[0] < 24.0, "{slow:?}");
        assert_eq!(told(&mut watch, 50, 20, 30), [0.0; 0]);
        assert_eq!(told(&mut watch, 70, 20, 15).len(), 1);
    }
}
