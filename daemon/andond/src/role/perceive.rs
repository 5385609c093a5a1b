//! `perceive`: frames to detections. Where an outside tracker sees instead, its track file is played.

use std::fs::File;
use std::io::BufReader;
use std::time::{Duration, Instant};

use andon_core::input::Space;
use andon_ipc::{FrameReader, FrameSample, Node, Wake, Writer, monotonic_ns};
use andon_learn::recording::TrackReader;
use andon_perception::metric::MetricScene;
use andon_perception::{Detections as Seen, ImageView, Perceiver, PerceptionError, PixelFormat};
use shm_schemas::{ColourFormat, Detections, FrameHeader, RoleId, flag};

use super::{Pulse, RoleError, WAIT};
use crate::config::{Config, Source, Speed};
use crate::log::{code, log};
use crate::metric::{PlaceError, Placer};
use crate::perception::SetupError;
use crate::{perception, wire};

/// Runs until it is asked to stop.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    if config.camera.source == Source::Tracks {
        return play_tracks(node, config);
    }
    // Before the ports: a model that is missing is said at once, and a frame that comes early is not kept waiting.
    let perceiver = perception::perceiver(config)?;
    let placer = Placer::new(config).map_err(SetupError::from)?;
    let mut role = Perceive {
        node,
        detections: node.writer()?,
        frames: node.frame_reader()?,
        perceiver,
        placer,
        without_bench: false,
        perceiver_epoch: 0,
        paced: false,
        dropped: 0,
        pulse: Pulse::new(node)?,
    };
    loop {
        let wake = node.wait(&mut [&mut role.frames, &mut role.detections], WAIT)?;
        if wake == Wake::Stop {
            return Ok(());
        }
        while let Some(frame) = role.take()? {
            role.step(&frame, config)?;
            // Frames may come faster than they are seen: neither signs of life nor a stop wait for a pause.
            role.beat(&wake)?;
            if node.stop().requested() {
                return Ok(());
            }
        }
        role.beat(&wake)?;
    }
}

struct Perceive<'a> {
    node: &'a Node,
    frames: FrameReader,
    detections: Writer<Detections>,
    perceiver: Perceiver,
    /// In metric mode.
    placer: Option<Placer>,
    /// Whether it was told that the bench is not found.
    without_bench: bool,
    perceiver_epoch: u64,
    paced: bool,
    /// Frames lost and skipped up to the newest one.
    dropped: u64,
    pulse: Pulse,
}

impl Perceive<'_> {
    /// Every frame of a source that waits; of a live one the newest, because a late frame is worth less than the next.
    fn take(&mut self) -> Result<Option<FrameSample>, RoleError> {
        Ok(if self.paced { self.frames.take()? } else { self.frames.take_newest()? })
    }

    fn beat(&mut self, wake: &Wake) -> Result<(), RoleError> {
        self.pulse.losses(self.frames.lost() + self.frames.skipped(), self.frames.restarts());
        Ok(self.pulse.beat_after(wake)?)
    }

    fn step(&mut self, frame: &FrameSample, config: &Config) -> Result<(), RoleError> {
        let began = Instant::now();
        let header = frame.header();
        self.pulse.received(&header.stamp);
        let paced = header.flags & flag::PACED != 0;
        if paced != self.paced {
            self.paced = paced;
            self.detections.follow(if paced { &[RoleId::Encode] } else { &[] });
        }
        if header.stamp.epoch != self.perceiver_epoch {
            // Another source: nothing that was learnt of the old picture holds.
            if self.perceiver_epoch != 0 {
                self.perceiver = perception::perceiver(config)?;
                self.placer = Placer::new(config).map_err(SetupError::from)?;
            }
            self.perceiver_epoch = header.stamp.epoch;
        }
        let dropped = self.frames.lost() + self.frames.skipped();
        super::wait_for_room(self.node, &mut self.detections, &mut self.pulse)?;
        let mut message = self.detections.loan()?;
        message.follow(&header.stamp);
        message.source_ns = header.source_ns;
        message.flags = header.flags;
        message.dropped = header.dropped.saturating_add((dropped - self.dropped) as u32);
        message.width = header.width;
        message.height = header.height;
        self.dropped = dropped;
        if header.flags & flag::END_OF_STREAM == 0 {
            let image = view(header, frame.colour()?)?;
            let seen = self.perceiver.perceive(image, header.source_ns, header.stamp.seq)?;
            match self.scene(frame, &seen)? {
                Some(scene) => wire::detections::write_metric(&seen, &scene, &mut message),
                None => wire::detections::write(&seen, &mut message),
            }
        } else {
            self.pulse.finished();
        }
        self.detections.send(message)?;
        self.pulse.sent();
        self.pulse.stepped(began.elapsed());
        Ok(())
    }
}

impl Perceive<'_> {
    /// What was seen in three dimensions; `None` in plane mode. While the bench is not found, nothing is placed.
    fn scene(&mut self, frame: &FrameSample, seen: &Seen) -> Result<Option<MetricScene>, RoleError> {
        let Some(placer) = &mut self.placer else { return Ok(None) };
        match placer.place(frame.header(), frame.depth()?, seen) {
            Ok(scene) => {
                self.without_bench = false;
                Ok(Some(scene.unwrap_or_default()))
            }
            Err(PlaceError::NoBench(error)) => {
                if !std::mem::replace(&mut self.without_bench, true) {
                    log!(code::BENCH_NOT_FOUND, "{error}");
                }
                Ok(Some(MetricScene::default()))
            }
            Err(PlaceError::Calibration(error)) => Err(SetupError::from(error).into()),
            Err(PlaceError::Frame(error)) => Err(RoleError::Source(error.to_string())),
        }
    }
}

/// The colour plane, where it lies.
fn view<'a>(header: &FrameHeader, colour: &'a [u8]) -> Result<ImageView<'a>, PerceptionError> {
    let format = match ColourFormat::try_from(header.colour_format) {
        Ok(ColourFormat::Rgb8) => PixelFormat::Rgb8,
        Ok(ColourFormat::Bgr8) => PixelFormat::Bgr8,
        Ok(ColourFormat::Grey8) => PixelFormat::Gray8,
        Ok(ColourFormat::Yuyv) | Err(_) => {
            return Err(PerceptionError::Setting {
                key: "the colour format of the frames",
                value: header.colour_format.to_string(),
                range: "RGB, BGR or grey, 8 bits each",
            });
        }
    };
    ImageView::new(header.width as usize, header.height as usize, header.stride as usize, format, colour)
}

/// Plays the track file at its own rate or as fast as the readers go.
fn play_tracks(node: &Node, config: &Config) -> Result<(), RoleError> {
    let mut detections: Writer<Detections> = node.writer()?;
    let mut pulse = Pulse::new(node)?;
    let paced = config.camera.speed == Speed::Max;
    if paced {
        detections.follow(&[RoleId::Encode]);
    }
    let space = if config.method.space == Space::Metric { flag::METRIC } else { 0 };
    let flags = space | if paced { flag::PACED } else { 0 };
    let mut offset_ns = 0;
    let mut seq = 0;
    loop {
        let began = monotonic_ns();
        let mut newest_ns = 0;
        let mut step_ns = 0;
        let mut tracks = tracks(config)?;
        for frame in tracks.by_ref() {
            let mut frame = frame?;
            step_ns = frame.captured_ns.saturating_sub(newest_ns);
            newest_ns = frame.captured_ns;
            let due_ns = began + newest_ns;
            if !paced && node.stop().wait(Duration::from_nanos(due_ns.saturating_sub(monotonic_ns()))) {
                return Ok(());
            }
            let stepped = Instant::now();
            frame.captured_ns += offset_ns;
            seq += 1;
            super::wait_for_room(node, &mut detections, &mut pulse)?;
            let mut message = detections.loan()?;
            message.stamp.frame_seq = seq;
            message.stamp.captured_ns = if paced { monotonic_ns() } else { due_ns };
            message.source_ns = frame.captured_ns;
            message.flags = flags;
            wire::detections::write_frame(&frame, &mut message);
            detections.send(message)?;
            pulse.sent();
            pulse.stepped(stepped.elapsed());
            pulse.beat()?;
        }
        if let Some(truncation) = tracks.truncation() {
            log!(code::TRACK_CUT_SHORT, "{truncation}");
        }
        // Once more from the start, as if the tracker had gone on.
        offset_ns += newest_ns + step_ns;
        if !config.camera.repeat {
            break;
        }
    }
    super::wait_for_room(node, &mut detections, &mut pulse)?;
    let mut end = detections.loan()?;
    end.source_ns = offset_ns;
    end.flags = flags | flag::END_OF_STREAM;
    detections.send(end)?;
    log!(code::RECORDING_ENDED, "the track file is at its end");
    pulse.finished();
    loop {
        let wake = node.wait(&mut [&mut detections], WAIT)?;
        if wake == Wake::Stop {
            return Ok(());
        }
        pulse.beat()?;
    }
}

fn tracks(config: &Config) -> Result<TrackReader<BufReader<File>>, RoleError> {
    // The configuration is refused without a path for this source.
    let path = config.camera.path.clone().unwrap_or_default();
    let file =
        File::open(&path).map_err(|error| RoleError::Source(format!("{}: {error}", path.display())))?;
    Ok(TrackReader::new(&path.display().to_string(), BufReader::new(file))?)
}
