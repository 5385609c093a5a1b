//! `judge`: feature couples to verdicts, by the taught job.

mod state;
mod watched;

use std::path::{Path, PathBuf};

use andon_host::config::Config;
use andon_host::log::{code, log};
use andon_host::role::{Cycle, Output, Role, Turn};
use andon_ipc::{Node, Port, Reader, Writer};
use shm_schemas::{
    AuditKind, Command as CommandMessage, CommandSource, Couples, JudgePhase, Refusal, RoleId, Verdict,
};

use super::RoleError;
use super::audit::Auditor;
use super::jobs::{self, Wanted};
use crate::wire;
use crate::wire::command::Command;
use state::State;
use watched::Watched;

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
        is_between_jobs: false,
    };
    let mut cycle = Cycle::new(node)?;
    let configured = jobs::chosen(config).or_else(|| config.station.job.clone());
    let ordered = || jobs::ordered(config).inspect(|_| ports.asked_by = "last order of an engineer");
    let mut job = configured.or_else(ordered);
    loop {
        let next = match &job {
            Some(path) => watch(path, config, &mut ports, &mut cycle)?,
            None => {
                log!(code::NO_JOB, "no job is selected");
                Session { config, ports: &mut ports, watched: None, next: None }.run(&mut cycle)?
            }
        };
        // A session that does not ask for another job was asked to stop.
        if next.is_none() {
            return Ok(());
        }
        job = next;
    }
}

/// Who has asked for a job, for the journal.
fn who(source: CommandSource) -> &'static str {
    match source {
        CommandSource::Plc => "plc",
        CommandSource::Tool => "andond use",
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
    /// It was known that no piece was under work when that was asked for.
    is_between_jobs: bool,
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
        self.state.answer(number, answer, cycle.stamp().id());
        match (command, answer) {
            (Command::LoadJob { job_id, source, .. }, Err(refusal)) => {
                let what = format!("job {job_id} refused: {}", refusal.name());
                Ok(self.auditor.record(cycle, AuditKind::Job, who(source), &what)?)
            }
            _ => Ok(()),
        }
    }

    /// The next command that has not come before, with its number. What is not a command is counted and logged.
    fn take_command(&mut self, cycle: &mut Cycle<'_>) -> Result<Option<(u64, Command)>, RoleError> {
        while let Some(message) = self.commands.take()? {
            if !self.state.is_new(message.number) {
                self.state.repeat();
                continue;
            }
            match wire::command::read(&message) {
                Ok(command) => {
                    log!(code::COMMAND, "{command}");
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
    ports.auditor.record(cycle, AuditKind::Job, asked_by, &format!("{what} loaded"))?;
    ports.state.job(&file);
    ports.state.phase(JudgePhase::Waiting);
    file.with_job(|job| {
        let watched = Some(Watched::new(job, &file, &config.station.name, ports.is_between_jobs)?);
        Session { config, ports, watched, next: None }.run(cycle)
    })
}

/// Until another job is asked for. Without a job nothing is judged, and the role is not ready; only commands count.
struct Session<'s, 'j> {
    config: &'s Config,
    ports: &'s mut Ports,
    watched: Option<Watched<'j>>,
    /// The job that a command asks for instead.
    next: Option<PathBuf>,
}

impl Role for Session<'_, '_> {
    type Error = RoleError;
    const INPUT_IS_STEADY: bool = true;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        self.ports.all()
    }

    /// Commands first: couples are older by the time that perception takes.
    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        while let Some((number, command)) = self.ports.take_command(cycle)? {
            let answer = self.obey(command, cycle)?;
            self.ports.answer(number, command, answer, cycle)?;
            if let (Some(path), Command::LoadJob { source, .. }) = (&self.next, command) {
                self.ports.asked_by = who(source);
                jobs::choose(self.config, path);
                // The next session tells it, when it has the job.
                return Ok(Turn::Left);
            }
        }
        let turn = self.judge_next(cycle)?;
        self.ports.state.send(self.ports.verdicts.writer().newest(), cycle)?;
        Ok(turn)
    }
}

impl Session<'_, '_> {
    /// The job that comes next; `None` when a stop was asked for.
    fn run(mut self, cycle: &mut Cycle<'_>) -> Result<Option<PathBuf>, RoleError> {
        cycle.run(&mut self)?;
        Ok(self.next)
    }

    fn judge_next(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        let Some(couples) = cycle.take(&mut self.ports.couples)? else { return Ok(Turn::Idle) };
        self.ports.state.took(couples.stamp.id());
        let Some(watched) = &mut self.watched else { return Ok(Turn::Idle) };
        if cycle.is_at_end() {
            watched.finish(self.ports, cycle)?;
        } else if !watched.is_meant_by(&couples) {
            // Where parts are met differs from job to job, and encode has not followed yet.
            return Ok(Turn::Idle);
        } else if self.ports.state.is_enabled() {
            watched.step(&wire::couples::read(&couples), self.ports, cycle)?;
        }
        Ok(Turn::Stepped)
    }

    fn obey(&mut self, command: Command, cycle: &mut Cycle<'_>) -> Result<Result<(), Refusal>, RoleError> {
        let state = &mut self.ports.state;
        match (command, &mut self.watched) {
            (Command::Enable, _) => state.enable(true),
            (Command::Disable, watched) => {
                state.enable(false);
                // Nobody says that the piece will not be completed: it is only not watched any more.
                if let Some(watched) = watched {
                    watched.break_off(self.ports, cycle)?;
                }
            }
            (Command::Start, None) => return Ok(Err(Refusal::NoJob)),
            (Command::Start, Some(_)) if !state.is_enabled() => {
                log!(code::COMMAND_REFUSED, "Start: the line is not enabled");
                return Ok(Err(Refusal::NotEnabled));
            }
            (Command::Start, Some(watched)) => watched.start(self.ports, cycle)?,
            (Command::Abort, None) => {}
            (Command::Abort, Some(watched)) => watched.finish(self.ports, cycle)?,
            (Command::SetPart { part, source }, _) => return Ok(state.set_part(part, source)),
            (Command::LoadJob { job_id, model_hash, source }, watched) => {
                if let Err(refusal) = state.may_load(source) {
                    log!(code::COMMAND_REFUSED, "job {job_id} is not loaded. {}", refusal.meaning());
                    return Ok(Err(refusal));
                }
                let found = match jobs::select(self.config, Wanted { job_id, model_hash }) {
                    Ok(found) => found,
                    Err(refusal) => return Ok(Err(refusal)),
                };
                // The one in force goes on as if nothing had been said.
                if state.has_job(job_id, found.model_hash) {
                    return Ok(Ok(()));
                }
                self.ports.is_between_jobs = watched.as_ref().is_some_and(Watched::is_between_jobs);
                // As where the judge is disabled: nobody says that the piece will not be completed.
                if let Some(watched) = watched {
                    watched.break_off(self.ports, cycle)?;
                }
                self.next = Some(found.path);
            }
        }
        Ok(Ok(()))
    }
}
