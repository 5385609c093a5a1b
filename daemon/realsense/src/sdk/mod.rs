//! The SDK's side: the only code that calls librealsense.
//!
//! [`library`] loads it; [`camera`] opens an attached camera and [`recording`] a file; the [`picture`]s of both take the same path.

mod camera;
mod library;
mod picture;
mod recording;

use std::time::{Duration, Instant};

use realsense_rust::context::Context;
use realsense_rust::frame::{ColorFrame, CompositeFrame, DepthFrame, FrameEx};
use realsense_rust::pipeline::{ActivePipeline, FrameWaitError};

use crate::Error;
use crate::clock::{Arrival, CameraClock, RecordingClock};
use crate::settings::{Origin, Settings};
use crate::wait::{self, STEP, Wait};

pub use picture::Frame;

/// What the SDK may take beyond the time of a wait. It reopens a lost camera by itself, which takes longer than this and leaves all
/// options at their defaults, so such a camera counts as unplugged and is opened again with its settings.
const SLACK: Duration = Duration::from_millis(500);

/// A camera or a recording that frames come from.
///
/// A frame lies in one of the sensor's own buffers, of which there are few: write it out and drop it before the next wait.
#[derive(Debug)]
pub struct Source {
    pipeline: ActivePipeline,
    depth: bool,
    optics: picture::Optics,
    kind: Kind,
    /// The frameset that was fetched while opening.
    fetched: Option<CompositeFrame>,
    last_number: Option<u64>,
    // Outlives the pipeline that was made of it.
    _context: Context,
}

/// What differs between the two.
#[derive(Debug)]
enum Kind {
    Camera { serial: String, clock: CameraClock },
    Recording { playback: recording::Playback, clock: RecordingClock },
}

impl Source {
    /// Loads librealsense and opens what the settings name.
    ///
    /// # Errors
    /// Every [`Error`] says what to do about it.
    pub fn open(settings: &Settings) -> Result<Self, Error> {
        let api = library::load(&settings.library)?;
        let context = Context::new().map_err(|error| sdk("setting up", error))?;
        match &settings.origin {
            Origin::Camera(wanted) => camera::open(context, wanted, settings.depth),
            Origin::Recording(file) => recording::open(api, context, file, settings.depth),
        }
    }

    /// Waits for the next frame; `None` at the end of a recording.
    ///
    /// # Errors
    /// [`Error::Silent`] after 2 s without a frame of a camera, [`Error::Unplugged`] when it is gone, and what the SDK refuses. A camera
    /// that has failed must be opened again.
    pub fn next_frame(&mut self) -> Result<Option<Frame>, Error> {
        loop {
            match (wait::for_frame(|| self.step())?, &self.kind) {
                (Wait::Frame(frame), _) => return Ok(Some(frame)),
                (Wait::Ended, _) => return Ok(None),
                (Wait::Nothing, Kind::Camera { serial, .. }) => {
                    return Err(Error::Silent { serial: serial.clone() });
                }
                // A slow disk or a busy machine is no fault of the recording.
                (Wait::Nothing, Kind::Recording { .. }) => {}
            }
        }
    }

    /// Waits for one [`STEP`].
    fn step(&mut self) -> Result<Wait<Frame>, Error> {
        let until = Instant::now() + STEP;
        loop {
            match self.wait(until.saturating_duration_since(Instant::now()))? {
                // A frameset without a new colour picture: depth is quicker than colour in dim light.
                Wait::Nothing if Instant::now() < until => {}
                came => return Ok(came),
            }
        }
    }

    /// The next frameset's frame; `Nothing` also when it has no new colour picture.
    fn wait(&mut self, timeout: Duration) -> Result<Wait<Frame>, Error> {
        let asked = Instant::now();
        let came = match self.fetched.take() {
            Some(frameset) => Ok(frameset),
            None => self.pipeline.wait(Some(timeout)),
        };
        let arrival = Arrival::now();
        let unplugged = |serial: &String| Err(Error::Unplugged { serial: serial.clone() });
        match (came, &self.kind) {
            (Ok(_), Kind::Camera { serial, .. }) if asked.elapsed() > timeout + SLACK => unplugged(serial),
            (Ok(frameset), _) => self.frame(&frameset, arrival),
            (Err(FrameWaitError::DidTimeoutBeforeFrameArrival), Kind::Recording { playback, .. }) => {
                Ok(if playback.has_ended() { Wait::Ended } else { Wait::Nothing })
            }
            (Err(FrameWaitError::DidTimeoutBeforeFrameArrival), Kind::Camera { .. }) => Ok(Wait::Nothing),
            (Err(_), Kind::Camera { serial, .. }) => unplugged(serial),
            (Err(error), Kind::Recording { .. }) => Err(sdk("playing the recording", error)),
        }
    }

    fn frame(&mut self, frameset: &CompositeFrame, arrival: Arrival) -> Result<Wait<Frame>, Error> {
        let Some(colour) = frameset.frames_of_type::<ColorFrame>().pop() else { return Ok(Wait::Nothing) };
        let number = colour.frame_number();
        if self.last_number == Some(number) {
            return Ok(Wait::Nothing);
        }
        let depth = if self.depth { frameset.frames_of_type::<DepthFrame>().pop() } else { None };
        let time = picture::sensor_time(&colour);
        let (captured_ns, source_ns) = match &mut self.kind {
            Kind::Camera { clock, .. } => {
                let captured = clock.captured_ns(time, arrival);
                (captured, captured)
            }
            Kind::Recording { clock, .. } => (arrival.monotonic_ns, clock.since_first_ns(time)),
        };
        // A camera that has restarted counts from the start again: that is no loss.
        let dropped = self.last_number.map_or(0, |last| number.saturating_sub(last + 1));
        self.last_number = Some(number);
        let times = picture::Times { captured_ns, source_ns };
        let dropped = u32::try_from(dropped).unwrap_or(u32::MAX);
        Frame::new(colour, depth, &self.optics, times, dropped).map(Wait::Frame)
    }
}

fn sdk(step: &'static str, error: impl std::fmt::Display) -> Error {
    Error::Sdk { step, detail: error.to_string() }
}
