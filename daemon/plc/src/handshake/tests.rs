#![allow(clippy::unwrap_used, clippy::panic)]
use super::*;
use shm_schemas::VerdictOutcome;

pub(super) const WRITES: Settings = Settings { writes: true, hold_ns: 0 };
pub(super) const ENABLED: Control = Control { word: control::ENABLE, load_job_id: 0, load_model_hash: 0 };

fn verdict(epoch: u64, seq: u64, level: VerdictLevel, outcome: VerdictOutcome) -> Verdict {
    let mut verdict = Verdict { level: level.code(), outcome: outcome.code(), ..Default::default() };
    verdict.stamp.epoch = epoch;
    verdict.stamp.seq = seq;
    verdict
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
    machine.judged(verdict, now_ns);
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
    machine.tick(Line::Ready, 0);
    while let Some(command) = machine.next_command() {
        machine.command_sent(command.kind, true);
    }
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
    machine.judged(&iu(1, 1, OK), 0);
    assert!(!has(&machine, 0, status::DONE));
    journal.write(iu(1, 1, OK));
    journal.settle(&mut machine, 0);
    assert!(has(&machine, 0, status::DONE | status::OK));
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
    machine.judged(&iu(1, 2, ANOMALY), 0);
    machine.judged(&iu(1, 3, OK), 0);
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
        machine.judged(&iu(1, 1, OK), 0);
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
    machine.judged(&verdict(1, 1, VerdictLevel::Job, OK), 0);
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

#[test]
fn commands_are_sent_once_when_their_bit_rises_and_answered_until_it_falls() {
    let mut machine = ready(WRITES);
    let load = Control { word: control::ENABLE | control::LOAD_JOB, load_job_id: 7, load_model_hash: 9 };
    machine.write(load, 0);
    machine.write(load, 0);
    let command = machine.next_command().unwrap();
    assert_eq!(command, LineCommand { kind: CommandKind::LoadJob, job_id: 7, model_hash: 9 });
    assert_eq!(machine.next_command(), None);
    assert_eq!(machine.image(0).carried_out & control::LOAD_JOB, 0, "not sent yet");
    machine.command_sent(command.kind, true);
    assert_eq!(machine.image(0).carried_out & control::LOAD_JOB, control::LOAD_JOB);
    set(&mut machine, 0);
    assert_eq!(machine.image(0).carried_out & control::LOAD_JOB, 0);
}

#[test]
fn start_needs_ready_and_makes_busy_and_load_waits_for_the_end() {
    let (mut machine, _) = ready_with_journal(WRITES);
    set(&mut machine, control::START);
    let command = machine.next_command().unwrap();
    machine.command_sent(command.kind, true);
    assert!(has(&machine, 0, status::BUSY));
    set(&mut machine, control::LOAD_JOB);
    assert_eq!(machine.image(0).refused, control::LOAD_JOB);
    machine.judged(&verdict(1, 1, VerdictLevel::Job, VerdictOutcome::NotJudged), 0);
    assert!(!has(&machine, 0, status::BUSY));

    let mut lost = ready(WRITES);
    lost.tick(Line::Fault { fault: Fault::Camera, detail: 0 }, 0);
    set(&mut lost, control::START);
    assert_eq!((lost.image(0).refused, lost.next_command()), (control::START, None));
}

#[test]
fn without_enable_the_line_is_not_ready_and_commands_are_refused() {
    let mut machine = Handshake::new(WRITES, 0);
    machine.tick(Line::Ready, 0);
    assert!(!has(&machine, 0, status::READY));
    let refused = control::LOAD_JOB | control::START | control::ABORT;
    machine.write(Control { word: refused, ..ENABLED }, 0);
    assert_eq!((machine.image(0).refused, machine.next_command()), (refused, None));
}

#[test]
fn enable_is_a_level_and_its_end_drops_ready_and_busy() {
    let (mut machine, _) = ready_with_journal(WRITES);
    machine.judged(&iu(1, 1, OK), 0);
    assert!(has(&machine, 0, status::READY | status::BUSY));
    machine.write(Control::default(), 0);
    assert_eq!(machine.next_command().unwrap().kind, CommandKind::Disable);
    assert_eq!(machine.image(0).status & (status::READY | status::BUSY), 0);
}

#[test]
fn abort_ends_busy() {
    let (mut machine, _) = ready_with_journal(WRITES);
    machine.judged(&iu(1, 1, OK), 0);
    set(&mut machine, control::ABORT);
    let command = machine.next_command().unwrap();
    assert_eq!(command.kind, CommandKind::Abort);
    machine.command_sent(command.kind, true);
    assert_eq!(machine.image(0).carried_out & control::ABORT, control::ABORT);
    assert!(!has(&machine, 0, status::BUSY));
}

#[test]
fn acknowledge_is_refused_when_nothing_is_offered() {
    let mut machine = ready(WRITES);
    set(&mut machine, control::ACKNOWLEDGE);
    assert_eq!(machine.image(0).refused, control::ACKNOWLEDGE);
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
fn a_command_that_cannot_be_sent_is_refused_and_an_error() {
    let (mut machine, _) = ready_with_journal(WRITES);
    set(&mut machine, control::START);
    let command = machine.next_command().unwrap();
    machine.command_sent(command.kind, false);
    let image = machine.image(0);
    assert_eq!((image.refused, image.error), (control::START, Fault::Command as u16));
    assert_eq!(image.status & (status::BUSY | status::READY), 0);
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
