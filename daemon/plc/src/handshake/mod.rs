//! The handshake with the PLC: a pure state machine, no IO, time as an argument.
//!
//! ```text
//!         a confirmed result waits            `acknowledge` set
//!  Empty ─────────────────────────► Offered ─────────────────────► Taken
//!    ▲                              ▲    │                           │
//!    │                              │    │ writes off: held long     │ `acknowledge` cleared
//!    │                              │    │ enough, and another waits │
//!    │                              ├────┘                           │
//!    │                              └──────── another waits ◄────────┤
//!    └─────────────────────────────────────── nothing waits ◄────────┘
//! ```
//!
//! `done`, and one of `ok`, `nok`, `not-judged`, are set in `Offered` and in no other state. A result
//! is offered only once the journal has it. What does not fit the queue is lost, and the overrun bit
//! and a jump of `sequence` say so.

mod fault;
mod queue;

use std::collections::VecDeque;

use shm_schemas::{CommandKind, Verdict, VerdictKind};

pub use fault::{Fault, Line};
pub use queue::QUEUE;

use crate::registers::{Control, Image, ResultBlock, control, status};
use queue::{Queue, Taken, ends_job};

const MS: u64 = 1_000_000;
/// The heartbeat moves this often: a PLC that looks once a second sees at least three moves.
const BEAT_NS: u64 = 250 * MS;
/// A loop that has not turned for this long is dead: it turns every 20 ms.
const LOOP_DEADLINE_NS: u64 = 500 * MS;
/// Health comes at 1 Hz or faster (DESIGN 2): two beats missed.
const LINE_DEADLINE_NS: u64 = 2_000 * MS;
/// A journal that needs longer than this for one row is broken: a slow disk syncs in 50 ms.
const CONFIRM_DEADLINE_NS: u64 = 2_000 * MS;
/// Commands that wait for the loop. A client has six bits, and the loop takes them every 20 ms.
const ASKS: usize = 16;

/// What does not change while it runs.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Whether a client may write. If not, nothing can be acknowledged: see `hold_ns`.
    pub writes: bool,
    /// With writes off, how long a result is offered before the next one takes its place.
    pub hold_ns: u64,
}

/// A command for the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ask {
    /// What is asked.
    pub kind: CommandKind,
    /// The job, for `LoadJob`.
    pub job_id: u32,
    /// Its version, for `LoadJob`.
    pub model_hash: u64,
    /// The `seq` of the verdict, for `Acknowledge`.
    pub argument: u64,
}

/// Where the result on the registers is in its life.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Empty,
    Offered { since_ns: u64 },
    Taken,
}

/// The state machine.
#[derive(Debug)]
pub struct Handshake {
    settings: Settings,
    phase: Phase,
    queue: Queue,
    /// What the result block shows.
    result: Option<ResultBlock>,
    lost: u32,
    overrun: bool,
    line: Line,
    line_ns: u64,
    /// Latched until `reset_error`.
    error: Option<(Fault, u32)>,
    busy: bool,
    control: Control,
    carried_out: u16,
    refused: u16,
    asks: VecDeque<Ask>,
    heartbeat: u16,
    beat_ns: u64,
    turned_ns: u64,
}

impl Handshake {
    /// Nothing is known of the line, nothing is offered.
    pub fn new(settings: Settings, now_ns: u64) -> Self {
        Self {
            settings,
            phase: Phase::Empty,
            queue: Queue::default(),
            result: None,
            lost: 0,
            overrun: false,
            line: Line::Starting,
            line_ns: now_ns,
            error: None,
            busy: false,
            control: Control::default(),
            carried_out: 0,
            refused: 0,
            asks: VecDeque::with_capacity(ASKS),
            heartbeat: 0,
            beat_ns: now_ns,
            turned_ns: now_ns,
        }
    }

    /// A verdict came from the channel.
    pub fn verdict(&mut self, verdict: &Verdict, now_ns: u64) {
        match self.queue.push(verdict, now_ns) {
            Taken::Again => return,
            Taken::Queued { lost: 0 } => {}
            Taken::Queued { lost } | Taken::Full { lost } => {
                self.lost = self.lost.saturating_add(u32::try_from(lost).unwrap_or(u32::MAX));
                self.overrun = true;
            }
        }
        self.busy = !ends_job(verdict);
        if VerdictKind::try_from(verdict.kind).is_err() {
            self.latch(Fault::ForeignVerdict, 0);
        }
        self.advance(now_ns);
    }

    /// The journal has every verdict of this epoch up to `seq`.
    pub fn confirmed(&mut self, epoch: u64, seq: u64, now_ns: u64) {
        self.queue.confirm(epoch, seq);
        self.advance(now_ns);
    }

    /// How the line is. Must be told again within 2 s, or it counts as silent.
    pub fn line(&mut self, line: Line, now_ns: u64) {
        self.line = line;
        self.line_ns = now_ns;
        match line {
            Line::Fault { fault, detail } => self.latch(fault, detail),
            // With writes off there is nobody who could reset it.
            Line::Ready if !self.settings.writes => self.error = None,
            Line::Ready | Line::Starting => {}
        }
    }

    /// The loop has turned once. Deadlines are found here.
    pub fn tick(&mut self, now_ns: u64) {
        self.turned_ns = now_ns;
        if now_ns.saturating_sub(self.beat_ns) >= BEAT_NS {
            self.heartbeat = self.heartbeat.wrapping_add(1);
            self.beat_ns = now_ns;
        }
        if self.line == Line::Ready && now_ns.saturating_sub(self.line_ns) > LINE_DEADLINE_NS {
            self.line = Line::Fault { fault: Fault::Silence, detail: 0 };
            self.latch(Fault::Silence, 0);
        }
        let waits = self.queue.unconfirmed_since().map(|since_ns| now_ns.saturating_sub(since_ns));
        if waits.is_some_and(|waited_ns| waited_ns > CONFIRM_DEADLINE_NS) {
            self.latch(Fault::Journal, 0);
        }
        self.advance(now_ns);
    }

    /// A client has written the control block.
    pub fn write(&mut self, written: Control, now_ns: u64) {
        let changed = written.word ^ self.control.word;
        let set = changed & written.word;
        self.carried_out &= written.word;
        self.refused &= written.word;
        self.control = written;

        if changed & control::ENABLE != 0 {
            self.busy &= self.enabled();
            self.ask(if self.enabled() { CommandKind::Enable } else { CommandKind::Disable }, 0);
        }
        // What ends something goes before what begins something.
        if set & control::RESET_ERROR != 0 {
            self.reset_error();
        }
        if set & control::ABORT != 0 {
            self.ask_if(self.enabled(), CommandKind::Abort);
        }
        if set & control::LOAD_JOB != 0 {
            self.ask_if(self.enabled() && !self.busy, CommandKind::LoadJob);
        }
        if set & control::START != 0 {
            self.ask_if(self.ready(now_ns) && !self.busy, CommandKind::Start);
        }
        if set & control::ACKNOWLEDGE != 0 {
            self.acknowledge();
        }
        self.advance(now_ns);
    }

    /// The next command that the line must be told.
    pub fn next_ask(&mut self) -> Option<Ask> {
        self.asks.pop_front()
    }

    /// Whether the line has been told.
    pub fn asked(&mut self, ask: &Ask, told: bool) {
        if !told {
            self.latch(Fault::Command, 0);
        }
        match ask.kind {
            CommandKind::Start if told => self.busy = true,
            CommandKind::Abort if told => self.busy = false,
            // Answered already: what the PLC wants of them happens here.
            CommandKind::Acknowledge | CommandKind::ResetError => return,
            _ => {}
        }
        self.answer(bit(ask.kind), told);
    }

    /// What the registers show now.
    pub fn image(&self, now_ns: u64) -> Image {
        let mut word = 0;
        let mut set = |condition: bool, bits: u16| {
            if condition {
                word |= bits;
            }
        };
        set(self.online(now_ns), status::ONLINE);
        set(self.ready(now_ns), status::READY);
        set(self.busy, status::BUSY);
        if let (Phase::Offered { .. }, Some(result)) = (self.phase, self.result) {
            set(true, status::DONE | result.outcome);
        }
        set(self.error.is_some(), status::ERROR);
        set(self.overrun, status::OVERRUN);
        Image {
            status: word,
            carried_out: self.carried_out,
            refused: self.refused,
            heartbeat: self.heartbeat,
            error: self.error.map_or(0, |(fault, _)| fault as u16),
            error_detail: self.error.map_or(0, |(_, detail)| detail),
            // At most QUEUE.
            queued: self.queue.len() as u16,
            lost: self.lost,
            result: self.result,
            control: self.control,
        }
    }

    /// Offers the next result where the phase and the journal allow it.
    fn advance(&mut self, now_ns: u64) {
        let free = match self.phase {
            Phase::Empty => true,
            Phase::Taken => self.control.word & control::ACKNOWLEDGE == 0,
            Phase::Offered { since_ns } => {
                !self.settings.writes
                    && self.queue.is_next_confirmed()
                    && now_ns.saturating_sub(since_ns) >= self.settings.hold_ns
            }
        };
        if !free {
            return;
        }
        self.phase = match self.queue.pop() {
            Some(result) => {
                self.result = Some(result);
                Phase::Offered { since_ns: now_ns }
            }
            None => Phase::Empty,
        };
    }

    fn acknowledge(&mut self) {
        let offered = matches!(self.phase, Phase::Offered { .. });
        self.answer(control::ACKNOWLEDGE, offered);
        if let (true, Some(result)) = (offered, self.result) {
            self.phase = Phase::Taken;
            self.ask(CommandKind::Acknowledge, result.verdict.stamp.seq);
        }
    }

    fn reset_error(&mut self) {
        self.overrun = false;
        // What is still wrong stays.
        self.error = match self.line {
            Line::Fault { fault, detail } => Some((fault, detail)),
            Line::Ready | Line::Starting => None,
        };
        self.answer(control::RESET_ERROR, true);
        self.ask(CommandKind::ResetError, 0);
    }

    /// The first error stays: it is the cause, the others follow from it.
    fn latch(&mut self, fault: Fault, detail: u32) {
        self.error.get_or_insert((fault, detail));
        self.busy = false;
    }

    fn ask_if(&mut self, allowed: bool, kind: CommandKind) {
        if allowed {
            self.ask(kind, 0);
        } else {
            self.answer(bit(kind), false);
        }
    }

    fn ask(&mut self, kind: CommandKind, argument: u64) {
        let (job_id, model_hash) = match kind {
            CommandKind::LoadJob => (self.control.load_job_id, self.control.load_model_hash),
            _ => (0, 0),
        };
        let ask = Ask { kind, job_id, model_hash, argument };
        if self.asks.len() < ASKS {
            self.asks.push_back(ask);
        } else {
            self.asked(&ask, false);
        }
    }

    /// Says how a command went, for as long as its control bit is set.
    fn answer(&mut self, bit: u16, carried_out: bool) {
        let bits = bit & self.control.word;
        *(if carried_out { &mut self.carried_out } else { &mut self.refused }) |= bits;
    }

    fn enabled(&self) -> bool {
        !self.settings.writes || self.control.word & control::ENABLE != 0
    }

    fn online(&self, now_ns: u64) -> bool {
        now_ns.saturating_sub(self.turned_ns) <= LOOP_DEADLINE_NS
    }

    fn ready(&self, now_ns: u64) -> bool {
        self.online(now_ns) && self.enabled() && self.line == Line::Ready && self.error.is_none()
    }
}

/// The control bit that asks for it.
const fn bit(kind: CommandKind) -> u16 {
    match kind {
        // A level: `Disable` clears the bit, and its answer with it.
        CommandKind::Enable | CommandKind::Disable => control::ENABLE,
        CommandKind::LoadJob => control::LOAD_JOB,
        CommandKind::Start => control::START,
        CommandKind::Abort => control::ABORT,
        CommandKind::Acknowledge => control::ACKNOWLEDGE,
        CommandKind::ResetError => control::RESET_ERROR,
    }
}

#[cfg(test)]
mod tests;
