//! `andond tail`: follows the verdicts of a running station.

use std::io::{ErrorKind, IsTerminal, Write, stdout};
use std::time::Duration;

use andon_core::verdict::{Level, Outcome, Verdict};
use andon_ipc::{Channel, Heartbeat, MonotonicTime, Reader, UtcTime, Wake};
use shm_schemas::{Health, RoleId, Verdict as Message};

use super::join::join;
use super::{ToolError, job, running_config};
use crate::cli::{self, Tail};
use crate::config::Config;
use crate::exit::Code;
use crate::outage::{Outage, Outages};
use crate::report::{Names, VerdictLine, verdict_sentence};
use crate::sight::{self, SightChange, SightChanges};
use crate::wire;

/// A role that falls silent is reported within this time after its deadline.
const WAIT: Duration = Heartbeat::PERIOD;

/// Runs the command until it is interrupted or the reader of its output is gone. It begins with the newest verdicts that
/// the channel still has.
///
/// # Errors
/// What is missing, or that the station cannot be joined.
pub fn run(arguments: &Tail) -> Result<Code, ToolError> {
    let config = running_config(&arguments.config)?.config;
    let node = join(&config)?;
    let mut outages = Outages::new(&config, RoleId::Tool);
    let mut verdicts: Reader<Message> = node.reader()?;
    let mut health: Reader<Health> = node.reader()?;
    let mut sight = SightChanges::default();
    let names = names(&config);
    let mut lost = 0;
    loop {
        match node.wait(&mut [&mut verdicts, &mut health], WAIT)? {
            Wake::Stop => return Ok(Code::Stopped),
            Wake::WriterGone { channel: Channel::Verdict, .. } => {
                eprintln!("the judge has gone; waiting for the next one")
            }
            _ => (),
        }
        while let Some(health) = health.take()? {
            if let Some(change) = sight.receive(&health) {
                tell_sight(change);
            }
            if let Some(outage) = outages.receive(&health) {
                tell_outage(&outage);
            }
        }
        outages.look(MonotonicTime::now()).iter().for_each(tell_outage);
        while let Some(message) = verdicts.take()? {
            if let Err(error) = print(arguments, &message, &names) {
                // The reader has seen enough, as `head` does.
                let is_over = error.kind() == ErrorKind::BrokenPipe;
                return if is_over { Ok(Code::Stopped) } else { Err(ToolError::Print(error)) };
            }
        }
        if verdicts.lost() > lost {
            eprintln!("{} verdicts were not shown; `andond history` has them", verdicts.lost() - lost);
            lost = verdicts.lost();
        }
    }
}

/// Says once when the line stops seeing its bench, and once when it sees it again. Not among the verdicts, which programs read.
fn tell_sight(change: SightChange) {
    match change.now.and_then(sight::code) {
        Some(code) => eprintln!("not watching: {}. {}", code.meaning, code.remedy),
        None => eprintln!("watching again"),
    }
}

/// Says when a role is down, and when it is back: from when to when nobody watched.
fn tell_outage(outage: &Outage) {
    let role = outage.role.name();
    let is_beside = matches!(outage.role, RoleId::Steward | RoleId::Journal | RoleId::Plc);
    let what = if is_beside { "" } else { "not watching " };
    match outage.ended {
        None => eprintln!("{what}since {}: {role} is down", clock(outage.began)),
        Some(ended) => {
            eprintln!("{what}from {} to {}: {}", clock(outage.began), clock(ended), outage.why());
        }
    }
}

/// The UTC time of day at which the monotonic clock showed this.
fn clock(then: MonotonicTime) -> String {
    let utc_ns = UtcTime::at(then).nanoseconds();
    jiff::Timestamp::from_nanosecond(utc_ns.into())
        .map_or_else(|_| utc_ns.to_string(), |time| time.strftime("%H:%M:%S UTC").to_string())
}

/// What the job of the station calls its steps and objects; without it, what the configuration calls the objects.
fn names(config: &Config) -> Names {
    let job = config.station.job.as_deref().and_then(|path| job::load(path).ok());
    job.map_or_else(|| objects(config), |job| Names::of_job(&job))
}

fn objects(config: &Config) -> Names {
    Names::new(config.objects.iter().map(|object| (object.id, object.name.clone())))
}

fn print(arguments: &Tail, message: &Message, names: &Names) -> std::io::Result<()> {
    let Some(verdict) = wire::verdict::read(message).filter(|verdict| is_wanted(arguments, verdict)) else {
        return Ok(());
    };
    let mut out = stdout().lock();
    if arguments.json {
        serde_json::to_writer(
            &mut out,
            &VerdictLine::new(message.stamp.seq, &verdict, &message.part, names),
        )?;
        writeln!(out)?;
    } else {
        let sentence = verdict_sentence(&verdict, names);
        match colour(&verdict).filter(|_| out.is_terminal()) {
            Some(colour) => writeln!(out, "\x1b[{colour}m{sentence}\x1b[0m")?,
            None => writeln!(out, "{sentence}")?,
        }
    }
    out.flush()
}

fn is_wanted(arguments: &Tail, verdict: &Verdict) -> bool {
    let level = match verdict.level {
        Level::Iu => cli::Level::Iu,
        Level::Activity => cli::Level::Activity,
        Level::Job => cli::Level::Job,
    };
    let is_wanted_outcome = !arguments.nok || verdict.outcome != Outcome::Ok;
    is_wanted_outcome && arguments.level.is_none_or(|wanted| wanted == level)
}

/// Red for an anomaly, yellow for what could not be judged, green for a job that is right.
fn colour(verdict: &Verdict) -> Option<u8> {
    match verdict.outcome {
        Outcome::Anomaly => Some(31),
        Outcome::NotJudged => Some(33),
        Outcome::Ok => (verdict.level == Level::Job).then_some(32),
    }
}
