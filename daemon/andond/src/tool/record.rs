//! `andond record`: writes what a running station sees to a track file, which replays to the verdicts of the live run.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::time::Duration;

use andon_core::input::{Frame, Side};
use andon_ipc::{Reader, Wake};
use andon_learn::recording::{Header, Landmarks, NamedObject, TrackWriter};
use shm_schemas::{Detections, flag};

use super::join::join;
use super::{Failure, load_config};
use crate::cli::Record;
use crate::config::Config;
use crate::exit::Code;
use crate::wire;

/// Nothing is due between two frames: this is only how often the wait begins anew.
const WAIT: Duration = Duration::from_secs(10);

/// Runs the command until it is interrupted, or the source is at its end.
///
/// # Errors
/// A file that cannot be written, a station that cannot be joined, and frames that were lost: without them the recording
/// would not give the same verdicts.
pub fn run(arguments: &Record) -> Result<Code, Failure> {
    let config = load_config(&arguments.config)?;
    let node = join(&config)?;
    let mut recorder = Recorder::create(&arguments.out, &config)?;
    let mut detections: Reader<Detections> = node.reader()?;
    eprintln!("recording to {}; stop with Ctrl-C", arguments.out.display());
    let mut ended = false;
    while !ended && node.wait(&mut [&mut detections], WAIT)? != Wake::Stop {
        while let Some(message) = detections.take()? {
            ended = !recorder.write(&message)?;
            if ended {
                break;
            }
        }
    }
    recorder.finish()?;
    eprintln!("{} frames", recorder.frames);
    match detections.lost() {
        0 => Ok(Code::Stopped),
        lost => Err(Failure::new(
            Code::Fault,
            format!("{lost} frames were lost: the machine is too busy, and a replay may judge otherwise"),
        )),
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
    fn create(path: &'a Path, config: &Config) -> Result<Self, Failure> {
        let failed = |error| cannot_write(path, &error);
        let file = File::create(path).map_err(failed)?;
        let tracks = TrackWriter::new(BufWriter::new(file), &header(config)).map_err(failed)?;
        let objects = config.objects.iter().map(|object| object.id).collect();
        Ok(Self { tracks, path, objects, first_ns: None, newest_ns: 0, frames: 0 })
    }

    /// Adds a frame. False where the recording is complete: at the end of the source, or where it begins anew.
    fn write(&mut self, message: &Detections) -> Result<bool, Failure> {
        if message.flags & flag::END_OF_STREAM != 0 {
            return Ok(false);
        }
        let mut frame = wire::detections::frame(message);
        let first_ns = *self.first_ns.get_or_insert(frame.captured_ns);
        let again = self.frames > 0 && frame.captured_ns <= self.newest_ns;
        if again {
            return Ok(false);
        }
        self.newest_ns = frame.captured_ns;
        frame.captured_ns -= first_ns;
        self.keep_known(&mut frame);
        self.tracks.frame(&frame).map_err(|error| cannot_write(self.path, &error))?;
        self.frames += 1;
        Ok(true)
    }

    /// A track file names its objects in its first line; the encoder has no use for others either.
    fn keep_known(&self, frame: &mut Frame) {
        frame.objects.retain(|object| self.objects.contains(&object.id));
    }

    fn finish(&mut self) -> Result<(), Failure> {
        self.tracks.flush().map_err(|error| cannot_write(self.path, &error))
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

fn cannot_write(path: &Path, error: &std::io::Error) -> Failure {
    Failure::new(Code::Usage, format!("{}: {error}", path.display()))
}
