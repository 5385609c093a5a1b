//! `judge`: feature couples to verdicts, by the taught job.

mod state;

use std::path::{Path, PathBuf};

use andon_core::anomaly::{self, Event};
use andon_core::dtw::OnlineDtw;
use andon_core::job::Job;
use andon_core::verdict::{Level, Outcome, Reason, Verdict as CoreVerdict};
use andon_ipc::{Node, Port, Reader, UtcTime, Writer};
use andon_learn::job_file::JobFile;
use shm_schemas::{
    AuditKind, Command as CommandMessage, Couples, JudgePhase, PartId, Refusal, RoleId, Verdict,
};

use super::RoleError;
use super::audit::Auditor;
use super::cycle::{Cycle, Role, Turn};
use super::jobs::{self, Wanted};
use super::output::Output;
use crate::config::Config;
use crate::log::{code, log};
use crate::report::{Names, verdict_sentence};
use crate::wire::command::Command;
use crate::wire::verdict::{Sender, station_name};
use crate::wire::{self};
use state::State;

/// Runs until it is asked to stop. Each job that is loaded has a session of its own.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    // A PLC that may write decides whether the line watches, and it has not written yet.
    let is_enabled = !(config.plc.enable && config.plc.writes);
    let mut ports = Ports {
        couples: node.reader()?,
        commands: node.reader()?,
        verdicts: Output::new(node.writer()?, &[RoleId::Journal]),
        state: State::new(node, is_enabled)?,
        auditor: Auditor::open(node)?,
        asked_by: "configuration",
    };
    let mut cycle = Cycle::new(node)?;
    let mut job = config.station.job.clone();
    loop {
        let next = match &job {
            Some(path) => watch(path, config, &mut ports, &mut cycle)?,
            None => idle(config, &mut ports, &mut cycle)?,
        };
        // A session that does not ask for another job was asked to stop.
        if next.is_none() {
            return Ok(());
        }
        job = next;
    }
}

struct Ports {
    couples: Reader<Couples>,
    commands: Reader<CommandMessage>,
    verdicts: Output<Writer<Verdict>>,
    state: State,
    auditor: Auditor,
    /// Who has asked for the job in force.
    asked_by: &'static str,
}

impl Ports {
    fn all(&mut self) -> Vec<&mut dyn Port> {
        let outputs = [self.verdicts.port(), self.state.port(), self.auditor.port()];
        let inputs: [&mut dyn Port; 2] = [&mut self.commands, &mut self.couples];
        outputs.into_iter().chain(inputs).collect()
    }

    /// Answers a command. The journal hears of a job that was refused.
    fn answer(
        &mut self,
        number: u64,
        command: Command,
        answer: Result<(), Refusal>,
        cycle: &mut Cycle<'_>,
    ) -> Result<(), RoleError> {
        self.state.answer(number, answer);
        match (command, answer) {
            (Command::LoadJob { job_id, .. }, Err(refusal)) => {
                let what = format!("job {job_id} refused: {}", refusal.name());
                self.auditor.tell(cycle, AuditKind::Job, "plc", &what)
            }
            _ => Ok(()),
        }
    }

    /// The next command that has not come before, with its number. What is no command is counted and logged.
    fn take_command(&mut self, cycle: &mut Cycle<'_>) -> Result<Option<(u64, Command)>, RoleError> {
        while let Some(message) = self.commands.take()? {
            if !self.state.is_new(message.number) {
                self.state.repeat();
                continue;
            }
            match wire::command::read(&message) {
                Ok(command) => {
                    log!(code::COMMAND, "{command:?}");
                    return Ok(Some((message.number, command)));
                }
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
fn idle(config: &Config, ports: &mut Ports, cycle: &mut Cycle<'_>) -> Result<Option<PathBuf>, RoleError> {
    log!(code::NO_JOB, "no job is selected");
    let mut idle = Idle { config, ports, next: None };
    cycle.run(&mut idle)?;
    Ok(idle.next)
}

/// Without a job nothing is judged, and the role is not ready; only commands count.
struct Idle<'p> {
    config: &'p Config,
    ports: &'p mut Ports,
    next: Option<PathBuf>,
}

impl Role for Idle<'_> {
    const INPUT_IS_STEADY: bool = true;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        self.ports.all()
    }

    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        cycle.take(&mut self.ports.couples)?;
        while let Some((number, command)) = self.ports.take_command(cycle)? {
            let state = &mut self.ports.state;
            let answer = match command {
                Command::LoadJob { job_id, model_hash } => {
                    jobs::select(self.config, Wanted { job_id, model_hash })
                        .map(|found| self.next = Some(found.path))
                }
                Command::Start => Err(Refusal::NoJob),
                Command::Enable | Command::Disable => {
                    state.enable(command == Command::Enable);
                    Ok(())
                }
                Command::Abort => Ok(()),
                Command::SetPart { part, source } => state.set_part(part, source),
            };
            self.ports.answer(number, command, answer, cycle)?;
            if self.next.is_some() {
                self.ports.asked_by = "plc";
                // The next session tells it, when it has the job.
                return Ok(Turn::Left);
            }
        }
        self.ports.state.tell(self.ports.verdicts.writer().newest(), cycle)?;
        Ok(Turn::Idle)
    }
}

/// Watches a job until another one is asked for.
fn watch(
    path: &Path,
    config: &Config,
    ports: &mut Ports,
    cycle: &mut Cycle<'_>,
) -> Result<Option<PathBuf>, RoleError> {
    let file = jobs::load(path, config)?;
    let what =
        format!("job {} {:?} of hash {:016x} ({})", file.id, file.name, file.model_hash(), path.display());
    log!(code::JOB_LOADED, { job = %path.display() }, "watching the {what}");
    let asked_by = ports.asked_by;
    ports.auditor.tell(cycle, AuditKind::Job, asked_by, &format!("{what} loaded"))?;
    ports.state.job(file.id, file.model_hash());
    ports.state.phase(JudgePhase::Waiting);
    file.with_job(|job| {
        let mut session = Session {
            config,
            ports,
            job,
            file: &file,
            sender: Sender {
                job_id: file.id,
                model_hash: file.model_hash(),
                station: station_name(&config.station.name),
                part: PartId::NONE,
            },
            names: Names::of_job(&file),
            judge: judge(job, &file)?,
            newest_ns: 0,
            events: Vec::new(),
            next: None,
        };
        cycle.run(&mut session)?;
        Ok(session.next)
    })
}

/// A judge with as much memory as its job needs.
type Judge<'j> = anomaly::Judge<'j, Vec<OnlineDtw<'j>>>;

fn judge<'j>(job: &'j Job<'j>, file: &JobFile) -> Result<Judge<'j>, RoleError> {
    Judge::with_memory(job, file.method).map_err(|error| RoleError::Method(format!("{error:?}")))
}

/// One job that is watched.
struct Session<'s, 'j> {
    config: &'s Config,
    ports: &'s mut Ports,
    job: &'j Job<'j>,
    file: &'s JobFile,
    sender: Sender,
    names: Names,
    judge: Judge<'j>,
    /// The time of the newest couples.
    newest_ns: u64,
    /// What the judge has said and nobody has heard yet.
    events: Vec<Event>,
    /// The job that a command asks for instead.
    next: Option<PathBuf>,
}

impl Role for Session<'_, '_> {
    const INPUT_IS_STEADY: bool = true;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        self.ports.all()
    }

    /// Commands first: couples are older by the time that perception takes.
    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        while let Some((number, command)) = self.ports.take_command(cycle)? {
            let answer = self.obey(command, cycle)?;
            self.ports.answer(number, command, answer, cycle)?;
            if self.next.is_some() {
                self.ports.asked_by = "plc";
                // The next session tells it, when it has the job.
                return Ok(Turn::Left);
            }
        }
        let turn = self.judge_next(cycle)?;
        self.ports.state.tell(self.ports.verdicts.writer().newest(), cycle)?;
        Ok(turn)
    }
}

impl Session<'_, '_> {
    fn judge_next(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        let Some(couples) = cycle.take(&mut self.ports.couples)? else { return Ok(Turn::Idle) };
        if cycle.is_at_end() {
            self.finish(cycle)?;
        } else if self.ports.state.is_enabled() {
            let couples = wire::couples::read(&couples);
            // Their time never goes back, except where the source has started again.
            if couples.captured_ns < std::mem::replace(&mut self.newest_ns, couples.captured_ns) {
                self.break_off(cycle)?;
            }
            self.judge.step(&couples, &mut |event| self.events.push(event));
            self.publish(cycle)?;
        }
        Ok(Turn::Stepped)
    }

    fn obey(&mut self, command: Command, cycle: &mut Cycle<'_>) -> Result<Result<(), Refusal>, RoleError> {
        match command {
            Command::Enable => self.ports.state.enable(true),
            Command::Disable => {
                // Nobody says that the piece will not be completed: it is only not watched any more.
                self.break_off(cycle)?;
                self.ports.state.enable(false);
            }
            Command::Start if !self.ports.state.is_enabled() => {
                log!(code::COMMAND_REFUSED, "Start: the line is not enabled");
                return Ok(Err(Refusal::NotEnabled));
            }
            Command::Start => {
                self.judge.start(&mut |event| self.events.push(event));
                self.publish(cycle)?;
                self.ports.state.phase(JudgePhase::Running);
            }
            Command::Abort => self.finish(cycle)?,
            Command::SetPart { part, source } => return Ok(self.ports.state.set_part(part, source)),
            Command::LoadJob { job_id, model_hash } => {
                let found = match jobs::select(self.config, Wanted { job_id, model_hash }) {
                    Ok(found) => found,
                    Err(refusal) => return Ok(Err(refusal)),
                };
                // The one in force goes on as if nothing had been said.
                if !self.ports.state.has_job(job_id, found.model_hash) {
                    self.finish(cycle)?;
                    self.next = Some(found.path);
                }
            }
        }
        Ok(Ok(()))
    }

    /// Ends the job; what comes next belongs to a new one.
    fn finish(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        self.judge.finish(&mut |event| self.events.push(event));
        self.judge = judge(self.job, self.file)?;
        self.publish(cycle)?;
        self.ports.state.phase(JudgePhase::Waiting);
        Ok(())
    }

    /// Ends the job where its couples break off, or are not watched any more.
    fn break_off(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        self.judge.break_off(&mut |event| self.events.push(event));
        self.judge = judge(self.job, self.file)?;
        self.publish(cycle)?;
        self.ports.state.phase(JudgePhase::Waiting);
        Ok(())
    }

    /// Logs and sends what the judge has said.
    fn publish(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        for event in self.events.drain(..) {
            match event {
                Event::JobBegan { .. } => {
                    log!(code::JOB_STARTED, "the job {:?} has begun", self.file.name);
                    self.ports.state.phase(JudgePhase::Running);
                    // One that comes in the midst of a job is that of the next part.
                    self.sender.part = self.ports.state.part();
                }
                Event::Verdict(verdict) => {
                    let is_end = verdict.level == Level::Job;
                    self.ports.state.phase(if is_end { JudgePhase::Waiting } else { JudgePhase::Running });
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
        (Outcome::Ok, Level::Activity) if verdict.note.is_some() => log!(code::NOTE, "{sentence}"),
        (Outcome::Ok, Level::Iu | Level::Activity) => tracing::debug!("{sentence}"),
        (Outcome::Anomaly, Level::Job) => log!(code::JOB_ANOMALY, "{sentence}"),
        (Outcome::Anomaly, Level::Iu | Level::Activity) => log!(code::ACTIVITY_ANOMALY, "{sentence}"),
        (Outcome::NotJudged, _) if verdict.reason == Reason::Overload => log!(code::OVERLOAD, "{sentence}"),
        (Outcome::NotJudged, _) => log!(code::NOT_JUDGED, "{sentence}"),
    }
}
