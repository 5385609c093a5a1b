//! The control block: commands on their way to the judge, and what became of them.
//!
//! A command is under way from its rising bit to the judge's answer; then it is carried out, or refused with a reason. The PLC wants `enable`, the
//! job and the part id for good. They are compared with what the judge says, and asked for again until the judge has them.

use std::collections::VecDeque;

use shm_schemas::{Account, CommandKind, Judging, PartId, Refusal};

use super::MS;
use crate::registers::{Control, control};

/// Commands that can wait. The control word has three bits for the judge, so a client would have to pulse them faster than they go.
const WAITING: usize = 8;
/// A command without an answer is sent again. The judge knows it by its number, and does nothing twice.
const AGAIN_NS: u64 = 250 * MS;
/// A command without an answer by then is refused: a judge that runs answers within one couple.
const ANSWER_DEADLINE_NS: u64 = 2_000 * MS;
/// Between two tries to give the judge back a job that it has refused.
const REFUSED_AGAIN_NS: u64 = 1_000 * MS;

/// A command for the judge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineCommand {
    /// Its number, which no other command has.
    pub number: u64,
    /// What the judge must do.
    pub kind: CommandKind,
    /// The job, for `LoadJob`; otherwise 0.
    pub job_id: u32,
    /// Hash of the job file, for `LoadJob`, where 0 accepts any; otherwise 0.
    pub model_hash: u64,
    /// The part id, for `SetPart`; otherwise none.
    pub part: PartId,
}

/// A job by number and hash; hash 0 is any.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Job {
    id: u32,
    hash: u64,
}

impl Job {
    fn is_in_force(self, judging: &Judging) -> bool {
        self.id == judging.job_id && (self.hash == 0 || self.hash == judging.model_hash)
    }
}

/// What the judge is asked for, with all that belongs to it.
#[derive(Clone, Copy, Debug)]
struct Asked {
    kind: CommandKind,
    job: Job,
    part: PartId,
}

impl Asked {
    const fn plain(kind: CommandKind) -> Self {
        Self { kind, job: Job { id: 0, hash: 0 }, part: PartId::NONE }
    }

    const fn job(job: Job) -> Self {
        Self { job, ..Self::plain(CommandKind::LoadJob) }
    }

    const fn part(part: PartId) -> Self {
        Self { part, ..Self::plain(CommandKind::SetPart) }
    }
}

/// A command that was sent and not answered.
#[derive(Clone, Copy, Debug)]
struct UnderWay {
    command: LineCommand,
    /// Whether a control bit waits for the answer: not when it only gives the judge back what it has forgotten.
    is_asked: bool,
    since_ns: u64,
    sent_ns: Option<u64>,
}

/// What a turn has shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Trouble {
    /// The judge does not answer.
    Silent,
    /// The judge does not take back the job that the PLC has loaded.
    JobRefused,
}

/// The control block as a client has written it, and what became of its commands.
#[derive(Debug, Default)]
pub(super) struct Commands {
    control: Control,
    carried_out: u16,
    refused: u16,
    refusal: u8,
    waiting: VecDeque<Asked>,
    under_way: Option<UnderWay>,
    sent: u32,
    /// The job that the PLC has loaded: it is wanted for good.
    job: Option<Job>,
    job_refused_ns: Option<u64>,
    /// The part id that the PLC has given last.
    part: Option<PartId>,
}

impl Commands {
    pub(super) fn control(&self) -> Control {
        self.control
    }

    pub(super) fn is_set(&self, bit: u16) -> bool {
        self.control.word & bit != 0
    }

    /// The bits of the commands that were carried out, and of those that were refused.
    pub(super) fn answers(&self) -> (u16, u16) {
        (self.carried_out, self.refused)
    }

    /// The bits of the commands whose answer is still to come.
    pub(super) fn executing(&self) -> u16 {
        let waiting = self.waiting.iter().map(|asked| bit(asked.kind));
        let under_way = self.under_way.filter(|under_way| under_way.is_asked);
        let bits = waiting.chain(under_way.map(|under_way| bit(under_way.command.kind)));
        bits.fold(0, |bits, bit| bits | bit) & self.control.word
    }

    /// Why the newest refused command was refused.
    pub(super) fn refusal(&self) -> u8 {
        self.refusal
    }

    /// What the PLC wants for good, for the account.
    pub(super) fn save(&self, account: &mut Account) {
        (account.gives_parts, account.part) = self.part.map_or((0, PartId::NONE), |part| (1, part));
        (account.wanted_job, account.wanted_hash) = self.job.map_or((0, 0), |job| (job.id, job.hash));
    }

    /// Wants again what the account says. What a client has asked for meanwhile counts more.
    pub(super) fn resume(&mut self, account: &Account) {
        let kept = Job { id: account.wanted_job, hash: account.wanted_hash };
        self.job = self.job.or((kept.id != 0).then_some(kept));
        self.part = self.part.or((account.gives_parts != 0).then_some(account.part));
    }

    /// The wanted job and part, to see when they change.
    pub(super) fn wanted(&self) -> (Option<Job>, Option<PartId>) {
        (self.job, self.part)
    }

    /// Whether the judge has the job that is wanted.
    pub(super) fn has_job(&self, judging: &Judging) -> bool {
        self.job.is_none_or(|job| job.is_in_force(judging))
    }

    /// Takes what a client has written; returns the control bits that have changed. Answers clear with their bit.
    pub(super) fn write(&mut self, written: Control) -> u16 {
        let changed = written.word ^ self.control.word;
        self.carried_out &= written.word;
        self.refused &= written.word;
        self.control = written;
        changed
    }

    /// Lets a command wait for the judge.
    pub(super) fn push(&mut self, kind: CommandKind) {
        let job = Job { id: self.control.load_job_id, hash: self.control.load_model_hash };
        self.wait(if kind == CommandKind::LoadJob { Asked::job(job) } else { Asked::plain(kind) });
    }

    /// Takes the part id that a client has written. It counts from now on, and is given to the judge until that has it. After an
    /// invalid one the next job has none, and never that of the part before.
    pub(super) fn set_part(&mut self) {
        let part = PartId::new(&self.control.part);
        let wanted = part.unwrap_or(PartId::NONE);
        self.part = Some(wanted);
        match part {
            Ok(part) => self.wait(Asked::part(part)),
            Err(_) => self.refuse(control::SET_PART, Refusal::BadPart.code()),
        }
    }

    fn wait(&mut self, asked: Asked) {
        if self.waiting.len() == WAITING {
            return self.refuse(bit(asked.kind), Refusal::TooMany.code());
        }
        self.waiting.push_back(asked);
    }

    /// What must be sent to the judge now. It is sent again until the answer comes.
    pub(super) fn next(
        &mut self,
        boot: u32,
        wants_enable: bool,
        judging: &Judging,
        now_ns: u64,
    ) -> Option<LineCommand> {
        if self.under_way.is_none() {
            self.under_way = self.begin(boot, wants_enable, judging, now_ns);
        }
        let under_way = self.under_way.as_mut()?;
        if under_way.sent_ns.is_some_and(|sent_ns| now_ns.saturating_sub(sent_ns) < AGAIN_NS) {
            return None;
        }
        under_way.sent_ns = Some(now_ns);
        Some(under_way.command)
    }

    fn begin(&mut self, boot: u32, wants_enable: bool, judging: &Judging, now_ns: u64) -> Option<UnderWay> {
        let waiting = self.waiting.pop_front();
        let is_asked = waiting.is_some();
        let Asked { kind, job, part } = waiting.or_else(|| self.missing(wants_enable, judging, now_ns))?;
        self.sent = self.sent.wrapping_add(1);
        let number = u64::from(boot) << 32 | u64::from(self.sent);
        let command = LineCommand { number, kind, job_id: job.id, model_hash: job.hash, part };
        Some(UnderWay { command, is_asked, since_ns: now_ns, sent_ns: None })
    }

    /// What is wanted for good and the judge has not. Part id and job come before `enable`, so that nothing is judged without them.
    fn missing(&self, wants_enable: bool, judging: &Judging, now_ns: u64) -> Option<Asked> {
        let is_enabled = judging.is_enabled != 0;
        if is_enabled && !wants_enable {
            return Some(Asked::plain(CommandKind::Disable));
        }
        if let Some(part) = self.part.filter(|part| *part != judging.part) {
            return Some(Asked::part(part));
        }
        if let Some(job) = self.job.filter(|job| !job.is_in_force(judging)) {
            let retries = self
                .job_refused_ns
                .is_none_or(|refused_ns| now_ns.saturating_sub(refused_ns) >= REFUSED_AGAIN_NS);
            return retries.then(|| Asked::job(job));
        }
        (wants_enable && !is_enabled).then(|| Asked::plain(CommandKind::Enable))
    }

    /// The judge has said how it is. Returns the trouble that its answer means.
    pub(super) fn answered(&mut self, judging: &Judging, now_ns: u64) -> Option<Trouble> {
        let under_way = self.under_way.filter(|under_way| under_way.command.number == judging.command)?;
        self.end(under_way, judging.refusal, now_ns)
    }

    /// Gives up what has had no answer for too long.
    pub(super) fn expire(&mut self, now_ns: u64) -> Option<Trouble> {
        let is_late = |under_way: &UnderWay| now_ns.saturating_sub(under_way.since_ns) > ANSWER_DEADLINE_NS;
        let under_way = self.under_way.filter(is_late)?;
        self.end(under_way, Refusal::NoAnswer.code(), now_ns);
        Some(Trouble::Silent)
    }

    fn end(&mut self, under_way: UnderWay, refusal: u8, now_ns: u64) -> Option<Trouble> {
        self.under_way = None;
        let command = under_way.command;
        let is_done = refusal == Refusal::None.code();
        // One that a client asks for says nothing of the one that is wanted.
        if command.kind == CommandKind::LoadJob && !under_way.is_asked {
            self.job_refused_ns = (!is_done).then_some(now_ns);
        }
        match (is_done, under_way.is_asked) {
            (true, true) => {
                if command.kind == CommandKind::LoadJob {
                    self.job = Some(Job { id: command.job_id, hash: command.model_hash });
                }
                self.carry_out(bit(command.kind));
            }
            (false, true) => self.refuse(bit(command.kind), refusal),
            (false, false) if command.kind == CommandKind::LoadJob => return Some(Trouble::JobRefused),
            (_, false) => {}
        }
        None
    }

    /// A command is carried out, if its control bit is still set.
    pub(super) fn carry_out(&mut self, bit: u16) {
        self.carried_out |= bit & self.control.word;
    }

    /// A command is refused, if its control bit is still set.
    pub(super) fn refuse(&mut self, bit: u16, refusal: u8) {
        self.refused |= bit & self.control.word;
        self.refusal = refusal;
    }
}

/// The control bit of a command.
const fn bit(kind: CommandKind) -> u16 {
    match kind {
        CommandKind::Enable | CommandKind::Disable => control::ENABLE,
        CommandKind::LoadJob => control::LOAD_JOB,
        CommandKind::Start => control::START,
        CommandKind::Abort => control::ABORT,
        CommandKind::SetPart => control::SET_PART,
    }
}
