//! `perceive`: frames to detections. Where an outside tracker sees instead, its track file is played.
//!
//! A calibration that is made while the line runs, on the board or in a shell, is taken between two pieces of work.

use std::time::{Duration, Instant};

use andon_host::config::{Config, Source};
use andon_host::log::{code, log};
use andon_host::role::{Cycle, Output, Role, Turn};
use andon_host::video::frame::view;
use andon_ipc::{FrameReader, FrameSample, Node, Port, Reader, Writer};
use andon_perception::Detections as Seen;
use andon_perception::metric::MetricScene;
use shm_schemas::{Detections, JudgePhase, Judging, RoleId, flag};

use super::duplicates::DuplicateMarkers;
use super::sight::SightWatch;
use super::{RoleError, tracks};
use crate::mark::{Mark, mark};
use crate::metric::{PlaceError, Placer};
use crate::perceiving::Perceiving;
use crate::perception::{SetupError, is_calibration_awaited};
use crate::wire;

/// How often it is looked whether the calibration was written anew.
const LOOK: Duration = Duration::from_secs(1);

/// Runs until it is asked to stop.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    if config.camera.source == Source::Tracks {
        return tracks::run(node, config);
    }
    let calibration = calibration(config);
    if let Some(path) = config.bench.calibration.as_ref().filter(|_| is_calibration_awaited(config)) {
        log!(code::CALIBRATION_AWAITED, "{}", path.display());
    }
    // Before the ports: a model that is missing is reported at once, and a frame that comes early is not kept waiting.
    let perceiving = Perceiving::new(config)?;
    let placer = Placer::new(config).map_err(SetupError::from)?;
    let mut role = Perceive {
        config,
        detections: Output::new(node.writer()?, &[RoleId::Encode]),
        frames: node.frame_reader()?,
        judging: node.reader()?,
        perceiving,
        placer,
        is_without_bench: false,
        sight: SightWatch::default(),
        duplicates: DuplicateMarkers::new(config),
        missed: 0,
        calibration,
        looked: Instant::now(),
        is_at_work: false,
    };
    Cycle::new(node)?.run(&mut role)
}

/// What changes with the file of the calibration.
fn calibration(config: &Config) -> Mark {
    config.bench.calibration.as_deref().and_then(mark)
}

struct Perceive<'a> {
    config: &'a Config,
    frames: FrameReader,
    judging: Reader<Judging>,
    detections: Output<Writer<Detections>>,
    perceiving: Perceiving,
    /// In metric mode.
    placer: Option<Placer>,
    /// Whether it was logged that the bench is not found.
    is_without_bench: bool,
    sight: SightWatch,
    duplicates: DuplicateMarkers<'a>,
    /// Frames up to the newest one that were not processed, whoever lost or skipped them.
    missed: u64,
    /// The file of the calibration in force.
    calibration: Mark,
    looked: Instant,
    /// Whether a piece is in work.
    is_at_work: bool,
}

impl Role for Perceive<'_> {
    type Error = RoleError;
    const INPUT_IS_STEADY: bool = true;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        vec![self.detections.port(), &mut self.judging, &mut self.frames]
    }

    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        while let Some(judging) = self.judging.take()? {
            self.perceiving.watch_for(&judging);
            self.is_at_work = judging.phase == JudgePhase::Running.code();
        }
        self.follow_calibration();
        let Some(frame) = cycle.take(&mut self.frames)? else { return Ok(Turn::Idle) };
        let header = frame.header();
        self.follow_source(header.stamp.epoch)?;
        let missed = self.frames.lost() + self.frames.skipped() + self.frames.lost_by_source();
        let newly_missed = missed - std::mem::replace(&mut self.missed, missed);
        let seen =
            if cycle.is_at_end() { None } else { Some(self.perceive(&frame, newly_missed as u32, cycle)?) };
        let unseen = if seen.is_none() || self.perceiving.is_seen() { 0 } else { flag::UNSEEN };
        self.detections.send(cycle, |message| {
            message.source_ns = header.source_ns;
            message.flags = header.flags | unseen;
            match seen {
                Some((seen, Some(scene))) => wire::detections::write_metric(&seen, &scene, message),
                Some((seen, None)) => wire::detections::write(&seen, message),
                None => (),
            }
        })?;
        Ok(Turn::Stepped)
    }
}

impl Perceive<'_> {
    /// Nothing that was learnt from the pictures of another source holds.
    fn follow_source(&mut self, epoch: u64) -> Result<(), RoleError> {
        if self.perceiving.follow_source(self.config, epoch)? {
            self.sight = SightWatch::default();
            self.placer = Placer::new(self.config).map_err(SetupError::from)?;
        }
        Ok(())
    }

    /// Takes a calibration that was written anew. A piece in work would have been seen in two places, so its end is waited for, unless nothing is seen
    /// of it anyway.
    fn follow_calibration(&mut self) {
        if self.looked.elapsed() < LOOK || (self.is_at_work && self.perceiving.is_seen()) {
            return;
        }
        self.looked = Instant::now();
        let now = calibration(self.config);
        if now.is_none() || now == self.calibration {
            return;
        }
        self.calibration = now;
        match self.begin() {
            Ok(()) => log!(code::CALIBRATION_TAKEN, "what is seen is placed by it from now on"),
            Err(error) => log!(code::CALIBRATION_REFUSED, "the one before it stays in force: {error}"),
        }
    }

    fn begin(&mut self) -> Result<(), SetupError> {
        let placer = Placer::new(self.config)?;
        self.perceiving.begin(self.config)?;
        (self.placer, self.sight) = (placer, SightWatch::default());
        Ok(())
    }

    /// What a frame shows, with its scene in metric mode. `dropped` are the frames before it that were not processed.
    fn perceive(
        &mut self,
        frame: &FrameSample,
        dropped: u32,
        cycle: &mut Cycle<'_>,
    ) -> Result<(Seen, Option<MetricScene>), RoleError> {
        let header = frame.header();
        let image = view(header, frame.colour()?)?;
        let (seen, spell) = self.perceiving.step(image, header.source_ns, dropped)?;
        let scene = self.scene(frame, &seen)?;
        self.duplicates.look(&seen.twice, seen.captured_ns);
        self.sight.tell(header, spell, &self.perceiving, cycle.liveness());
        Ok((seen, scene))
    }

    /// What was seen in three dimensions; `None` in plane mode. While the bench is not found, nothing is placed.
    fn scene(&mut self, frame: &FrameSample, seen: &Seen) -> Result<Option<MetricScene>, RoleError> {
        let Some(placer) = &mut self.placer else { return Ok(None) };
        match placer.place(frame.header(), frame.depth()?, seen) {
            Ok(scene) => {
                self.is_without_bench = false;
                Ok(Some(scene.unwrap_or_default()))
            }
            Err(PlaceError::NoBench(error)) => {
                if !std::mem::replace(&mut self.is_without_bench, true) {
                    log!(code::BENCH_NOT_FOUND, remedied: "{error}");
                }
                Ok(Some(MetricScene::default()))
            }
            Err(PlaceError::Calibration(error)) => Err(SetupError::from(error).into()),
            Err(PlaceError::Frame(error)) => Err(RoleError::Source(error.to_string())),
        }
    }
}
