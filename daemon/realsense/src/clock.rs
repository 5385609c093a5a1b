//! From the sensor's time to the computer's.
//!
//! A camera stamps its pictures with one of three clocks; Andon computes with CLOCK_MONOTONIC alone.
//!
//! - *Hardware*: the camera's own clock, 32 bits of microseconds from an unknown start. A picture arrives some time after it was taken: exposure,
//!   transfer and scheduler take their time. The minimum of this delay over the last seconds is the best estimate of the offset between the two
//!   clocks. Jitter only ever adds to it. The minimum delay itself stays unknown; it is a constant of the mode.
//! - *System* and *global*: CLOCK_REALTIME, stamped by the driver or computed by the SDK. Both clocks of the computer are read when a
//!   picture arrives, so a step of the wall clock is followed at once.
//!
//! A recording has its own time, which starts at its first frame: [`RecordingClock`].

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
    /// Milliseconds since the start of the clock.
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
            // Neither clock is negative on a running system, and nanoseconds are below 1e9.
            u64::try_from(time.tv_sec).unwrap_or(0) * 1_000_000_000 + u64::try_from(time.tv_nsec).unwrap_or(0)
        };
        Self { monotonic_ns: read(ClockId::Monotonic), realtime_ns: read(ClockId::Realtime) }
    }
}

/// The hardware clock of a D400 counts microseconds in 32 bits, so it wraps every 71 minutes.
const HARDWARE_PERIOD_NS: i64 = (1_i64 << 32) * 1000;

/// A minimum delay is used for one to two of these spans. Two crystals differ by up to 50 millionths, which is 0.5 ms in 10 s and less than
/// the jitter of a USB frame.
const SPAN_NS: u64 = 5_000_000_000;

/// A wall-clock stamp that is this far from its arrival precedes a step of that clock: no mode delays a picture by a second.
const IMPLAUSIBLE_NS: i64 = 1_000_000_000;

/// Removes the wraps of the hardware clock.
#[derive(Clone, Copy, Debug, Default)]
struct Unwrap {
    turns: i64,
    last: Option<i64>,
}

impl Unwrap {
    /// The time without wraps, and whether the clock has jumped back for another reason.
    fn push(&mut self, time: SensorTime) -> (i64, bool) {
        let raw = (time.ms * 1e6) as i64;
        let mut jumped = false;
        if let Some(last) = self.last.filter(|&last| raw < last) {
            // A jump from the last tenth to the first is a wrap: pictures come more often than every seven minutes.
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
    /// Minimum of arrival minus stamp in this span of `SPAN_NS` and in the one before.
    min: [Option<i64>; 2],
    span_began_ns: u64,
    last_ns: u64,
}

impl CameraClock {
    /// `time` on CLOCK_MONOTONIC, in nanoseconds.
    ///
    /// It is never later than the arrival, and always later than the previous result, so that no reader sees time stand still. A camera that
    /// restarts its clock is followed from that picture on.
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
        if arrived.saturating_sub(self.span_began_ns) > SPAN_NS {
            self.min = [None, self.min[0]];
            self.span_began_ns = arrived;
        }
        let min = self.min[0].map_or(distance, |min| min.min(distance));
        self.min[0] = Some(min);
        stamp + self.min[1].map_or(min, |before| before.min(min))
    }

    fn forget(&mut self) {
        self.unwrap = Unwrap::default();
        self.min = [None; 2];
    }
}

/// The time of a recording: nanoseconds since its first frame.
#[derive(Clone, Debug, Default)]
pub struct RecordingClock {
    unwrap: Unwrap,
    /// What is added to a stamp.
    shift: i64,
    last_ns: i64,
    /// The newest interval between two frames, which is the best estimate of an interval in which the clock has jumped back.
    period: i64,
    began: bool,
}

impl RecordingClock {
    /// Nanoseconds since the first frame of the recording. Where the camera has restarted its clock, the time continues without a jump.
    pub fn since_first_ns(&mut self, time: SensorTime) -> u64 {
        let (stamp, jumped) = self.unwrap.push(time);
        if !self.began {
            self.began = true;
            self.shift = -stamp;
        } else if jumped {
            self.shift = self.last_ns + self.period - stamp;
        } else {
            self.period = stamp + self.shift - self.last_ns;
        }
        self.last_ns = stamp + self.shift;
        // Not negative: every later stamp is greater than the first, or is shifted behind the one before.
        u64::try_from(self.last_ns).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests;
