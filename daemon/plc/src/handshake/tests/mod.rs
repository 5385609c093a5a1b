//! The state machine beside a judge and a journal that do as they are told.
#![allow(clippy::unwrap_used, clippy::panic)]

mod commands;
mod parts;
mod ready;
mod restart;
mod results;
mod rows;

use super::*;
use shm_schemas::{Verdict, VerdictLevel, VerdictNote, VerdictOutcome};

pub(super) const WRITES: Settings = Settings { writes: true, hold_ns: 0 };

pub(super) const ENABLED: Control = Control {
    word: control::ENABLE,
    load_job_id: 0,
    load_model_hash: 0,
    part: [0; shm_schemas::PART_BYTES],
    acknowledge_sequence: 0,
};

fn verdict(epoch: u64, seq: u64, level: VerdictLevel, outcome: VerdictOutcome) -> Verdict {
    let mut verdict = Verdict { level: level.code(), outcome: outcome.code(), ..Default::default() };
    verdict.stamp.epoch = epoch;
    verdict.stamp.seq = seq;
    verdict
}

/// A judge that watches job 1, and has judged nothing.
pub(super) fn watching() -> Judging {
    Judging {
        phase: JudgePhase::Waiting.code(),
        is_enabled: 1,
        job_id: 1,
        model_hash: 11,
        ..Judging::default()
    }
}

/// The judge has sent a verdict, and says so.
pub(super) fn judged(machine: &mut Handshake, verdict: &Verdict, now_ns: u64) {
    let is_end = verdict.level() == Ok(VerdictLevel::Job);
    let phase = if is_end { JudgePhase::Waiting } else { JudgePhase::Running };
    let (verdict_epoch, verdict_seq) = (verdict.stamp.epoch, verdict.stamp.seq);
    machine.judging(&Judging { verdict_epoch, verdict_seq, phase: phase.code(), ..watching() }, now_ns);
}

/// The judge answers a command.
fn answer(machine: &mut Handshake, command: &LineCommand, refusal: Refusal, judging: Judging) {
    machine.judging(&Judging { command: command.number, refusal: refusal.code(), ..judging }, 0);
}

/// The role `journal`, as the state machine sees it.
#[derive(Clone, Debug, Default)]
pub(super) struct Journal {
    identity: u64,
    rows: Vec<(u64, Verdict)>,
    kept: Account,
    asked: (u32, u32),
    sent_row: u64,
    /// Rows that it may still send before it is told something.
    room: usize,
    /// What it sends does not arrive.
    is_cut_off: bool,
}

impl Journal {
    pub(super) fn new(identity: u64) -> Self {
        Self { identity, kept: Account { journal: identity, ..Account::default() }, ..Self::default() }
    }

    /// Writes a verdict.
    pub(super) fn write(&mut self, verdict: Verdict) {
        self.rows.push((self.rows.len() as u64 + 1, verdict));
    }

    /// What it says at its start and after each account.
    fn says(&self) -> AccountKept {
        AccountKept { journal: self.identity, account: self.kept, ..AccountKept::default() }
    }

    /// Exchanges everything that is due. False where nothing was.
    pub(super) fn serve(&mut self, machine: &mut Handshake, now_ns: u64) -> bool {
        let mut has_served = false;
        if !machine.ledger.is_open() {
            machine.kept(&self.says(), now_ns);
        }
        if let Some(update) = machine.update(now_ns) {
            (has_served, self.room) = (true, 32);
            if update.account.journal == self.identity {
                self.kept = update.account;
            }
            let asked = (update.account.boot, update.asked);
            if asked != self.asked {
                (self.asked, self.sent_row) = (asked, update.after_row);
            }
            machine.kept(&self.says(), now_ns);
        }
        let from = self.sent_row;
        let rows: Vec<_> = self.rows.iter().filter(|(row, _)| *row > from).take(self.room).copied().collect();
        self.room -= rows.len();
        for (row, verdict) in rows {
            if !self.is_cut_off {
                machine.journalled(&self.row(row, verdict), now_ns);
            }
            self.sent_row = row;
        }
        has_served
    }

    fn row(&self, row: u64, verdict: Verdict) -> Journalled {
        let ((boot, asked), before) = (self.asked, self.sent_row);
        Journalled { journal: self.identity, row, before, boot, asked, verdict, ..Journalled::default() }
    }

    pub(super) fn settle(&mut self, machine: &mut Handshake, now_ns: u64) {
        while self.serve(machine, now_ns) {}
    }
}

/// A machine that is enabled and ready, at time 0, and a journal beside it.
fn ready_with_journal(settings: Settings) -> (Handshake, Journal) {
    let (mut machine, mut journal) = (ready(settings), Journal::new(77));
    journal.settle(&mut machine, 0);
    (machine, journal)
}

/// The judge sends a verdict, and the journal has it at once.
fn send(machine: &mut Handshake, journal: &mut Journal, verdict: &Verdict, now_ns: u64) {
    judged(machine, verdict, now_ns);
    journal.write(*verdict);
    journal.settle(machine, now_ns);
}

/// The role starts again, and the journal is the same.
fn restarted(settings: Settings, journal: &mut Journal) -> Handshake {
    let mut machine = ready(settings);
    journal.settle(&mut machine, 0);
    machine
}

/// A machine that is enabled and whose line is ready, at time 0. Of the journal it knows nothing yet.
pub(super) fn ready(settings: Settings) -> Handshake {
    let mut machine = Handshake::new(settings, 0);
    machine.write(ENABLED, 0);
    machine.judging(&watching(), 0);
    machine.tick(Line::Ready, 0);
    machine
}

fn has(machine: &Handshake, now_ns: u64, bits: u16) -> bool {
    machine.image(now_ns).status & bits == bits
}

pub(super) fn set(machine: &mut Handshake, bits: u16) {
    machine.write(Control { word: control::ENABLE | bits, ..ENABLED }, 0);
}

fn acknowledge(machine: &mut Handshake, journal: &mut Journal) {
    set(machine, control::ACKNOWLEDGE);
    journal.settle(machine, 0);
    set(machine, 0);
}

const OK: VerdictOutcome = VerdictOutcome::Ok;

const ANOMALY: VerdictOutcome = VerdictOutcome::Anomaly;

fn iu(epoch: u64, seq: u64, outcome: VerdictOutcome) -> Verdict {
    verdict(epoch, seq, VerdictLevel::Iu, outcome)
}

/// The number of the offered result, with its outcome bit.
fn offered(machine: &Handshake) -> Option<(u32, u16)> {
    let image = machine.image(0);
    let outcome = image.status & (status::OK | status::NOK | status::NOT_JUDGED);
    (image.status & status::DONE != 0).then(|| (image.result.unwrap().sequence, outcome))
}

/// The PLC takes and acknowledges everything that is offered; the numbers of it.
fn taken(machine: &mut Handshake, journal: &mut Journal) -> Vec<u32> {
    let mut taken = Vec::new();
    while let Some((sequence, _)) = offered(machine) {
        taken.push(sequence);
        acknowledge(machine, journal);
    }
    taken
}

/// A machine whose client has just asked for this, and the command for the judge.
fn asked(bits: u16, load_job_id: u32) -> (Handshake, LineCommand) {
    let (mut machine, _) = ready_with_journal(WRITES);
    machine.write(Control { word: control::ENABLE | bits, load_job_id, load_model_hash: 9, ..ENABLED }, 0);
    let command = machine.next_command(0).unwrap();
    (machine, command)
}
