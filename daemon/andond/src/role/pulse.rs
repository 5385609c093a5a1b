//! The signs of life of a role, given by its data loop: health, readiness, watchdog.

use std::time::{Duration, Instant};

use andon_ipc::{Error, Heartbeat, Node, Wake};
use sd_notify::NotifyState;
use shm_schemas::{RoleState, Stamp};

use crate::log::{code, last_error, log};

/// Health on its channel, and `READY=1` and `WATCHDOG=1` to systemd. Nothing of it has a thread of its own: a data loop
/// that stands still falls silent everywhere at once.
pub struct Pulse {
    heartbeat: Heartbeat,
    ready: bool,
    silent: bool,
    /// The source is at its end; only the next message changes that.
    finished: bool,
    /// Losses that have been told, and when.
    told: (u64, Option<Instant>),
}

/// A machine that is too slow loses something all the time.
const TELL_LOSSES_EVERY: Duration = Duration::from_secs(60);

impl Pulse {
    /// Starting.
    ///
    /// # Errors
    /// That the channel `health` cannot be opened.
    pub fn new(node: &Node) -> Result<Self, Error> {
        Ok(Self {
            heartbeat: Heartbeat::new(node)?,
            ready: false,
            silent: false,
            finished: false,
            told: (0, None),
        })
    }

    /// A message was taken.
    pub fn received(&mut self, stamp: &Stamp) {
        self.finished = false;
        self.heartbeat.received(stamp);
    }

    /// A message was sent.
    pub fn sent(&mut self) {
        self.heartbeat.sent();
    }

    /// A message could not be used.
    pub fn refused(&mut self) {
        self.heartbeat.refused();
    }

    /// Losses and restarts so far, as the reader counts them.
    pub fn losses(&mut self, lost: u64, restarts: u32) {
        self.heartbeat.losses(lost, restarts);
        let (told, at) = self.told;
        if lost > told && at.is_none_or(|at| at.elapsed() >= TELL_LOSSES_EVERY) {
            log!(code::LOSSES, "{} messages were lost or skipped", lost - told);
            self.told = (lost, Some(Instant::now()));
        }
    }

    /// A step has gone through. The first one makes the role ready.
    pub fn stepped(&mut self, took: Duration) {
        self.heartbeat.stepped(took);
        if !self.finished {
            self.heartbeat.state(RoleState::Running);
        }
        if !self.ready {
            self.ready = true;
            // Without systemd there is nobody to tell.
            let _ = sd_notify::notify(&[NotifyState::Ready]);
            log!(code::ROLE_READY, "ready: the first step took {took:?}");
        }
    }

    /// It goes on, and what it is there for does not work: the log says what. The next step ends it.
    pub fn failing(&mut self) {
        self.heartbeat.state(RoleState::Fault);
    }

    /// Everything that follows from the source has been sent.
    pub fn finished(&mut self) {
        self.finished = true;
        self.heartbeat.state(RoleState::Finished);
    }

    /// After a wait whose end says how the role's input is: tells transitions, and gives the signs of life that are due.
    ///
    /// # Errors
    /// As [`Pulse::beat`].
    pub fn beat_after(&mut self, wake: &Wake) -> Result<(), Error> {
        self.note(wake);
        self.beat()
    }

    /// Gives the signs of life that are due. After every wait.
    ///
    /// # Errors
    /// That health cannot be sent.
    pub fn beat(&mut self) -> Result<(), Error> {
        self.heartbeat.error(last_error());
        if self.heartbeat.beat()? {
            let _ = sd_notify::notify(&[NotifyState::Watchdog]);
        }
        Ok(())
    }

    fn note(&mut self, wake: &Wake) {
        match wake {
            // Silence is what follows the end.
            Wake::DeadlineMissed | Wake::WriterGone { .. } if self.finished => (),
            Wake::DeadlineMissed if self.ready && !self.silent => {
                self.silent = true;
                self.heartbeat.state(RoleState::Waiting);
                log!(code::DEADLINE_MISSED, "nothing came for {:?}", super::WAIT);
            }
            Wake::WriterGone { channel, departure } => {
                log!(code::DEADLINE_MISSED, "the writer of the channel {channel} has gone ({departure:?})");
                self.silent = true;
                self.heartbeat.state(RoleState::Waiting);
            }
            Wake::Sample if self.silent => {
                self.silent = false;
                log!(code::DEADLINE_MET, "messages come again");
            }
            _ => (),
        }
    }
}
