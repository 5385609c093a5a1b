//! What writes down what a line has seen, below roles and tools, so that both can use it: track files, frame by frame.
//!
//! A recorder takes what comes from a channel and knows neither the channel nor the clock. A role gives it each message in its turn, a tool in its
//! loop, and both finish it. A writer of another kind, as one that keeps pictures, is a module beside this one.
//! It has the same three steps: begin in an open file, write, finish.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use andon_core::input::{Frame, Side};
use andon_host::config::Config;
use andon_host::unwritten::remedy;
use andon_learn::recording::{Header, Landmarks, NamedObject, TrackWriter};

/// A track file that grows.
pub struct Recorder {
    tracks: TrackWriter<BufWriter<File>>,
    /// The same file, to bring it to the disk.
    file: File,
    path: PathBuf,
    objects: Vec<u16>,
    /// Source time of the first frame: a track file begins at zero.
    first_ns: Option<u64>,
    newest_ns: u64,
    frames: u64,
}

/// A track file that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: it cannot be written: {source}; {}", path.display(), remedy(source))]
pub struct Unwritten {
    /// The file.
    pub path: PathBuf,
    /// What the system said.
    pub source: io::Error,
}

impl Recorder {
    /// Begins a track file in `file`; `path` is what messages call it.
    ///
    /// # Errors
    /// What the system says.
    pub fn new(file: File, path: &Path, header: Header) -> Result<Self, Unwritten> {
        let header = Header { landmarks: Landmarks::Five, ..header };
        let unwritten = |source| Unwritten { path: path.into(), source };
        let again = file.try_clone().map_err(unwritten)?;
        let tracks = TrackWriter::new(BufWriter::new(again), &header).map_err(unwritten)?;
        let objects = header.objects.iter().map(|object| object.shape.id).collect();
        Ok(Self { tracks, file, path: path.into(), objects, first_ns: None, newest_ns: 0, frames: 0 })
    }

    /// Adds a frame. False where the recording is complete, because it starts again.
    ///
    /// # Errors
    /// What the system says.
    pub fn write(&mut self, mut frame: Frame) -> Result<bool, Unwritten> {
        let first_ns = *self.first_ns.get_or_insert(frame.captured_ns);
        let is_repeated = self.frames > 0 && frame.captured_ns <= self.newest_ns;
        if is_repeated {
            return Ok(false);
        }
        self.newest_ns = frame.captured_ns;
        frame.captured_ns -= first_ns;
        self.keep_known(&mut frame);
        self.tracks.frame(&frame).map_err(|source| self.unwritten(source))?;
        self.frames += 1;
        Ok(true)
    }

    /// Removes objects that the first line of the track file does not name; the encoder ignores them as well.
    fn keep_known(&self, frame: &mut Frame) {
        frame.objects.retain(|object| self.objects.contains(&object.id));
    }

    /// Writes what is still in memory, and waits until all of it is on the disk.
    ///
    /// # Errors
    /// What the system says.
    pub fn finish(&mut self) -> Result<(), Unwritten> {
        self.tracks.flush().and_then(|()| self.file.sync_all()).map_err(|source| self.unwritten(source))
    }

    /// Frames that were written so far.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    fn unwritten(&self, source: io::Error) -> Unwritten {
        Unwritten { path: self.path.clone(), source }
    }
}

/// What a running station can see.
pub fn header(config: &Config) -> Header {
    let objects = config.objects.iter().zip(config.shapes());
    Header {
        rate_hz: config.method.rate_hz,
        space: config.method.space,
        hands: vec![Side::Right, Side::Left],
        landmarks: Landmarks::Five,
        objects: objects.map(|(object, shape)| NamedObject { name: object.name.clone(), shape }).collect(),
    }
}
