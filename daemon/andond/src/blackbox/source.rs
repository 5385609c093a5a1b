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
use andon_record::picture::{Decoded, PictureError, decode, jpeg_in};
use andon_record::{End, Entry, Item, RecordingReader, Topic};
use shm_schemas::{Detections, MessageId, flag};

use super::look::{Looked, Looking};
use super::{BlackboxError, Piece, message, only_piece, station_of};
use crate::recorder;
use crate::wire;

/// Pictures that wait for what was seen in them, and the reverse. A recorder encodes a picture once `perceive` has looked at it, or while it does. Both
/// are at most a second behind.
const WAITING: usize = 32;

/// The frames of a recording.
pub struct Frames {
    reader: RecordingReader<BufReader<File>>,
    /// The file that is being read, and the one that the newest frame is in.
    paths: [PathBuf; 2],
    /// What follows it.
    following: VecDeque<PathBuf>,
    waiting: VecDeque<Waiting>,
    pictures: VecDeque<Entry>,
    shown: Option<Decoded>,
    seen: Detections,
    wants_pictures: bool,
    looking: Option<Looking>,
    /// How it ended, once it has been read.
    end: Option<End>,
}

/// Detections whose picture may still come.
struct Waiting {
    seen: Detections,
    /// The time of the picture.
    time_ns: u64,
    path: PathBuf,
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
            paths: [path.clone(), path],
            following,
            waiting: VecDeque::with_capacity(WAITING),
            pictures: VecDeque::with_capacity(WAITING),
            shown: None,
            seen: Detections::default(),
            wants_pictures: false,
            looking: None,
            end: None,
        })
    }

    /// From now on pictures are decoded.
    pub fn with_pictures(mut self) -> Self {
        self.wants_pictures = true;
        self
    }

    /// From now on detections are what is seen in the pictures again, by this configuration.
    pub(super) fn looked_at_again(mut self, config: &Config) -> Self {
        self.looking = Some(Looking::new(config));
        self.with_pictures()
    }

    /// What has come of looking at the pictures again.
    pub(super) fn looked(&self) -> Option<Looked> {
        self.looking.as_ref().map(Looking::looked)
    }

    /// The next message of detections, also one that only says that the source has ended.
    ///
    /// # Errors
    /// What the system says.
    pub fn next_detections(&mut self) -> Result<Option<&Detections>, BlackboxError> {
        loop {
            if let Some(next) = self.due() {
                self.show(next)?;
                return Ok(Some(&self.seen));
            }
            match self.next_item()? {
                Some(Item::Entry(entry)) => self.take(entry),
                Some(Item::Attachment(_)) => (),
                None if self.end.is_some() => return Ok(None),
                None => self.end = Some(self.reader.end()),
            }
        }
    }

    fn next_item(&mut self) -> Result<Option<Item>, BlackboxError> {
        loop {
            if let Some(item) = self.reader.next_item()? {
                return Ok(Some(item));
            }
            let Some(next) = self.following.pop_front() else { return Ok(None) };
            self.reader = RecordingReader::open(&next)?;
            self.paths[0] = next;
        }
    }

    fn take(&mut self, entry: Entry) {
        let Entry { topic, time_ns, ref data, .. } = entry;
        if let Some(seen) = message(topic, Topic::Raw(Channel::Detections), data) {
            self.waiting.push_back(Waiting { seen, time_ns, path: self.paths[0].clone() });
        } else if topic == Topic::Picture && self.wants_pictures {
            if self.pictures.len() == WAITING {
                self.pictures.pop_front();
            }
            self.pictures.push_back(entry);
        } else if let Some(looking) = &mut self.looking {
            if let Some(header) = message(topic, Topic::Raw(Channel::Frame), data) {
                looking.take_header(header);
            } else if let Some(judging) = message(topic, Topic::Raw(Channel::Judging), data) {
                looking.take_judging(judging);
            }
        }
    }

    /// The oldest detections, once their picture is there or does not come any more. Pictures come in the order of their times.
    fn due(&mut self) -> Option<Waiting> {
        let oldest = self.waiting.front()?;
        let has_come = self.pictures.back().is_some_and(|newest| newest.time_ns >= oldest.time_ns);
        let may_come = self.wants_pictures && !has_come && self.end.is_none() && self.waiting.len() < WAITING;
        if may_come { None } else { self.waiting.pop_front() }
    }

    /// The file that the newest frame is in.
    pub fn path(&self) -> &Path {
        &self.paths[1]
    }

    /// Shows detections, with the picture of their time.
    fn show(&mut self, next: Waiting) -> Result<(), BlackboxError> {
        let Waiting { seen, time_ns, path } = next;
        self.shown = None;
        let mut bytes = 0;
        while let Some(picture) = self.pictures.pop_front_if(|oldest| oldest.time_ns <= time_ns) {
            // What is older was never looked at.
            if picture.time_ns == time_ns {
                (self.shown, bytes) = decoded(&path, &picture)?;
            }
        }
        let picture = self.shown.as_ref().map(|picture| (picture, bytes));
        self.seen = match &mut self.looking {
            Some(looking) => looking.look(&path, &seen, picture)?,
            None => seen,
        };
        self.paths[1] = path;
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
        self.end.as_ref().unwrap_or(&End::Complete)
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

/// A picture of a recording, and how many bytes its file has; none where it is damaged. One that is too large is not tried.
fn decoded(path: &Path, message: &Entry) -> Result<(Option<Decoded>, usize), BlackboxError> {
    let found = jpeg_in(message.data.as_ref()).and_then(|(jpeg, _)| Ok((decode(&jpeg)?, jpeg.len())));
    match found {
        Ok((picture, bytes)) => Ok((Some(picture).filter(|picture| picture.width > 0), bytes)),
        Err(source @ PictureError::TooLarge { .. }) => {
            Err(BlackboxError::Picture { path: path.into(), source })
        }
        Err(_) => Ok((None, 0)),
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
            return Ok(decoded(path, &entry)?.0.map(|picture| PictureFormat {
                width: picture.width,
                height: picture.height,
                rate_hz: 0.0,
                count: 0,
            }));
        }
    }
    Ok(None)
}
