//! The job that is watched, and what the judge says of it.

use andon_core::anomaly::Event;
use andon_core::couple::Couples;
use andon_core::job::Job;
use andon_core::verdict::{Level, Verdict};
use andon_host::log::{Remedy, code, log};
use andon_host::role::Cycle;
use andon_ipc::UtcTime;
use andon_learn::job_file::JobFile;
use shm_schemas::{Couples as Message, JudgePhase, PartId};

use super::super::RoleError;
use super::Ports;
use crate::report::{Names, code_of, verdict_sentence};
use crate::watch::Watch;
use crate::wire;
use crate::wire::verdict::{Sender, station_name};

pub(super) struct Watched<'j> {
    file: &'j JobFile,
    sender: Sender,
    names: Names,
    watch: Watch<'j>,
    /// What the judge has said and nobody has heard yet.
    events: Vec<Event>,
}

impl<'j> Watched<'j> {
    /// `is_between_jobs`: it is known that no piece is under work.
    pub(super) fn new(
        job: &'j Job<'j>,
        file: &'j JobFile,
        station: &str,
        is_between_jobs: bool,
    ) -> Result<Self, RoleError> {
        let sender = Sender {
            job_id: file.id,
            model_hash: file.model_hash(),
            station: station_name(station),
            part: PartId::NONE,
        };
        let names = Names::of_job(file);
        let watch = Watch::new(job, file, is_between_jobs)?;
        Ok(Self { file, sender, names, watch, events: Vec::new() })
    }

    /// Whether it is known that no piece is under work.
    pub(super) fn is_between_jobs(&self) -> bool {
        self.watch.is_between_jobs()
    }

    /// Whether the couples are made for this job.
    pub(super) fn is_meant_by(&self, couples: &Message) -> bool {
        couples.model_hash == self.sender.model_hash
    }

    /// Judges the next couples.
    pub(super) fn step(
        &mut self,
        couples: &Couples,
        ports: &mut Ports,
        cycle: &mut Cycle<'_>,
    ) -> Result<(), RoleError> {
        // Their time never goes back, except where the source has started again.
        if self.watch.begins_again(couples) {
            self.break_off(ports, cycle)?;
        }
        self.watch.step(couples, &mut |event| self.events.push(event));
        self.publish(ports, cycle)
    }

    /// Starts a job on command.
    pub(super) fn start(&mut self, ports: &mut Ports, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        self.watch.start(&mut |event| self.events.push(event));
        self.publish(ports, cycle)?;
        ports.state.phase(JudgePhase::Running);
        Ok(())
    }

    /// Ends the job; what comes next belongs to a new one.
    pub(super) fn finish(&mut self, ports: &mut Ports, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        self.watch.finish(&mut |event| self.events.push(event))?;
        self.begin_again(ports, cycle)
    }

    /// Ends the job where its couples break off, or are not watched any more.
    pub(super) fn break_off(&mut self, ports: &mut Ports, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        self.watch.break_off(&mut |event| self.events.push(event))?;
        self.begin_again(ports, cycle)
    }

    fn begin_again(&mut self, ports: &mut Ports, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        self.publish(ports, cycle)?;
        ports.state.phase(JudgePhase::Waiting);
        Ok(())
    }

    /// Logs and sends what the judge has said.
    fn publish(&mut self, ports: &mut Ports, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        for event in self.events.drain(..) {
            match event {
                Event::JobBegan { .. } => {
                    log!(code::JOB_STARTED, "the job {:?} has begun", self.file.name);
                    ports.state.phase(JudgePhase::Running);
                    // One that comes in the middle of a job is that of the next part.
                    self.sender.part = ports.state.part();
                }
                Event::Verdict(verdict) => {
                    let is_end = verdict.level == Level::Job;
                    ports.state.phase(if is_end { JudgePhase::Waiting } else { JudgePhase::Running });
                    log_verdict(&verdict, &self.names);
                    let sender = &self.sender;
                    ports.verdicts.send(cycle, |message| {
                        wire::verdict::write(&verdict, sender, UtcTime::now(), message);
                    })?;
                }
            }
        }
        Ok(())
    }
}

/// What a technician reads: jobs and anomalies, each IU only on request.
fn log_verdict(verdict: &Verdict, names: &Names) {
    let sentence = verdict_sentence(verdict, names);
    match code_of(verdict) {
        None => tracing::debug!("{sentence}"),
        Some(code) => code.log_found(&sentence, Remedy::OfCode),
    }
}
