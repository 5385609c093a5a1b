//! What the judge says of itself, on a channel of its own: the newest counts.

use std::time::Instant;

use andon_host::role::{Cycle, Output};
use andon_ipc::{Error, Heartbeat, Node, Port, Writer};
use andon_learn::job_file::JobFile;
use shm_schemas::{CommandSource, JudgePhase, Judging, MessageId, PartId, Refusal};

use super::super::RoleError;

/// The state, which outlives the session of a job.
pub(super) struct State {
    writer: Output<Writer<Judging>>,
    now: Judging,
    /// Whether the PLC has loaded a job: then it chooses them.
    is_job_of_plc: bool,
    last_sent: Option<(Judging, Instant)>,
}

impl State {
    /// Without a PLC that may write, nobody could enable the judge: then it is enabled from the start.
    pub(super) fn new(node: &Node, is_enabled: bool) -> Result<Self, Error> {
        let now =
            Judging { phase: JudgePhase::NoJob.code(), is_enabled: is_enabled.into(), ..Judging::default() };
        Ok(Self { writer: Output::beside(node.writer()?), now, is_job_of_plc: false, last_sent: None })
    }

    pub(super) fn port(&mut self) -> &mut dyn Port {
        self.writer.port()
    }

    pub(super) fn is_enabled(&self) -> bool {
        self.now.is_enabled != 0
    }

    pub(super) fn enable(&mut self, is_enabled: bool) {
        self.now.is_enabled = is_enabled.into();
    }

    /// The part id of the jobs that begin from now on.
    pub(super) fn part(&self) -> PartId {
        self.now.part
    }

    /// Takes the part id of the jobs that begin from now on. The PLC's counts, if it gives any.
    pub(super) fn set_part(&mut self, part: PartId, source: CommandSource) -> Result<(), Refusal> {
        if source == CommandSource::Tool && self.now.part_source == CommandSource::Plc.code() {
            return Err(Refusal::PartOfPlc);
        }
        (self.now.part, self.now.part_source) = (part, source.code());
        Ok(())
    }

    /// Why nobody may load a job at this request, if so. The PLC's counts, if it loads any, and it has looked itself whether a job runs.
    pub(super) fn may_load(&mut self, source: CommandSource) -> Result<(), Refusal> {
        self.is_job_of_plc |= source == CommandSource::Plc;
        match source {
            CommandSource::Plc => Ok(()),
            CommandSource::Tool if self.is_job_of_plc => Err(Refusal::JobOfPlc),
            CommandSource::Tool if self.now.phase == JudgePhase::Running.code() => Err(Refusal::Busy),
            CommandSource::Tool => Ok(()),
        }
    }

    /// The job in force.
    pub(super) fn job(&mut self, file: &JobFile) {
        let Judging { job_id, model_hash, min_rate_hz, .. } = &mut self.now;
        (*job_id, *model_hash, *min_rate_hz) = (file.id, file.model_hash(), file.min_rate_hz);
    }

    /// Whether this is the job in force.
    pub(super) fn has_job(&self, job_id: u32, model_hash: u64) -> bool {
        (self.now.job_id, self.now.model_hash) == (job_id, model_hash)
    }

    pub(super) fn phase(&mut self, phase: JudgePhase) {
        self.now.phase = phase.code();
    }

    /// Whether the command has not come before: one that is not answered in time is sent again. One without a number is new.
    pub(super) fn is_new(&self, number: u64) -> bool {
        number == 0 || number != self.now.command
    }

    /// The answer to a command, which was obeyed after these couples.
    pub(super) fn answer(&mut self, number: u64, answer: Result<(), Refusal>, after: MessageId) {
        (self.now.command, self.now.refusal) = (number, answer.err().unwrap_or(Refusal::None).code());
        (self.now.obeyed_epoch, self.now.obeyed_seq) = (after.epoch, after.seq);
    }

    /// Couples were taken: the first are remembered.
    pub(super) fn took(&mut self, couples: MessageId) {
        if self.now.first_seq == 0 {
            (self.now.first_epoch, self.now.first_seq) = (couples.epoch, couples.seq);
        }
    }

    /// An answer may have been lost: it is sent again.
    pub(super) fn repeat(&mut self) {
        self.last_sent = None;
    }

    /// Sends what has changed since the last message, and everything with every beat.
    pub(super) fn send(&mut self, newest: MessageId, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        (self.now.verdict_epoch, self.now.verdict_seq) = (newest.epoch, newest.seq);
        let now = self.now;
        let is_known =
            self.last_sent.is_some_and(|(sent, at)| sent == now && at.elapsed() < Heartbeat::PERIOD);
        if !is_known {
            self.writer.send(cycle, |message| {
                *message = Judging { stamp: message.stamp, ..now };
            })?;
            self.last_sent = Some((now, Instant::now()));
        }
        Ok(())
    }
}
