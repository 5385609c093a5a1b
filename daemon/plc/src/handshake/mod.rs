//! The handshake with the PLC: a pure state machine without IO and without a clock.
//!
//! Verdicts, confirmations of the journal, the state of the line and what clients write go in, each with its time in
//! nanoseconds since any moment. What the registers show and the commands for the line come out.
//!
//! - `results`: how a result gets to the PLC, and when it gives way to the next one;
//! - `commands`: the control block, and the answers to its commands;
//! - this file: `ready`, `busy`, the latched fault and the heartbeat, which depend on both.

mod commands;
mod fault;
mod queue;
mod results;

use shm_schemas::{CommandKind, Verdict, VerdictLevel};

pub use commands::LineCommand;
pub use fault::{Fault, Line};
pub use queue::QUEUE;

use crate::registers::{Control, Image, control, status};
use commands::Commands;
use results::{Release, Results};

const MS: u64 = 1_000_000;
/// The heartbeat moves this often: a PLC that looks once per second sees at least three moves.
const BEAT_NS: u64 = 250 * MS;
/// A loop that has not turned for this long is dead: it turns every 20 ms.
const LOOP_DEADLINE_NS: u64 = 500 * MS;
/// A journal that needs longer than this for one row is broken: a slow disk syncs in 50 ms.
const CONFIRM_DEADLINE_NS: u64 = 2_000 * MS;

/// What does not change while the role runs.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Whether clients may write. If not, nothing can be acknowledged: see `hold_ns`.
    pub writes: bool,
    /// Without writes, how long a result is offered before the next one takes its place.
    pub hold_ns: u64,
}

/// The state machine.
#[derive(Debug)]
pub struct Handshake {
    settings: Settings,
    results: Results,
    commands: Commands,
    line: Line,
    /// The latched fault, and the number of the log's code that belongs to it.
    error: Option<(Fault, u32)>,
    busy: bool,
    heartbeat: u16,
    beat_ns: u64,
    turned_ns: u64,
}

impl Handshake {
    /// Nothing is known of the line and nothing is offered.
    pub fn new(settings: Settings, now_ns: u64) -> Self {
        Self {
            settings,
            results: Results::default(),
            commands: Commands::default(),
            line: Line::Starting,
            error: None,
            busy: false,
            heartbeat: 0,
            beat_ns: now_ns,
            turned_ns: now_ns,
        }
    }

    /// A verdict came from the channel. One that had come before changes nothing.
    pub fn verdict(&mut self, verdict: &Verdict, now_ns: u64) {
        if !self.results.push(verdict, now_ns) {
            return;
        }
        self.busy = verdict.level() != Ok(VerdictLevel::Job);
        if verdict.level().is_err() || verdict.outcome().is_err() {
            self.latch(Fault::ForeignVerdict, 0);
        }
        self.advance(now_ns);
    }

    /// The journal has every verdict of this epoch up to `seq` on disk.
    pub fn confirmed(&mut self, epoch: u64, seq: u64, now_ns: u64) {
        self.results.confirm(epoch, seq);
        self.advance(now_ns);
    }

    /// The loop of the role has turned once and found the line in this state.
    pub fn tick(&mut self, line: Line, now_ns: u64) {
        self.turned_ns = now_ns;
        let is_beat = now_ns.saturating_sub(self.beat_ns) >= BEAT_NS;
        if is_beat {
            self.heartbeat = self.heartbeat.wrapping_add(1);
            self.beat_ns = now_ns;
        }
        let has_changed = line != std::mem::replace(&mut self.line, line);
        match line {
            Line::Fault { fault, detail } => self.latch(fault, detail),
            // Without writes nobody could reset it. It stays for a beat, so that a client can see it.
            Line::Ready if !self.settings.writes && (has_changed || is_beat) => self.error = None,
            Line::Ready | Line::Starting => {}
        }
        let unconfirmed_ns = self.results.unconfirmed_since().map(|since_ns| now_ns.saturating_sub(since_ns));
        if unconfirmed_ns.is_some_and(|waited_ns| waited_ns > CONFIRM_DEADLINE_NS) {
            self.latch(Fault::Journal, 0);
        }
        self.advance(now_ns);
    }

    /// A client has written the control block.
    pub fn write(&mut self, written: Control, now_ns: u64) {
        let changed = self.commands.write(written);
        let risen = changed & written.word;
        if changed & control::ENABLE != 0 {
            self.busy &= self.is_enabled();
            self.command(if self.is_enabled() { CommandKind::Enable } else { CommandKind::Disable });
        }
        // What ends something goes before what begins something.
        if risen & control::RESET_ERROR != 0 {
            self.reset_error();
        }
        if risen & control::ABORT != 0 {
            self.command_if(self.is_enabled(), CommandKind::Abort);
        }
        if risen & control::LOAD_JOB != 0 {
            self.command_if(self.is_enabled() && !self.busy, CommandKind::LoadJob);
        }
        if risen & control::START != 0 {
            self.command_if(self.is_ready(now_ns) && !self.busy, CommandKind::Start);
        }
        if risen & control::ACKNOWLEDGE != 0 {
            let was_offered = self.results.acknowledge();
            self.commands.answer(control::ACKNOWLEDGE, was_offered);
        }
        self.advance(now_ns);
    }

    /// The next command that the line must be sent. [`Handshake::command_sent`] must follow.
    pub fn next_command(&mut self) -> Option<LineCommand> {
        self.commands.pop()
    }

    /// Whether the command could be sent to the line.
    pub fn command_sent(&mut self, kind: CommandKind, was_sent: bool) {
        if !was_sent {
            self.latch(Fault::Command, 0);
        }
        match kind {
            CommandKind::Start if was_sent => self.busy = true,
            CommandKind::Abort if was_sent => self.busy = false,
            _ => {}
        }
        self.commands.answer(commands::bit(kind), was_sent);
    }

    /// What the registers show now.
    pub fn image(&self, now_ns: u64) -> Image {
        let bit = |condition: bool, bit: u16| if condition { bit } else { 0 };
        let offered = self.results.offered().map_or(0, |result| status::DONE | result.outcome);
        let status = offered
            | bit(self.is_online(now_ns), status::ONLINE)
            | bit(self.is_ready(now_ns), status::READY)
            | bit(self.busy, status::BUSY)
            | bit(self.error.is_some(), status::ERROR)
            | bit(self.results.has_overrun(), status::OVERRUN);
        let (carried_out, refused) = self.commands.answers();
        Image {
            status,
            carried_out,
            refused,
            heartbeat: self.heartbeat,
            error: self.error.map_or(0, |(fault, _)| fault as u16),
            error_detail: self.error.map_or(0, |(_, detail)| detail),
            queued: self.results.queued(),
            lost: self.results.lost(),
            result: self.results.newest(),
            control: self.commands.control(),
        }
    }

    /// Offers the next result, if it may be offered now.
    fn advance(&mut self, now_ns: u64) {
        let release = match self.settings {
            Settings { writes: true, .. } => {
                Release::Acknowledge { is_set: self.commands.is_set(control::ACKNOWLEDGE) }
            }
            Settings { writes: false, hold_ns } => Release::After { hold_ns },
        };
        self.results.advance(release, now_ns);
    }

    fn reset_error(&mut self) {
        self.results.reset_overrun();
        // A fault that is still there stays.
        self.error = match self.line {
            Line::Fault { fault, detail } => Some((fault, detail)),
            Line::Ready | Line::Starting => None,
        };
        self.commands.answer(control::RESET_ERROR, true);
    }

    /// The first fault stays: it is the cause, the others follow from it.
    fn latch(&mut self, fault: Fault, detail: u32) {
        self.error.get_or_insert((fault, detail));
        self.busy = false;
    }

    fn command_if(&mut self, is_allowed: bool, kind: CommandKind) {
        if is_allowed {
            self.command(kind);
        } else {
            self.commands.answer(commands::bit(kind), false);
        }
    }

    fn command(&mut self, kind: CommandKind) {
        if !self.commands.push(kind) {
            self.command_sent(kind, false);
        }
    }

    fn is_enabled(&self) -> bool {
        !self.settings.writes || self.commands.is_set(control::ENABLE)
    }

    fn is_online(&self, now_ns: u64) -> bool {
        now_ns.saturating_sub(self.turned_ns) <= LOOP_DEADLINE_NS
    }

    fn is_ready(&self, now_ns: u64) -> bool {
        self.is_online(now_ns) && self.is_enabled() && self.line == Line::Ready && self.error.is_none()
    }
}

#[cfg(test)]
mod properties;
#[cfg(test)]
mod tests;
