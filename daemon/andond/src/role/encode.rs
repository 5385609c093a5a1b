//! `encode`: detections to feature couples.

use andon_core::couple::{self, Encoder};
use andon_core::object::ObjectShape;
use andon_host::config::Config;
use andon_host::log::{code, log};
use andon_host::role::{Cycle, Output, Role, Turn};
use andon_ipc::{Node, Port, Reader, SourceTime, Writer};
use andon_learn::job_file::JobFile;
use shm_schemas::{Couples, Detections, Judging, RoleId, flag};

use super::RoleError;
use super::jobs;
use super::visibility::Visibility;
use crate::wire;

/// Runs until it is asked to stop.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    // The judge begins with this job too. Where it cannot be used, the judge says so.
    let job = config.station.job.as_deref().and_then(|path| jobs::load(path, config).ok());
    let objects = Objects::of(job.as_ref(), config);
    let mut role = Encode {
        config,
        couples: Output::new(node.writer()?, &[RoleId::Judge]),
        detections: node.reader()?,
        judging: node.reader()?,
        encoder: encoder(config, &objects)?,
        objects,
        newest: SourceTime::default(),
        ready: Vec::new(),
        visibility: Visibility::new(config),
    };
    Cycle::new(node)?.run(&mut role)
}

struct Encode<'a> {
    config: &'a Config,
    detections: Reader<Detections>,
    couples: Output<Writer<Couples>>,
    judging: Reader<Judging>,
    objects: Objects,
    encoder: Encoder,
    /// The time of the newest frame.
    newest: SourceTime,
    ready: Vec<couple::Couples>,
    visibility: Visibility,
}

impl Role for Encode<'_> {
    type Error = RoleError;
    const INPUT_IS_STEADY: bool = true;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        vec![self.couples.port(), &mut self.judging, &mut self.detections]
    }

    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        while let Some(judging) = self.judging.take()? {
            self.follow(&judging, cycle)?;
        }
        let Some(detections) = cycle.take(&mut self.detections)? else { return Ok(Turn::Idle) };
        let captured = SourceTime::from_nanoseconds(detections.source_ns);
        if cycle.is_at_end() || begins_again(captured, self.newest) {
            self.send_rest(cycle)?;
            self.begin()?;
        }
        if cycle.is_at_end() {
            self.couples.send(cycle, |message| message.flags = detections.flags)?;
        } else {
            self.newest = captured;
            self.encode(&detections, cycle)?;
        }
        Ok(Turn::Stepped)
    }
}

impl Encode<'_> {
    /// Encodes for the job in force: its runs have shown where and how near its objects are met.
    fn follow(&mut self, judging: &Judging, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        if judging.model_hash == self.objects.model_hash {
            return Ok(());
        }
        let job = jobs::in_force(self.config, judging)?;
        self.send_rest(cycle)?;
        self.objects = Objects::of(job.as_ref(), self.config);
        self.begin()
    }

    fn encode(&mut self, detections: &Detections, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        let frame = wire::detections::to_core(detections);
        let ready = &mut self.ready;
        if let Err(refused) = self.encoder.step(&frame, &mut |couples| ready.push(couples)) {
            cycle.liveness().refused();
            log!(code::FRAME_OUT_OF_ORDER, "frame {}: {refused:?}", detections.stamp.frame_seq);
        }
        self.visibility.look(&frame, &self.ready);
        self.send_ready(cycle)
    }

    /// Sends what the encoder still holds back.
    fn send_rest(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        let ready = &mut self.ready;
        self.encoder.flush(&mut |couples| ready.push(couples));
        self.send_ready(cycle)
    }

    /// Begins with a new encoder.
    fn begin(&mut self) -> Result<(), RoleError> {
        self.encoder = encoder(self.config, &self.objects)?;
        self.visibility = Visibility::new(self.config);
        self.newest = SourceTime::default();
        Ok(())
    }

    fn send_ready(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        let flags = cycle.flags() & !(flag::END_OF_STREAM | flag::UNSEEN);
        let model_hash = self.objects.model_hash;
        for couples in self.ready.drain(..) {
            self.couples.send(cycle, |message| {
                message.flags = flags;
                message.model_hash = model_hash;
                wire::couples::write(&couples, message);
            })?;
        }
        Ok(())
    }
}

/// A recording that starts again begins at zero. A frame that is only out of order is not so far back.
fn begins_again(captured: SourceTime, newest: SourceTime) -> bool {
    captured.nanoseconds() < newest.nanoseconds() / 2
}

/// The objects as the encoder knows them.
struct Objects {
    shapes: Vec<ObjectShape>,
    /// The hash of the job that shows where they are met and what they are used for; 0 where there is none.
    model_hash: u64,
}

impl Objects {
    fn of(job: Option<&JobFile>, config: &Config) -> Self {
        let mut shapes = config.shapes();
        for shown in job.iter().flat_map(|job| job.shapes()) {
            if let Some(shape) = shapes.iter_mut().find(|shape| shape.id == shown.id) {
                *shape = shown;
            }
        }
        Self { shapes, model_hash: job.map_or(0, JobFile::model_hash) }
    }
}

fn encoder(config: &Config, objects: &Objects) -> Result<Encoder, RoleError> {
    Encoder::new(config.method(), &objects.shapes).map_err(|error| RoleError::Method(format!("{error:?}")))
}
