//! What outlives a start of this role, of the judge and of the journal.

use super::*;

#[test]
fn a_restart_offers_again_what_was_not_acknowledged_and_keeps_lost_overrun_and_error() {
    let (mut machine, mut journal) = ready_with_journal(WRITES);
    // The journal has lost the seventh.
    for seq in (1..=6).chain(8..=14) {
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
    let taken = taken(&mut machine, &mut journal);
    assert_eq!(taken, [2, 3, 4, 5, 6, 8, 9, 10, 11, 12, 13, 14, 15]);
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
