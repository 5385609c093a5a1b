//! `encode`: detections to feature couples.

use andon_core::couple;
use andon_host::config::Config;
use andon_host::log::{code, log};
use andon_host::role::{Cycle, Output, Role, Turn};
use andon_ipc::{Node, Port, Reader, Writer};
use shm_schemas::{Couples, Detections, Judging, RoleId, flag};

use super::RoleError;
use super::jobs;
use super::visibility::Visibility;
use crate::encoding::Encoding;
use crate::wire;

/// Runs until it is asked to stop.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    // The judge begins with this job too. Where it cannot be used, the judge says so.
    let job = config.station.job.as_deref().and_then(|path| jobs::load(path, config).ok());
    let mut role = Encode {
        config,
        couples: Output::new(node.writer()?, &[RoleId::Judge]),
        detections: node.reader()?,
        judging: node.reader()?,
        encoding: Encoding::new(config, job.as_ref())?,
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
    encoding: Encoding,
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
        if cycle.is_at_end() || self.encoding.begins_again(detections.source_ns) {
            self.send_remaining(cycle)?;
            self.begin()?;
        }
        if cycle.is_at_end() {
            self.couples.send(cycle, |message| message.flags = detections.flags)?;
        } else {
            self.encode(&detections, cycle)?;
        }
        Ok(Turn::Stepped)
    }
}

impl Encode<'_> {
    /// Encodes for the job in force: its runs have shown where and how near its objects are met.
    fn follow(&mut self, judging: &Judging, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        if judging.model_hash == self.encoding.model_hash() {
            return Ok(());
        }
        let job = jobs::in_force(self.config, judging)?;
        self.send_remaining(cycle)?;
        self.encoding = Encoding::new(self.config, job.as_ref())?;
        self.visibility = Visibility::new(self.config);
        Ok(())
    }

    fn encode(&mut self, detections: &Detections, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        let frame = wire::detections::to_core(detections);
        let ready = &mut self.ready;
        let captured_ns = detections.stamp.captured_ns;
        if let Err(refused) = self.encoding.step(&frame, captured_ns, &mut |couples| ready.push(couples)) {
            cycle.liveness().refused();
            log!(code::FRAME_OUT_OF_ORDER, "frame {}: {refused:?}", detections.stamp.frame_seq);
        }
        self.visibility.look(&frame, &self.ready);
        self.send_ready(cycle)
    }

    /// Sends what the encoder still holds back.
    fn send_remaining(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        let ready = &mut self.ready;
        self.encoding.flush(&mut |couples| ready.push(couples));
        self.send_ready(cycle)
    }

    /// Begins with a new encoder.
    fn begin(&mut self) -> Result<(), RoleError> {
        self.visibility = Visibility::new(self.config);
        Ok(self.encoding.begin()?)
    }

    fn send_ready(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        let flags = cycle.flags() & !(flag::END_OF_STREAM | flag::UNSEEN);
        let (model_hash, began_ns) = (self.encoding.model_hash(), self.encoding.began_ns());
        for couples in self.ready.drain(..) {
            self.couples.send(cycle, |message| {
                message.flags = flags;
                (message.model_hash, message.began_ns) = (model_hash, began_ns);
                wire::couples::write(&couples, message);
            })?;
        }
        Ok(())
    }
}
