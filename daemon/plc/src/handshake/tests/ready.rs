//! `ready`, `busy`, the latched fault and the heartbeat.

use super::*;

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
fn enable_is_a_level_and_its_end_drops_ready_and_busy() {
    let (mut machine, _) = ready_with_journal(WRITES);
    judged(&mut machine, &iu(1, 1, OK), 0);
    assert!(has(&machine, 0, status::READY | status::BUSY));
    machine.write(Control::default(), 0);
    assert_eq!(machine.next_command(0).unwrap().kind, CommandKind::Disable);
    assert_eq!(machine.image(0).status & (status::READY | status::BUSY), 0);
}

#[test]
fn a_judge_that_is_not_heard_drops_ready() {
    let (mut machine, _) = ready_with_journal(WRITES);
    machine.tick(Line::Ready, 2_001 * MS);
    assert_eq!(machine.image(2_001 * MS).error, Fault::Command as u16);
    assert!(!has(&machine, 2_001 * MS, status::READY));
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
