//! From the sensor's time to the computer's.
//!
//! A camera stamps its pictures with one of three clocks; Andon computes with CLOCK_MONOTONIC alone.
//!
//! - *Hardware*: the camera's own microseconds, 32 bits, from an unknown beginning. A picture arrives some time after it
//!   was taken: the exposure's end, the transfer, the scheduler. The least such delay of the last seconds is the best
//!   guess of the distance between the two clocks: jitter only ever adds to it. What remains unknown is that least
//!   delay itself, a constant of the mode.
//! - *System* and *global*: CLOCK_REALTIME, stamped by the driver or computed by the SDK. Both of the computer's clocks
//!   are read when a picture arrives, so a step of the wall clock is followed at once.
//!
//! A recording has its own time, which begins at its first frame: [`RecordingClock`].

/// Which clock stamped a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// The camera's own.
    Hardware,
    /// The computer's CLOCK_REALTIME, read by the driver.
    System,
    /// CLOCK_REALTIME, computed by the SDK from the camera's own clock.
    Global,
}

/// A picture's time as its sensor gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorTime {
    /// Milliseconds since the clock's beginning.
    pub ms: f64,
    /// Which clock.
    pub domain: Domain,
}

/// When a picture arrived, on both of the computer's clocks, in nanoseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arrival {
    /// CLOCK_MONOTONIC.
    pub monotonic_ns: u64,
    /// CLOCK_REALTIME.
    pub realtime_ns: u64,
}

impl Arrival {
    /// Both clocks now.
    pub fn now() -> Self {
        use rustix::time::{ClockId, clock_gettime};
        let read = |clock| {
            let time = clock_gettime(clock);
            // Neither clock is before its beginning on a running system; nanoseconds are below 1e9.
            u64::try_from(time.tv_sec).unwrap_or(0) * 1_000_000_000 + u64::try_from(time.tv_nsec).unwrap_or(0)
        };
        Self { monotonic_ns: read(ClockId::Monotonic), realtime_ns: read(ClockId::Realtime) }
    }
}

/// The hardware clock of a D400 counts microseconds in 32 bits: it starts again every 71 minutes.
const HARDWARE_PERIOD_NS: i64 = (1_i64 << 32) * 1000;

/// A least delay is trusted for one to two of these spans. Two crystals differ by up to 50 millionths: 0.5 ms in 10 s,
/// less than the jitter of a USB frame.
const TRUST_NS: u64 = 5_000_000_000;

/// A wall-clock stamp this far from its arrival is a stamp from before a step of that clock: no mode holds a picture
/// back for a second.
const IMPLAUSIBLE_NS: i64 = 1_000_000_000;

/// Undoes the wrap of a clock that starts again.
#[derive(Clone, Copy, Debug, Default)]
struct Unwrap {
    turns: i64,
    last: Option<i64>,
}

impl Unwrap {
    /// The time without wraps, and whether the clock has jumped back.
    fn push(&mut self, time: SensorTime) -> (i64, bool) {
        let raw = (time.ms * 1e6) as i64;
        let mut jumped = false;
        if let Some(last) = self.last.filter(|&last| raw < last) {
            // From the last tenth to the first tenth is a wrap: pictures come more often than every seven minutes.
            let tenth = HARDWARE_PERIOD_NS / 10;
            if time.domain == Domain::Hardware && last > HARDWARE_PERIOD_NS - tenth && raw < tenth {
                self.turns += 1;
            } else {
                jumped = true;
            }
        }
        self.last = Some(raw);
        (raw + self.turns * HARDWARE_PERIOD_NS, jumped)
    }
}

/// Maps the times of an attached camera's pictures to CLOCK_MONOTONIC.
#[derive(Clone, Debug, Default)]
pub struct CameraClock {
    domain: Option<Domain>,
    unwrap: Unwrap,
    /// Least arrival minus stamp in this span of `TRUST_NS` and in the one before it.
    least: [Option<i64>; 2],
    span_began_ns: u64,
    last_ns: u64,
}

impl CameraClock {
    /// CLOCK_MONOTONIC of the moment that `time` names, in nanoseconds.
    ///
    /// Never later than the arrival, and later than the result before it, so that no reader sees time stand still.
    /// A camera that starts its clock anew is followed from that picture on.
    pub fn captured_ns(&mut self, time: SensorTime, arrival: Arrival) -> u64 {
        if self.domain.replace(time.domain) != Some(time.domain) {
            self.forget();
        }
        let now = arrival.monotonic_ns as i64;
        let captured = match time.domain {
            Domain::Hardware => self.of_hardware(time, now),
            Domain::System | Domain::Global => {
                let captured = (time.ms * 1e6) as i64 - (arrival.realtime_ns as i64 - now);
                if (now - captured).abs() > IMPLAUSIBLE_NS { now } else { captured }
            }
        };
        let captured = u64::try_from(captured.min(now)).unwrap_or(0);
        self.last_ns = captured.max(self.last_ns + 1);
        self.last_ns
    }

    fn of_hardware(&mut self, time: SensorTime, now: i64) -> i64 {
        let (stamp, jumped) = self.unwrap.push(time);
        if jumped {
            self.forget();
            self.unwrap.push(time);
        }
        let distance = now - stamp;
        let arrived = now.unsigned_abs();
        if arrived.saturating_sub(self.span_began_ns) > TRUST_NS {
            self.least = [None, self.least[0]];
            self.span_began_ns = arrived;
        }
        let least = self.least[0].map_or(distance, |least| least.min(distance));
        self.least[0] = Some(least);
        stamp + self.least[1].map_or(least, |before| before.min(least))
    }

    fn forget(&mut self) {
        self.unwrap = Unwrap::default();
        self.least = [None; 2];
    }
}

/// The time of a recording: nanoseconds since its first frame, through repetitions too.
#[derive(Clone, Debug, Default)]
pub struct RecordingClock {
    unwrap: Unwrap,
    /// What is added to a stamp.
    shift: i64,
    last_ns: i64,
    /// The newest distance of two frames: the best guess of the one from the last frame back to the first.
    period: i64,
    began: bool,
}

impl RecordingClock {
    /// Nanoseconds since the first frame of the recording; a repetition goes on where the last one ended.
    pub fn since_first_ns(&mut self, time: SensorTime) -> u64 {
        let (stamp, again) = self.unwrap.push(time);
        if !self.began {
            self.began = true;
            self.shift = -stamp;
        } else if again {
            self.shift = self.last_ns + self.period - stamp;
        } else {
            self.period = stamp + self.shift - self.last_ns;
        }
        self.last_ns = stamp + self.shift;
        // Stamps after the first are later than it, or are shifted behind the one before.
        u64::try_from(self.last_ns).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests;
