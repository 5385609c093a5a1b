//! `plc`: verdicts to the PLC, once the journal has them, and the PLC's commands to the judge.
//!
//! A result that was sent before this role started is not offered: the PLC may have acknowledged it then. It is in the
//! journal.

mod clients;
mod line;

use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use andon_ipc::{Error, Node, Reader, Wake, Writer, monotonic_ns};
use andon_plc::handshake::{Ask, Fault, Line};
use andon_plc::modbus::{CommandSink, Config as Server, Counters, Event, ModbusServer, VerdictSource};
use andon_plc::registers::{Image, status};
use shm_schemas::{Command, CommandSource, Confirmed, Health, Verdict};

use super::{Pulse, RoleError, WAIT};
use crate::config::Config;
use crate::log::{code, log};
use clients::Clients;
use line::Watch;

/// How often the server is told how the line is when nothing changes: it counts a line as silent after 2 s.
const TELL_EVERY: Duration = Duration::from_millis(250);

/// A line that is not ready for so long is listened to anew. Where iceoryx2 0.10.0 fails once to connect a reader with a writer, as
/// with one that is killed while it comes up, it does not try again before another one comes or goes: a role that is well would stay
/// unheard. Twice as long as the longest beat is apart.
const LISTEN_ANEW: Duration = Duration::from_secs(1);

/// Runs until it is asked to stop.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    if !config.plc.enable {
        return rest(node);
    }
    let began = Instant::now();
    let server = ModbusServer::start(server_config(config))?;
    let stop = AtomicBool::new(false);
    let mut line = Events::open(node, config, server.counters(), &stop)?;
    let mut commands = Commands { writer: node.writer()? };
    log!(code::PLC_LISTENING, { address = %server.address() }, "Modbus TCP on {}", server.address());
    line.pulse.stepped(began.elapsed());
    server.run(&mut line, &mut commands, &stop);
    line.outcome
}

/// Without a PLC in the configuration there is nothing to do; the unit is there all the same, and healthy.
fn rest(node: &Node) -> Result<(), RoleError> {
    let mut pulse = Pulse::new(node)?;
    log!(code::PLC_OFF, "plc.enable is false: nothing listens");
    pulse.stepped(Duration::ZERO);
    while !node.stop().wait(WAIT) {
        pulse.beat()?;
    }
    Ok(())
}

fn server_config(config: &Config) -> Server {
    Server {
        bind: SocketAddr::new(config.plc.bind, config.plc.port),
        allowed_clients: config.plc.allow.clone(),
        writes: config.plc.writes,
        ..Server::default()
    }
}

/// What comes from the line, as the server asks for it.
struct Events<'a> {
    node: &'a Node,
    verdicts: Reader<Verdict>,
    confirmed: Reader<Confirmed>,
    health: Reader<Health>,
    watch: Watch,
    line: Line,
    told: Instant,
    /// Since when `health` has had the chance to hear everybody.
    listening: Instant,
    began_ns: u64,
    /// When the server was handed a verdict: its step.
    handed: Option<Instant>,
    clients: Clients,
    shown: u16,
    pulse: Pulse,
    stop: &'a AtomicBool,
    outcome: Result<(), RoleError>,
}

impl<'a> Events<'a> {
    fn open(
        node: &'a Node,
        config: &Config,
        counters: Arc<Counters>,
        stop: &'a AtomicBool,
    ) -> Result<Self, RoleError> {
        Ok(Self {
            node,
            verdicts: node.reader()?,
            confirmed: node.reader()?,
            health: node.reader()?,
            watch: Watch::new(config),
            line: Line::Starting,
            told: Instant::now(),
            listening: Instant::now(),
            began_ns: monotonic_ns(),
            handed: None,
            clients: Clients::new(counters),
            shown: 0,
            pulse: Pulse::new(node)?,
            stop,
            outcome: Ok(()),
        })
    }

    fn try_next(&mut self, wait: Duration) -> Result<Option<Event>, RoleError> {
        if let Some(handed) = self.handed.take() {
            self.pulse.stepped(handed.elapsed());
        }
        let wake = self.node.wait(&mut [&mut self.verdicts, &mut self.confirmed, &mut self.health], wait)?;
        match wake {
            Wake::Stop => self.stop.store(true, Ordering::Relaxed),
            Wake::WriterGone { .. } => self.watch.gone(monotonic_ns()),
            _ => (),
        }
        self.pulse.losses(self.verdicts.lost(), self.verdicts.restarts());
        self.clients.tell(&mut self.pulse);
        // This role works while its loop turns. A bench where nobody works gives no verdicts, and who of the others has gone, this role's
        // own predecessor among them, is `watch`'s to tell.
        self.pulse.beat()?;
        if let Some(line) = self.look()? {
            return Ok(Some(Event::Line(line)));
        }
        self.take()
    }

    /// How the line is, when that has changed or is due to be told.
    fn look(&mut self) -> Result<Option<Line>, Error> {
        while let Some(health) = self.health.take()? {
            self.watch.heard(&health);
        }
        let line = self.watch.line(monotonic_ns());
        if line == Line::Ready {
            self.listening = Instant::now();
        } else if self.listening.elapsed() > LISTEN_ANEW {
            self.health = self.node.reader()?;
            self.listening = Instant::now();
        }
        if line == self.line && self.told.elapsed() < TELL_EVERY {
            return Ok(None);
        }
        self.line = line;
        self.told = Instant::now();
        Ok(Some(line))
    }

    fn take(&mut self) -> Result<Option<Event>, RoleError> {
        while let Some(verdict) = self.verdicts.take()? {
            self.pulse.received(&verdict.stamp);
            if verdict.stamp.sent_ns >= self.began_ns {
                self.handed = Some(Instant::now());
                return Ok(Some(Event::Verdict(*verdict)));
            }
        }
        let confirmed = self.confirmed.take()?;
        Ok(confirmed
            .map(|message| Event::Confirmed { epoch: message.verdict_epoch, seq: message.verdict_seq }))
    }
}

impl VerdictSource for Events<'_> {
    fn next(&mut self, wait: Duration) -> Option<Event> {
        match self.try_next(wait) {
            Ok(event) => event,
            Err(error) => {
                self.outcome = Err(error);
                self.stop.store(true, Ordering::Relaxed);
                let detail = code::SERVICE_UNUSABLE.number;
                Some(Event::Line(Line::Fault { fault: Fault::Channel, detail }))
            }
        }
    }

    fn turned(&mut self, image: &Image) {
        let changed = image.status ^ self.shown;
        self.shown = image.status;
        if changed & status::READY != 0 {
            match (image.status & status::READY != 0, self.line) {
                (true, _) => log!(code::PLC_READY, "ready"),
                (false, Line::Fault { fault, detail }) => {
                    log!(code::PLC_NOT_READY, { detail }, "ready has dropped: {}", fault.meaning());
                }
                (false, _) => log!(code::PLC_NOT_READY, "ready has dropped: error {}", image.error),
            }
        }
        if changed & image.status & status::OVERRUN != 0 {
            log!(code::PLC_OVERRUN, "{} results are lost to the PLC; the journal has them", image.lost);
        }
    }
}

/// Where the PLC's commands go.
struct Commands {
    writer: Writer<Command>,
}

impl CommandSink for Commands {
    fn tell(&mut self, ask: &Ask) -> bool {
        let Ok(mut message) = self.writer.loan() else { return false };
        message.kind = ask.kind.code();
        message.source = CommandSource::Plc.code();
        message.job_id = ask.job_id;
        message.model_hash = ask.model_hash;
        message.argument = ask.argument;
        self.writer.send(message).is_ok()
    }
}
