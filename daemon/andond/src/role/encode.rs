//! `encode`: detections to feature couples.

use std::time::Instant;

use andon_core::couple::{self, Encoder};
use andon_ipc::{Node, Reader, Wake, Writer};
use shm_schemas::{Couples, Detections, RoleId, Stamp, flag};

use super::sight::Sight;
use super::{Pulse, RoleError, WAIT};
use crate::config::Config;
use crate::log::{code, log};
use crate::wire;

/// Runs until it is asked to stop.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    let mut role = Encode::new(node, config)?;
    loop {
        let wake = node.wait(&mut [&mut role.detections, &mut role.couples], WAIT)?;
        if wake == Wake::Stop {
            return Ok(());
        }
        while let Some(detections) = role.detections.take()? {
            role.step(&detections)?;
        }
        role.pulse.losses(role.detections.lost(), role.detections.restarts());
        role.pulse.beat_after(&wake)?;
    }
}

struct Encode<'a> {
    node: &'a Node,
    config: &'a Config,
    detections: Reader<Detections>,
    couples: Writer<Couples>,
    encoder: Encoder,
    newest_ns: u64,
    ready: Vec<couple::Couples>,
    sight: Sight,
    paced: bool,
    pulse: Pulse,
}

impl<'a> Encode<'a> {
    fn new(node: &'a Node, config: &'a Config) -> Result<Self, RoleError> {
        Ok(Self {
            node,
            config,
            couples: node.writer()?,
            detections: node.reader()?,
            encoder: encoder(config)?,
            newest_ns: 0,
            ready: Vec::new(),
            sight: Sight::new(config),
            paced: false,
            pulse: Pulse::new(node)?,
        })
    }

    fn step(&mut self, detections: &Detections) -> Result<(), RoleError> {
        let began = Instant::now();
        self.pulse.received(&detections.stamp);
        self.pace(detections.flags & flag::PACED != 0);
        let ended = detections.flags & flag::END_OF_STREAM != 0;
        // A recording that starts again begins at zero.
        if ended || detections.source_ns < self.newest_ns / 2 {
            self.end_stream(&detections.stamp, detections.flags, ended)?;
        }
        if !ended {
            self.newest_ns = detections.source_ns;
            let frame = wire::detections::frame(detections);
            let ready = &mut self.ready;
            if let Err(refused) = self.encoder.step(&frame, &mut |couples| ready.push(couples)) {
                self.pulse.refused();
                log!(code::FRAME_OUT_OF_ORDER, "frame {}: {refused:?}", detections.stamp.frame_seq);
            }
            self.sight.look(&frame, &self.ready);
            self.send_ready(&detections.stamp, detections.flags)?;
        }
        self.pulse.stepped(began.elapsed());
        Ok(())
    }

    fn pace(&mut self, paced: bool) {
        if paced != self.paced {
            self.paced = paced;
            self.couples.follow(if paced { &[RoleId::Judge] } else { &[] });
        }
    }

    /// Sends what the encoder still holds back, and starts anew.
    fn end_stream(&mut self, stamp: &Stamp, flags: u32, ended: bool) -> Result<(), RoleError> {
        let ready = &mut self.ready;
        self.encoder.flush(&mut |couples| ready.push(couples));
        self.send_ready(stamp, flags & !flag::END_OF_STREAM)?;
        self.encoder = encoder(self.config)?;
        self.sight = Sight::new(self.config);
        self.newest_ns = 0;
        if ended {
            self.send(stamp, flags, None)?;
            self.pulse.finished();
        }
        Ok(())
    }

    fn send_ready(&mut self, stamp: &Stamp, flags: u32) -> Result<(), RoleError> {
        // Taken out and put back, so that its memory is used again.
        let mut ready = std::mem::take(&mut self.ready);
        for couples in ready.drain(..) {
            self.send(stamp, flags, Some(&couples))?;
        }
        self.ready = ready;
        Ok(())
    }

    fn send(
        &mut self,
        stamp: &Stamp,
        flags: u32,
        couples: Option<&couple::Couples>,
    ) -> Result<(), RoleError> {
        super::wait_for_room(self.node, &mut self.couples, &mut self.pulse)?;
        let mut message = self.couples.loan()?;
        message.follow(stamp);
        message.flags = flags;
        if let Some(couples) = couples {
            wire::couples::write(couples, &mut message);
        }
        self.couples.send(message)?;
        self.pulse.sent();
        Ok(())
    }
}

fn encoder(config: &Config) -> Result<Encoder, RoleError> {
    Encoder::new(config.method(), &config.shapes()).map_err(|error| RoleError::Method(format!("{error:?}")))
}
