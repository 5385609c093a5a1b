//! `plc`: the journal's verdicts to the PLC, and the PLC's commands to the judge.
//!
//! What the PLC has been told is an account that the journal keeps. Each start of this role goes on where the last one ended.

mod account;
mod clients;

use std::net::SocketAddr;
use std::time::{Duration, Instant};

use andon_host::config::Config;
use andon_host::log::{code, log};
use andon_host::role::{Cycle, Output, Role, Turn};
use andon_ipc::{MonotonicTime, Node, Port, Reader, Wake, Writer};
use andon_plc::handshake::{Line, LineCommand};
use andon_plc::modbus::{Config as Server, ModbusServer};
use andon_plc::registers::{Image, status};
use shm_schemas::{AuditKind, Command, CommandSource, Health, Judging};

use super::RoleError;
use super::audit::Auditor;
use super::disabled;
use super::line::LineHealth;
use account::Account;
use clients::Clients;

/// The longest wait: a command of a client waits no longer than this to be passed on.
const TURN: Duration = Duration::from_millis(20);

/// Runs until it is asked to stop.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    let mut cycle = Cycle::new(node)?;
    if config.plc.enable {
        // The port may be taken by what is about to end.
        let Some(server) =
            cycle.until_open(|| ModbusServer::start(server_config(config)).map_err(RoleError::from))?
        else {
            return Ok(());
        };
        let mut role = Plc::open(server, &mut cycle, config)?;
        cycle.run(&mut role)
    } else {
        log!(code::PLC_OFF, "plc.enable is false: nothing listens");
        disabled::run(&mut cycle)
    }
}

struct Plc {
    server: ModbusServer,
    clients: Clients,
    commands: Output<Writer<Command>>,
    auditor: Auditor,
    account: Account,
    judging: Reader<Judging>,
    health: Reader<Health>,
    line_health: LineHealth,
    line: Line,
    /// The status word that was last on the registers.
    status: u16,
}

impl Role for Plc {
    type Error = RoleError;
    const INPUT_IS_STEADY: bool = false;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        let mut ports: Vec<&mut dyn Port> = self.account.ports().into();
        ports.extend([self.commands.port(), self.auditor.port(), &mut self.judging, &mut self.health]);
        ports
    }

    fn patience(&self) -> Duration {
        TURN
    }

    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        // It may be its own predecessor that has departed: the health of the roles shows that.
        if let Wake::WriterGone { .. } = cycle.wake() {
            self.line_health.departed(MonotonicTime::now());
        }
        self.clients.log(cycle.liveness());
        for write in self.server.writes() {
            for what in write.commands() {
                self.auditor.record(cycle, AuditKind::Command, &write.client.to_string(), &what)?;
            }
        }
        self.watch_line()?;
        while let Some(judging) = self.judging.take()? {
            self.server.handshake(|handshake, now_ns| handshake.judging(&judging, now_ns));
        }
        let turn = self.account.receive(&self.server, cycle)?;
        self.server.handshake(|handshake, now_ns| handshake.tick(self.line, now_ns));
        self.account.send(&self.server, cycle)?;
        self.pass_command_on(cycle)?;
        let image = self.server.handshake(|handshake, now_ns| handshake.image(now_ns));
        self.log_changes(&image);
        Ok(turn)
    }
}

impl Plc {
    /// A server that listens is the first step: readiness must not wait for a worker.
    fn open(server: ModbusServer, cycle: &mut Cycle<'_>, config: &Config) -> Result<Self, RoleError> {
        let began = Instant::now();
        let node = cycle.node();
        let role = Self {
            clients: Clients::new(server.counters()),
            commands: Output::new(node.writer()?, &[]),
            auditor: Auditor::open(node)?,
            account: Account::open(node)?,
            judging: node.reader()?,
            health: node.reader()?,
            line_health: LineHealth::new(config),
            line: Line::Starting,
            status: 0,
            server,
        };
        let address = role.server.address();
        log!(code::PLC_LISTENING, { address = %address }, "Modbus TCP on {address}");
        cycle.stepped(began);
        Ok(role)
    }

    /// Finds the state of the line by the health of its roles.
    fn watch_line(&mut self) -> Result<(), RoleError> {
        while let Some(health) = self.health.take()? {
            self.line_health.received(&health);
        }
        self.line = self.line_health.line(MonotonicTime::now());
        Ok(())
    }

    /// Passes on what clients ask for, and what the judge must be given again.
    fn pass_command_on(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        match self.server.handshake(|handshake, now_ns| handshake.next_command(now_ns)) {
            Some(command) => Ok(self.commands.send(cycle, |message| write_command(&command, message))?),
            None => Ok(()),
        }
    }

    fn log_changes(&mut self, image: &Image) {
        let changed = image.status ^ std::mem::replace(&mut self.status, image.status);
        if changed & status::READY != 0 {
            match (image.status & status::READY != 0, self.line) {
                (true, _) => log!(code::PLC_READY, "ready"),
                (false, Line::Fault { detail, .. }) => {
                    log!(code::PLC_NOT_READY, { detail }, "ready has dropped: {}", self.line_health.cause());
                }
                (false, _) => {
                    let why = self.server.handshake(|handshake, now_ns| handshake.obstacle(now_ns));
                    // It may have gone again between the two looks.
                    log!(code::PLC_NOT_READY, "ready has dropped: {}", why.unwrap_or("for a moment"));
                }
            }
        }
        if changed & image.status & status::OVERRUN != 0 {
            log!(code::PLC_OVERRUN, "{} results are lost to the PLC since the journal was begun", image.lost);
        }
    }
}

fn server_config(config: &Config) -> Server {
    Server {
        bind: SocketAddr::new(config.plc.bind, config.plc.port),
        allowed_clients: config.plc.allow.clone(),
        writes: config.plc.writes,
        commanders: config.plc.commanders().to_vec(),
        word_order: config.plc.word_order,
        ..Server::default()
    }
}

fn write_command(command: &LineCommand, message: &mut Command) {
    message.number = command.number;
    message.kind = command.kind.code();
    message.job_id = command.job_id;
    message.model_hash = command.model_hash;
    message.part = command.part;
    message.source = CommandSource::Plc.code();
}
