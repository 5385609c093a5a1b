//! The signs of life of a role, given by its data loop: health, readiness, watchdog.

use std::time::{Duration, Instant};

use andon_ipc::{Error, Heartbeat, Node, Wake};
use sd_notify::NotifyState;
use shm_schemas::{MessageId, RoleState, Sight, Stamp};

use crate::log::{code, last_error, log};

/// Health on its channel, and `READY=1` and `WATCHDOG=1` to systemd. Nothing of it has a thread of its own: a data loop
/// that stands still falls silent everywhere at once.
pub struct Liveness {
    heartbeat: Heartbeat,
    is_ready: bool,
    /// The input has fallen silent; only the next message changes that.
    is_silent: bool,
    /// The source is at its end; only the next message changes that.
    is_finished: bool,
    /// Losses that have been logged, and when.
    logged: (u64, Option<Instant>),
    began: Instant,
}

/// A role whose first message has not come by then says so: before that its neighbours may still be starting.
const FIRST_MESSAGE: Duration = Duration::from_secs(10);

/// A machine that is too slow loses something all the time.
const LOG_LOSSES_EVERY: Duration = Duration::from_secs(60);

impl Liveness {
    /// Starting.
    ///
    /// # Errors
    /// That the channel `health` cannot be opened.
    pub(super) fn new(node: &Node) -> Result<Self, Error> {
        Ok(Self {
            heartbeat: Heartbeat::new(node)?,
            is_ready: false,
            is_silent: false,
            is_finished: false,
            logged: (0, None),
            began: Instant::now(),
        })
    }

    /// A message was taken.
    pub(super) fn received(&mut self, stamp: &Stamp) {
        self.is_finished = false;
        if std::mem::take(&mut self.is_silent) {
            log!(code::DEADLINE_MET, "messages come again");
        }
        self.heartbeat.received(stamp);
    }

    /// This is the newest message that was sent.
    pub(super) fn sent(&mut self, newest: MessageId) {
        self.heartbeat.sent(newest);
    }

    /// A message could not be used.
    pub fn refused(&mut self) {
        self.heartbeat.refused();
    }

    /// Losses and restarts so far, as the reader counts them.
    pub(super) fn losses(&mut self, lost: u64, restarts: u32) {
        self.heartbeat.losses(lost, restarts);
        let (logged, at) = self.logged;
        if lost > logged && at.is_none_or(|at| at.elapsed() >= LOG_LOSSES_EVERY) {
            log!(code::LOSSES, "{} messages were lost or skipped", lost - logged);
            self.logged = (lost, Some(Instant::now()));
        }
    }

    /// A step has gone through. The first one makes the role ready.
    pub(super) fn stepped(&mut self, took: Duration) {
        self.heartbeat.stepped(took);
        self.heartbeat.state(RoleState::Running);
        self.ready(took);
    }

    fn ready(&mut self, took: Duration) {
        if !self.is_ready {
            self.is_ready = true;
            // Without systemd there is nobody to notify.
            let _ = sd_notify::notify(&[NotifyState::Ready]);
            log!(code::ROLE_READY, "ready: the first step took {took:?}");
        }
    }

    /// The role goes on but cannot do its work: the log says why. The next step ends this state.
    pub fn failing(&mut self) {
        self.heartbeat.state(RoleState::Fault);
    }

    /// What the role can see of its bench, and since when on the monotonic clock.
    pub fn sees(&mut self, sight: Sight, since_ns: u64) {
        self.heartbeat.sight(sight, since_ns);
    }

    /// The message that ends the source was taken, and everything that follows from it has been sent. It has no frame: it makes the
    /// role ready as a step does, and does not count as one.
    pub(super) fn finished(&mut self, took: Duration) {
        self.is_finished = true;
        self.heartbeat.state(RoleState::Finished);
        self.ready(took);
    }

    /// Gives the signs of life that are due, and tells whether any were. Belongs after every wait.
    ///
    /// # Errors
    /// That health cannot be sent.
    pub(super) fn beat(&mut self) -> Result<bool, Error> {
        self.heartbeat.error(last_error());
        let was_due = self.heartbeat.beat()?;
        if was_due {
            let _ = sd_notify::notify(&[NotifyState::Watchdog]);
        }
        Ok(was_due)
    }

    /// After a wait whose end says how the role's input is: logs that it has fallen silent.
    pub(super) fn note(&mut self, wake: &Wake) {
        match wake {
            // Silence is what follows the end.
            Wake::DeadlineMissed | Wake::WriterGone { .. } if self.is_finished => (),
            Wake::DeadlineMissed if self.is_ready && !self.is_silent => {
                self.fall_silent();
                log!(code::DEADLINE_MISSED, "nothing came for {:?}", super::WAIT);
            }
            // The roles of a station start side by side, and a camera may take its time.
            Wake::DeadlineMissed if !self.is_silent && self.began.elapsed() >= FIRST_MESSAGE => {
                self.fall_silent();
                log!(code::DEADLINE_MISSED, "nothing has come since the start, {FIRST_MESSAGE:?} ago");
            }
            Wake::WriterGone { channel, departure } => {
                self.fall_silent();
                log!(code::DEADLINE_MISSED, "the writer of the channel {channel} has gone ({departure:?})");
            }
            _ => (),
        }
    }

    fn fall_silent(&mut self) {
        self.is_silent = true;
        self.heartbeat.state(RoleState::Waiting);
    }
}
