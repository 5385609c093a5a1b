//! Track files as they are written, frame by frame.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use andon_core::input::{Frame, Side};
use andon_host::config::Config;
use andon_learn::recording::{Header, Landmarks, NamedObject, TrackWriter};

use super::{ToolError, cannot_write};

/// A track file that grows.
pub(super) struct Recorder<'a> {
    tracks: TrackWriter<BufWriter<File>>,
    /// The same file, to bring it to the disk.
    file: File,
    path: &'a Path,
    objects: Vec<u16>,
    /// Source time of the first frame: a track file begins at zero.
    first_ns: Option<u64>,
    newest_ns: u64,
    pub(super) frames: u64,
}

impl<'a> Recorder<'a> {
    /// Begins a track file in `file`; `path` is what messages call it.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn new(file: File, path: &'a Path, header: Header) -> Result<Self, ToolError> {
        let header = Header { landmarks: Landmarks::Five, ..header };
        let again = file.try_clone().map_err(cannot_write(path))?;
        let tracks = TrackWriter::new(BufWriter::new(again), &header).map_err(cannot_write(path))?;
        let objects = header.objects.iter().map(|object| object.shape.id).collect();
        Ok(Self { tracks, file, path, objects, first_ns: None, newest_ns: 0, frames: 0 })
    }

    /// Adds a frame. False where the recording is complete, because it starts again.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn write(&mut self, mut frame: Frame) -> Result<bool, ToolError> {
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

    /// Writes what is still in memory, and waits until all of it is on the disk.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn finish(&mut self) -> Result<(), ToolError> {
        self.tracks.flush().and_then(|()| self.file.sync_all()).map_err(cannot_write(self.path))
    }
}

/// What a running station can see.
pub(super) fn header(config: &Config) -> Header {
    let objects = config.objects.iter().zip(config.shapes());
    Header {
        rate_hz: config.method.rate_hz,
        space: config.method.space,
        hands: vec![Side::Right, Side::Left],
        landmarks: Landmarks::Five,
        objects: objects.map(|(object, shape)| NamedObject { name: object.name.clone(), shape }).collect(),
    }
}
