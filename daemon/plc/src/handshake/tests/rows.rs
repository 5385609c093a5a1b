//! What becomes of the rows of the journal on their way.

use super::*;

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
fn rows_that_were_lost_on_their_way_after_a_restart_are_asked_for_again_although_newer_ones_come() {
    let (mut machine, mut journal) = ready_with_journal(WRITES);
    for seq in 1..=5 {
        send(&mut machine, &mut journal, &iu(1, seq, OK), 0);
    }
    acknowledge(&mut machine, &mut journal);
    journal.is_cut_off = true;
    let mut machine = restarted(WRITES, &mut journal);
    journal.is_cut_off = false;
    send(&mut machine, &mut journal, &iu(1, 6, OK), 0);
    machine.tick(Line::Ready, 600 * MS);
    journal.settle(&mut machine, 600 * MS);
    assert_eq!(taken(&mut machine, &mut journal), [2, 3, 4, 5, 6]);
    assert_eq!(machine.image(0).lost, 0);
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
    let taken = taken(&mut machine, &mut anew);
    assert_eq!((taken, machine.image(0).lost), (vec![1, 2, 3, 4], 0));
}

#[test]
fn what_another_journal_cannot_give_back_is_lost_and_reported() {
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
