//! `encode`: detections to feature couples.

use andon_core::couple::{self, Encoder};
use andon_ipc::{Node, Port, Reader, SourceTime, Writer};
use shm_schemas::{Couples, Detections, RoleId, flag};

use super::RoleError;
use super::cycle::{Cycle, Role, Turn};
use super::output::Output;
use super::visibility::Visibility;
use crate::config::Config;
use crate::log::{code, log};
use crate::wire;

/// Runs until it is asked to stop.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    let mut role = Encode {
        config,
        couples: Output::new(node.writer()?, &[RoleId::Judge]),
        detections: node.reader()?,
        encoder: encoder(config)?,
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
    encoder: Encoder,
    /// The time of the newest frame.
    newest: SourceTime,
    ready: Vec<couple::Couples>,
    visibility: Visibility,
}

impl Role for Encode<'_> {
    const INPUT_IS_STEADY: bool = true;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        vec![self.couples.port(), &mut self.detections]
    }

    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        let Some(detections) = cycle.take(&mut self.detections)? else { return Ok(Turn::Idle) };
        let captured = SourceTime::from_nanoseconds(detections.source_ns);
        if cycle.is_at_end() || begins_again(captured, self.newest) {
            self.start_over(cycle)?;
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

    /// Sends what the encoder still holds back, and begins with a new one.
    fn start_over(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        let ready = &mut self.ready;
        self.encoder.flush(&mut |couples| ready.push(couples));
        self.send_ready(cycle)?;
        self.encoder = encoder(self.config)?;
        self.visibility = Visibility::new(self.config);
        self.newest = SourceTime::default();
        Ok(())
    }

    fn send_ready(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        let flags = cycle.flags() & !flag::END_OF_STREAM;
        for couples in self.ready.drain(..) {
            self.couples.send(cycle, |message| {
                message.flags = flags;
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

fn encoder(config: &Config) -> Result<Encoder, RoleError> {
    Encoder::new(config.method(), &config.shapes()).map_err(|error| RoleError::Method(format!("{error:?}")))
}
