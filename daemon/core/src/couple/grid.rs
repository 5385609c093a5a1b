//! The grid of `rate_hz`: which of its frames a captured frame is.

use super::Refused;

/// The grid. It begins at the first frame and follows the camera's clock.
///
/// A frame belongs to a grid instant if it comes at most a third of a period before it or two thirds after it. Cameras stamp late rather than early,
/// and the frames of one of twice the rate fall clearly on one side. The instant then moves by an eighth of the frame's phase. So a camera of 29.97 Hz
/// neither adds nor loses frames on a grid of 30 Hz, and jitter averages out.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    period_ns: i128,
    /// The instant of the newest frame of the grid; `i128` so that no time stamp can overflow it.
    instant_ns: i128,
    /// The newest time stamp of any frame.
    newest_ns: Option<u64>,
}

impl Grid {
    pub(super) fn new(period_ns: u64) -> Self {
        Self { period_ns: period_ns.into(), instant_ns: 0, newest_ns: None }
    }

    pub(super) fn period_ns(&self) -> u64 {
        // The rate is at least 1 Hz, so a period is at most 1e9.
        self.period_ns as u64
    }

    /// Takes the time stamp of the next captured frame. Returns how many frames of the grid it lies after the newest one. The first is one after none;
    /// what lies between two frames of the grid adds none.
    pub(super) fn step(&mut self, captured_ns: u64) -> Result<u64, Refused> {
        match self.newest_ns {
            Some(newest) if captured_ns == newest => return Err(Refused::Repeated),
            Some(newest) if captured_ns < newest => return Err(Refused::Late),
            Some(_) => {}
            None => {
                self.anchor(captured_ns);
                return Ok(1);
            }
        }
        self.newest_ns = Some(captured_ns);
        let elapsed = i128::from(captured_ns) - self.instant_ns;
        let steps = (3 * elapsed + self.period_ns).div_euclid(3 * self.period_ns);
        if steps <= 0 {
            return Ok(0);
        }
        let phase = elapsed - steps * self.period_ns;
        self.instant_ns += steps * self.period_ns + phase / 8;
        // Positive, and no greater than the span of `u64` time stamps.
        Ok(steps as u64)
    }

    /// Starts the grid again at this frame.
    pub(super) fn anchor(&mut self, captured_ns: u64) {
        self.instant_ns = i128::from(captured_ns);
        self.newest_ns = Some(captured_ns);
    }

    /// Forgets the grid: the next frame is the first.
    pub(super) fn clear(&mut self) {
        self.newest_ns = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Method;

    fn grid(rate_hz: f32) -> Grid {
        Grid::new(Method { rate_hz, ..Method::default() }.period_ns())
    }

    /// How many of these time stamps on a grid of 30 Hz are single steps, how many are surplus, and how many skip frames.
    fn locations(times: impl IntoIterator<Item = u64>) -> [u32; 3] {
        let mut grid = grid(30.0);
        let mut counts = [0; 3];
        for time in times {
            match grid.step(time) {
                Ok(1) => counts[0] += 1,
                Ok(0) => counts[1] += 1,
                _ => counts[2] += 1,
            }
        }
        counts
    }

    #[test]
    fn neither_rounded_times_nor_a_slow_clock_nor_jitter_adds_or_loses_a_frame() {
        let rounded = (0..10_000u64).map(|k| (k * 1_000_000_000 / 30).div_ceil(100_000) * 100_000);
        assert_eq!(locations(rounded), [10_000, 0, 0], "whole tenths of milliseconds");
        assert_eq!(locations((0..100_000).map(|k| k * 33_366_667)), [100_000, 0, 0], "29.97 Hz");
        let mut random = 1u64;
        let late = (0..10_000).map(|k| {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            k * 33_333_333 + (random >> 33) % 10_000_000
        });
        assert_eq!(locations(late), [10_000, 0, 0], "up to ten milliseconds late");
    }

    #[test]
    fn of_twice_the_rate_every_other_frame_is_taken_and_a_missing_one_is_a_step_of_two() {
        let twice = (0..2_000).map(|k| k * 16_666_667 + k % 3 * 1_000_000);
        assert_eq!(locations(twice), [1_000, 1_000, 0]);
        let mut grid = grid(30.0);
        assert_eq!([grid.step(0), grid.step(66_666_667)], [Ok(1), Ok(2)]);
    }

    #[test]
    fn no_time_stamp_overflows() {
        let mut grid = grid(240.0);
        assert_eq!(grid.step(0), Ok(1));
        assert!(grid.step(u64::MAX).is_ok_and(|steps| steps > 1));
        assert_eq!([grid.step(u64::MAX), grid.step(7)], [Err(Refused::Repeated), Err(Refused::Late)]);
    }
}
