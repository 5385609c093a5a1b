//! `perceive`: frames to detections. Where an outside tracker sees instead, its track file is played.

use andon_host::config::{Config, Source};
use andon_host::log::{code, log};
use andon_host::role::{Cycle, Output, Role, Turn};
use andon_host::video::frame::view;
use andon_ipc::{FrameReader, FrameSample, Node, Port, Reader, Writer};
use andon_perception::Detections as Seen;
use andon_perception::metric::MetricScene;
use shm_schemas::{Detections, Judging, RoleId, flag};

use super::duplicates::DuplicateMarkers;
use super::sight::SightWatch;
use super::{RoleError, tracks};
use crate::metric::{PlaceError, Placer};
use crate::perceiving::Perceiving;
use crate::perception::SetupError;
use crate::wire;

/// Runs until it is asked to stop.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    if config.camera.source == Source::Tracks {
        return tracks::run(node, config);
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
    };
    Cycle::new(node)?.run(&mut role)
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
        }
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
