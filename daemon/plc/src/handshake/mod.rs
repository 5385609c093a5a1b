//! The handshake with the PLC: a pure state machine without IO and without a clock.
//!
//! Rows of the journal, what it keeps, verdicts, the state of the line and what clients write go in, each with its time in
//! nanoseconds since any moment. What the registers show, the account to be kept and the commands for the line come out.
//!
//! - `results`: how a result gets to the PLC, and when it gives way to the next one;
//! - `ledger`: the account with the journal, which outlives this process;
//! - `commands`: the control block, and the answers to its commands;
//! - this file: `ready`, `busy`, the latched fault and the heartbeat, which depend on both.

mod commands;
mod fault;
mod ledger;
mod queue;
mod results;

use shm_schemas::{Account, AccountKept, CommandKind, Journalled, Verdict, VerdictLevel};

pub use commands::LineCommand;
pub use fault::{Fault, Line};
pub use ledger::Update;
pub use queue::{QUEUE, Taken};

use crate::registers::{Control, Image, control, status};
use commands::Commands;
use ledger::{Ledger, News};
use results::{Release, Results};

const MS: u64 = 1_000_000;
/// The heartbeat moves this often: a PLC that looks once per second sees at least three moves.
const BEAT_NS: u64 = 250 * MS;
/// A loop that has not turned for this long is dead: it turns every 20 ms.
const LOOP_DEADLINE_NS: u64 = 500 * MS;
/// A journal that needs longer than this for one row is broken: a slow disk syncs in 50 ms.
const JOURNAL_DEADLINE_NS: u64 = 2_000 * MS;

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
    ledger: Ledger,
    /// The newest verdict that the judge has sent, and since when the journal has not sent a row though it is behind.
    judged: Option<(u64, u64)>,
    behind_since: Option<u64>,
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
            ledger: Ledger::default(),
            judged: None,
            behind_since: None,
            commands: Commands::default(),
            line: Line::Starting,
            error: None,
            busy: false,
            heartbeat: 0,
            beat_ns: now_ns,
            turned_ns: now_ns,
        }
    }

    /// The judge has sent a verdict. It is no result before the journal has it.
    pub fn judged(&mut self, verdict: &Verdict, now_ns: u64) {
        self.judged = Some((verdict.stamp.epoch, verdict.stamp.seq));
        self.busy = verdict.level() != Ok(VerdictLevel::Job);
        self.compare(false, now_ns);
    }

    /// The journal has said which account it keeps. The first one is where this start goes on.
    pub fn kept(&mut self, kept: &AccountKept, now_ns: u64) {
        match self.ledger.hear(kept.journal, &kept.account) {
            News::Resume => self.resume(&kept.account, now_ns),
            News::OtherJournal => self.results.forget_rows(),
            News::Acknowledged => {
                self.results.kept();
                self.commands.answer(control::ACKNOWLEDGE, true);
            }
            News::Nothing => {}
        }
        self.advance(now_ns);
    }

    /// The journal has started again.
    pub fn journal_restarted(&mut self) {
        self.ledger.journal_restarted();
    }

    /// The journal has sent a row.
    pub fn journalled(&mut self, row: &Journalled, now_ns: u64) -> Taken {
        if !self.ledger.is_answer(row) {
            return Taken::Repeated;
        }
        let taken = self.account_for(|machine| machine.results.take(row));
        match taken {
            Taken::Early => self.ledger.ask_again(now_ns),
            Taken::New if row.verdict.level().is_err() || row.verdict.outcome().is_err() => {
                self.latch(Fault::ForeignVerdict, 0);
            }
            Taken::New | Taken::Repeated => {}
        }
        self.compare(true, now_ns);
        self.advance(now_ns);
        taken
    }

    /// What the journal must be sent now, if anything.
    pub fn update(&mut self, now_ns: u64) -> Option<Update> {
        if !self.ledger.is_due(now_ns) {
            return None;
        }
        let asked = self.ledger.sent(now_ns);
        Some(Update { after_row: self.results.needs_after(), asked, account: self.account() })
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
            Line::Ready if !self.settings.writes && (has_changed || is_beat) => {
                self.account_for(|machine| machine.error = None);
            }
            Line::Ready | Line::Starting => {}
        }
        self.expect_rows(now_ns);
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
            // It is answered once the journal keeps it.
            if !self.account_for(|machine| machine.results.acknowledge()) {
                self.commands.answer(control::ACKNOWLEDGE, false);
            }
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
            boot: self.ledger.boot(),
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
        self.account_for(|machine| machine.results.advance(release, now_ns));
    }

    fn resume(&mut self, account: &Account, now_ns: u64) {
        self.results = Results::resume(account, now_ns);
        let restored = Fault::of_number(account.error).map(|fault| (fault, account.error_detail));
        self.error = restored.or(self.error);
    }

    /// The whole account as it is now.
    fn account(&self) -> Account {
        let mut account = Account::default();
        self.ledger.save(&mut account);
        self.results.save(&mut account);
        (account.error, account.error_detail) = self.error.map_or((0, 0), |(fault, n)| (fault as u16, n));
        account
    }

    /// What must be kept as soon as it changes. The rest follows again from the journal's rows.
    fn vital(&self) -> (u32, u32, bool, Option<(Fault, u32)>) {
        (self.results.released(), self.results.lost(), self.results.has_overrun(), self.error)
    }

    /// Does something, and notes what it changes in the account.
    fn account_for<R>(&mut self, act: impl FnOnce(&mut Self) -> R) -> R {
        let before = self.vital();
        let done = act(self);
        let now = self.vital();
        if now != before {
            let is_release = now.0 != before.0 && now.0 != 0;
            self.ledger.change(is_release);
        }
        done
    }

    /// Compares what the judge has sent with what the journal has: `has_progress` when a row has come.
    fn compare(&mut self, has_progress: bool, now_ns: u64) {
        let is_behind = match (self.judged, self.results.newest_key()) {
            (Some((judged, seq)), Some((epoch, newest))) => judged != epoch || newest < seq,
            (Some(_), None) => true,
            (None, _) => false,
        };
        self.behind_since = match self.behind_since {
            _ if !is_behind => None,
            Some(since_ns) if !has_progress => Some(since_ns),
            _ => Some(now_ns),
        };
    }

    /// Asks again for what does not come, and says so when it takes too long.
    fn expect_rows(&mut self, now_ns: u64) {
        let waited_ns = self.behind_since.map_or(0, |since_ns| now_ns.saturating_sub(since_ns));
        if waited_ns > 0 || self.results.is_missing_rows() {
            self.ledger.ask_again(now_ns);
        }
        if waited_ns > JOURNAL_DEADLINE_NS {
            self.latch(Fault::Journal, 0);
        }
    }

    fn reset_error(&mut self) {
        self.account_for(|machine| {
            machine.results.reset_overrun();
            // A fault that is still there stays.
            machine.error = match machine.line {
                Line::Fault { fault, detail } => Some((fault, detail)),
                Line::Ready | Line::Starting => None,
            };
        });
        self.commands.answer(control::RESET_ERROR, true);
    }

    /// The first fault stays: it is the cause, the others follow from it.
    fn latch(&mut self, fault: Fault, detail: u32) {
        self.account_for(|machine| machine.error.get_or_insert((fault, detail)).0);
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
        self.is_online(now_ns)
            && self.ledger.is_open()
            && self.is_enabled()
            && self.line == Line::Ready
            && self.error.is_none()
    }
}

#[cfg(test)]
mod properties;
#[cfg(test)]
mod tests;
