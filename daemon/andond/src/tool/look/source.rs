//! Where the pictures come from: a recording, a running station, or the camera of one that does not run.

use std::path::Path;
use std::time::{Duration, Instant};

use andon_host::config::Config;
use andon_host::video::frame::view;
use andon_host::video::pipe::PictureFormat;
use andon_ipc::{FrameReader, Node, Reader, Wake};
use shm_schemas::Detections;

use super::file_name;
use crate::recording::{Recording, RecordingError};
use crate::tool::ToolError;
use crate::tool::join::join;
use crate::video::Film;

/// A station that runs and sends no frame for so long has no camera.
const PATIENCE: Duration = Duration::from_secs(5);

/// A picture, and what the running line has seen in it.
pub(super) struct View<'a> {
    /// Nanoseconds since the first.
    pub(super) at_ns: u64,
    /// Blue, green, red, without padding.
    pub(super) picture: &'a [u8],
    pub(super) format: PictureFormat,
    pub(super) seen: Option<&'a Detections>,
}

/// Where the pictures come from.
pub(super) enum Source {
    Film { film: Film, name: String, is_live: bool, began: Instant },
    Station(Box<Running>),
}

/// A running station.
pub(super) struct Running {
    node: Node,
    frames: FrameReader,
    detections: Reader<Detections>,
    name: String,
    format: PictureFormat,
    picture: Vec<u8>,
    seen: Detections,
    first_ns: Option<u64>,
}

impl Source {
    /// Opens the recording, or else the running station, or else its camera.
    pub(super) fn open(path: Option<&Path>, config: &Config) -> Result<Self, ToolError> {
        let film = |film, name, is_live| Self::Film { film, name, is_live, began: Instant::now() };
        if let Some(path) = path {
            if Recording::is_tracks(path) {
                return Err(ToolError::NothingToShow(path.into()));
            }
            if let Err(source) = path.metadata() {
                return Err(RecordingError::Open { path: path.into(), source }.into());
            }
            return Ok(film(Film::open(path, config.camera.rate_hz)?, file_name(path), false));
        }
        if config.ipc_station().is_ok_and(|station| station.is_in_use()) {
            return Ok(Self::Station(Box::new(Running::join(config)?)));
        }
        let name = format!("the camera of {}", config.station.name);
        Ok(film(Film::watch(config)?, name, config.camera.source.is_live()))
    }

    pub(super) fn name(&self) -> String {
        match self {
            Self::Film { name, .. } => name.clone(),
            Self::Station(running) => running.name.clone(),
        }
    }

    /// Whether it has no end.
    pub(super) fn is_live(&self) -> bool {
        match self {
            Self::Film { is_live, .. } => *is_live,
            Self::Station(_) => true,
        }
    }

    /// Whether the hands come with the pictures: the running line has looked for them already.
    pub(super) fn sees_hands(&self) -> bool {
        matches!(self, Self::Station(_))
    }

    pub(super) fn format(&self) -> PictureFormat {
        match self {
            Self::Film { film, .. } => film.format(),
            Self::Station(running) => running.format,
        }
    }

    /// The next picture; `None` at the end.
    pub(super) fn next(&mut self) -> Result<Option<View<'_>>, ToolError> {
        match self {
            Self::Film { film, .. } => {
                let Some(at_ns) = film.advance()? else { return Ok(None) };
                Ok(Some(View { at_ns, picture: film.picture(), format: film.format(), seen: None }))
            }
            Self::Station(running) => running.next(),
        }
    }

    /// As [`Source::next`]; a recording keeps to its own pace.
    pub(super) fn next_at_its_time(&mut self) -> Result<Option<View<'_>>, ToolError> {
        let pace = match self {
            Self::Film { is_live: false, began, .. } => Some(*began),
            _ => None,
        };
        let view = self.next()?;
        if let (Some(began), Some(view)) = (pace, &view) {
            std::thread::sleep(Duration::from_nanos(view.at_ns).saturating_sub(began.elapsed()));
        }
        Ok(view)
    }
}

impl Running {
    fn join(config: &Config) -> Result<Self, ToolError> {
        let node = join(config)?;
        let (frames, detections) = (node.frame_reader()?, node.reader()?);
        let name = format!("the running station {}", config.station.name);
        let format =
            PictureFormat { width: 0, height: 0, rate_hz: f64::from(config.camera.rate_hz), count: 0 };
        let (picture, seen, first_ns) = (Vec::new(), Detections::default(), None);
        let mut running = Self { node, frames, detections, name, format, picture, seen, first_ns };
        // The first one says how large pictures are.
        running.take()?;
        Ok(running)
    }

    fn next(&mut self) -> Result<Option<View<'_>>, ToolError> {
        let Some(captured_ns) = self.take()? else { return Ok(None) };
        let at_ns = captured_ns.saturating_sub(*self.first_ns.get_or_insert(captured_ns));
        Ok(Some(View { at_ns, picture: &self.picture, format: self.format, seen: Some(&self.seen) }))
    }

    /// Takes the newest frame with what the line has seen in it, and returns when it was captured. `None` when it is asked to stop.
    fn take(&mut self) -> Result<Option<u64>, ToolError> {
        let until = Instant::now() + PATIENCE;
        let mut wanted: Option<(u64, u64)> = None;
        loop {
            if wanted.is_none()
                && let Some(frame) = self.frames.take_newest()?
            {
                let header = frame.header();
                let image = view(header, frame.colour()?);
                self.picture = image.and_then(|image| image.bgr()).map_err(RecordingError::from)?;
                (self.format.width, self.format.height) = (header.width, header.height);
                wanted = Some((header.stamp.seq, header.stamp.captured_ns));
            }
            while let Some(message) = self.detections.take()? {
                self.seen = *message;
            }
            if let Some((seq, captured_ns)) = wanted
                && self.seen.stamp.frame_seq >= seq
            {
                return Ok(Some(captured_ns));
            }
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(ToolError::NothingSeen(self.name.clone()));
            }
            if self.node.wait(&mut [&mut self.frames, &mut self.detections], left)? == Wake::Stop {
                return Ok(None);
            }
        }
    }
}
