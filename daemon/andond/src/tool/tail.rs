//! `andond tail`: follows the verdicts of a running station.

use std::io::Write;
use std::time::Duration;

use andon_core::verdict::{Level, Outcome, Verdict};
use andon_host::config::Config;
use andon_host::exit::Code;
use andon_ipc::{Channel, Heartbeat, MonotonicTime, Reader, UtcTime, Wake};
use serde::Serialize;
use shm_schemas::{Health, RoleId, Verdict as Message};

use super::join::join;
use super::known_jobs::KnownJobs;
use super::{ToolError, running_config};
use crate::cli::{self, Tail};
use crate::clock::Clock;
use crate::outage::{Outage, Outages};
use crate::report::{NotWatchingLine, Teller, VerdictLine};
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
    let mut printer = Printer {
        arguments,
        known: KnownJobs::of(&config),
        config,
        clock: Clock::new(arguments.utc),
        teller: Teller::default(),
    };
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
                printer.tell_sight(change).map_err(ToolError::Print)?;
            }
            if let Some(outage) = outages.receive(&health) {
                printer.tell_outage(&outage).map_err(ToolError::Print)?;
            }
        }
        for outage in outages.look(MonotonicTime::now()) {
            printer.tell_outage(&outage).map_err(ToolError::Print)?;
        }
        while let Some(message) = verdicts.take()? {
            printer.print(&message).map_err(ToolError::Print)?;
        }
        if verdicts.lost() > lost {
            eprintln!("{} verdicts were not shown; `andond history` has them", verdicts.lost() - lost);
            lost = verdicts.lost();
        }
    }
}

struct Printer<'a> {
    arguments: &'a Tail,
    config: Config,
    known: KnownJobs,
    clock: Clock,
    teller: Teller,
}

impl Printer<'_> {
    fn print(&mut self, message: &Message) -> std::io::Result<()> {
        let verdict = wire::verdict::read(message);
        let Some(verdict) = verdict.filter(|verdict| is_wanted(self.arguments, verdict)) else {
            return Ok(());
        };
        // The file of a job that was loaded after this began.
        if self.known.of_hash(message.model_hash).is_none() {
            self.known = KnownJobs::of(&self.config);
        }
        let job = self.known.of_hash(message.model_hash).map(|known| &known.file);
        let names = self.known.names(message.model_hash);
        if self.arguments.json {
            let line = VerdictLine::new(message.stamp.seq, &verdict, &message.part, names, job);
            return print_json(&line);
        }
        let when = self.clock.time(message.decided_utc_ns);
        // Without colours where they are not wanted, or where this is no terminal.
        let mut out = anstream::stdout().lock();
        self.teller.tell(&when, &verdict, names).write(&mut out)?;
        out.flush()
    }

    /// Says once when the line stops seeing its bench, and once when it sees it again. People read it beside the verdicts, programs between them.
    fn tell_sight(&self, change: SightChange) -> std::io::Result<()> {
        if self.arguments.json {
            return print_json(&NotWatchingLine::of_sight(change, UtcTime::now()));
        }
        let now = self.clock.time_of(MonotonicTime::now());
        match change.now.and_then(sight::code) {
            Some(code) => eprintln!("{now} not watching: {}. {}", code.meaning, code.remedy),
            None => eprintln!("{now} watching again"),
        }
        Ok(())
    }

    /// Says when a role is down, and when it is back: from when to when nobody watched.
    fn tell_outage(&self, outage: &Outage) -> std::io::Result<()> {
        if self.arguments.json {
            return print_json(&NotWatchingLine::of_outage(outage));
        }
        let role = outage.role.name();
        let what = if outage.role.is_beside() { "" } else { "not watching " };
        let began = self.clock.time_of(outage.began);
        match outage.ended.map(|ended| self.clock.time_of(ended)) {
            None => eprintln!("{what}since {began}: {role} is down"),
            Some(ended) => eprintln!("{what}from {began} to {ended}: {}", outage.why()),
        }
        Ok(())
    }
}

/// One line, at once: programs wait for it.
fn print_json(line: &impl Serialize) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    serde_json::to_writer(&mut out, line)?;
    writeln!(out)?;
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
