//! Looks at the pictures of a recording once more, as `perceive` did while they were recorded.
//!
//! What comes out is the same only where `perceive` has seen the same pixels, frame by frame, with the same program, models and libraries.
//! So [`Looked`] counts each frame of which that is not so.

use std::collections::VecDeque;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use andon_core::input::Space;
use andon_host::config::{Config, Source};
use andon_perception::{ImageView, PixelFormat};
use andon_record::picture::Decoded;
use shm_schemas::{Detections, FrameHeader, Judging, MessageId, Stamp, bytes_of, flag};
use tempfile::NamedTempFile;

use super::{BlackboxError, Station, first_picture};
use crate::perceiving::Perceiving;
use crate::perception::SetupError;
use crate::wire;

/// Headers and states of the judge that wait for the detections after them: those of more than a second.
const WAITING: usize = 256;

/// The configuration by which pictures are looked at.
pub struct Sight {
    config: Config,
    /// The calibration of the recording, for as long as it is read.
    _calibration: Option<NamedTempFile>,
}

impl Sight {
    /// That of a recording, with the models in this folder.
    ///
    /// # Errors
    /// Why its pictures cannot be looked at.
    pub fn of(path: &Path, station: &Station, models: PathBuf) -> Result<Self, BlackboxError> {
        let mut config = station.config.clone();
        let refused = |why| BlackboxError::NotFromFrames { path: path.into(), why };
        if config.camera.source == Source::Tracks {
            return Err(refused("its station played what was detected, and has no pictures"));
        }
        if config.method.space == Space::Metric {
            return Err(refused("its station measures in three dimensions, and the depth is not recorded"));
        }
        if first_picture(path)?.is_none() {
            return Err(refused("no picture of the camera is in it"));
        }
        config.perception.models = models;
        let mut calibration = None;
        if let Some(named) = &mut config.bench.calibration {
            let Some(recorded) = &station.calibration else {
                return Err(refused("it does not carry the calibration of its bench"));
            };
            let mut file = NamedTempFile::new().map_err(BlackboxError::Temporary)?;
            file.write_all(recorded).map_err(BlackboxError::Temporary)?;
            *named = file.path().into();
            calibration = Some(file);
        }
        Ok(Self { config, _calibration: calibration })
    }

    /// The configuration itself, with the calibration of the recording and with the models that are here.
    pub fn config(&self) -> &Config {
        &self.config
    }
}

/// What has come of looking again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Looked {
    /// Frames of which the recording says what was detected in them.
    pub frames: u64,
    /// Those in which the same was detected, bit for bit.
    pub equal: u64,
    /// Those whose picture is there, and is not the one that `perceive` saw: the recorder has encoded it.
    pub encoded: u64,
    /// Those without a picture. What was detected then stands for what would be detected again.
    pub without_picture: u64,
    /// Frames that `perceive` had looked at, and of which the recording does not say what was detected.
    pub lost: u64,
    /// How often the recording begins in the middle of what a start of `perceive` saw.
    pub begins_in_the_middle: u64,
}

impl Looked {
    /// Whether `perceive` has seen nothing else than these pictures, and all of them.
    pub fn is_all_that_was_seen(&self) -> bool {
        let Self { encoded, without_picture, lost, begins_in_the_middle, .. } = *self;
        [encoded, without_picture, lost, begins_in_the_middle] == [0; 4]
    }
}

/// Looks at one frame after the other.
pub(super) struct Looking {
    config: Config,
    /// Of the start of `perceive` that has sent the newest detections.
    perceiving: Option<Perceiving>,
    newest: MessageId,
    judging: Judging,
    /// States of the judge that `perceive` had not heard of when it took the newest frame.
    judgings: VecDeque<Judging>,
    /// Of frames that came after the newest one that was looked at.
    headers: VecDeque<FrameHeader>,
    /// The newest frame that was looked at.
    frame: MessageId,
    looked: Looked,
}

/// A picture, and how many bytes its file has.
pub(super) type Recorded<'a> = (&'a Decoded, usize);

impl Looking {
    pub(super) fn new(config: &Config) -> Self {
        Self {
            config: config.clone(),
            perceiving: None,
            newest: MessageId::default(),
            judging: Judging::default(),
            judgings: VecDeque::new(),
            headers: VecDeque::new(),
            frame: MessageId::default(),
            looked: Looked::default(),
        }
    }

    pub(super) fn looked(&self) -> Looked {
        self.looked
    }

    pub(super) fn take_judging(&mut self, judging: Judging) {
        push(&mut self.judgings, judging);
    }

    pub(super) fn take_header(&mut self, header: FrameHeader) {
        push(&mut self.headers, header);
    }

    /// What is detected in a frame, of which these detections are recorded. `path` is what messages call the recording.
    pub(super) fn look(
        &mut self,
        path: &Path,
        recorded: &Detections,
        picture: Option<Recorded<'_>>,
    ) -> Result<Detections, BlackboxError> {
        let begins = self.follow(recorded.stamp.id());
        let (header, dropped) = self.frame(&recorded.stamp, begins);
        if begins {
            self.perceiving = None;
        }
        let sent_ns = header.map_or(recorded.stamp.sent_ns, |header| header.stamp.sent_ns);
        while let Some(judging) = self.judgings.pop_front_if(|judging| judging.stamp.sent_ns <= sent_ns) {
            self.judging = judging;
        }
        if recorded.flags & flag::END_OF_STREAM != 0 {
            return Ok(*recorded);
        }
        self.looked.frames += 1;
        let Some((picture, bytes)) = picture else {
            self.looked.without_picture += 1;
            return Ok(*recorded);
        };
        let setup = |source: SetupError| BlackboxError::Look { path: path.into(), source };
        let perceiving = match &mut self.perceiving {
            Some(perceiving) => perceiving,
            none => none.insert(Perceiving::new(&self.config).map_err(setup)?),
        };
        perceiving.watch_for(&self.judging);
        if let Some(header) = header {
            perceiving.follow_source(&self.config, header.stamp.epoch).map_err(setup)?;
        }
        let is_as_sent = header.is_some_and(|header| header.jpeg_bytes as usize == bytes);
        let record = &self.config.record;
        let is_whole = record.bench.is_empty() && record.masks.is_empty();
        self.looked.encoded += u64::from(!(is_as_sent && is_whole));
        let (width, height) = (picture.width as usize, picture.height as usize);
        let image = ImageView::new(width, height, 3 * width, PixelFormat::Bgr8, &picture.pixels);
        let step = image.and_then(|image| perceiving.step(image, recorded.source_ns, dropped));
        let (seen, _) = step.map_err(|error| setup(error.into()))?;
        let unseen = if perceiving.is_seen() { 0 } else { flag::UNSEEN };
        let mut detections = Detections {
            stamp: recorded.stamp,
            source_ns: recorded.source_ns,
            flags: recorded.flags & !flag::UNSEEN | unseen,
            ..Detections::default()
        };
        wire::detections::write(&seen, &mut detections);
        self.looked.equal += u64::from(is_same(&detections, recorded));
        Ok(detections)
    }

    /// Follows the numbers of the detections. True where another start of `perceive` has sent these.
    fn follow(&mut self, id: MessageId) -> bool {
        let newest = std::mem::replace(&mut self.newest, id);
        if newest.epoch == id.epoch && newest.seq != 0 {
            let lost = id.seq.saturating_sub(newest.seq).saturating_sub(1);
            self.looked.lost = self.looked.lost.saturating_add(lost);
            return false;
        }
        self.looked.begins_in_the_middle += u64::from(id.seq != 1);
        true
    }

    /// The header of the frame that detections come from, and how many frames before it were not looked at. The first one of a start of `perceive`
    /// comes after none.
    fn frame(&mut self, stamp: &Stamp, is_first: bool) -> (Option<FrameHeader>, u32) {
        let (mut found, mut dropped) = (None, 0_u64);
        while let Some(header) =
            self.headers.pop_front_if(|header| header.stamp.captured_ns <= stamp.captured_ns)
        {
            dropped += u64::from(header.dropped);
            found = Some(header);
        }
        let header = found.filter(|header| header.stamp.seq == stamp.frame_seq);
        let epoch = header.map_or(self.frame.epoch, |header| header.stamp.epoch);
        let before = std::mem::replace(&mut self.frame, MessageId { epoch, seq: stamp.frame_seq });
        if is_first {
            return (header, header.map_or(0, |header| header.dropped));
        }
        let newest = if before.epoch == epoch { before.seq } else { 0 };
        let dropped = dropped.saturating_add(stamp.frame_seq.saturating_sub(newest).saturating_sub(1));
        (header, u32::try_from(dropped).unwrap_or(u32::MAX))
    }
}

/// Keeps the newest of those that wait.
fn push<T>(waiting: &mut VecDeque<T>, next: T) {
    if waiting.len() == WAITING {
        waiting.pop_front();
    }
    waiting.push_back(next);
}

/// Whether all that was detected is the same, bit for bit. What lies behind it in a message says nothing.
fn is_same(one: &Detections, other: &Detections) -> bool {
    let hands = |of: &Detections| -> Vec<u8> { of.hands().iter().flat_map(bytes_of).copied().collect() };
    let objects = |of: &Detections| -> Vec<u8> { of.objects().iter().flat_map(bytes_of).copied().collect() };
    (one.source_ns, one.flags) == (other.source_ns, other.flags)
        && hands(one) == hands(other)
        && objects(one) == objects(other)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use andon_record::picture::{encode, message_of};
    use andon_record::{Attachment, Entry, RecordingWriter, Topic};
    use std::fs::{self, File};

    /// A recording of a camera, with one picture, with this configuration and these files.
    fn recording(folder: &Path, configuration: &str, files: &[(&str, &str)]) -> PathBuf {
        let path = folder.join("run.mcap");
        let mut writer = RecordingWriter::new(File::create(&path).unwrap(), 0).unwrap();
        for (name, text) in [("configuration.toml", configuration)].iter().chain(files) {
            let data = text.as_bytes().into();
            writer.attach(&Attachment { name: (*name).into(), data }, 1).unwrap();
        }
        let picture = Decoded { width: 16, height: 16, pixels: vec![0; 16 * 16 * 3] };
        let data = message_of(encode(&picture, 80).unwrap(), 1).into();
        writer.write(&Entry { topic: Topic::Picture, time_ns: 1, sent_ns: 1, data }).unwrap();
        writer.finish().unwrap();
        path
    }

    fn sight(configuration: &str, files: &[(&str, &str)]) -> Result<Sight, BlackboxError> {
        let folder = tempfile::tempdir().unwrap();
        let path = recording(folder.path(), configuration, files);
        let (station, _) = super::super::station_of(&path)?;
        Sight::of(&path, &station, "/models/that/are/here".into())
    }

    const CAMERA: &str = "[station]\nname = \"line\"\n[camera]\nsource = \"v4l2\"\n[[objects]]\nid = 1\nname = \"cup\"\n\
        marker_side_m = 0.03\n";

    #[test]
    fn pictures_are_looked_at_with_the_calibration_that_the_recording_carries() {
        let calibrated = format!("{CAMERA}[bench]\ncalibration = \"/nowhere/bench.toml\"\n");
        let found = sight(&calibrated, &[("calibration.toml", "as it was")]).unwrap();
        let path = found.config().bench.calibration.clone().unwrap();
        assert_eq!(fs::read_to_string(path).unwrap(), "as it was");
        assert_eq!(found.config().perception.models, Path::new("/models/that/are/here"));
        let error = sight(&calibrated, &[]).err().unwrap().to_string();
        assert!(error.contains("run.mcap: it does not carry the calibration"), "{error}");
        assert_eq!(sight(CAMERA, &[]).unwrap().config().bench.calibration, None);
    }

    #[test]
    fn without_the_depth_that_a_station_measures_with_nothing_is_looked_at() {
        let metric = CAMERA.replace("v4l2", "realsense") + "[bench]\nspace = \"metric\"\n";
        let error = sight(&metric, &[]).err().unwrap().to_string();
        assert!(error.contains("the depth is not recorded: leave out --from-frames"), "{error}");
    }

    fn header(epoch: u64, seq: u64, dropped: u32) -> FrameHeader {
        let stamp = Stamp { epoch, seq, captured_ns: 1000 * epoch + seq, ..Stamp::default() };
        FrameHeader { stamp, dropped, ..FrameHeader::default() }
    }

    #[test]
    fn frames_that_were_not_looked_at_are_counted_as_perceive_counts_them() {
        let mut looking = Looking::new(&Config::default());
        let mut dropped = |is_first, headers: &[FrameHeader]| {
            headers.iter().for_each(|header| looking.take_header(*header));
            let stamp = headers.last().unwrap().stamp;
            let of_frame = Stamp { frame_seq: stamp.seq, captured_ns: stamp.captured_ns, ..Stamp::default() };
            looking.frame(&of_frame, is_first).1
        };
        assert_eq!(dropped(true, &[header(1, 4, 2), header(1, 5, 0)]), 0, "before it was there");
        assert_eq!(dropped(false, &[header(1, 6, 0)]), 0);
        assert_eq!(dropped(false, &[header(1, 7, 0), header(1, 9, 3)]), 5, "two skipped, three lost");
        assert_eq!(dropped(false, &[header(2, 3, 0)]), 2, "of the next start of the camera");
        let found = looking.frame(&Stamp { frame_seq: 4, captured_ns: 2004, ..Stamp::default() }, false);
        assert_eq!(found, (None, 0), "a frame that the recorder lost");
    }
}
