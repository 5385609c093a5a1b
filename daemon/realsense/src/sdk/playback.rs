//! Plays a recording: every picture once, in order, whatever else the machine does.
//!
//! The SDK's pipeline is not used. It starts in real time, in which it drops what is not fetched in time. It begins with the first picture of the
//! stream that was opened last. Its framesets repeat the last picture of a stream that has sent no new one.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::thread::{self, JoinHandle};

use realsense_rust::frame::{ColorFrame, DepthFrame, FrameEx as _};
use realsense_rust::kind::Rs2StreamKind;

use super::picture::{Pictures, Times, sensor_time};
use super::player::{Player, RawFrame, Sensor, Status};
use crate::Error;
use crate::clock::{Arrival, RecordingClock};
use crate::pair::Pairing;
use crate::wait::STEP;

/// Frames that the SDK reads ahead.
const MAX_AHEAD: usize = 2;

/// A recording that is being played.
#[derive(Debug)]
pub(super) struct Playback {
    // Dropped first: a sensor that waits to send is then free to be stopped.
    frames: Receiver<RawFrame>,
    /// `None` where depth is off.
    pairing: Option<Pairing<ColorFrame, DepthFrame>>,
    running: Running,
    clock: RecordingClock,
    file: PathBuf,
    is_at_end: bool,
    has_given: bool,
}

impl Playback {
    /// Starts the opened sensors. `depth_hz` is the rate of the colour pictures where each needs its depth.
    pub(super) fn start(
        player: Player,
        sensors: Vec<Sensor>,
        depth_hz: Option<u32>,
        file: &Path,
    ) -> Result<Self, String> {
        let (channel, frames) = mpsc::sync_channel(MAX_AHEAD);
        let running = Running::start(player, sensors, channel)?;
        Ok(Self {
            frames,
            pairing: depth_hz.map(Pairing::new),
            running,
            clock: RecordingClock::default(),
            file: file.into(),
            is_at_end: false,
            has_given: false,
        })
    }

    /// The next pictures; `None` at the end.
    pub(super) fn next(&mut self) -> Result<Option<Pictures>, Error> {
        loop {
            let pair = self.pairing.as_mut().and_then(|pairing| pairing.next(self.is_at_end));
            if let Some((colour, depth)) = pair {
                return Ok(Some(self.give(colour, Some(depth))));
            }
            if self.is_at_end {
                let is_mismatched = self.pairing.is_some() && !self.has_given;
                let problem = "no colour picture has a depth picture of the same moment";
                return if is_mismatched { Err(self.bad(problem.into())) } else { Ok(None) };
            }
            if let Some(frame) = self.fetch().map_err(|detail| self.bad(detail))?
                && let Some(colour) = self.take(frame).map_err(|detail| self.bad(detail))?
            {
                return Ok(Some(self.give(colour, None)));
            }
        }
    }

    /// Waits for one [`STEP`]. A slow disk or a busy machine is not a fault of the recording: the wait can be repeated.
    fn fetch(&mut self) -> Result<Option<RawFrame>, String> {
        if let Ok(frame) = self.frames.recv_timeout(STEP) {
            return Ok(Some(frame));
        }
        match self.running.status()? {
            // The last frame may have come in between.
            Status::Stopped => {
                let last = self.frames.try_recv().ok();
                self.is_at_end = last.is_none();
                Ok(last)
            }
            Status::Playing | Status::Paused => Ok(None),
        }
    }

    /// Keeps a frame for its pair. A colour picture that needs no depth is returned.
    fn take(&mut self, frame: RawFrame) -> Result<Option<ColorFrame>, String> {
        let colour: ColorFrame = frame.into_image()?;
        let time = sensor_time(&colour);
        let Some(pairing) = &mut self.pairing else { return Ok(Some(colour)) };
        if colour.stream_profile().kind() == Rs2StreamKind::Color {
            pairing.push_colour(time, colour);
        } else {
            pairing.push_depth(time, RawFrame::of(colour).into_image()?);
        }
        Ok(None)
    }

    fn give(&mut self, colour: ColorFrame, depth: Option<DepthFrame>) -> Pictures {
        self.has_given = true;
        let source_ns = self.clock.since_first_ns(sensor_time(&colour));
        Pictures { colour, depth, times: Times { captured_ns: Arrival::now().monotonic_ns, source_ns } }
    }

    fn bad(&self, detail: String) -> Error {
        Error::recording(&self.file, self.pairing.is_some(), detail)
    }
}

/// The player and its sensors at work.
#[derive(Debug)]
struct Running {
    player: Arc<Player>,
    sensors: Vec<Sensor>,
    resuming: Option<JoinHandle<Result<(), String>>>,
    /// Where the sensors send to; in a place of its own, because they have its address.
    channel: Box<SyncSender<RawFrame>>,
}

impl Running {
    fn start(player: Player, sensors: Vec<Sensor>, channel: SyncSender<RawFrame>) -> Result<Self, String> {
        let mut running =
            Self { player: Arc::new(player), sensors, resuming: None, channel: Box::new(channel) };
        // The player begins with its first sensor and would drop what the others recorded until they have started as well.
        running.player.pause()?;
        for sensor in &running.sensors {
            // SAFETY: `drop` stops every sensor before the channel is gone.
            unsafe { sensor.start(&running.channel)? };
        }
        // Until they have started, the player counts as stopped.
        running.player.pause()?;
        let player = running.player.clone();
        // In a thread of its own, because it can wait for frames to be received.
        running.resuming = Some(thread::spawn(move || player.resume()));
        Ok(running)
    }

    /// What the player is doing; an error where it could not begin.
    fn status(&mut self) -> Result<Status, String> {
        if let Some(done) = self.resuming.take_if(|resuming| resuming.is_finished()) {
            done.join().map_err(|_| "its player has failed")??;
        }
        let status = self.player.status()?;
        if self.resuming.is_none() && status == Status::Paused {
            return Err("it cannot be read from its beginning".into());
        }
        Ok(status)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // Nobody receives any more, so neither waits for room in the channel.
        if let Some(resuming) = self.resuming.take() {
            drop(resuming.join());
        }
        for sensor in &self.sensors {
            sensor.stop();
        }
    }
}
