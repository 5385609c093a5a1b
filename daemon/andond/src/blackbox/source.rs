//! A recording as frames for the method: what was detected, with the picture where there is one.

use std::collections::VecDeque;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use andon_core::input::Frame;
use andon_host::config::Config;
use andon_host::video::pipe::PictureFormat;
use andon_ipc::Channel;
use andon_learn::recording::{Header, Landmarks};
use andon_record::picture::{Decoded, PictureError, picture_in};
use andon_record::{End, Entry, Item, RecordingReader, Topic};
use shm_schemas::{Detections, MessageId, flag};

use super::{BlackboxError, Piece, message, only_piece, station_of};
use crate::recorder;
use crate::wire;

/// Pictures that wait for what was seen in them: perception is at most a second behind.
const WAITING: usize = 32;

/// The frames of a recording.
pub struct Frames {
    reader: RecordingReader<BufReader<File>>,
    path: PathBuf,
    /// What follows it.
    following: VecDeque<PathBuf>,
    pictures: VecDeque<Entry>,
    shown: Option<Decoded>,
    seen: Detections,
    wants_pictures: bool,
    end: End,
}

impl Frames {
    /// Begins to read.
    ///
    /// # Errors
    /// Why it cannot be used.
    pub fn open(path: &Path) -> Result<Self, BlackboxError> {
        Self::open_chain(&[path.into()])
    }

    /// Begins to read recordings that follow each other.
    ///
    /// # Errors
    /// Why one cannot be used.
    pub fn open_chain(paths: &[PathBuf]) -> Result<Self, BlackboxError> {
        let mut following: VecDeque<PathBuf> = paths.iter().cloned().collect();
        let path = following.pop_front().unwrap_or_default();
        Ok(Self {
            reader: RecordingReader::open(&path)?,
            path,
            following,
            pictures: VecDeque::with_capacity(WAITING),
            shown: None,
            seen: Detections::default(),
            wants_pictures: false,
            end: End::Complete,
        })
    }

    /// From now on pictures are decoded.
    pub fn with_pictures(mut self) -> Self {
        self.wants_pictures = true;
        self
    }

    /// The next message of detections, also one that only says that the source has ended.
    ///
    /// # Errors
    /// What the system says.
    pub fn next_detections(&mut self) -> Result<Option<&Detections>, BlackboxError> {
        while let Some(item) = self.next_item()? {
            let Item::Entry(entry) = item else { continue };
            if entry.topic == Topic::Picture && self.wants_pictures {
                if self.pictures.len() == WAITING {
                    self.pictures.pop_front();
                }
                self.pictures.push_back(entry);
                continue;
            }
            let of = Topic::Raw(Channel::Detections);
            let Some(detections) = message::<Detections>(entry.topic, of, &entry.data) else { continue };
            self.seen = detections;
            self.show(entry.time_ns)?;
            return Ok(Some(&self.seen));
        }
        self.end = self.reader.end();
        Ok(None)
    }

    fn next_item(&mut self) -> Result<Option<Item>, BlackboxError> {
        loop {
            if let Some(item) = self.reader.next_item()? {
                return Ok(Some(item));
            }
            let Some(next) = self.following.pop_front() else { return Ok(None) };
            self.reader = RecordingReader::open(&next)?;
            self.path = next;
        }
    }

    /// The file that the newest frame is in.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Shows the picture of this time.
    fn show(&mut self, time_ns: u64) -> Result<(), BlackboxError> {
        self.shown = None;
        while let Some(oldest) = self.pictures.front()
            && oldest.time_ns <= time_ns
        {
            // What is older was never looked at.
            let Some(picture) = self.pictures.pop_front().filter(|picture| picture.time_ns == time_ns) else {
                continue;
            };
            self.shown = decoded(&self.path, &picture)?;
        }
        Ok(())
    }

    /// The newest detections.
    pub fn newest(&self) -> MessageId {
        self.seen.stamp.id()
    }

    /// The picture of the newest frame, where there is one.
    pub fn shown(&self) -> Option<(PictureFormat, &[u8], &Detections)> {
        let Decoded { width, height, pixels } = self.shown.as_ref()?;
        let format = PictureFormat { width: *width, height: *height, rate_hz: 0.0, count: 0 };
        Some((format, pixels, &self.seen))
    }

    /// How it ended; complete until it has.
    pub fn end(&self) -> &End {
        &self.end
    }
}

/// A recording as a run: from its first frame on, in the order of time.
pub struct Run {
    frames: Frames,
    /// The piece that is wanted; all of it where there is none.
    piece: Option<Piece>,
    header: Header,
    /// The size of its first picture, where it has pictures.
    format: Option<PictureFormat>,
    period_ns: u64,
    /// What is subtracted from the source's time, and added where the source has started again.
    origin_ns: i128,
    newest_ns: Option<u64>,
}

impl Run {
    /// Opens a recording.
    ///
    /// # Errors
    /// Why it cannot be used.
    pub fn open(path: &Path) -> Result<Self, BlackboxError> {
        let (station, _) = station_of(path)?;
        let header = header(&station.config);
        let format =
            first_picture(path)?.map(|format| PictureFormat { rate_hz: f64::from(header.rate_hz), ..format });
        let frames = Frames::open(path)?;
        let frames = if format.is_some() { frames.with_pictures() } else { frames };
        let period_ns = station.config.method.period_ns();
        Ok(Self { frames, piece: None, header, format, period_ns, origin_ns: 0, newest_ns: None })
    }

    /// Opens a recording for the one piece that is in it, without its pictures.
    ///
    /// # Errors
    /// Why it cannot be used, as that it has several pieces.
    pub fn open_piece(path: &Path) -> Result<Self, BlackboxError> {
        let (station, _) = station_of(path)?;
        Ok(Self {
            frames: Frames::open(path)?,
            piece: only_piece(path)?,
            header: header(&station.config),
            format: None,
            period_ns: station.config.method.period_ns(),
            origin_ns: 0,
            newest_ns: None,
        })
    }

    /// Rate, space, hands and objects.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The size of its pictures, where it has any.
    pub fn format(&self) -> Option<PictureFormat> {
        self.format
    }

    /// The next frame, in nanoseconds since the first. A source that starts again goes on a period later.
    ///
    /// # Errors
    /// What the system says.
    pub fn next_frame(&mut self) -> Result<Option<Frame>, BlackboxError> {
        while let Some(detections) = self.frames.next_detections()? {
            let is_of_other =
                self.piece.as_ref().is_some_and(|piece| !piece.contains(&detections.stamp.captured_ns));
            if detections.flags & flag::END_OF_STREAM != 0 || is_of_other {
                continue;
            }
            let mut frame = wire::detections::to_core(detections);
            let source_ns = i128::from(frame.captured_ns);
            match self.newest_ns {
                None => self.origin_ns = source_ns,
                Some(newest_ns) if source_ns - self.origin_ns <= i128::from(newest_ns) => {
                    self.origin_ns = source_ns - i128::from(newest_ns) - i128::from(self.period_ns);
                }
                Some(_) => (),
            }
            let Ok(captured_ns) = u64::try_from(source_ns - self.origin_ns) else { continue };
            frame.captured_ns = captured_ns;
            self.newest_ns = Some(captured_ns);
            return Ok(Some(frame));
        }
        Ok(None)
    }

    /// The picture of the newest frame, where there is one of the size of the first.
    pub fn shown(&self) -> Option<(PictureFormat, &[u8], &Detections)> {
        let format = self.format?;
        let (own, picture, seen) = self.frames.shown()?;
        ((own.width, own.height) == (format.width, format.height)).then_some((format, picture, seen))
    }

    /// How it ended; complete until it has.
    pub fn end(&self) -> &End {
        self.frames.end()
    }
}

/// What a station can see.
fn header(config: &Config) -> Header {
    let hands = config.perception.hands.clone();
    Header { hands, landmarks: Landmarks::All, ..recorder::header(config) }
}

/// A picture of a recording; `None` where it is damaged. One that is too large is not tried.
fn decoded(path: &Path, message: &Entry) -> Result<Option<Decoded>, BlackboxError> {
    match picture_in(message) {
        Ok(picture) => Ok(Some(picture).filter(|picture| picture.width > 0)),
        Err(source @ PictureError::TooLarge { .. }) => {
            Err(BlackboxError::Picture { path: path.into(), source })
        }
        Err(_) => Ok(None),
    }
}

/// The size of the first picture of a recording.
///
/// # Errors
/// Why it cannot be used.
pub fn first_picture(path: &Path) -> Result<Option<PictureFormat>, BlackboxError> {
    let mut reader = RecordingReader::open(path)?;
    while let Some(item) = reader.next_item()? {
        if let Item::Entry(entry) = item
            && entry.topic == Topic::Picture
        {
            return Ok(decoded(path, &entry)?.map(|picture| PictureFormat {
                width: picture.width,
                height: picture.height,
                rate_hz: 0.0,
                count: 0,
            }));
        }
    }
    Ok(None)
}
