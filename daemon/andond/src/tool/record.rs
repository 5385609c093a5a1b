//! `andond record`: writes what a running station sees, or a film shows, to a track file, whose replay gives the same verdicts.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::time::Duration;

use andon_core::input::{Frame, Side};
use andon_ipc::{Reader, Wake};
use andon_learn::recording::{Header, Landmarks, NamedObject, TrackWriter};
use shm_schemas::{Detections, flag};

use super::join::join;
use super::{ToolError, cannot_write, check_writable, each_frame, load_config};
use crate::cli::Record;
use crate::config::Config;
use crate::exit::Code;
use crate::recording::Recording;
use crate::wire;

/// Nothing is due between two frames: this is only how often the wait is repeated.
const WAIT: Duration = Duration::from_secs(10);

/// Runs the command until it is interrupted, or the source is at its end.
///
/// # Errors
/// A file that cannot be written, a station that cannot be joined, or frames that were lost, without which the recording
/// would not give the same verdicts.
pub fn run(arguments: &Record) -> Result<Code, ToolError> {
    let config = load_config(&arguments.config)?;
    match &arguments.recording {
        Some(film) => record_film(film, &arguments.out, &config),
        None => record_station(&arguments.out, &config),
    }
}

fn record_film(film: &Path, out: &Path, config: &Config) -> Result<Code, ToolError> {
    check_writable(out)?;
    let mut recording = Recording::open(film, config)?;
    let mut recorder =
        Recorder::create(out, Header { landmarks: Landmarks::Five, ..recording.header().clone() })?;
    each_frame(&mut recording, film, |frame| recorder.write(frame).map(drop))?;
    recorder.finish()?;
    Ok(Code::Stopped)
}

fn record_station(out: &Path, config: &Config) -> Result<Code, ToolError> {
    let node = join(config)?;
    let mut recorder = Recorder::create(out, header(config))?;
    let mut detections: Reader<Detections> = node.reader()?;
    eprintln!("recording to {}; stop with Ctrl-C", out.display());
    let mut ended = false;
    while !ended && node.wait(&mut [&mut detections], WAIT)? != Wake::Stop {
        while let Some(message) = detections.take()? {
            ended = message.flags & flag::END_OF_STREAM != 0
                || !recorder.write(wire::detections::to_core(&message))?;
            if ended {
                break;
            }
        }
    }
    recorder.finish()?;
    eprintln!("{} frames", recorder.frames);
    match detections.lost() {
        0 => Ok(Code::Stopped),
        lost => Err(ToolError::Lost(lost)),
    }
}

struct Recorder<'a> {
    tracks: TrackWriter<BufWriter<File>>,
    path: &'a Path,
    objects: Vec<u16>,
    /// Source time of the first frame: a track file begins at zero.
    first_ns: Option<u64>,
    newest_ns: u64,
    frames: u64,
}

impl<'a> Recorder<'a> {
    fn create(path: &'a Path, header: Header) -> Result<Self, ToolError> {
        let file = File::create(path).map_err(cannot_write(path))?;
        let tracks = TrackWriter::new(BufWriter::new(file), &header).map_err(cannot_write(path))?;
        let objects = header.objects.iter().map(|object| object.shape.id).collect();
        Ok(Self { tracks, path, objects, first_ns: None, newest_ns: 0, frames: 0 })
    }

    /// Adds a frame. False where the recording is complete, because it starts again.
    fn write(&mut self, mut frame: Frame) -> Result<bool, ToolError> {
        let first_ns = *self.first_ns.get_or_insert(frame.captured_ns);
        let is_repeated = self.frames > 0 && frame.captured_ns <= self.newest_ns;
        if is_repeated {
            return Ok(false);
        }
        self.newest_ns = frame.captured_ns;
        frame.captured_ns -= first_ns;
        self.keep_known(&mut frame);
        self.tracks.frame(&frame).map_err(cannot_write(self.path))?;
        self.frames += 1;
        Ok(true)
    }

    /// Removes objects that the first line of the track file does not name; the encoder ignores them as well.
    fn keep_known(&self, frame: &mut Frame) {
        frame.objects.retain(|object| self.objects.contains(&object.id));
    }

    fn finish(&mut self) -> Result<(), ToolError> {
        self.tracks.flush().map_err(cannot_write(self.path))
    }
}

fn header(config: &Config) -> Header {
    let objects = config.objects.iter().zip(config.shapes());
    Header {
        rate_hz: config.method.rate_hz,
        space: config.method.space,
        hands: vec![Side::Right, Side::Left],
        landmarks: Landmarks::Five,
        objects: objects.map(|(object, shape)| NamedObject { name: object.name.clone(), shape }).collect(),
    }
}
