//! `board`: what the line does, on pages for worker, technician and engineer.
//!
//! Nothing waits for it: the line goes on without it as before. What the pages show is made by the crate `andon-board`. This role feeds it with the
//! channels, the journal, the names in the job in force, and the clock. It writes no file: what somebody who has logged in asks for goes over a channel
//! to the role that may do it, `journal` or `executor`.
//!
//! As in `metrics`, the server reads and writes in a thread of its own, and the loop answers. A disk may be slow, so the journal and clips are read in
//! threads as well, and passwords are compared in one.

mod camera;
mod confirm;
mod door;
mod engineer;
mod films;
mod past;
mod seen;
mod trail;

use std::net::SocketAddr;
use std::path::Path;
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use andon_board::{Board, Clips, Code, Inbox, Job, Line, Said, Settings, Stop, Tables};
use andon_host::config::{Config, RecordMode};
use andon_host::log::{code, log};
use andon_host::role::{Cycle, Role, Turn};
use andon_http::{Offer, Server};
use andon_ipc::{MonotonicTime, Node, Port, Reader, Wake};
use andon_plc::handshake::{Fault, Line as PlcLine};
use andon_record::store;
use camera::Camera;
use confirm::Confirmer;
use door::Door;
use engineer::Engineer;
use films::Films;
use jiff::{Timestamp, Zoned};
use past::PastReader;
use shm_schemas::{Health, Judging, Verdict};
use trail::Trail;

use super::audit::Auditor;
use super::line::LineHealth;
use super::{RoleError, disabled, jobs};
use crate::clock::Clock;
use crate::report::code_of;
use crate::{boards, step_pictures, wire};

/// The longest wait: a browser waits no longer than this to be answered. A verdict ends the wait.
const TURN: Duration = Duration::from_millis(50);

/// How often it looks whether a process has gone of which nobody tells: the steward, which tells of the others.
const LOOK: Duration = Duration::from_millis(250);

/// How often it looks for new clips while somebody looks at the events.
const LOOK_FOR_CLIPS: Duration = Duration::from_secs(5);

/// A line that starts for so long does not watch, and the worker must know. The models of `perceive` are loaded in less.
const STARTS: Duration = Duration::from_secs(10);

/// Runs until it is asked to stop.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    let mut cycle = Cycle::new(node)?;
    if config.board.enable {
        let mut role = Pages::open(&mut cycle, config)?;
        cycle.run(&mut role)
    } else {
        log!(code::BOARD_OFF, "board.enable is false: nothing listens");
        disabled::run(&mut cycle)
    }
}

struct Pages<'c> {
    config: &'c Config,
    server: Server,
    board: Board,
    verdicts: Reader<Verdict>,
    judging: Reader<Judging>,
    health: Reader<Health>,
    inbox: Inbox,
    past: PastReader,
    camera: Camera,
    films: Films,
    trail: Trail,
    door: Door,
    confirmer: Confirmer,
    engineer: Engineer,
    line: LineHealth,
    /// Since when the line starts.
    starting: Option<Instant>,
    /// The hash of the job whose names are shown; `None` before the judge has said one.
    job: Option<u64>,
    looked: Option<Instant>,
    looked_for_clips: Option<Instant>,
    /// Looks for clips now.
    search: Option<JoinHandle<Clips>>,
}

impl Role for Pages<'_> {
    type Error = RoleError;
    const INPUT_IS_STEADY: bool = false;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        let own: [&mut dyn Port; 3] = [&mut self.verdicts, &mut self.judging, &mut self.health];
        let asked = self.confirmer.ports().into_iter().chain(self.engineer.ports());
        own.into_iter().chain(self.camera.ports()).chain(asked).collect()
    }

    fn patience(&self) -> Duration {
        TURN
    }

    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        let now = MonotonicTime::now();
        if matches!(cycle.wake(), Wake::WriterGone { .. }) {
            self.line.departed(now);
        }
        self.take(now)?;
        self.take_health()?;
        self.look(now);
        if let Some(picture) = self.camera.look(cycle.node(), self.board.wants_picture())? {
            self.board.picture(&picture);
        }
        self.door.turn(&mut self.board);
        self.confirmer.turn(cycle, &mut self.board)?;
        if self.engineer.turn(cycle, &mut self.board)? {
            // They are read again with the next word of the judge.
            self.job = None;
        }
        self.films.turn(&mut self.board);
        self.trail.turn(&mut self.board);
        self.board.publish(now.nanoseconds());
        let board = &mut self.board;
        self.server.serve(|request| board.answer(request));
        Ok(Turn::Idle)
    }
}

impl<'c> Pages<'c> {
    /// A server that listens is the first step: readiness must not wait for a worker.
    fn open(cycle: &mut Cycle<'_>, config: &'c Config) -> Result<Self, RoleError> {
        let began = Instant::now();
        let settings = settings(config)?;
        let address = SocketAddr::new(config.board.bind, config.board.port);
        let (tls, logins) = boards::check(config)?;
        let offer = Offer { tls, takes_forms: true };
        let scheme = if offer.tls.is_some() { "https" } else { "http" };
        let failed = |source| RoleError::Board { address, source };
        let server = Server::bind_with(address, offer).map_err(failed)?;
        let mut board = Board::new(settings);
        board.logins(logins.logins.clone());
        let door = Door::open(logins).map_err(failed)?;
        let node = cycle.node();
        let role = Self {
            config,
            server,
            board,
            verdicts: node.reader()?,
            judging: node.reader()?,
            health: node.reader()?,
            inbox: Inbox::default(),
            past: PastReader::new(config.journal_path()),
            camera: Camera::new(config),
            door,
            confirmer: Confirmer::new(config.journal_path(), Auditor::open(node)?, node.reader()?),
            engineer: Engineer::open(node, config)?,
            films: Films::new(config),
            trail: Trail::new(config.journal_path()),
            line: LineHealth::new(config),
            starting: None,
            job: None,
            looked: None,
            looked_for_clips: None,
            search: None,
        };
        log!(code::BOARD_LISTENING, { address = %address }, "the board at {scheme}://{address}/");
        cycle.stepped(began);
        Ok(role)
    }

    /// Takes everything that the judge has said until now, in the order in which it said it.
    fn take(&mut self, now: MonotonicTime) -> Result<(), RoleError> {
        while let Some(verdict) = self.verdicts.take()? {
            self.inbox.put(Said::Verdict(Box::new(*verdict)));
        }
        while let Some(judging) = self.judging.take()? {
            self.inbox.put(Said::Judging(Box::new(*judging)));
        }
        for said in self.inbox.take_until(now.nanoseconds()) {
            match said {
                Said::Verdict(verdict) => self.board.verdict(&verdict),
                Said::Judging(judging) => self.judging(&judging),
            }
        }
        Ok(())
    }

    fn judging(&mut self, judging: &Judging) {
        if self.job != Some(judging.model_hash) {
            self.job = Some(judging.model_hash);
            self.board.job(names(self.config, judging));
        }
        self.board.judging(judging);
    }

    /// Takes everything that the roles have said of themselves.
    fn take_health(&mut self) -> Result<(), RoleError> {
        while let Some(health) = self.health.take()? {
            self.line.received(&health);
            self.board.health(&health);
        }
        Ok(())
    }

    /// Looks how the line is, which day it is, what was before it, and which clips there are.
    fn look(&mut self, now: MonotonicTime) {
        if is_due(&mut self.looked, LOOK) {
            self.line.departed(now);
            self.board.clock(nanoseconds(Timestamp::now()), midnight_utc_ns());
        }
        if let Some(past) = self.past.take() {
            self.board.past(&past);
        }
        let line = self.line.line(now);
        let line = self.shown(line);
        // A judge without a job is always starting, which says nothing to anybody.
        let cause = self.line.culprit().filter(|_| line != Line::NoJob);
        self.board.line(line, cause);
        self.look_for_clips();
    }

    /// Begins to look for clips where somebody looks at the events, and takes what was found.
    fn look_for_clips(&mut self) {
        // Where a search was broken off, the next one finds what it would have found.
        if let Some(Ok(found)) = self.search.take_if(|search| search.is_finished()).map(JoinHandle::join) {
            self.board.clips(found);
        }
        let records = self.config.record.mode != RecordMode::Off && self.board.is_looked_through();
        if records && self.search.is_none() && is_due(&mut self.looked_for_clips, LOOK_FOR_CLIPS) {
            let folder = self.config.recordings();
            // Without a thread there are no clips this time.
            self.search = Builder::new().name("clips".into()).spawn(move || clips(&folder)).ok();
        }
    }

    /// The line as the worker is told of it.
    fn shown(&mut self, line: PlcLine) -> Line {
        if line != PlcLine::Starting {
            self.starting = None;
        }
        match line {
            PlcLine::Ready => Line::Ready,
            PlcLine::Starting if self.line.has_ended() => Line::Stopped(Stop::Ended),
            PlcLine::Starting if self.line.has_idle_judge() && self.board.has_no_job() => Line::NoJob,
            PlcLine::Starting => {
                let since = self.starting.get_or_insert_with(Instant::now);
                if since.elapsed() < STARTS { Line::Starting } else { Line::Stopped(Stop::Role) }
            }
            PlcLine::Fault { fault, .. } => Line::Stopped(match (fault, self.line.trouble()) {
                (Fault::Sight, Some(sight)) => Stop::Sight(sight),
                (Fault::Camera, _) => Stop::Camera,
                (Fault::Journal, _) => Stop::Journal,
                _ => Stop::Role,
            }),
        }
    }
}

/// Whether it is time to look again, and if so, that it was looked now.
fn is_due(looked: &mut Option<Instant>, period: Duration) -> bool {
    let is_due = looked.is_none_or(|looked| looked.elapsed() >= period);
    if is_due {
        *looked = Some(Instant::now());
    }
    is_due
}

fn settings(config: &Config) -> Result<Settings, RoleError> {
    let shipped = Tables::shipped();
    let tables = match &config.board.words {
        Some(folder) => shipped.with_folder(folder)?,
        None => shipped,
    };
    tables.must_have(&config.board.language)?;
    Ok(Settings {
        station: config.station.name.clone(),
        bind: config.board.bind,
        port: config.board.port,
        hosts: config.board.hosts.clone(),
        is_secure: config.board.certificate.is_some(),
        tables,
        language: config.board.language.clone(),
        picture: config.board.picture,
        is_look: false,
        takes_orders: config.executor.enable,
        films: std::path::absolute(config.films()).unwrap_or_else(|_| config.films()).display().to_string(),
        roles: config.roles(),
        codes: code::ALL.iter().map(|code| told(code)).collect(),
        code_of: |verdict| code_of(&wire::verdict::read(verdict)?).map(|code| code.number),
        local_time: |utc_ns| Clock::new(false).date_time(utc_ns),
    })
}

/// A code as `andond explain` tells of it.
fn told(code: &andon_host::log::Code) -> Code {
    Code {
        number: code.number,
        name: code.name,
        level: code.level.to_string(),
        group: code::group(code.number),
        meaning: code.meaning,
        remedy: code.remedy,
    }
}

/// The names in the job in force; those of the parts alone where there is none.
fn names(config: &Config, judging: &Judging) -> Job {
    match jobs::file_in_force(config, judging) {
        Ok(Some((path, file))) => with_pictures(engineer::names(&file), step_pictures::read(&path, &file)),
        // The role judge says what is wrong with the file of its job.
        _ => Job {
            parts: config.objects.iter().map(|object| (object.id, object.name.clone())).collect(),
            ..Job::default()
        },
    }
}

fn with_pictures(mut job: Job, pictures: Vec<Option<Vec<u8>>>) -> Job {
    for (step, picture) in job.steps.iter_mut().zip(pictures) {
        step.picture = picture;
    }
    job
}

/// The clips that there are. Where the folder cannot be read, the role `record` says so.
fn clips(folder: &Path) -> Clips {
    let recordings = store::indexed(folder).unwrap_or_default();
    Clips::new(store::by_verdict(&recordings).into_keys())
}

/// When this day began on the clocks here.
fn midnight_utc_ns() -> u64 {
    let now = Zoned::now();
    nanoseconds(now.start_of_day().unwrap_or(now).timestamp())
}

fn nanoseconds(time: Timestamp) -> u64 {
    u64::try_from(time.as_nanosecond()).unwrap_or_default()
}
