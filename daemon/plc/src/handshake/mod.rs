//! The handshake with the PLC: a pure state machine without IO and without a clock.
//!
//! Rows of the journal, what it keeps, verdicts, the state of the line and what clients write go in. Each has its time in nanoseconds since any
//! moment. What the registers show, the account to be kept and the commands for the line come out.
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

use shm_schemas::{
    Account, AccountKept, CommandKind, Journalled, JudgePhase, Judging, MessageId, PartId, Refusal,
};

pub use commands::LineCommand;
pub use fault::{Fault, Line};
pub use ledger::Update;
pub use queue::{QUEUE, Taken};

use crate::registers::{Control, Image, control, status};
use commands::{Commands, Job, Trouble};
use ledger::{Ledger, News};
use results::{Release, Results};

const MS: u64 = 1_000_000;
/// The heartbeat moves this often: a PLC that looks once per second sees at least three moves.
const BEAT_NS: u64 = 250 * MS;
/// A loop that has not turned for this long is dead: it turns every 20 ms.
const LOOP_DEADLINE_NS: u64 = 500 * MS;
/// A judge that has said nothing for this long is not heard: it says how it is twice per second.
const JUDGE_DEADLINE_NS: u64 = 2_000 * MS;
/// A journal that needs longer than this for one row is broken: a slow disk syncs in 50 ms.
const JOURNAL_DEADLINE_NS: u64 = 2_000 * MS;

/// Whether the judge watches a job by what it has said last, unless that is too long ago.
pub fn watches(judging: &Judging, now_ns: u64) -> bool {
    judging.is_enabled != 0
        && judging.phase != JudgePhase::NoJob.code()
        && now_ns.saturating_sub(judging.stamp.sent_ns) <= JUDGE_DEADLINE_NS
}

/// The number of AND-302, which says in the judge's log why a job was refused.
const JOB_REFUSED: u32 = 302;

/// What does not change while the role runs.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Whether clients may write. If not, nothing can be acknowledged: see `hold_ns`.
    pub writes: bool,
    /// Without writes, how long a result is offered before the next one takes its place.
    pub hold_ns: u64,
}

/// What must be kept as soon as it changes: what was acknowledged and lost, the latched fault, the wanted job and part.
type Vital = (u32, u32, bool, Option<(Fault, u32)>, (Option<Job>, Option<PartId>));

/// The state machine.
#[derive(Debug)]
pub struct Handshake {
    settings: Settings,
    results: Results,
    ledger: Ledger,
    /// What the judge has said last, and when.
    judging: Option<(Judging, u64)>,
    /// Since when the journal has sent nothing though the judge has judged more.
    behind_since: Option<u64>,
    commands: Commands,
    line: Line,
    /// The latched fault, and the number of the log's code that belongs to it.
    error: Option<(Fault, u32)>,
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
            judging: None,
            behind_since: None,
            commands: Commands::default(),
            line: Line::Starting,
            error: None,
            heartbeat: 0,
            beat_ns: now_ns,
            turned_ns: now_ns,
        }
    }

    /// The judge has said how it is.
    pub fn judging(&mut self, judging: &Judging, now_ns: u64) {
        self.judging = Some((*judging, now_ns));
        let trouble = self.account_for(|machine| machine.commands.answered(judging, now_ns));
        self.report(trouble);
        self.compare(false, now_ns);
    }

    /// The journal has said which account it keeps. The first one is where this start goes on.
    pub fn kept(&mut self, kept: &AccountKept, now_ns: u64) {
        match self.ledger.account_kept(kept.journal, &kept.account) {
            News::Resume => self.resume(&kept.account, now_ns),
            News::OtherJournal => self.results.forget_rows(),
            News::Acknowledged => {
                self.results.kept();
                self.commands.carry_out(control::ACKNOWLEDGE);
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
        let may_wait = self.settings.writes;
        let taken = self.account_for(|machine| machine.results.take(row, may_wait));
        match taken {
            Taken::Early => self.ledger.ask_again(now_ns),
            Taken::New if row.verdict.level().is_err() || row.verdict.outcome().is_err() => {
                self.latch(Fault::ForeignVerdict, 0);
            }
            Taken::New | Taken::Repeated | Taken::Waits => {}
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
        Some(Update { after_row: self.results.ask(asked), asked, account: self.account() })
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
        let trouble = self.commands.expire(now_ns);
        self.report(trouble);
        if self.line == Line::Ready && self.judging.is_some() && self.heard(now_ns).is_none() {
            self.latch(Fault::Command, 0);
        }
        self.advance(now_ns);
    }

    /// A client has written the control block.
    pub fn write(&mut self, written: Control, now_ns: u64) {
        let changed = self.commands.write(written);
        let risen = changed & written.word;
        // What ends something goes before what begins something.
        if risen & control::RESET_ERROR != 0 {
            self.reset_error();
        }
        let disabled = (!self.is_enabled()).then_some(Refusal::NotEnabled);
        let busy = self.is_busy(now_ns).then_some(Refusal::Busy);
        let unready = (!self.is_ready(now_ns)).then_some(Refusal::NotReady);
        for (bit, kind, refusal) in [
            (control::ABORT, CommandKind::Abort, disabled),
            (control::LOAD_JOB, CommandKind::LoadJob, disabled.or(busy)),
            (control::START, CommandKind::Start, disabled.or(busy).or(unready)),
        ] {
            match refusal {
                _ if risen & bit == 0 => {}
                Some(refusal) => self.commands.refuse(bit, refusal.code()),
                None => self.commands.push(kind),
            }
        }
        if risen & control::SET_PART != 0 {
            self.account_for(|machine| machine.commands.set_part());
        }
        if risen & control::ACKNOWLEDGE != 0 {
            self.acknowledge(written.acknowledge_sequence);
        }
        self.advance(now_ns);
    }

    /// Takes an acknowledgement, which is answered once the journal keeps it. One that names its result means no other. A client that writes in a
    /// cycle may not know yet that this role has started again and offers the next.
    fn acknowledge(&mut self, sequence: u32) {
        let refusal = match self.results.offered() {
            None => Refusal::NothingOffered,
            Some(offered) if sequence != 0 && sequence != offered.sequence => Refusal::OtherResult,
            Some(_) => return self.account_for(|machine| machine.results.acknowledge()),
        };
        self.commands.refuse(control::ACKNOWLEDGE, refusal.code());
    }

    /// The next command that the judge must be sent. It comes again until the judge has answered.
    pub fn next_command(&mut self, now_ns: u64) -> Option<LineCommand> {
        let boot = self.ledger.boot();
        let (judging, _) = self.judging.filter(|_| boot != 0)?;
        self.commands.next(boot, self.is_enabled(), &judging, now_ns)
    }

    /// What the registers show now.
    pub fn image(&self, now_ns: u64) -> Image {
        let bit = |condition: bool, bit: u16| if condition { bit } else { 0 };
        let offered = self.results.offered().map_or(0, |result| {
            let note = if result.verdict.note == 0 { 0 } else { status::NOTE };
            status::DONE | result.outcome | note
        });
        let status = offered
            | bit(self.is_online(now_ns), status::ONLINE)
            | bit(self.is_ready(now_ns), status::READY)
            | bit(self.is_busy(now_ns), status::BUSY)
            | bit(self.error.is_some(), status::ERROR)
            | bit(self.results.has_overrun(), status::OVERRUN);
        let (carried_out, refused) = self.commands.answers();
        let judging = self.judging.map(|(judging, _)| judging).unwrap_or_default();
        let has_enable = self.is_enabled() && judging.is_enabled != 0 && self.settings.writes;
        let wants_enable = self.commands.is_set(control::ENABLE) && !has_enable;
        let released = self.results.is_released();
        Image {
            boot: self.ledger.boot(),
            status,
            carried_out: carried_out | bit(has_enable, control::ENABLE),
            refused,
            executing: self.commands.executing()
                | bit(wants_enable, control::ENABLE)
                | bit(released, control::ACKNOWLEDGE & self.commands.control().word),
            refusal: self.commands.refusal().into(),
            job_in_force: judging.job_id,
            hash_in_force: judging.model_hash,
            phase: judging.phase.into(),
            next_part: judging.part,
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
        if self.results.wants_more() {
            self.ledger.ask();
        }
    }

    fn resume(&mut self, account: &Account, now_ns: u64) {
        self.results = Results::resume(account, now_ns);
        self.commands.resume(account);
        let restored = Fault::of_number(account.error).map(|fault| (fault, account.error_detail));
        self.error = restored.or(self.error);
    }

    /// The whole account as it is now.
    fn account(&self) -> Account {
        let mut account = Account::default();
        self.ledger.save(&mut account);
        self.results.save(&mut account);
        self.commands.save(&mut account);
        (account.error, account.error_detail) = self.error.map_or((0, 0), |(fault, n)| (fault as u16, n));
        account
    }

    /// What must be kept as soon as it changes. The rest follows again from the journal's rows.
    fn vital(&self) -> Vital {
        let results = &self.results;
        (results.released(), results.lost(), results.has_overrun(), self.error, self.commands.wanted())
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
        let judged = self
            .judging
            .map(|(judging, _)| MessageId { epoch: judging.verdict_epoch, seq: judging.verdict_seq });
        let is_behind = match (judged, self.results.newest_verdict()) {
            (None | Some(MessageId { seq: 0, .. }), _) => false,
            // It is the PLC that does not keep up.
            _ if self.results.has_more() => false,
            (Some(judged), Some(newest)) => judged.epoch != newest.epoch || newest.seq < judged.seq,
            (Some(_), None) => true,
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
        self.commands.carry_out(control::RESET_ERROR);
    }

    fn report(&mut self, trouble: Option<Trouble>) {
        match trouble {
            Some(Trouble::Silent) => self.latch(Fault::Command, 0),
            Some(Trouble::JobRefused) => self.latch(Fault::Command, JOB_REFUSED),
            None => {}
        }
    }

    /// The first fault stays: it is the cause, the others follow from it.
    fn latch(&mut self, fault: Fault, detail: u32) {
        self.account_for(|machine| machine.error.get_or_insert((fault, detail)).0);
    }

    fn is_enabled(&self) -> bool {
        !self.settings.writes || self.commands.is_set(control::ENABLE)
    }

    fn is_online(&self, now_ns: u64) -> bool {
        now_ns.saturating_sub(self.turned_ns) <= LOOP_DEADLINE_NS
    }

    fn is_ready(&self, now_ns: u64) -> bool {
        self.obstacle(now_ns).is_none()
    }

    /// Why `ready` is not set, in words; `None` where it is.
    pub fn obstacle(&self, now_ns: u64) -> Option<&'static str> {
        if !self.is_online(now_ns) {
            return Some("this role has stalled");
        }
        if self.ledger.boot() == 0 {
            return Some("the journal has not yet stored the start of this role");
        }
        if !self.is_enabled() {
            return Some("the PLC has not set `enable`, or has cleared it");
        }
        match (self.line, self.error) {
            (Line::Starting, _) => return Some("a role is still starting, or the recording has ended"),
            (_, Some((fault, _))) => return Some(fault.meaning()),
            (Line::Fault { fault, .. }, None) => return Some(fault.meaning()),
            (Line::Ready, None) => {}
        }
        let Some(judging) = self.heard(now_ns) else { return Some("the judge does not answer") };
        if judging.is_enabled == 0 {
            return Some("the judge is not enabled yet");
        }
        if judging.phase == JudgePhase::NoJob.code() {
            return Some("no job is loaded");
        }
        (!self.commands.has_job(judging))
            .then_some("the judge has not yet taken back the job that the PLC has loaded")
    }

    /// Not while a fault is latched: what runs then has no result that counts, and must not keep the PLC from loading another job. The
    /// judge breaks it off as not judged.
    fn is_busy(&self, now_ns: u64) -> bool {
        self.is_enabled()
            && self.error.is_none()
            && self.heard(now_ns).is_some_and(|judging| judging.phase == JudgePhase::Running.code())
    }

    /// What the judge has said, unless that is too long ago.
    fn heard(&self, now_ns: u64) -> Option<&Judging> {
        let (judging, heard_ns) = self.judging.as_ref()?;
        (now_ns.saturating_sub(*heard_ns) <= JUDGE_DEADLINE_NS).then_some(judging)
    }
}

#[cfg(test)]
mod properties;
#[cfg(test)]
mod tests;
