//! Waits for the pictures of an attached camera.

use std::time::{Duration, Instant};

use realsense_rust::context::Context;
use realsense_rust::frame::{ColorFrame, CompositeFrame, DepthFrame, FrameEx};
use realsense_rust::pipeline::{ActivePipeline, FrameWaitError};

use super::picture::{Pictures, Times, sensor_time};
use crate::clock::{Arrival, CameraClock};
use crate::wait::{self, STEP};
use crate::{Error, pair};

/// What the SDK may take beyond the time of a wait. It reopens a lost camera by itself, which takes longer than this and leaves all options at their
/// defaults. So such a camera counts as unplugged and is opened again with its settings.
const SLACK: Duration = Duration::from_millis(500);

/// A camera that has been started.
#[derive(Debug)]
pub(super) struct Live {
    pipeline: ActivePipeline,
    serial: String,
    /// Pictures per second of both streams where depth is captured.
    depth_hz: Option<u32>,
    clock: CameraClock,
    // Outlives the pipeline that was made of it.
    _context: Context,
}

impl Live {
    pub(super) fn new(
        context: Context,
        pipeline: ActivePipeline,
        serial: String,
        depth_hz: Option<u32>,
    ) -> Self {
        Self { pipeline, serial, depth_hz, clock: CameraClock::default(), _context: context }
    }

    /// Waits for a colour picture other than number `last`, with its depth.
    pub(super) fn next(&mut self, last: Option<u64>) -> Result<Pictures, Error> {
        wait::for_frame(|| self.step(last))?.ok_or_else(|| Error::Silent { serial: self.serial.clone() })
    }

    /// Waits for one [`STEP`].
    fn step(&mut self, last: Option<u64>) -> Result<Option<Pictures>, Error> {
        let until = Instant::now() + STEP;
        loop {
            match self.wait(last, until.saturating_duration_since(Instant::now()))? {
                // A frameset without a new colour picture: depth is quicker than colour in dim light.
                None if Instant::now() < until => {}
                came => return Ok(came),
            }
        }
    }

    /// The next frameset's pictures; `None` also when it has no new colour picture, or not its depth.
    fn wait(&mut self, last: Option<u64>, timeout: Duration) -> Result<Option<Pictures>, Error> {
        let asked = Instant::now();
        let came = self.pipeline.wait(Some(timeout));
        let arrival = Arrival::now();
        match came {
            Ok(_) if asked.elapsed() > timeout + SLACK => Err(self.unplugged()),
            Ok(frameset) => Ok(self.pictures(&frameset, last, arrival)),
            Err(FrameWaitError::DidTimeoutBeforeFrameArrival) => Ok(None),
            Err(_) => Err(self.unplugged()),
        }
    }

    fn pictures(
        &mut self,
        frameset: &CompositeFrame,
        last: Option<u64>,
        arrival: Arrival,
    ) -> Option<Pictures> {
        let colour = frameset.frames_of_type::<ColorFrame>().pop()?;
        if last == Some(colour.frame_number()) {
            return None;
        }
        let time = sensor_time(&colour);
        let depth = match self.depth_hz {
            None => None,
            // A frameset repeats the last picture of a stream that has sent no new one.
            Some(rate_hz) => {
                let depth = frameset.frames_of_type::<DepthFrame>().pop()?;
                if !pair::is_of_one_moment(time, sensor_time(&depth), rate_hz) {
                    return None;
                }
                Some(depth)
            }
        };
        let captured_ns = self.clock.captured_ns(time, arrival);
        Some(Pictures { colour, depth, times: Times { captured_ns, source_ns: captured_ns } })
    }

    fn unplugged(&self) -> Error {
        Error::Unplugged { serial: self.serial.clone() }
    }
}
