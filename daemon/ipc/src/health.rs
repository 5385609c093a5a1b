//! How a role is doing, measured and sent in its data loop.

use crate::clock::MonotonicTime;
use crate::error::Error;
use crate::node::Node;
use crate::writer::Writer;
use hdrhistogram::Histogram;
use shm_schemas::{Health, MessageId, RoleState, Sight, Stamp};
use std::time::{Duration, Instant};

/// The longest step that is measured, in microseconds: a minute. A longer one counts as this long.
const MAX_STEP_US: u64 = 60_000_000;

/// Counts what a role does and sends it on the channel `health`.
///
/// [`Heartbeat::beat`] belongs in the data loop, after every wait, whatever ended the wait. Then a loop that stands still falls silent, whereas a
/// timer thread would go on. Waits must not be longer than [`Heartbeat::PERIOD`].
#[derive(Debug)]
pub struct Heartbeat {
    writer: Writer<Health>,
    counts: Health,
    steps: Histogram<u64>,
    began: Instant,
    changed: bool,
}

impl Heartbeat {
    /// 2 Hz, so that a late message still comes within the second that watchers allow.
    pub const PERIOD: Duration = Duration::from_millis(500);

    /// How long others wait for a sign of life of a role with this deadline: one beat may be late.
    pub fn silence(deadline: Duration) -> Duration {
        deadline.max(2 * Self::PERIOD)
    }

    /// Starts counting. The role is [`RoleState::Starting`].
    ///
    /// # Errors
    /// As [`Node::writer`].
    pub fn new(node: &Node) -> Result<Self, Error> {
        let deadline_ms = node.deadline().map_or(0, |deadline| deadline.as_millis());
        let counts = Health {
            role: node.role().code(),
            state: RoleState::Starting.code(),
            pid: std::process::id(),
            configuration: node.configuration(),
            deadline_ms: u32::try_from(deadline_ms).unwrap_or(u32::MAX),
            ..Health::default()
        };
        // Two digits: 1 % is finer than any decision that depends on it.
        let steps = Histogram::new_with_bounds(1, MAX_STEP_US, 2)
            .map_err(|e| Error::transport(crate::Channel::Health, "making the histogram of step times", e))?;
        Ok(Self { writer: node.writer()?, counts, steps, began: Instant::now(), changed: true })
    }

    /// A message was taken from the role's data channel.
    pub fn received(&mut self, stamp: &Stamp) {
        self.counts.received += 1;
        self.counts.stamp.frame_seq = stamp.frame_seq;
        self.counts.stamp.captured_ns = stamp.captured_ns;
        let lateness = MonotonicTime::now().since(MonotonicTime::sent(stamp));
        self.counts.lateness_us = u32::try_from(lateness.as_micros()).unwrap_or(u32::MAX);
    }

    /// A step of the data loop is done; `took` is how long it took.
    pub fn stepped(&mut self, took: Duration) {
        self.counts.steps += 1;
        let micros = u64::try_from(took.as_micros()).unwrap_or(MAX_STEP_US);
        self.steps.saturating_record(micros.clamp(1, MAX_STEP_US));
    }

    /// This is the newest message that was sent on the role's data channel.
    pub fn sent(&mut self, newest: MessageId) {
        (self.counts.sent_epoch, self.counts.sent) = (newest.epoch, newest.seq);
    }

    /// The losses and restarts so far, as the reader counts them.
    pub fn losses(&mut self, lost: u64, restarts: u32) {
        self.counts.losses = lost;
        self.counts.restarts_seen = restarts;
    }

    /// A message was received and could not be used.
    pub fn refused(&mut self) {
        self.counts.refused += 1;
    }

    /// Sets what the role is doing. The next [`Heartbeat::beat`] sends a change.
    pub fn state(&mut self, state: RoleState) {
        if self.counts.state != state.code() {
            self.counts.state = state.code();
            self.changed = true;
        }
    }

    /// Sets what the role can see of its bench, and since when. The next [`Heartbeat::beat`] sends a change.
    pub fn sight(&mut self, sight: Sight, since_ns: u64) {
        let now = (sight.code(), since_ns);
        if (self.counts.sight, self.counts.sight_since_ns) != now {
            (self.counts.sight, self.counts.sight_since_ns) = now;
            self.changed = true;
        }
    }

    /// Sets the number of the last error's code.
    pub fn error(&mut self, code: u32) {
        self.counts.last_error = code;
    }

    /// Sends health if it is due, and tells whether it was.
    ///
    /// # Errors
    /// As [`Writer::send`].
    pub fn beat(&mut self) -> Result<bool, Error> {
        let period = self.began.elapsed();
        if period < Self::PERIOD && !self.changed {
            return Ok(false);
        }
        self.counts.rate_hz = self.steps.len() as f32 / period.as_secs_f32();
        self.counts.p50_us = micros_at(&self.steps, 0.50);
        self.counts.p99_us = micros_at(&self.steps, 0.99);
        let mut health = self.writer.loan()?;
        *health = self.counts;
        self.writer.send(health)?;
        self.steps.reset();
        self.began = Instant::now();
        self.changed = false;
        Ok(true)
    }
}

fn micros_at(steps: &Histogram<u64>, quantile: f64) -> u32 {
    u32::try_from(steps.value_at_quantile(quantile)).unwrap_or(u32::MAX)
}
