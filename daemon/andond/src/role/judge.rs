//! `judge`: feature couples to verdicts, by the taught job.

use std::path::Path;

use andon_core::anomaly::{self, Event};
use andon_core::dtw::OnlineDtw;
use andon_core::job::Job;
use andon_core::verdict::{Level, Outcome, Reason, Verdict as CoreVerdict};
use andon_ipc::{Node, Port, Reader, UtcTime, Writer};
use andon_learn::job_file::JobFile;
use shm_schemas::{Command as CommandMessage, Couples, RoleId, Verdict};

use super::RoleError;
use super::cycle::{Cycle, Role, Turn};
use super::jobs::{self, Wanted};
use super::output::Output;
use crate::config::Config;
use crate::log::{code, log};
use crate::report::{Names, verdict_sentence};
use crate::wire::command::Command;
use crate::wire::verdict::{Sender, station_name};
use crate::wire::{self};

/// Runs until it is asked to stop. Each job that is loaded has a session of its own.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    let mut ports = Ports {
        couples: node.reader()?,
        commands: node.reader()?,
        verdicts: Output::new(node.writer()?, &[RoleId::Journal]),
    };
    let mut cycle = Cycle::new(node)?;
    let mut job = config.station.job.clone();
    loop {
        let wanted = match &job {
            Some(path) => watch(path, config, &mut ports, &mut cycle)?,
            None => idle(&mut ports, &mut cycle)?,
        };
        // A session that does not ask for another job was asked to stop.
        let Some(wanted) = wanted else { return Ok(()) };
        job = jobs::select(config, wanted, job);
    }
}

struct Ports {
    couples: Reader<Couples>,
    commands: Reader<CommandMessage>,
    verdicts: Output<Writer<Verdict>>,
}

impl Ports {
    fn all(&mut self) -> Vec<&mut dyn Port> {
        vec![self.verdicts.port(), &mut self.commands, &mut self.couples]
    }

    /// The next command. What is no command is counted and logged.
    fn take_command(&mut self, cycle: &mut Cycle<'_>) -> Result<Option<Command>, RoleError> {
        while let Some(message) = self.commands.take()? {
            match wire::command::read(&message) {
                Ok(command) => return Ok(Some(command)),
                Err(unknown) => {
                    cycle.liveness().refused();
                    log!(code::COMMAND_REFUSED, "{unknown}");
                }
            }
        }
        Ok(None)
    }
}

/// Waits for the command that names a job.
fn idle(ports: &mut Ports, cycle: &mut Cycle<'_>) -> Result<Option<Wanted>, RoleError> {
    log!(code::NO_JOB, "no job is selected");
    let mut idle = Idle { ports, wanted: None };
    cycle.run(&mut idle)?;
    Ok(idle.wanted)
}

/// Without a job nothing is judged, and the role is not ready; only commands count.
struct Idle<'p> {
    ports: &'p mut Ports,
    wanted: Option<Wanted>,
}

impl Role for Idle<'_> {
    const INPUT_IS_STEADY: bool = true;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        self.ports.all()
    }

    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        cycle.take(&mut self.ports.couples)?;
        while let Some(command) = self.ports.take_command(cycle)? {
            match command {
                Command::LoadJob { job_id, model_hash } => {
                    self.wanted = Some(Wanted { job_id, model_hash });
                    return Ok(Turn::Left);
                }
                Command::Start => log!(code::COMMAND_REFUSED, "Start: no job is loaded"),
                Command::Enable | Command::Disable | Command::Abort => (),
            }
        }
        Ok(Turn::Idle)
    }
}

/// Watches a job until another one is asked for.
fn watch(
    path: &Path,
    config: &Config,
    ports: &mut Ports,
    cycle: &mut Cycle<'_>,
) -> Result<Option<Wanted>, RoleError> {
    let file = jobs::load(path, config)?;
    log!(code::JOB_LOADED, { job = %path.display() }, "watching the job {:?} ({})", file.name, path.display());
    file.with_job(|job| {
        let mut session = Session {
            ports,
            job,
            file: &file,
            sender: Sender {
                job_id: file.id,
                model_hash: file.model_hash(),
                station: station_name(&config.station.name),
            },
            names: Names::new(file.objects.iter().map(|object| (object.shape.id, object.name.clone()))),
            judge: judge(job, &file)?,
            events: Vec::new(),
            is_enabled: true,
            wanted: None,
        };
        cycle.run(&mut session)?;
        Ok(session.wanted)
    })
}

/// A judge with as much memory as its job needs.
type Judge<'j> = anomaly::Judge<'j, Vec<OnlineDtw<'j>>>;

fn judge<'j>(job: &'j Job<'j>, file: &JobFile) -> Result<Judge<'j>, RoleError> {
    Judge::with_memory(job, file.method).map_err(|error| RoleError::Method(format!("{error:?}")))
}

/// One job that is watched.
struct Session<'s, 'j> {
    ports: &'s mut Ports,
    job: &'j Job<'j>,
    file: &'s JobFile,
    sender: Sender,
    names: Names,
    judge: Judge<'j>,
    /// What the judge has said and nobody has heard yet.
    events: Vec<Event>,
    is_enabled: bool,
    /// The job that a command asks for instead.
    wanted: Option<Wanted>,
}

impl Role for Session<'_, '_> {
    const INPUT_IS_STEADY: bool = true;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        self.ports.all()
    }

    /// Commands first: couples are older by the time that perception takes.
    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        while let Some(command) = self.ports.take_command(cycle)? {
            log!(code::COMMAND, "{command:?}");
            self.obey(command, cycle)?;
            if self.wanted.is_some() {
                return Ok(Turn::Left);
            }
        }
        let Some(couples) = cycle.take(&mut self.ports.couples)? else { return Ok(Turn::Idle) };
        if cycle.is_at_end() {
            self.finish(cycle)?;
        } else if self.is_enabled {
            let couples = wire::couples::read(&couples);
            self.judge.step(&couples, &mut |event| self.events.push(event));
            self.publish(cycle)?;
        }
        Ok(Turn::Stepped)
    }
}

impl Session<'_, '_> {
    fn obey(&mut self, command: Command, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        match command {
            Command::Enable => self.is_enabled = true,
            Command::Disable => {
                self.finish(cycle)?;
                self.is_enabled = false;
            }
            Command::Start => {
                self.judge.start(&mut |event| self.events.push(event));
                self.publish(cycle)?;
            }
            Command::Abort => self.finish(cycle)?,
            Command::LoadJob { job_id, model_hash } => {
                self.finish(cycle)?;
                self.wanted = Some(Wanted { job_id, model_hash });
            }
        }
        Ok(())
    }

    /// Ends the job; what comes next belongs to a new one.
    fn finish(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        self.judge.finish(&mut |event| self.events.push(event));
        self.judge = judge(self.job, self.file)?;
        self.publish(cycle)
    }

    /// Logs and sends what the judge has said.
    fn publish(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        for event in self.events.drain(..) {
            match event {
                Event::JobBegan { .. } => log!(code::JOB_STARTED, "the job {:?} has begun", self.file.name),
                Event::Verdict(verdict) => {
                    log_verdict(&verdict, &self.names);
                    let sender = &self.sender;
                    self.ports.verdicts.send(cycle, |message| {
                        wire::verdict::write(&verdict, sender, UtcTime::now(), message);
                    })?;
                }
            }
        }
        Ok(())
    }
}

/// What a technician reads: jobs and anomalies, each IU only on request.
fn log_verdict(verdict: &CoreVerdict, names: &Names) {
    let sentence = verdict_sentence(verdict, names);
    match (verdict.outcome, verdict.level) {
        (Outcome::Ok, Level::Job) => log!(code::JOB_OK, "{sentence}"),
        (Outcome::Ok, Level::Iu | Level::Activity) => tracing::debug!("{sentence}"),
        (Outcome::Anomaly, Level::Job) => log!(code::JOB_ANOMALY, "{sentence}"),
        (Outcome::Anomaly, Level::Iu | Level::Activity) => log!(code::ACTIVITY_ANOMALY, "{sentence}"),
        (Outcome::NotJudged, _) if verdict.reason == Reason::Overload => log!(code::OVERLOAD, "{sentence}"),
        (Outcome::NotJudged, _) => log!(code::NOT_JUDGED, "{sentence}"),
    }
}
