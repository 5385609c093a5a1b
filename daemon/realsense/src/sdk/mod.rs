//! The SDK's side: the only code that calls librealsense.
//!
//! [`library`] loads it; [`camera`] opens an attached camera, [`recording`] a file; both give an [`Open`], whose
//! [`picture`]s come through the same path. [`crate::recovery`] drives it.

mod camera;
mod library;
mod picture;
mod recording;

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use realsense_rust::context::Context;
use realsense_rust::frame::{ColorFrame, CompositeFrame, DepthFrame, FrameEx};
use realsense_rust::pipeline::{ActivePipeline, FrameWaitError};

use crate::Error;
use crate::clock::{Arrival, CameraClock, RecordingClock};
use crate::recovery::{Driver, Next, Supervised};
use crate::settings::{Origin, Settings};

pub use picture::Frame;

/// A camera or a recording that frames come from.
///
/// One thread uses it. A frame is taken from the sensor's own buffers, of which there are few: write it out and drop it
/// before the next one is waited for.
#[derive(Debug)]
pub struct Source(Supervised<Sdk>);

impl Source {
    /// Loads librealsense and opens what the settings name.
    ///
    /// # Errors
    /// Every [`Error`] says what to do about it. Nothing is retried here; once it has been opened, a camera that goes
    /// away is opened again by [`Source::next`].
    pub fn open(settings: Settings) -> Result<Self, Error> {
        let api = library::load(&settings.library)?;
        let context = Context::new().map_err(|error| sdk("setting up", error))?;
        Supervised::open(Sdk { api, context, settings, began: Instant::now() }).map(Self)
    }

    /// Waits for the next frame, `timeout` at most; while a camera is away the SDK can take 5 s more.
    pub fn next(&mut self, timeout: Duration) -> Next<Frame> {
        self.0.next(timeout)
    }

    /// Name and serial number, as `Intel RealSense D435I 123456789012`; `None` while it is away.
    pub fn name(&self) -> Option<&str> {
        self.0.camera().map(|open| open.name.as_str())
    }
}

/// 60 frames at 30 Hz: no exposure, no stall of USB and no auto exposure takes that long.
const PATIENCE: Duration = Duration::from_secs(2);

/// What the SDK may take beyond the timeout of a wait. It brings a lost camera back by itself, in more time than this
/// and with all options at their defaults: such a camera is opened again properly.
const SLACK: Duration = Duration::from_millis(500);

#[derive(Debug)]
struct Sdk {
    api: library::Api,
    context: Context,
    settings: Settings,
    began: Instant,
}

/// An open camera or recording.
#[derive(Debug)]
struct Open {
    pipeline: ActivePipeline,
    name: String,
    serial: String,
    depth: bool,
    optics: picture::Optics,
    kind: Kind,
    /// Framesets that were fetched while opening.
    fetched: VecDeque<CompositeFrame>,
    last_number: Option<u64>,
}

/// What differs between the two.
#[derive(Debug)]
enum Kind {
    Camera(CameraClock),
    Recording(RecordingClock, recording::Playback),
}

impl Driver for Sdk {
    type Camera = Open;
    type Frame = Frame;

    fn open(&mut self) -> Result<Open, Error> {
        match &self.settings.origin {
            Origin::Camera(wanted) => camera::open(&self.context, wanted, self.settings.depth),
            Origin::Recording(wanted) => {
                recording::open(self.api, &self.context, wanted, self.settings.depth)
            }
        }
    }

    fn reset(&mut self) {
        if let Origin::Camera(wanted) = &self.settings.origin {
            camera::reset(&self.context, wanted.serial.as_deref());
        }
    }

    fn wait(&mut self, open: &mut Open, timeout: Duration) -> Next<Frame> {
        let until = Instant::now() + timeout;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            match open.wait(left) {
                // A frameset without a new colour picture: depth is quicker than colour in dim light.
                Next::Nothing if Instant::now() < until => {}
                came => return came,
            }
        }
    }

    fn patience(&self) -> Option<Duration> {
        matches!(self.settings.origin, Origin::Camera(_)).then_some(PATIENCE)
    }

    fn silent(&self, open: &Open, silence: Duration) -> Error {
        Error::Silent { serial: open.serial.clone(), seconds: silence.as_secs() }
    }

    fn now(&self) -> Duration {
        self.began.elapsed()
    }

    fn pause(&mut self, time: Duration) {
        std::thread::sleep(time);
    }
}

impl Open {
    /// The next frameset's frame; `Nothing` also when it has no new colour picture.
    fn wait(&mut self, timeout: Duration) -> Next<Frame> {
        let asked = Instant::now();
        let came = match self.fetched.pop_front() {
            Some(frameset) => Ok(frameset),
            None => self.pipeline.wait(Some(timeout)),
        };
        let arrival = Arrival::now();
        let unplugged = || Next::Lost(Error::Unplugged { serial: self.serial.clone() });
        match (came, &self.kind) {
            (Ok(_), Kind::Camera(_)) if asked.elapsed() > timeout + SLACK => unplugged(),
            (Ok(frameset), _) => self.frame(&frameset, arrival),
            (Err(FrameWaitError::DidTimeoutBeforeFrameArrival), Kind::Recording(_, playback)) => {
                if playback.has_ended() { Next::Ended } else { Next::Nothing }
            }
            (Err(FrameWaitError::DidTimeoutBeforeFrameArrival), Kind::Camera(_)) => Next::Nothing,
            (Err(_), Kind::Camera(_)) => unplugged(),
            (Err(error), Kind::Recording(..)) => Next::Lost(sdk("playing the recording", error)),
        }
    }

    fn frame(&mut self, frameset: &CompositeFrame, arrival: Arrival) -> Next<Frame> {
        let Some(colour) = frameset.frames_of_type::<ColorFrame>().pop() else { return Next::Nothing };
        let number = colour.frame_number();
        if self.last_number == Some(number) {
            return Next::Nothing;
        }
        let depth = if self.depth { frameset.frames_of_type::<DepthFrame>().pop() } else { None };
        let time = picture::sensor_time(&colour);
        let (captured_ns, source_ns) = match &mut self.kind {
            Kind::Camera(clock) => {
                let captured = clock.captured_ns(time, arrival);
                (captured, captured)
            }
            Kind::Recording(clock, _) => (arrival.monotonic_ns, clock.since_first_ns(time)),
        };
        // Numbers begin again when a camera or a recording does: that is no loss.
        let dropped = self.last_number.map_or(0, |last| number.saturating_sub(last + 1));
        self.last_number = Some(number);
        let times = picture::Times { captured_ns, source_ns };
        match Frame::new(colour, depth, &self.optics, times, u32::try_from(dropped).unwrap_or(u32::MAX)) {
            Ok(frame) => Next::Frame(frame),
            Err(why) => Next::Lost(why),
        }
    }
}

fn sdk(step: &'static str, error: impl std::fmt::Display) -> Error {
    Error::Sdk { step, detail: error.to_string() }
}
