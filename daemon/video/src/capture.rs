//! `capture`: turns the pictures of a source into frames. Each is written once, straight into the loaned sample.

use std::mem::discriminant;
use std::time::Duration;

use andon_host::config::Config;
use andon_host::log::{code, log};
use andon_host::role::{Cycle, Output, Played, Player, Recording, Role, Turn, WAIT};
use andon_host::video::pipe::PictureFormat;
use andon_ipc::{FrameLoan, FrameWriter, MonotonicTime, Node, Port, SourceTime};
use shm_schemas::{RoleId, Stamp};

use crate::rate::RateWatch;
use crate::source::Source;
use crate::{CaptureError, OpenError};

/// How long a lost camera is left alone before it is opened again: the role must send its health in the meantime.
const RETRY: Duration = WAIT;

/// Runs until it is asked to stop. `open` opens the source that the configuration names. A lost camera is opened again and again until it
/// is back.
///
/// # Errors
/// A recording that cannot be read, and a camera that can never work as it is configured.
pub fn run(
    node: &Node,
    config: &Config,
    open: impl Fn(&Config) -> Result<Box<dyn Source>, OpenError>,
) -> Result<(), CaptureError> {
    let frames = Output::new(node.frame_writer()?, &[RoleId::Perceive]);
    let mut cycle = Cycle::new(node)?;
    if config.camera.source.is_live() {
        cycle.run(&mut Camera {
            frames,
            open: || open(config),
            source: None,
            presence: Presence::Unknown,
            rate: RateWatch::new(config.camera.rate_hz.into()),
        })
    } else {
        let mut is_first_round = true;
        let open = |frames: &mut FrameWriter| {
            let film = Film(open(config)?);
            frames.warm_up(film.0.frame_bytes())?;
            if std::mem::take(&mut is_first_round) {
                log!(code::CAMERA_READY, "{}", describe(film.0.format()));
            }
            Ok(film)
        };
        cycle.run(&mut Player::new(frames, &config.camera, open))
    }
}

fn describe(format: PictureFormat) -> String {
    format!("{} x {} pixels, {:.2} frames per second", format.width, format.height, format.rate_hz)
}

/// A recording that has pictures.
struct Film(Box<dyn Source>);

impl Recording<FrameLoan> for Film {
    type Error = CaptureError;

    fn message_bytes(&self) -> usize {
        self.0.frame_bytes()
    }

    fn interval(&self) -> Duration {
        Duration::from_secs_f64(1.0 / self.0.format().rate_hz)
    }

    fn next(&mut self, frame: &mut FrameLoan) -> Result<Option<Duration>, CaptureError> {
        let time_ns = self.0.next_picture(frame.bytes_mut()).map_err(CaptureError::Source)?;
        self.0.describe(frame.header_mut());
        Ok(time_ns.map(Duration::from_nanos))
    }
}

/// What has been logged about the camera.
enum Presence {
    /// Nothing so far.
    Unknown,
    Present,
    Missing(OpenError),
}

/// A device, which sets its own pace, and may go and come back.
struct Camera<O> {
    frames: Output<FrameWriter>,
    open: O,
    source: Option<Box<dyn Source>>,
    presence: Presence,
    rate: RateWatch,
}

impl<O: Fn() -> Result<Box<dyn Source>, OpenError>> Role for Camera<O> {
    type Error = CaptureError;
    const INPUT_IS_STEADY: bool = false;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        vec![self.frames.port()]
    }

    /// A source that is open blocks by itself until the next picture has come.
    fn patience(&self) -> Duration {
        if let Presence::Missing(_) = self.presence { RETRY } else { Duration::ZERO }
    }

    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, CaptureError> {
        let turn = match self.source.take() {
            Some(source) => self.capture(source, cycle),
            None => self.open(),
        };
        turn.or_else(|error| {
            self.report_missing(as_recoverable(error)?, cycle);
            Ok(Turn::Idle)
        })
    }
}

impl<O: Fn() -> Result<Box<dyn Source>, OpenError>> Camera<O> {
    fn open(&mut self) -> Result<Turn, CaptureError> {
        let source = (self.open)()?;
        let format = source.format();
        self.frames.writer().warm_up(source.frame_bytes())?;
        self.source = Some(source);
        match std::mem::replace(&mut self.presence, Presence::Present) {
            Presence::Unknown => log!(code::CAMERA_READY, "{}", describe(format)),
            Presence::Missing(_) => log!(code::CAMERA_BACK, "{}", describe(format)),
            Presence::Present => (),
        }
        Ok(Turn::Idle)
    }

    /// Sends the next picture. A source that gives none is dropped, and opened again later.
    fn capture(&mut self, mut source: Box<dyn Source>, cycle: &mut Cycle<'_>) -> Result<Turn, CaptureError> {
        self.frames.wait_for_room(cycle)?;
        let mut frame = self.frames.loan(source.frame_bytes())?;
        if source.next_picture(frame.bytes_mut()).map_err(CaptureError::Source)?.is_none() {
            return Err(CaptureError::Source("the camera sends no more pictures".into()));
        }
        if let Some(rate_hz) = self.rate.frame(MonotonicTime::now()) {
            log!(code::CAMERA_SLOW, "the camera sends {rate_hz:.1} frames per second");
        }
        let captured_ns = source.captured_ns().unwrap_or_else(|| MonotonicTime::now().nanoseconds());
        source.describe(frame.header_mut());
        // A camera has no time of its own: its pictures are as old as the machine says.
        let time = SourceTime::from_nanoseconds(captured_ns);
        frame.put(&Stamp { captured_ns, ..Stamp::default() }, time, 0);
        self.frames.send_loan(cycle, frame)?;
        self.source = Some(source);
        Ok(Turn::Stepped)
    }

    /// Reports a missing camera: in its health always, in the log once for each kind of reason.
    fn report_missing(&mut self, reason: OpenError, cycle: &mut Cycle<'_>) {
        cycle.liveness().failing();
        let is_logged = matches!(&self.presence, Presence::Missing(logged) if discriminant(logged) == discriminant(&reason));
        if !is_logged {
            reason.report();
            self.presence = Presence::Missing(reason);
        }
    }
}

/// Passes on what may pass by itself or be mended at the camera. Everything else stays an error.
fn as_recoverable(error: CaptureError) -> Result<OpenError, CaptureError> {
    match error {
        CaptureError::Source(message) => Ok(OpenError::Gone(message)),
        CaptureError::Open(OpenError::Refused(_) | OpenError::Unsupported(_)) => Err(error),
        CaptureError::Open(error) => Ok(error),
        _ => Err(error),
    }
}
