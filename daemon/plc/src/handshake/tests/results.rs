//! How a result is offered, acknowledged and followed by the next.

use super::*;

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
fn eight_wait_behind_the_offered_one_and_the_rest_in_the_journal_until_there_is_room() {
    let (mut machine, mut journal) = ready_with_journal(WRITES);
    for seq in 1..=60 {
        send(&mut machine, &mut journal, &iu(1, seq, OK), 0);
    }
    assert_eq!(machine.image(0).queued, 8);
    assert_eq!(taken(&mut machine, &mut journal), (1..=60).collect::<Vec<_>>());
    assert_eq!(machine.image(0).lost, 0);
    assert!(!has(&machine, 0, status::OVERRUN));
}

#[test]
fn a_plc_that_does_not_acknowledge_is_no_fault_of_the_journal() {
    let (mut machine, mut journal) = ready_with_journal(WRITES);
    for seq in 1..=20 {
        send(&mut machine, &mut journal, &iu(1, seq, OK), 0);
    }
    for now_ns in [1_000 * MS, 2_000 * MS, 3_000 * MS, 4_000 * MS] {
        judged(&mut machine, &iu(1, 20, OK), now_ns);
        machine.tick(Line::Ready, now_ns);
        journal.settle(&mut machine, now_ns);
    }
    assert!(has(&machine, 4_000 * MS, status::READY));
}

#[test]
fn with_writes_off_what_finds_the_queue_full_is_an_overrun_and_the_sequence_jumps() {
    let (mut machine, mut journal) = ready_with_journal(Settings { writes: false, hold_ns: 500 * MS });
    for seq in 1..=9 {
        send(&mut machine, &mut journal, &iu(1, seq, OK), 0);
    }
    assert!(!has(&machine, 0, status::OVERRUN));
    assert_eq!(machine.image(0).queued, 8);
    send(&mut machine, &mut journal, &iu(1, 10, ANOMALY), 0);
    assert!(has(&machine, 0, status::OVERRUN));
    for now_ns in (1..=10).map(|halves| halves * 500 * MS) {
        machine.tick(Line::Ready, now_ns);
        journal.settle(&mut machine, now_ns);
        send(&mut machine, &mut journal, &iu(1, 11, OK), now_ns);
    }
    let image = machine.image(5_000 * MS);
    assert_eq!((image.result.unwrap().sequence, image.lost), (11, 1), "the sequence jumps by what was lost");
    machine.write(Control { word: control::RESET_ERROR, ..ENABLED }, 5_000 * MS);
    assert!(!has(&machine, 5_000 * MS, status::OVERRUN));
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
