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

/// A machine that is enabled and ready, at time 0.
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

fn acknowledge(machine: &mut Handshake) {
    set(machine, control::ACKNOWLEDGE);
    set(machine, 0);
}

#[test]
fn done_waits_for_the_journal() {
    let mut machine = ready(WRITES);
    machine.verdict(&verdict(1, 1, VerdictLevel::Iu, VerdictOutcome::Ok), 0);
    assert!(!has(&machine, 0, status::DONE));
    machine.confirmed(1, 1, 0);
    assert!(has(&machine, 0, status::DONE | status::OK));
}

#[test]
fn a_confirmation_that_comes_before_its_verdict_counts() {
    let mut machine = ready(WRITES);
    machine.confirmed(1, 1, 0);
    machine.verdict(&verdict(1, 1, VerdictLevel::Iu, VerdictOutcome::Anomaly), 0);
    assert!(has(&machine, 0, status::DONE | status::NOK));
}

#[test]
fn a_journal_that_is_at_a_new_judge_is_through_with_the_old_one() {
    let mut machine = ready(WRITES);
    machine.verdict(&verdict(9, 1, VerdictLevel::Iu, VerdictOutcome::Ok), 0);
    machine.confirmed(4, 1, 0);
    assert!(!has(&machine, 0, status::DONE), "nothing is known of epoch 4 yet");
    machine.verdict(&verdict(4, 1, VerdictLevel::Iu, VerdictOutcome::Ok), 0);
    assert!(has(&machine, 0, status::DONE));
}

#[test]
fn a_result_stays_until_it_is_acknowledged() {
    let mut machine = ready(WRITES);
    machine.confirmed(1, 2, 0);
    machine.verdict(&verdict(1, 1, VerdictLevel::Iu, VerdictOutcome::Ok), 0);
    machine.verdict(&verdict(1, 2, VerdictLevel::Iu, VerdictOutcome::Anomaly), 0);
    machine.tick(Line::Ready, 3600 * 1000 * MS);
    assert_eq!(machine.image(0).result.unwrap().sequence, 1);
    set(&mut machine, control::ACKNOWLEDGE);
    assert_eq!(machine.image(0).status & (status::DONE | status::OK | status::NOK), 0);
    assert_eq!(machine.image(0).carried_out, control::ACKNOWLEDGE | control::ENABLE);
    set(&mut machine, 0);
    assert!(has(&machine, 0, status::DONE | status::NOK));
    assert_eq!(machine.image(0).result.unwrap().sequence, 2);
}

#[test]
fn eight_wait_behind_the_offered_one_and_the_tenth_is_an_overrun() {
    let mut machine = ready(WRITES);
    machine.confirmed(1, 99, 0);
    for seq in 1..=9 {
        machine.verdict(&verdict(1, seq, VerdictLevel::Iu, VerdictOutcome::Ok), 0);
    }
    assert!(!has(&machine, 0, status::OVERRUN));
    assert_eq!(machine.image(0).queued, 8);
    machine.verdict(&verdict(1, 10, VerdictLevel::Iu, VerdictOutcome::Anomaly), 0);
    assert!(has(&machine, 0, status::OVERRUN));
    for _ in 0..9 {
        acknowledge(&mut machine);
    }
    assert!(!has(&machine, 0, status::DONE));
    machine.verdict(&verdict(1, 11, VerdictLevel::Iu, VerdictOutcome::Ok), 0);
    let image = machine.image(0);
    assert_eq!((image.result.unwrap().sequence, image.lost), (11, 1), "the sequence jumps by what was lost");
    set(&mut machine, control::RESET_ERROR);
    assert!(!has(&machine, 0, status::OVERRUN));
}

#[test]
fn losses_on_the_channel_are_an_overrun_and_repeats_are_not_results() {
    let mut machine = ready(WRITES);
    machine.verdict(&verdict(1, 5, VerdictLevel::Iu, VerdictOutcome::Ok), 0);
    machine.verdict(&verdict(1, 5, VerdictLevel::Iu, VerdictOutcome::Ok), 0);
    assert_eq!((machine.image(0).lost, machine.image(0).queued), (0, 1));
    machine.verdict(&verdict(1, 8, VerdictLevel::Iu, VerdictOutcome::Ok), 0);
    assert_eq!(machine.image(0).lost, 2);
    machine.verdict(&verdict(2, 2, VerdictLevel::Iu, VerdictOutcome::Ok), 0);
    assert_eq!(machine.image(0).lost, 3, "a new judge numbers from 1");
    assert!(has(&machine, 0, status::OVERRUN));
}

#[test]
fn ready_drops_at_every_fault_and_busy_with_it_and_comes_back_after_reset() {
    for fault in Fault::ALL {
        let mut machine = ready(WRITES);
        machine.verdict(&verdict(1, 1, VerdictLevel::Iu, VerdictOutcome::Ok), 0);
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
    let machine = ready(WRITES);
    assert!(has(&machine, 500 * MS, status::READY | status::ONLINE));
    assert!(!has(&machine, 501 * MS, status::READY));
    assert!(!has(&machine, 501 * MS, status::ONLINE));

    let mut journal = ready(WRITES);
    journal.verdict(&verdict(1, 1, VerdictLevel::Job, VerdictOutcome::Ok), 0);
    journal.tick(Line::Ready, 2_001 * MS);
    assert_eq!(journal.image(2_001 * MS).error, Fault::Journal as u16);
    assert!(!has(&journal, 2_001 * MS, status::DONE));
}

#[test]
fn a_verdict_with_an_unknown_level_or_outcome_is_not_judged_and_an_error() {
    let known = verdict(1, 1, VerdictLevel::Iu, VerdictOutcome::Ok);
    for foreign in [Verdict { level: 77, ..known }, Verdict { outcome: 77, ..known }] {
        let mut machine = ready(WRITES);
        machine.confirmed(1, 1, 0);
        machine.verdict(&foreign, 0);
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
    let mut machine = ready(WRITES);
    set(&mut machine, control::START);
    let command = machine.next_command().unwrap();
    machine.command_sent(command.kind, true);
    assert!(has(&machine, 0, status::BUSY));
    set(&mut machine, control::LOAD_JOB);
    assert_eq!(machine.image(0).refused, control::LOAD_JOB);
    machine.verdict(&verdict(1, 1, VerdictLevel::Job, VerdictOutcome::NotJudged), 0);
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
    let mut machine = ready(WRITES);
    machine.verdict(&verdict(1, 1, VerdictLevel::Iu, VerdictOutcome::Ok), 0);
    assert!(has(&machine, 0, status::READY | status::BUSY));
    machine.write(Control::default(), 0);
    assert_eq!(machine.next_command().unwrap().kind, CommandKind::Disable);
    assert_eq!(machine.image(0).status & (status::READY | status::BUSY), 0);
}

#[test]
fn abort_ends_busy() {
    let mut machine = ready(WRITES);
    machine.verdict(&verdict(1, 1, VerdictLevel::Iu, VerdictOutcome::Ok), 0);
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
    let mut machine = ready(WRITES);
    set(&mut machine, control::START);
    let command = machine.next_command().unwrap();
    machine.command_sent(command.kind, false);
    let image = machine.image(0);
    assert_eq!((image.refused, image.error), (control::START, Fault::Command as u16));
    assert_eq!(image.status & (status::BUSY | status::READY), 0);
}

#[test]
fn with_writes_off_a_fault_stays_until_the_line_is_ready_again() {
    let mut machine = Handshake::new(Settings { writes: false, hold_ns: 0 }, 0);
    machine.tick(Line::Fault { fault: Fault::Role, detail: 0 }, 0);
    machine.tick(Line::Starting, 0);
    assert!(has(&machine, 0, status::ERROR));
    machine.tick(Line::Ready, 0);
    assert_eq!(machine.image(0).status & (status::ERROR | status::READY), status::READY);
}

#[test]
fn with_writes_off_a_result_gives_way_only_to_another_and_only_after_its_time() {
    let mut machine = Handshake::new(Settings { writes: false, hold_ns: 500 * MS }, 0);
    machine.confirmed(1, 9, 0);
    machine.verdict(&verdict(1, 1, VerdictLevel::Iu, VerdictOutcome::Ok), 0);
    machine.tick(Line::Ready, 9_000 * MS);
    assert_eq!(machine.image(0).result.unwrap().sequence, 1);
    machine.verdict(&verdict(1, 2, VerdictLevel::Iu, VerdictOutcome::Ok), 9_000 * MS);
    machine.verdict(&verdict(1, 3, VerdictLevel::Iu, VerdictOutcome::Ok), 9_000 * MS);
    assert_eq!(machine.image(0).result.unwrap().sequence, 2);
    machine.tick(Line::Ready, 9_499 * MS);
    assert_eq!(machine.image(0).result.unwrap().sequence, 2);
    machine.tick(Line::Ready, 9_500 * MS);
    assert_eq!(machine.image(0).result.unwrap().sequence, 3);
}
