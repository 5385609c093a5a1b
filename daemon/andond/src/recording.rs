//! Recordings for the tools: a film, a folder of pictures or a track file, as frames for the method.
//!
//! The perception that runs live looks at a film in this process.

use std::fmt;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use andon_core::input::{Frame, Space};
use andon_host::config::Config;
use andon_host::video::pipe::PictureFormat;
use andon_learn::file;
use andon_learn::recording::{
    Header, Landmarks, NamedObject, SeenTracks, TrackError, Truncation, object_name,
};
use andon_perception::sight::{Observation, SightMonitor};
use andon_perception::{ImageView, Perceiver, PerceptionError, PixelFormat};
use shm_schemas::{Detections, flag};

use crate::blackbox::{self, BlackboxError};
use crate::perception;
use crate::video::{Film, VideoError};
use crate::wire;

/// Why a recording cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// It is not there.
    #[error(
        "{path}: {source}; give a film, a folder of pictures, a track file (.tracks.jsonl) or a recording (.mcap)"
    )]
    Open {
        /// The recording.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A track file with a fault.
    #[error(transparent)]
    Track(#[from] TrackError),
    /// A track file that was not written to its end.
    #[error("{0}")]
    CutShort(Truncation),
    /// A recording of the role `record` that cannot be used.
    #[error(transparent)]
    Blackbox(#[from] BlackboxError),
    /// A film that cannot be read.
    #[error(transparent)]
    Video(#[from] VideoError),
    /// Perception cannot work.
    #[error(transparent)]
    Perception(#[from] PerceptionError),
    /// Perception cannot begin.
    #[error(transparent)]
    Setup(#[from] perception::SetupError),
    /// The configuration names no object whose marker a film could show.
    #[error(
        "{path}: a film needs the objects that it shows, and the configuration has none: name a station with --config FILE"
    )]
    NoObjects {
        /// The film.
        path: PathBuf,
    },
}

/// A recording that is being read.
pub struct Recording {
    header: Header,
    source: Source,
    frames: u64,
    duplicates: Vec<DuplicateMarker>,
}

/// A marker that was in view twice. Its part counts as not seen in these frames, because nobody knows which of the two lies on it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DuplicateMarker {
    /// The marker and the part.
    pub id: u16,
    /// What people call the part.
    pub name: String,
    /// In how many frames.
    pub frames: u64,
}

impl fmt::Display for DuplicateMarker {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "marker {} ({}) is in view twice", self.id, self.name)
    }
}

enum Source {
    Tracks(Box<SeenTracks<BufReader<File>>>),
    Film(Box<Watched>),
    Blackbox(Box<blackbox::Run>),
}

struct Watched {
    film: Film,
    perceiver: Perceiver,
    sight: SightMonitor,
    seen: Detections,
}

/// The picture of the newest frame and what was seen in it.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// Size and rate.
    pub format: PictureFormat,
    /// Pixels: blue, green, red.
    pub picture: &'a [u8],
    /// What was seen.
    pub seen: &'a Detections,
}

impl Recording {
    /// Opens a recording. A track file brings its objects and its space along; a film has the configuration's.
    ///
    /// # Errors
    /// What is missing or damaged, and where.
    pub fn open(path: &Path, config: &Config) -> Result<Self, RecordingError> {
        if Self::is_tracks(path) {
            Self::tracks(path, config.method.blind_ms)
        } else if blackbox::is_recording(path) {
            let run = blackbox::Run::open(path)?;
            Ok(Self::of(run.header().clone(), Source::Blackbox(Box::new(run))))
        } else {
            Self::film(path, config)
        }
    }

    /// As [`Recording::open`], as a run to learn from: of a recording of the role `record` the one piece in it.
    ///
    /// # Errors
    /// What is missing or damaged, and where.
    pub fn open_run(path: &Path, config: &Config) -> Result<Self, RecordingError> {
        if !blackbox::is_recording(path) {
            return Self::open(path, config);
        }
        let run = blackbox::Run::open_piece(path)?;
        Ok(Self::of(run.header().clone(), Source::Blackbox(Box::new(run))))
    }

    /// Whether this is the name of a track file.
    pub fn is_tracks(path: &Path) -> bool {
        path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("jsonl"))
    }

    /// Whether this names a recording that says itself what its station can see: a track file, or one of the role `record`.
    pub fn knows_its_station(path: &Path) -> bool {
        Self::is_tracks(path) || blackbox::is_recording(path)
    }

    fn tracks(path: &Path, blind_ms: u32) -> Result<Self, RecordingError> {
        let file = file::open(path).map_err(|source| RecordingError::Open { path: path.into(), source })?;
        let reader = SeenTracks::new(&path.display().to_string(), BufReader::new(file), blind_ms)?;
        Ok(Self::of(reader.header().clone(), Source::Tracks(Box::new(reader))))
    }

    fn film(path: &Path, config: &Config) -> Result<Self, RecordingError> {
        if let Err(source) = std::fs::metadata(path) {
            return Err(RecordingError::Open { path: path.into(), source });
        }
        if config.objects.is_empty() {
            return Err(RecordingError::NoObjects { path: path.into() });
        }
        let perceiver = perception::perceiver(config)?;
        let film = Film::open(path, config.camera.rate_hz)?;
        let shapes = config.shapes();
        let objects = config.objects.iter().zip(shapes);
        let header = Header {
            rate_hz: film.format().rate_hz as f32,
            space: Space::Plane,
            hands: config.perception.hands.clone(),
            landmarks: Landmarks::All,
            objects: objects
                .map(|(object, shape)| NamedObject { name: object.name.clone(), shape })
                .collect(),
        };
        let sight = SightMonitor::new(crate::sight::expected(config));
        let watched = Watched { film, perceiver, sight, seen: Detections::default() };
        Ok(Self::of(header, Source::Film(Box::new(watched))))
    }

    fn of(header: Header, source: Source) -> Self {
        Self { header, source, frames: 0, duplicates: Vec::new() }
    }

    /// Rate, space, hands and objects.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The number of frames, where it is known beforehand.
    pub fn count(&self) -> Option<u64> {
        match &self.source {
            Source::Tracks(_) | Source::Blackbox(_) => None,
            Source::Film(watched) => Some(watched.film.format().count).filter(|&count| count > 0),
        }
    }

    /// The next frame, in nanoseconds since the first; `None` after the last.
    ///
    /// # Errors
    /// What is damaged, and where.
    pub fn next_frame(&mut self) -> Result<Option<Frame>, RecordingError> {
        match &mut self.source {
            Source::Tracks(reader) => {
                let frame = reader.next().transpose()?;
                // What is known to be cut has no end that anything could be said of, as a film has none.
                match reader.truncation().filter(|_| frame.is_none()) {
                    Some(cut) => Err(RecordingError::CutShort(cut.clone())),
                    None => Ok(frame),
                }
            }
            Source::Film(watched) => {
                let frame = watched.next_frame()?;
                if frame.is_some() {
                    self.frames += 1;
                    wire::detections::twice(&watched.seen)
                        .for_each(|id| note(&mut self.duplicates, &self.header, id));
                }
                Ok(frame)
            }
            Source::Blackbox(run) => Ok(run.next_frame()?),
        }
    }

    /// What a person should know of the recording after it was read. `path` is what it is called.
    pub fn warnings(&self, path: &Path) -> Vec<String> {
        let words = |duplicate: &DuplicateMarker| {
            format!(
                "{}: {duplicate} in {} of {} frames, and the {} counts as not seen there: take the other print away, or give it an id of its own",
                path.display(),
                duplicate.frames,
                self.frames,
                duplicate.name
            )
        };
        // What is read once or twice is a lucky pattern.
        self.duplicates.iter().filter(|duplicate| duplicate.frames > 2).map(words).collect()
    }

    /// The size of the pictures; a track file has none.
    pub fn format(&self) -> Option<PictureFormat> {
        match &self.source {
            Source::Tracks(_) => None,
            Source::Film(watched) => Some(watched.film.format()),
            Source::Blackbox(run) => run.format(),
        }
    }

    /// What the film shows now; a track file has no pictures, and a recording not of every frame.
    pub fn view(&self) -> Option<View<'_>> {
        match &self.source {
            Source::Tracks(_) => None,
            Source::Blackbox(run) => {
                let (format, picture, seen) = run.shown()?;
                Some(View { format, picture, seen })
            }
            Source::Film(watched) => Some(View {
                format: watched.film.format(),
                picture: watched.film.picture(),
                seen: &watched.seen,
            }),
        }
    }
}

/// Notes that a marker is in view twice.
fn note(duplicates: &mut Vec<DuplicateMarker>, header: &Header, id: u16) {
    match duplicates.iter_mut().find(|duplicate| duplicate.id == id) {
        Some(duplicate) => duplicate.frames += 1,
        None => {
            let name = object_name(&header.objects, id);
            duplicates.push(DuplicateMarker { id, name, frames: 1 });
        }
    }
}

impl Watched {
    fn next_frame(&mut self) -> Result<Option<Frame>, RecordingError> {
        let Some(pts_ns) = self.film.advance()? else { return Ok(None) };
        let format = self.film.format();
        let (width, height) = (format.width as usize, format.height as usize);
        let image = ImageView::new(width, height, width * 3, PixelFormat::Bgr8, self.film.picture())?;
        let seen = self.perceiver.perceive(image, pts_ns)?;
        self.sight.step(&Observation::new(&seen, 0));
        let flags = if self.sight.is_seen() { 0 } else { flag::UNSEEN };
        self.seen = Detections { source_ns: pts_ns, flags, ..Detections::default() };
        wire::detections::write(&seen, &mut self.seen);
        Ok(Some(wire::detections::to_core(&self.seen)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_track_file_is_known_by_its_name_however_it_is_written() {
        for (name, is_tracks) in [("a.tracks.jsonl", true), ("A.TRACKS.JSONL", true), ("a.jsonl.mp4", false)]
        {
            assert_eq!(Recording::is_tracks(Path::new(name)), is_tracks, "{name}");
        }
    }
}
