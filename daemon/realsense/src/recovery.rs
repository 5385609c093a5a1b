//! Unplug and replug: a camera that went away comes back by itself.
//!
//! ```text
//!                 frame                        gone, or silent for too long
//!               ┌───────┐                    ┌───────────────────────────────┐
//!               ▼       │                    │                               ▼
//!             ┌───────────┐  ────────────────┘                         ┌──────────┐
//!             │   open    │                                            │  closed  │ ──┐ failed:
//!             └───────────┘  ◄──────────────────────────────────────── └──────────┘ ◄─┘ pause doubles
//!                                opened, when the pause is over
//! ```
//!
//! A camera that opens and stays silent, `RESET_AFTER` times in a row, is reset before it is opened once more.
//!
//! [`Recovery`] is the state alone, time is its argument. [`Supervised`] puts it over a [`Driver`].

use std::time::Duration;

use crate::Error;

/// The kernel needs about this long to list a camera that was plugged in.
const FIRST_PAUSE: Duration = Duration::from_millis(500);

/// A worker who has plugged the camera in again should see it back before he tries something else.
const LONGEST_PAUSE: Duration = Duration::from_secs(4);

/// One silent start may be a full bus; the second is the camera's firmware.
const RESET_AFTER: u32 = 2;

/// Whether the camera is open, and when to try again if not.
#[derive(Clone, Debug)]
pub struct Recovery {
    state: State,
    pause: Duration,
    silent_starts: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    Open { heard: Duration, sent: bool },
    Closed { retry: Duration },
}

/// What is to be done next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Due {
    /// Wait for a frame.
    Frame,
    /// Open the camera, and reset it first if so.
    Open {
        /// Reset it first.
        reset: bool,
    },
    /// Nothing before this much time has passed.
    Later(Duration),
}

impl Recovery {
    /// A camera that has just been opened. Times are those of one monotonic clock.
    pub fn opened(now: Duration) -> Self {
        Self { state: State::Open { heard: now, sent: false }, pause: FIRST_PAUSE, silent_starts: 0 }
    }

    /// What is to be done.
    pub fn due(&self, now: Duration) -> Due {
        match self.state {
            State::Open { .. } => Due::Frame,
            State::Closed { retry } if now < retry => Due::Later(retry - now),
            State::Closed { .. } => Due::Open { reset: self.silent_starts >= RESET_AFTER },
        }
    }

    /// A frame came.
    pub fn frame(&mut self, now: Duration) {
        *self = Self::opened(now);
        self.state = State::Open { heard: now, sent: true };
    }

    /// No frame came. `Some`, the silence so far, when it is longer than `patience` and the camera must be closed.
    pub fn nothing(&mut self, now: Duration, patience: Duration) -> Option<Duration> {
        let State::Open { heard, sent } = self.state else { return None };
        let silence = now.saturating_sub(heard);
        if silence < patience {
            return None;
        }
        self.silent_starts = if sent { 0 } else { self.silent_starts + 1 };
        self.close(now);
        Some(silence)
    }

    /// The camera is gone, or opening it has failed.
    pub fn close(&mut self, now: Duration) {
        self.state = State::Closed { retry: now + self.pause };
        self.pause = (self.pause * 2).min(LONGEST_PAUSE);
    }

    /// The camera has been opened again.
    pub fn reopened(&mut self, now: Duration) {
        self.state = State::Open { heard: now, sent: false };
        if self.silent_starts >= RESET_AFTER {
            self.silent_starts = 0;
        }
    }
}

/// Why a wait ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Next<F> {
    /// A frame came.
    Frame(F),
    /// No frame within the time given; the camera is there.
    Nothing,
    /// There is no camera for now; it is opened again by itself. Comes at every call until then.
    Lost(Error),
    /// The recording is at its end.
    Ended,
}

/// What [`Supervised`] drives: the SDK, or a test.
pub trait Driver {
    /// An open camera or recording.
    type Camera;
    /// A frame of it.
    type Frame;
    /// Opens it.
    fn open(&mut self) -> Result<Self::Camera, Error>;
    /// Makes it start from scratch, as if plugged in again; what cannot be reset is left as it is.
    fn reset(&mut self);
    /// Waits for a frame. `Lost` when it is gone.
    fn wait(&mut self, camera: &mut Self::Camera, timeout: Duration) -> Next<Self::Frame>;
    /// How long no frame may come before the camera is started again; `None` where silence is no fault.
    fn patience(&self) -> Option<Duration>;
    /// What `Lost` says of a silence.
    fn silent(&self, camera: &Self::Camera, silence: Duration) -> Error;
    /// A monotonic clock.
    fn now(&self) -> Duration;
    /// Lets time pass.
    fn pause(&mut self, time: Duration);
}

/// A driver whose camera comes back by itself.
#[derive(Debug)]
pub struct Supervised<D: Driver> {
    driver: D,
    camera: Option<D::Camera>,
    recovery: Recovery,
    /// Why there is no camera; meaningless while there is one.
    lost: Option<Error>,
}

impl<D: Driver> Supervised<D> {
    /// Opens the camera for the first time. An error here is for the person who has set it up: nothing is retried.
    pub fn open(mut driver: D) -> Result<Self, Error> {
        let camera = driver.open()?;
        let recovery = Recovery::opened(driver.now());
        Ok(Self { driver, camera: Some(camera), recovery, lost: None })
    }

    /// The open camera.
    pub fn camera(&self) -> Option<&D::Camera> {
        self.camera.as_ref()
    }

    /// Waits for a frame, or brings the camera back. Takes `timeout` at most, except for the SDK's own opening and
    /// closing of a camera (up to 5 s while one is away).
    pub fn next(&mut self, timeout: Duration) -> Next<D::Frame> {
        match self.recovery.due(self.driver.now()) {
            Due::Frame => self.wait(timeout),
            Due::Later(time) => {
                self.driver.pause(time.min(timeout));
                self.still_lost()
            }
            Due::Open { reset } => {
                if reset {
                    self.driver.reset();
                }
                match self.driver.open() {
                    Ok(camera) => {
                        self.camera = Some(camera);
                        self.recovery.reopened(self.driver.now());
                        self.wait(timeout)
                    }
                    Err(why) => self.lose(why),
                }
            }
        }
    }

    fn wait(&mut self, timeout: Duration) -> Next<D::Frame> {
        // Open by `Recovery::due`: a missing camera is then a fault of this file, and is reported as no frame.
        let Some(camera) = self.camera.as_mut() else { return self.still_lost() };
        match self.driver.wait(camera, timeout) {
            Next::Frame(frame) => {
                self.recovery.frame(self.driver.now());
                Next::Frame(frame)
            }
            Next::Nothing => self.nothing(),
            Next::Lost(why) => self.lose(why),
            Next::Ended => Next::Ended,
        }
    }

    fn nothing(&mut self) -> Next<D::Frame> {
        let now = self.driver.now();
        let silence = self.driver.patience().and_then(|patience| self.recovery.nothing(now, patience));
        let (Some(silence), Some(camera)) = (silence, self.camera.take_if(|_| silence.is_some())) else {
            return Next::Nothing;
        };
        self.lost = Some(self.driver.silent(&camera, silence));
        self.still_lost()
    }

    fn lose(&mut self, why: Error) -> Next<D::Frame> {
        self.camera = None;
        self.recovery.close(self.driver.now());
        self.lost = Some(why);
        self.still_lost()
    }

    fn still_lost(&self) -> Next<D::Frame> {
        self.lost.clone().map_or(Next::Nothing, Next::Lost)
    }
}

#[cfg(test)]
mod tests;
