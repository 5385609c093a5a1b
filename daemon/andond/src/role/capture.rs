//! `capture`: a source of pictures to frames, each written once, into the loaned sample.
//!
//! The sources that need OpenCV's `videoio` are in the binary `andond-video`, which runs this role.

use std::mem::discriminant;
use std::os::unix::process::CommandExt as _;
use std::process::Command;
use std::time::{Duration, Instant};

use andon_ipc::{FrameWriter, Node, Wake, monotonic_ns};
use shm_schemas::{RoleId, flag};

use super::rate::RateWatch;
use super::{Pulse, RoleError, WAIT};
use crate::config::{Config, Speed};
use crate::log::{code, log};
use crate::video::helper_path;
use crate::video::pipe::PictureFormat;
use crate::video::source::{OpenError, Source};

/// How long a camera that has gone is left alone before it is tried again: its health must be heard meanwhile.
const RETRY: Duration = WAIT;

/// Goes on as `andond-video` with the same arguments: systemd sees one process.
pub(super) fn replace_this_process() -> Result<(), RoleError> {
    let path = helper_path();
    let source = Command::new(&path).args(std::env::args_os().skip(1)).exec();
    Err(RoleError::Start { path: path.display().to_string(), source })
}

/// Runs until it is asked to stop. `open` opens the source that the configuration names.
///
/// # Errors
/// A recording that cannot be read; a camera that will never do. A camera that goes is tried again until it is back.
pub fn run(
    node: &Node,
    config: &Config,
    open: impl Fn(&Config) -> Result<Box<dyn Source>, OpenError>,
) -> Result<(), RoleError> {
    let live = config.camera.source.is_live();
    let paced = !live && config.camera.speed == Speed::Max;
    let mut role = Capture {
        node,
        frames: node.frame_writer()?,
        pulse: Pulse::new(node)?,
        live,
        paced,
        offset_ns: 0,
        rate: RateWatch::new(config.camera.rate_hz.into()),
        presence: Presence::Awaited,
    };
    if paced {
        role.frames.follow(&[RoleId::Perceive]);
    }
    loop {
        match open(config).map_err(RoleError::from).and_then(|source| role.play(source)) {
            Ok(Ended::Stopped) => return Ok(()),
            Ok(Ended::AtEnd) if config.camera.repeat => (),
            Ok(Ended::AtEnd) => return role.end_stream(),
            Err(error) if live => {
                role.missing(may_come_back(error)?);
                if node.stop().wait(RETRY) {
                    return Ok(());
                }
                role.pulse.beat()?;
            }
            Err(error) => return Err(error),
        }
    }
}

/// What may be over by itself, or when somebody has been at the camera; everything else is an error.
fn may_come_back(error: RoleError) -> Result<OpenError, RoleError> {
    match error {
        RoleError::Source(message) => Ok(OpenError::Gone(message)),
        RoleError::Open(OpenError::Refused(_) | OpenError::Unsupported(_)) => Err(error),
        RoleError::Open(error) => Ok(error),
        _ => Err(error),
    }
}

fn describe(format: PictureFormat) -> String {
    format!("{} x {} pixels, {:.2} frames a second", format.width, format.height, format.rate_hz)
}

enum Ended {
    AtEnd,
    Stopped,
}

/// What has been told of the source.
enum Presence {
    /// Nothing.
    Awaited,
    There,
    Missing(OpenError),
}

struct Capture<'a> {
    node: &'a Node,
    frames: FrameWriter,
    pulse: Pulse,
    live: bool,
    paced: bool,
    /// Source time that earlier rounds of a repeated recording have taken.
    offset_ns: u64,
    rate: RateWatch,
    presence: Presence,
}

impl Capture<'_> {
    /// The source is there: told once, and again when it had been missing.
    fn there(&mut self, format: PictureFormat) {
        match std::mem::replace(&mut self.presence, Presence::There) {
            Presence::Awaited => log!(code::CAMERA_READY, "{}", describe(format)),
            Presence::Missing(_) => log!(code::CAMERA_BACK, "{}", describe(format)),
            Presence::There => (),
        }
    }

    /// The camera is missing: told once for each kind of reason.
    fn missing(&mut self, why: OpenError) {
        self.pulse.failing();
        let known =
            matches!(&self.presence, Presence::Missing(known) if discriminant(known) == discriminant(&why));
        if !known {
            super::error::report_camera(&why);
            self.presence = Presence::Missing(why);
        }
    }

    fn play(&mut self, mut source: Box<dyn Source>) -> Result<Ended, RoleError> {
        let format = source.format();
        self.there(format);
        self.frames.warm_up(source.frame_bytes())?;
        let began_ns = monotonic_ns();
        let mut newest_ns = 0;
        loop {
            super::wait_for_room(self.node, &mut self.frames, &mut self.pulse)?;
            let began = Instant::now();
            let mut loan = self.frames.loan(source.frame_bytes())?;
            let Some(pts_ns) = source.next_picture(loan.bytes_mut()).map_err(RoleError::Source)? else {
                self.offset_ns += newest_ns + (1e9 / format.rate_hz) as u64;
                return Ok(Ended::AtEnd);
            };
            let read = began.elapsed();
            newest_ns = pts_ns;
            if self.live
                && let Some(rate_hz) = self.rate.frame(monotonic_ns())
            {
                log!(code::CAMERA_SLOW, "the camera gives {rate_hz:.1} frames a second");
            }
            let due_ns = began_ns + pts_ns;
            if !self.live && !self.paced && self.node.stop().wait(until(due_ns))
                || self.node.stop().requested()
            {
                return Ok(Ended::Stopped);
            }
            let header = loan.header_mut();
            source.describe(header);
            // A frame of a film is captured when it is due; then latencies mean what they mean for a camera.
            header.stamp.captured_ns = match source.captured_ns() {
                Some(captured_ns) => captured_ns,
                None if self.live || self.paced => monotonic_ns(),
                None => due_ns,
            };
            header.source_ns = if self.live { header.stamp.captured_ns } else { self.offset_ns + pts_ns };
            header.flags = if self.paced { flag::PACED } else { 0 };
            self.frames.send(loan)?;
            self.pulse.sent();
            self.pulse.stepped(read);
            self.pulse.beat()?;
        }
    }

    /// Says that nothing follows, and stays until everybody has heard it.
    fn end_stream(&mut self) -> Result<(), RoleError> {
        super::wait_for_room(self.node, &mut self.frames, &mut self.pulse)?;
        let mut loan = self.frames.loan(0)?;
        let header = loan.header_mut();
        header.stamp.captured_ns = monotonic_ns();
        header.source_ns = self.offset_ns;
        header.flags = flag::END_OF_STREAM | if self.paced { flag::PACED } else { 0 };
        self.frames.send(loan)?;
        log!(code::RECORDING_ENDED, "the recording is at its end");
        self.pulse.finished();
        loop {
            if self.node.wait(&mut [&mut self.frames], WAIT)? == Wake::Stop {
                return Ok(());
            }
            self.pulse.beat()?;
        }
    }
}

fn until(due_ns: u64) -> Duration {
    Duration::from_nanos(due_ns.saturating_sub(monotonic_ns()))
}
