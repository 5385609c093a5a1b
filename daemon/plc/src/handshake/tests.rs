#![allow(clippy::unwrap_used, clippy::panic)]
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
            has_served = true;
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
        for (row, verdict) in self.rows.clone().into_iter().filter(|(row, _)| *row > from) {
            machine.journalled(&self.row(row, verdict), now_ns);
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

#[test]
fn done_waits_for_the_journal() {
    let (mut machine, mut journal) = ready_with_journal(WRITES);
    judged(&mut machine, &iu(1, 1, OK), 0);
    assert!(!has(&machine, 0, status::DONE));
    journal.write(iu(1, 1, OK));
    journal.settle(&mut machine, 0);
    assert!(has(&machine, 0, status::DONE | status::OK));
}

#[test]
fn a_note_is_a_bit_beside_the_outcome() {
    for note in [0, VerdictNote::Order.code()] {
        let (mut machine, mut journal) = ready_with_journal(WRITES);
        send(&mut machine, &mut journal, &Verdict { note, ..iu(1, 1, OK) }, 0);
        assert!(has(&machine, 0, status::DONE | status::OK));
        assert_eq!(has(&machine, 0, status::NOTE), note != 0);
    }
}

#[test]
fn a_result_stays_until_it_is_acknowledged() {
    let (mut machine, mut journal) = ready_with_journal(WRITES);
    send(&mut machine, &mut journal, &iu(1, 1, OK), 0);
    send(&mut machine, &mut journal, &iu(1, 2, ANOMALY), 0);
    machine.tick(Line::Ready, 3600 * 1000 * MS);
    assert_eq!(offered(&machine), Some((1, status::OK)));
    set(&mut machine, control::ACKNOWLEDGE);
    assert_eq!(machine.image(0).carried_out & control::ACKNOWLEDGE, 0, "the journal does not keep it yet");
    assert_eq!(offered(&machine), Some((1, status::OK)));
    journal.settle(&mut machine, 0);
    assert_eq!(offered(&machine), None);
    assert_eq!(machine.image(0).carried_out, control::ACKNOWLEDGE | control::ENABLE);
    set(&mut machine, 0);
    assert_eq!(offered(&machine), Some((2, status::NOK)));
}

#[test]
fn eight_wait_behind_the_offered_one_and_the_tenth_is_an_overrun() {
    let (mut machine, mut journal) = ready_with_journal(WRITES);
    for seq in 1..=9 {
        send(&mut machine, &mut journal, &iu(1, seq, OK), 0);
    }
    assert!(!has(&machine, 0, status::OVERRUN));
    assert_eq!(machine.image(0).queued, 8);
    send(&mut machine, &mut journal, &iu(1, 10, ANOMALY), 0);
    assert!(has(&machine, 0, status::OVERRUN));
    for _ in 0..9 {
        acknowledge(&mut machine, &mut journal);
    }
    assert!(!has(&machine, 0, status::DONE));
    send(&mut machine, &mut journal, &iu(1, 11, OK), 0);
    let image = machine.image(0);
    assert_eq!((image.result.unwrap().sequence, image.lost), (11, 1), "the sequence jumps by what was lost");
    set(&mut machine, control::RESET_ERROR);
    assert!(!has(&machine, 0, status::OVERRUN));
}

#[test]
fn what_the_journal_has_lost_is_an_overrun_and_repeats_are_not_results() {
    let (mut machine, mut journal) = ready_with_journal(WRITES);
    send(&mut machine, &mut journal, &iu(1, 5, OK), 0);
    send(&mut machine, &mut journal, &iu(1, 5, OK), 0);
    assert_eq!((machine.image(0).lost, machine.image(0).queued), (0, 0));
    send(&mut machine, &mut journal, &iu(1, 8, OK), 0);
    assert_eq!(machine.image(0).lost, 2);
    send(&mut machine, &mut journal, &iu(2, 2, OK), 0);
    assert_eq!(machine.image(0).lost, 3, "a new judge numbers from 1");
    assert!(has(&machine, 0, status::OVERRUN));
}

#[test]
fn a_restart_offers_again_what_was_not_acknowledged_and_keeps_lost_overrun_and_error() {
    let (mut machine, mut journal) = ready_with_journal(WRITES);
    for seq in 1..=14 {
        let outcome = if seq == 2 { ANOMALY } else { OK };
        send(&mut machine, &mut journal, &iu(1, seq, outcome), 0);
    }
    acknowledge(&mut machine, &mut journal);
    machine.tick(Line::Fault { fault: Fault::Camera, detail: 104 }, 0);
    journal.settle(&mut machine, 0);
    let before = machine.image(0);
    assert_eq!(offered(&machine), Some((2, status::NOK)));

    // While the role was gone the judge was killed as well, and its successor has sent something.
    journal.write(iu(2, 1, OK));
    let mut machine = restarted(WRITES, &mut journal);
    let image = machine.image(0);
    assert_eq!(offered(&machine), Some((2, status::NOK)), "under its old number");
    assert_eq!((image.boot, before.boot), (2, 1));
    assert_eq!((image.lost, image.error, image.error_detail), (before.lost, Fault::Camera as u16, 104));
    assert!(has(&machine, 0, status::OVERRUN | status::ERROR));
    let mut taken = Vec::new();
    while let Some((sequence, _)) = offered(&machine) {
        taken.push(sequence);
        acknowledge(&mut machine, &mut journal);
    }
    assert_eq!(taken, [2, 3, 4, 5, 6, 7, 8, 9, 15], "10 to 14 were lost before");
}

#[test]
fn an_acknowledgement_that_the_journal_does_not_keep_does_not_count_after_a_restart() {
    let (mut machine, mut journal) = ready_with_journal(WRITES);
    send(&mut machine, &mut journal, &iu(1, 1, ANOMALY), 0);
    set(&mut machine, control::ACKNOWLEDGE);
    let machine = restarted(WRITES, &mut journal);
    assert_eq!(offered(&machine), Some((1, status::NOK)));
}

#[test]
fn an_acknowledged_result_is_not_offered_again_after_a_restart() {
    let (mut machine, mut journal) = ready_with_journal(WRITES);
    send(&mut machine, &mut journal, &iu(1, 1, OK), 0);
    acknowledge(&mut machine, &mut journal);
    let mut machine = restarted(WRITES, &mut journal);
    assert_eq!(offered(&machine), None);
    send(&mut machine, &mut journal, &iu(1, 2, ANOMALY), 0);
    assert_eq!(offered(&machine), Some((2, status::NOK)));
    assert_eq!(machine.image(0).lost, 0);
}

#[test]
fn before_the_first_account_nothing_is_the_plc_s() {
    let mut journal = Journal::new(77);
    journal.write(iu(1, 1, OK));
    journal.kept = Account { journal: 77, row: 1, epoch: 1, seq: 1, ..Account::default() };
    let mut machine = restarted(WRITES, &mut journal);
    assert_eq!(offered(&machine), None);
    send(&mut machine, &mut journal, &iu(1, 2, OK), 0);
    assert_eq!((offered(&machine), machine.image(0).lost), (Some((1, status::OK)), 0));
}

#[test]
fn rows_that_were_lost_on_their_way_are_asked_for_again() {
    let (mut machine, mut journal) = ready_with_journal(WRITES);
    send(&mut machine, &mut journal, &iu(1, 1, OK), 0);
    // The journal believes that it has sent row 2.
    journal.write(iu(1, 2, ANOMALY));
    journal.sent_row = 2;
    judged(&mut machine, &iu(1, 2, ANOMALY), 0);
    judged(&mut machine, &iu(1, 3, OK), 0);
    journal.write(iu(1, 3, OK));
    journal.settle(&mut machine, 0);
    assert_eq!(machine.image(0).queued, 0, "row 3 came without row 2");
    machine.tick(Line::Ready, 600 * MS);
    journal.settle(&mut machine, 600 * MS);
    assert_eq!((machine.image(0).queued, machine.image(0).lost), (2, 0));
}

#[test]
fn a_journal_that_was_made_anew_goes_on_without_a_repeat() {
    let (mut machine, mut journal) = ready_with_journal(WRITES);
    for seq in 1..=3 {
        send(&mut machine, &mut journal, &iu(1, seq, OK), 0);
    }
    let mut anew = Journal::new(78);
    // It reads again what is still on the judge's channel.
    (2..=4).for_each(|seq| anew.write(iu(1, seq, OK)));
    machine.kept(&anew.says(), 0);
    anew.settle(&mut machine, 0);
    let mut taken = Vec::new();
    while let Some((sequence, _)) = offered(&machine) {
        taken.push(sequence);
        acknowledge(&mut machine, &mut anew);
    }
    assert_eq!((taken, machine.image(0).lost), (vec![1, 2, 3, 4], 0));
}

#[test]
fn what_another_journal_cannot_give_back_is_lost_and_said() {
    let (mut machine, mut journal) = ready_with_journal(WRITES);
    for seq in 1..=3 {
        send(&mut machine, &mut journal, &iu(1, seq, OK), 0);
    }
    let mut anew = Journal::new(78);
    machine.kept(&anew.says(), 0);
    anew.settle(&mut machine, 0);
    let mut machine = restarted(WRITES, &mut anew);
    send(&mut machine, &mut anew, &iu(1, 4, ANOMALY), 0);
    assert_eq!((offered(&machine), machine.image(0).lost), (Some((4, status::NOK)), 3));
    assert!(has(&machine, 0, status::OVERRUN));
}

#[test]
fn ready_drops_at_every_fault_and_busy_with_it_and_comes_back_after_reset() {
    for fault in Fault::ALL {
        let (mut machine, _) = ready_with_journal(WRITES);
        judged(&mut machine, &iu(1, 1, OK), 0);
        assert!(has(&machine, 0, status::READY | status::BUSY));
        machine.tick(Line::Fault { fault, detail: 104 }, 0);
        let image = machine.image(0);
        assert_eq!(image.status & (status::READY | status::BUSY | status::ERROR), status::ERROR);
        assert_eq!((image.error, image.error_detail), (fault as u16, 104));
        set(&mut machine, control::RESET_ERROR);
        assert!(has(&machine, 0, status::ERROR), "it is still wrong");
        machine.tick(Line::Ready, 0);
        assert!(!has(&machine, 0, status::READY), "latched");
        set(&mut machine, 0);
        set(&mut machine, control::RESET_ERROR);
        assert!(has(&machine, 0, status::READY));
    }
}

#[test]
fn silence_of_the_loop_or_of_the_journal_drops_ready() {
    let (machine, _) = ready_with_journal(WRITES);
    assert!(has(&machine, 500 * MS, status::READY | status::ONLINE));
    assert!(!has(&machine, 501 * MS, status::READY));
    assert!(!has(&machine, 501 * MS, status::ONLINE));

    let (mut machine, _) = ready_with_journal(WRITES);
    judged(&mut machine, &verdict(1, 1, VerdictLevel::Job, OK), 0);
    machine.tick(Line::Ready, 2_001 * MS);
    assert_eq!(machine.image(2_001 * MS).error, Fault::Journal as u16);
    assert!(!has(&machine, 2_001 * MS, status::DONE));

    let mut machine = ready(WRITES);
    machine.tick(Line::Ready, 0);
    assert!(!has(&machine, 0, status::READY), "nothing is known of the journal yet");
}

#[test]
fn a_verdict_with_an_unknown_level_or_outcome_is_not_judged_and_an_error() {
    let known = iu(1, 1, OK);
    for foreign in [Verdict { level: 77, ..known }, Verdict { outcome: 77, ..known }] {
        let (mut machine, mut journal) = ready_with_journal(WRITES);
        send(&mut machine, &mut journal, &foreign, 0);
        assert!(has(&machine, 0, status::DONE | status::NOT_JUDGED | status::ERROR));
        assert_eq!(machine.image(0).error, Fault::ForeignVerdict as u16);
    }
}

/// A machine whose client has just asked for this, and the command for the judge.
fn asked(bits: u16, load_job_id: u32) -> (Handshake, LineCommand) {
    let (mut machine, _) = ready_with_journal(WRITES);
    machine.write(Control { word: control::ENABLE | bits, load_job_id, load_model_hash: 9, ..ENABLED }, 0);
    let command = machine.next_command(0).unwrap();
    (machine, command)
}

#[test]
fn a_command_is_under_way_until_the_judge_answers_and_its_answer_stays_until_the_bit_falls() {
    let (mut machine, command) = asked(control::LOAD_JOB, 7);
    assert_eq!((command.kind, command.job_id, command.model_hash), (CommandKind::LoadJob, 7, 9));
    assert_eq!(machine.next_command(0), None, "it is sent once");
    let image = machine.image(0);
    assert_eq!((image.executing, image.carried_out & control::LOAD_JOB), (control::LOAD_JOB, 0));
    answer(&mut machine, &command, Refusal::None, Judging { job_id: 7, model_hash: 9, ..watching() });
    let image = machine.image(0);
    assert_eq!((image.executing, image.carried_out & control::LOAD_JOB), (0, control::LOAD_JOB));
    assert_eq!((image.job_in_force, image.hash_in_force), (7, 9));
    set(&mut machine, 0);
    assert_eq!(machine.image(0).carried_out & control::LOAD_JOB, 0);
}

#[test]
fn a_command_that_the_judge_refuses_is_refused_with_the_reason_and_changes_nothing() {
    let (mut machine, command) = asked(control::LOAD_JOB, 999);
    answer(&mut machine, &command, Refusal::NoSuchJob, watching());
    let image = machine.image(0);
    assert_eq!((image.refused, image.refusal), (control::LOAD_JOB, u16::from(Refusal::NoSuchJob.code())));
    assert_eq!((image.job_in_force, image.hash_in_force), (1, 11));
    assert!(has(&machine, 0, status::READY), "the job of before goes on");
    assert_eq!(machine.next_command(5_000 * MS), None, "what was refused is not wanted");
}

#[test]
fn a_command_without_an_answer_is_sent_again_under_its_number_and_then_refused() {
    let (mut machine, command) = asked(control::START, 0);
    assert_eq!(machine.next_command(300 * MS), Some(command));
    machine.judging(&watching(), 1_000 * MS);
    machine.tick(Line::Ready, 2_100 * MS);
    let image = machine.image(2_100 * MS);
    assert_eq!((image.refused, image.refusal), (control::START, u16::from(Refusal::NoAnswer.code())));
    assert_eq!(image.error, Fault::Command as u16);
    assert_eq!(machine.next_command(2_100 * MS), None);
}

#[test]
fn a_judge_that_starts_again_is_given_the_loaded_job_and_then_enable_and_until_then_nothing_is_ready() {
    let (mut machine, command) = asked(control::LOAD_JOB, 7);
    let with_job = Judging { job_id: 7, model_hash: 9, ..watching() };
    answer(&mut machine, &command, Refusal::None, with_job);
    assert!(has(&machine, 0, status::READY));
    let configured = Judging { is_enabled: 0, ..watching() };
    machine.judging(&configured, 0);
    assert!(!has(&machine, 0, status::READY));
    let load = machine.next_command(0).unwrap();
    assert_eq!((load.kind, load.job_id, load.model_hash), (CommandKind::LoadJob, 7, 9));
    answer(&mut machine, &load, Refusal::None, Judging { is_enabled: 0, ..with_job });
    let enable = machine.next_command(0).unwrap();
    assert_eq!(enable.kind, CommandKind::Enable);
    answer(&mut machine, &enable, Refusal::None, with_job);
    assert!(has(&machine, 0, status::READY));
}

#[test]
fn the_loaded_job_is_wanted_after_a_restart_too_and_one_that_is_refused_then_is_an_error() {
    let (mut machine, mut journal) = ready_with_journal(WRITES);
    machine.write(
        Control { word: control::ENABLE | control::LOAD_JOB, load_job_id: 7, load_model_hash: 9, ..ENABLED },
        0,
    );
    let command = machine.next_command(0).unwrap();
    answer(&mut machine, &command, Refusal::None, Judging { job_id: 7, model_hash: 9, ..watching() });
    journal.settle(&mut machine, 0);
    let mut machine = restarted(WRITES, &mut journal);
    assert!(!has(&machine, 0, status::READY));
    let again = machine.next_command(0).unwrap();
    assert_eq!((again.kind, again.job_id, again.model_hash), (CommandKind::LoadJob, 7, 9));
    assert_ne!(again.number, command.number);
    answer(&mut machine, &again, Refusal::NoSuchJob, watching());
    let image = machine.image(0);
    assert_eq!((image.error, image.error_detail), (Fault::Command as u16, JOB_REFUSED));
    assert_eq!(machine.next_command(500 * MS), None);
    assert_eq!(machine.next_command(1_000 * MS).unwrap().job_id, 7, "it may have been put back");
}

#[test]
fn start_needs_ready_and_makes_busy_and_load_waits_for_the_end() {
    let (mut machine, command) = asked(control::START, 0);
    assert_eq!(command.kind, CommandKind::Start);
    answer(
        &mut machine,
        &command,
        Refusal::None,
        Judging { phase: JudgePhase::Running.code(), ..watching() },
    );
    assert!(has(&machine, 0, status::BUSY));
    set(&mut machine, control::LOAD_JOB);
    let image = machine.image(0);
    assert_eq!((image.refused, image.refusal), (control::LOAD_JOB, u16::from(Refusal::Busy.code())));
    judged(&mut machine, &verdict(1, 1, VerdictLevel::Job, VerdictOutcome::NotJudged), 0);
    assert!(!has(&machine, 0, status::BUSY));

    let (mut lost, _) = ready_with_journal(WRITES);
    lost.tick(Line::Fault { fault: Fault::Camera, detail: 0 }, 0);
    set(&mut lost, control::START);
    assert_eq!((lost.image(0).refused, lost.next_command(0)), (control::START, None));
    assert_eq!(lost.image(0).refusal, u16::from(Refusal::NotReady.code()));
}

#[test]
fn before_enable_is_written_the_judge_is_told_not_to_watch_and_commands_are_refused() {
    let mut machine = Handshake::new(WRITES, 0);
    Journal::new(77).settle(&mut machine, 0);
    machine.judging(&watching(), 0);
    machine.tick(Line::Ready, 0);
    assert!(!has(&machine, 0, status::READY));
    let command = machine.next_command(0).unwrap();
    assert_eq!(command.kind, CommandKind::Disable);
    answer(&mut machine, &command, Refusal::None, Judging { is_enabled: 0, ..watching() });
    let refused = control::LOAD_JOB | control::START | control::ABORT;
    machine.write(Control { word: refused, ..ENABLED }, 0);
    assert_eq!((machine.image(0).refused, machine.next_command(0)), (refused, None));
    assert_eq!(machine.image(0).refusal, u16::from(Refusal::NotEnabled.code()));
}

#[test]
fn an_acknowledgement_of_nothing_and_a_command_too_many_are_refused() {
    let (mut machine, _) = ready_with_journal(WRITES);
    set(&mut machine, control::ACKNOWLEDGE);
    let image = machine.image(0);
    let nothing_offered = u16::from(Refusal::NothingOffered.code());
    assert_eq!((image.refused, image.refusal), (control::ACKNOWLEDGE, nothing_offered));
    for _ in 0..100 {
        set(&mut machine, 0);
        set(&mut machine, control::ABORT);
    }
    let image = machine.image(0);
    assert_eq!((image.refused, image.refusal), (control::ABORT, u16::from(Refusal::TooMany.code())));
}

#[test]
fn enable_is_a_level_and_its_end_drops_ready_and_busy() {
    let (mut machine, _) = ready_with_journal(WRITES);
    judged(&mut machine, &iu(1, 1, OK), 0);
    assert!(has(&machine, 0, status::READY | status::BUSY));
    machine.write(Control::default(), 0);
    assert_eq!(machine.next_command(0).unwrap().kind, CommandKind::Disable);
    assert_eq!(machine.image(0).status & (status::READY | status::BUSY), 0);
}

#[test]
fn abort_ends_busy() {
    let (mut machine, _) = ready_with_journal(WRITES);
    judged(&mut machine, &iu(1, 1, OK), 0);
    set(&mut machine, control::ABORT);
    let command = machine.next_command(0).unwrap();
    assert_eq!(command.kind, CommandKind::Abort);
    answer(&mut machine, &command, Refusal::None, watching());
    assert_eq!(machine.image(0).carried_out & control::ABORT, control::ABORT);
    assert!(!has(&machine, 0, status::BUSY));
}

#[test]
fn a_judge_that_is_not_heard_drops_ready() {
    let (mut machine, _) = ready_with_journal(WRITES);
    machine.tick(Line::Ready, 2_001 * MS);
    assert_eq!(machine.image(2_001 * MS).error, Fault::Command as u16);
    assert!(!has(&machine, 2_001 * MS, status::READY));
}

#[test]
fn acknowledge_is_refused_when_nothing_is_offered() {
    let mut machine = ready(WRITES);
    set(&mut machine, control::ACKNOWLEDGE);
    assert_eq!(machine.image(0).refused, control::ACKNOWLEDGE);
}

#[test]
fn an_acknowledgement_that_names_another_result_is_refused() {
    let (mut machine, mut journal) = ready_with_journal(WRITES);
    for seq in 1..=2 {
        send(&mut machine, &mut journal, &iu(1, seq, OK), 0);
    }
    let named = |sequence| Control {
        word: control::ENABLE | control::ACKNOWLEDGE,
        acknowledge_sequence: sequence,
        ..ENABLED
    };
    machine.write(named(1), 0);
    journal.settle(&mut machine, 0);
    assert_eq!(offered(&machine), None);
    // This start ends. The next one offers the second, and a client that writes in a cycle still writes the first.
    let mut machine = restarted(WRITES, &mut journal);
    assert_eq!(offered(&machine), Some((2, status::OK)));
    machine.write(named(1), 0);
    journal.settle(&mut machine, 0);
    let image = machine.image(0);
    assert_eq!(
        (image.refused, image.refusal),
        (control::ACKNOWLEDGE, u16::from(Refusal::OtherResult.code()))
    );
    assert_eq!(offered(&machine), Some((2, status::OK)), "it was not read yet");
    machine.write(ENABLED, 0);
    machine.write(named(2), 0);
    journal.settle(&mut machine, 0);
    assert_eq!(offered(&machine), None);
}

/// What a client writes to set the part of the next job.
fn with_part(bytes: &[u8]) -> Control {
    let mut part = [0; shm_schemas::PART_BYTES];
    part[..bytes.len()].copy_from_slice(bytes);
    Control { word: control::ENABLE | control::SET_PART, part, ..ENABLED }
}

#[test]
fn a_part_id_is_given_to_the_judge_until_it_has_it_and_again_before_enable_after_its_restart() {
    let (mut machine, _) = ready_with_journal(WRITES);
    machine.write(with_part(b"A-17 "), 0);
    let command = machine.next_command(0).unwrap();
    assert_eq!((command.kind, command.part.text()), (CommandKind::SetPart, "A-17"));
    assert_eq!(machine.image(0).executing & control::SET_PART, control::SET_PART);
    let with_id = Judging { part: command.part, ..watching() };
    answer(&mut machine, &command, Refusal::None, with_id);
    let image = machine.image(0);
    assert_eq!(image.carried_out & control::SET_PART, control::SET_PART);
    assert_eq!(image.next_part.text(), "A-17");
    machine.write(ENABLED, 0);
    assert_eq!(machine.next_command(0), None, "the registers of the id may be written before its bit");

    machine.judging(&Judging { is_enabled: 0, ..watching() }, 0);
    let again = machine.next_command(0).unwrap();
    assert_eq!((again.kind, again.part.text()), (CommandKind::SetPart, "A-17"));
    answer(&mut machine, &again, Refusal::None, Judging { is_enabled: 0, ..with_id });
    assert_eq!(machine.next_command(0).unwrap().kind, CommandKind::Enable);
}

#[test]
fn a_job_that_a_client_asks_for_in_vain_does_not_keep_the_judge_from_the_one_that_is_wanted() {
    let (mut machine, load) = asked(control::LOAD_JOB, 7);
    let loaded = Judging { job_id: 7, model_hash: 9, ..watching() };
    answer(&mut machine, &load, Refusal::None, loaded);
    // Again and again, and the judge has started again meanwhile.
    for _ in 0..3 {
        machine.write(ENABLED, 0);
        machine.write(Control { word: control::ENABLE | control::LOAD_JOB, load_job_id: 8, ..ENABLED }, 0);
        let vain = machine.next_command(0).unwrap();
        assert_eq!((vain.kind, vain.job_id), (CommandKind::LoadJob, 8));
        answer(&mut machine, &vain, Refusal::NoSuchJob, Judging { is_enabled: 0, ..watching() });
    }
    let wanted = machine.next_command(0).unwrap();
    assert_eq!((wanted.kind, wanted.job_id), (CommandKind::LoadJob, 7));
    answer(&mut machine, &wanted, Refusal::None, Judging { is_enabled: 0, ..loaded });
    assert_eq!(machine.next_command(0).unwrap().kind, CommandKind::Enable, "nothing is judged before");
}

#[test]
fn a_start_whose_number_is_not_on_disk_has_none_and_commands_nothing() {
    let (mut machine, journal) = (ready(WRITES), Journal::new(77));
    machine.kept(&journal.says(), 0);
    set(&mut machine, control::ABORT);
    let update = machine.update(0).unwrap();
    assert_eq!((update.account.boot, machine.image(0).boot, machine.next_command(0)), (1, 0, None));
    assert!(!has(&machine, 0, status::READY));
    machine.kept(&AccountKept { journal: 77, account: update.account, ..AccountKept::default() }, 0);
    assert_eq!((machine.image(0).boot, machine.next_command(0).unwrap().kind), (1, CommandKind::Abort));
    assert!(has(&machine, 0, status::READY));
}

#[test]
fn a_part_id_survives_a_restart_of_this_role_and_of_the_judge_together() {
    for (given, kept) in [(&b"A-17"[..], "A-17"), (b"", "")] {
        let (mut machine, mut journal) = ready_with_journal(WRITES);
        machine.write(with_part(given), 0);
        journal.settle(&mut machine, 0);
        let mut machine = restarted(WRITES, &mut journal);
        let scanned = PartId::new(b"scanned").unwrap();
        machine.judging(&Judging { part: scanned, ..watching() }, 0);
        let again = machine.next_command(0).unwrap();
        assert_eq!((again.kind, again.part.text()), (CommandKind::SetPart, kept));
    }
}

#[test]
fn a_part_id_that_is_none_is_refused_and_the_next_job_has_none_instead_of_the_one_before() {
    let (mut machine, _) = ready_with_journal(WRITES);
    machine.write(with_part(b"A-17"), 0);
    let command = machine.next_command(0).unwrap();
    answer(&mut machine, &command, Refusal::None, Judging { part: command.part, ..watching() });
    machine.write(ENABLED, 0);
    machine.write(with_part(b"A\x01"), 0);
    let image = machine.image(0);
    assert_eq!((image.refused, image.refusal), (control::SET_PART, u16::from(Refusal::BadPart.code())));
    let none = machine.next_command(0).unwrap();
    assert_eq!((none.kind, none.part), (CommandKind::SetPart, PartId::NONE));
}

#[test]
fn a_plc_that_gives_no_part_id_leaves_that_of_the_tool() {
    let (mut machine, _) = ready_with_journal(WRITES);
    machine.judging(&Judging { part: PartId::new(b"scanned").unwrap(), ..watching() }, 0);
    assert_eq!(machine.next_command(0), None);
    assert_eq!(machine.image(0).next_part.text(), "scanned");
}

#[test]
fn why_the_line_is_not_ready_is_said_in_words() {
    let (mut machine, _) = ready_with_journal(WRITES);
    assert_eq!(machine.obstacle(0), None);
    machine.write(Control::default(), 0);
    assert!(machine.obstacle(0).unwrap().contains("`enable`"), "not a fault of the line");
    machine.write(ENABLED, 0);
    machine.tick(Line::Fault { fault: Fault::Camera, detail: 0 }, 0);
    assert_eq!(machine.obstacle(0), Some(Fault::Camera.meaning()));
}

#[test]
fn the_heartbeat_counts_the_loop_s_quarters_of_a_second() {
    let mut machine = ready(WRITES);
    machine.tick(Line::Ready, 249 * MS);
    assert_eq!(machine.image(0).heartbeat, 0);
    machine.tick(Line::Ready, 250 * MS);
    assert_eq!(machine.image(0).heartbeat, 1);
}

#[test]
fn with_writes_off_a_fault_stays_until_the_line_is_ready_again() {
    let (mut machine, _) = ready_with_journal(Settings { writes: false, hold_ns: 0 });
    machine.tick(Line::Fault { fault: Fault::Role, detail: 0 }, 0);
    machine.tick(Line::Starting, 0);
    assert!(has(&machine, 0, status::ERROR));
    machine.tick(Line::Ready, 0);
    assert_eq!(machine.image(0).status & (status::ERROR | status::READY), status::READY);
}

#[test]
fn with_writes_off_a_result_gives_way_only_to_another_and_only_after_its_time() {
    let settings = Settings { writes: false, hold_ns: 500 * MS };
    let (mut machine, mut journal) = ready_with_journal(settings);
    let turn = |machine: &mut Handshake, journal: &mut Journal, now_ns: u64| {
        machine.tick(Line::Ready, now_ns);
        journal.settle(machine, now_ns);
        offered(machine).unwrap().0
    };
    send(&mut machine, &mut journal, &iu(1, 1, OK), 0);
    assert_eq!(turn(&mut machine, &mut journal, 9_000 * MS), 1);
    send(&mut machine, &mut journal, &iu(1, 2, OK), 9_000 * MS);
    send(&mut machine, &mut journal, &iu(1, 3, OK), 9_000 * MS);
    assert_eq!(turn(&mut machine, &mut journal, 9_000 * MS), 2);
    assert_eq!(turn(&mut machine, &mut journal, 9_499 * MS), 2);
    assert_eq!(turn(&mut machine, &mut journal, 9_500 * MS), 3);
    let machine = restarted(settings, &mut journal);
    assert!(offered(&machine).is_none_or(|(sequence, _)| sequence >= 3), "nothing older after a restart");
}
