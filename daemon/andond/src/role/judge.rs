//! `judge`: feature couples to verdicts, by the taught job.

use std::path::{Path, PathBuf};
use std::time::Instant;

use andon_core::anomaly;
use andon_core::dtw::OnlineDtw;
use andon_core::job::Job;
use andon_core::verdict::{Kind, Reason, Verdict as CoreVerdict};
use andon_ipc::{Node, Reader, Wake, Writer, utc_ns};
use andon_learn::job_file::JobFile;
use shm_schemas::{Command as CommandMessage, Couples, RoleId, Stamp, Verdict, flag};

use super::job::JobWatch;
use super::{Pulse, RoleError, WAIT};
use crate::config::Config;
use crate::fit;
use crate::log::{code, log};
use crate::report::{Names, verdict_sentence};
use crate::wire::command::Command;
use crate::wire::verdict::{Sender, station_name};
use crate::wire::{self};

/// Runs until it is asked to stop. A job that is loaded is watched in a session of its own.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    let mut line = Line {
        node,
        couples: node.reader()?,
        commands: node.reader()?,
        verdicts: node.writer()?,
        pulse: Pulse::new(node)?,
        paced: false,
    };
    let mut job = config.station.job.clone();
    loop {
        let next = match &job {
            Some(path) => watch(&mut line, config, path)?,
            None => {
                log!(code::NO_JOB, "no job is selected");
                line.idle()?
            }
        };
        match next {
            Next::Stop => return Ok(()),
            Next::Load { job_id, model_hash } => job = select(config, job_id, model_hash, job),
        }
    }
}

/// Why a session ended.
enum Next {
    Stop,
    Load { job_id: u32, model_hash: u64 },
}

struct Line<'a> {
    node: &'a Node,
    couples: Reader<Couples>,
    commands: Reader<CommandMessage>,
    verdicts: Writer<Verdict>,
    pulse: Pulse,
    paced: bool,
}

/// Reads a job file.
fn load(path: &Path) -> Result<JobFile, RoleError> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path)
        .map_err(|error| RoleError::Job { path: name.clone(), reason: error.to_string() })?;
    Ok(JobFile::parse(&name, &bytes)?)
}

/// Looks for the job that the PLC names. What does not fit leaves the old one in force.
fn select(config: &Config, job_id: u32, model_hash: u64, running: Option<PathBuf>) -> Option<PathBuf> {
    let folder = &config.station.jobs;
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let fits = |path: &PathBuf| {
        load(path).is_ok_and(|file| {
            let wanted = file.id == job_id && (model_hash == 0 || file.model_hash() == model_hash);
            wanted && fit::station(&file, config).is_ok()
        })
    };
    match files.filter(|path| path.extension().is_some_and(|ending| ending == "toml")).find(fits) {
        Some(path) => Some(path),
        None => {
            log!(
                code::JOB_REFUSED,
                "no job {job_id} of the wanted version that fits this station in {}",
                folder.display()
            );
            running
        }
    }
}

fn watch(line: &mut Line<'_>, config: &Config, path: &Path) -> Result<Next, RoleError> {
    let file = load(path)?;
    fit::station(&file, config)
        .map_err(|reason| RoleError::Job { path: path.display().to_string(), reason })?;
    let sender = Sender {
        job_id: file.id,
        model_hash: file.model_hash(),
        station: station_name(&config.station.name),
    };
    log!(code::JOB_LOADED, { job = %path.display() }, "watching the job {:?} ({})", file.name, path.display());
    let names = Names::new(file.objects.iter().map(|object| (object.shape.id, object.name.clone())));
    file.with_job(|job| {
        let session = Session {
            line,
            job,
            file: &file,
            sender,
            names,
            judge: judge(job, &file)?,
            enabled: true,
            watch: JobWatch::default(),
            newest: Stamp::default(),
        };
        session.run()
    })
}

/// A judge with as much memory as its job needs.
type Judge<'j> = anomaly::Judge<'j, Vec<OnlineDtw<'j>>>;

fn judge<'j>(job: &'j Job<'j>, file: &JobFile) -> Result<Judge<'j>, RoleError> {
    Judge::with_memory(job, file.method).map_err(|error| RoleError::Method(format!("{error:?}")))
}

impl Line<'_> {
    /// What a message asks of the judge. One that is no command is counted and told.
    fn command(&mut self, message: &CommandMessage) -> Option<Command> {
        match wire::command::read(message) {
            Ok(command) => command,
            Err(unknown) => {
                self.pulse.refused();
                log!(code::COMMAND_REFUSED, "{unknown}");
                None
            }
        }
    }

    /// Without a job nothing is judged; only commands count.
    fn idle(&mut self) -> Result<Next, RoleError> {
        loop {
            let wake =
                self.node.wait(&mut [&mut self.couples, &mut self.commands, &mut self.verdicts], WAIT)?;
            if wake == Wake::Stop {
                return Ok(Next::Stop);
            }
            while self.couples.take()?.is_some() {}
            while let Some(message) = self.commands.take()? {
                match self.command(&message) {
                    Some(Command::LoadJob { job_id, model_hash }) => {
                        return Ok(Next::Load { job_id, model_hash });
                    }
                    Some(Command::Start) => log!(code::COMMAND_REFUSED, "Start: no job is loaded"),
                    _ => (),
                }
            }
            self.pulse.beat_after(&wake)?;
        }
    }
}

/// One job being watched.
struct Session<'s, 'l, 'j> {
    line: &'s mut Line<'l>,
    job: &'j Job<'j>,
    file: &'s JobFile,
    sender: Sender,
    names: Names,
    judge: Judge<'j>,
    enabled: bool,
    watch: JobWatch,
    newest: Stamp,
}

impl Session<'_, '_, '_> {
    fn run(mut self) -> Result<Next, RoleError> {
        loop {
            let line = &mut *self.line;
            let wake =
                line.node.wait(&mut [&mut line.couples, &mut line.commands, &mut line.verdicts], WAIT)?;
            if wake == Wake::Stop {
                return Ok(Next::Stop);
            }
            while let Some(message) = self.line.commands.take()? {
                if let Some(next) = self.obey(&message)? {
                    return Ok(next);
                }
            }
            while let Some(couples) = self.line.couples.take()? {
                self.step(&couples)?;
            }
            let (lost, restarts) = (self.line.couples.lost(), self.line.couples.restarts());
            self.line.pulse.losses(lost, restarts);
            self.line.pulse.beat_after(&wake)?;
        }
    }

    fn obey(&mut self, message: &CommandMessage) -> Result<Option<Next>, RoleError> {
        let Some(command) = self.line.command(message) else { return Ok(None) };
        log!(code::COMMAND, "{command:?}");
        match command {
            Command::Enable => self.enabled = true,
            Command::Disable => {
                self.finish()?;
                self.enabled = false;
            }
            Command::Start => {
                self.judge_with(|judge, emit| judge.start(&mut |verdict| emit(verdict)))?;
                self.watch.commanded(true);
                self.tell_start();
            }
            Command::Abort => self.finish()?,
            Command::LoadJob { job_id, model_hash } => {
                self.finish()?;
                return Ok(Some(Next::Load { job_id, model_hash }));
            }
        }
        Ok(None)
    }

    fn step(&mut self, couples: &Couples) -> Result<(), RoleError> {
        let began = Instant::now();
        self.newest = couples.stamp;
        self.line.pulse.received(&couples.stamp);
        let paced = couples.flags & flag::PACED != 0;
        if paced != self.line.paced {
            self.line.paced = paced;
            self.line.verdicts.follow(if paced { &[RoleId::Journal] } else { &[] });
        }
        if couples.flags & flag::END_OF_STREAM != 0 {
            self.finish()?;
            self.line.pulse.finished();
        } else if self.enabled {
            let couples = wire::couples::read(couples);
            if self.watch.begins(&couples) {
                self.tell_start();
            }
            let ended = self.judge_with(|judge, emit| judge.step(&couples, &mut |verdict| emit(verdict)))?;
            if ended && self.watch.ended() {
                self.tell_start();
            }
        }
        self.line.pulse.stepped(began.elapsed());
        Ok(())
    }

    /// Ends the job; what comes next belongs to a new one.
    fn finish(&mut self) -> Result<(), RoleError> {
        self.judge_with(|judge, emit| judge.finish(&mut |verdict| emit(verdict)))?;
        self.judge = judge(self.job, self.file)?;
        self.watch.commanded(false);
        Ok(())
    }

    fn tell_start(&self) {
        log!(code::JOB_STARTED, "the job {:?} has begun", self.file.name);
    }

    /// Lets the judge say something, and publishes it. Whether the job has ended.
    fn judge_with(
        &mut self,
        act: impl FnOnce(&mut Judge<'_>, &mut dyn FnMut(CoreVerdict)),
    ) -> Result<bool, RoleError> {
        let (mut outcome, mut ended) = (Ok(()), false);
        let Self { line, judge, sender, names, newest, .. } = self;
        act(judge, &mut |verdict| {
            if outcome.is_ok() {
                ended |= matches!(verdict.kind, Kind::JobOk | Kind::JobAnomaly);
                tell(&verdict, names);
                outcome = publish(line, sender, newest, &verdict);
            }
        });
        outcome.map(|()| ended)
    }
}

fn publish(
    line: &mut Line<'_>,
    sender: &Sender,
    rests_on: &Stamp,
    verdict: &CoreVerdict,
) -> Result<(), RoleError> {
    super::wait_for_room(line.node, &mut line.verdicts, &mut line.pulse)?;
    let mut message = line.verdicts.loan()?;
    message.follow(rests_on);
    wire::verdict::write(verdict, sender, utc_ns(), &mut message);
    line.verdicts.send(message)?;
    line.pulse.sent();
    Ok(())
}

/// What a technician reads: jobs and anomalies, each IU only on request.
fn tell(verdict: &CoreVerdict, names: &Names) {
    let sentence = verdict_sentence(verdict, names);
    match verdict.kind {
        Kind::IuOk | Kind::ActivityOk => tracing::debug!("{sentence}"),
        Kind::JobOk => log!(code::JOB_OK, "{sentence}"),
        Kind::JobAnomaly => log!(code::JOB_ANOMALY, "{sentence}"),
        Kind::IuAnomaly | Kind::ActivityAnomaly => log!(code::ACTIVITY_ANOMALY, "{sentence}"),
        Kind::NotJudged if verdict.reason == Reason::Overload => log!(code::OVERLOAD, "{sentence}"),
        Kind::NotJudged => log!(code::NOT_JUDGED, "{sentence}"),
    }
}
