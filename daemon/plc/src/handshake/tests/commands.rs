//! The commands, and the answers to them.

use super::*;

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
fn while_a_fault_is_latched_nothing_is_busy_and_another_job_may_be_loaded_in_the_middle_of_one() {
    let (mut machine, _) = ready_with_journal(WRITES);
    judged(&mut machine, &iu(1, 1, OK), 0);
    assert!(has(&machine, 0, status::BUSY));
    machine.tick(Line::Fault { fault: Fault::Camera, detail: 0 }, 0);
    assert!(!has(&machine, 0, status::BUSY));
    set(&mut machine, control::LOAD_JOB);
    assert_eq!(machine.image(0).refused, 0);
    assert_eq!(machine.next_command(0).unwrap().kind, CommandKind::LoadJob);
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
