//! What is written, in which order, and what is missing from it.

use super::*;
use shm_schemas::{PartId, VerdictReason};

#[test]
fn a_verdict_comes_back_as_it_was_written() {
    let mut bench = Bench::new();
    let mut sent = verdict(u64::MAX, 1);
    sent.outcome = VerdictOutcome::Anomaly.code();
    sent.reason = VerdictReason::Motion.code();
    sent.model_hash = 0xFFFF_0000_0000_0001;
    sent.x_c = [1, 2, 2, 65535];
    bench.append(&sent).unwrap();
    assert_eq!(bench.journal.newest(), Some(MessageId { epoch: u64::MAX, seq: 1 }));
    let entries = bench.entries(&Query::default());
    let [Entry::Verdict(read)] = entries.as_slice() else { unreachable!("{entries:?}") };
    // A distance that there is not is not equal to itself.
    assert_eq!(format!("{read:?}"), format!("{sent:?}"));
}

#[test]
fn a_row_is_read_back_as_the_verdict_that_was_written() {
    let mut bench = Bench::new();
    let mut known = verdict(u64::MAX, 1);
    known.distance = 1.5;
    known.reason = VerdictReason::Motion.code();
    known.hand = 2;
    known.model_hash = 0xFFFF_0000_0000_0001;
    known.x_c = [1, 2, 2, 65535];
    known.part = PartId::new(&[b'~'; shm_schemas::PART_BYTES]).unwrap();
    (known.stamp.frame_seq, known.stamp.captured_ns, known.stamp.sent_ns) = (4, 5, 6);
    (known.began_ns, known.ended_ns, known.decided_ns, known.early) = (7, 8, 9, 1);
    (known.note, known.broken, known.broken_activity, known.broken_runs) = (4, 2, 10, 11);
    (known.measure, known.measured, known.shown_min, known.shown_max) = (2, 4.0, 5.5, 6.5);
    (known.captured_percent, known.seen_percent) = (90, shm_schemas::NO_PERCENT);
    (known.missing_hand, known.missing_object, known.missing_s) = (2, 7, 1.25);
    (known.missing_percent, known.needed_percent) = (20, 25);
    // Of another build: its numbers are kept as numbers.
    let foreign = Verdict {
        level: 77,
        outcome: 78,
        reason: 79,
        hand: 80,
        note: 81,
        broken: 82,
        distance: 0.25,
        measure: 83,
        measured: 0.5,
        shown_min: 0.25,
        shown_max: 0.75,
        missing_hand: 84,
        missing_s: 1.0,
        ..verdict(u64::MAX, 2)
    };
    bench.append(&known).unwrap();
    bench.append(&foreign).unwrap();
    let rows = bench.journal.rows_after(0, 10).unwrap();
    assert_eq!(rows, [Written { row: 1, verdict: known }, Written { row: 2, verdict: foreign }]);
    assert_eq!(bench.journal.rows_after(1, 10).unwrap().len(), 1);
    assert_eq!(bench.journal.rows_after(0, 1).unwrap().len(), 1);
}

#[test]
fn a_jump_in_the_numbers_and_a_restart_of_the_judge_are_recorded_as_gaps() {
    let mut bench = Bench::new();
    bench.send(5, [3, 4, 7]);
    bench.send(2, [1, 2]);
    bench.send(9, [3]);
    let expected = [
        "lost 5 1-2",
        "v 5 3",
        "v 5 4",
        "lost 5 5-6",
        "v 5 7",
        "restart 5 8-?",
        "v 2 1",
        "v 2 2",
        "restart 2 3-?",
        "lost 9 1-2",
        "v 9 3",
    ];
    assert_eq!(bench.lines(&Query::default()), expected);
}

#[test]
fn a_verdict_that_arrives_twice_is_written_once_even_across_a_restart_of_the_journal() {
    let mut bench = Bench::new();
    bench.send(1, [1, 2, 2]);
    bench.journal = Journal::open(&bench.path(), KEEP).unwrap();
    assert_eq!(bench.journal.newest(), Some(MessageId { epoch: 1, seq: 2 }));
    bench.send(1, [1, 2, 3]);
    assert_eq!(bench.lines(&Query::default()), ["v 1 1", "v 1 2", "v 1 3"]);
}

#[test]
fn verdicts_that_do_not_fit_the_queue_become_a_gap() {
    let mut bench = Bench::new();
    bench.send(1, [1]);
    let other = Connection::open(bench.path()).unwrap();
    other.execute_batch("BEGIN IMMEDIATE").unwrap();
    bench.journal.connection.busy_timeout(Duration::ZERO).unwrap();
    for seq in 2..=MAX_WAITING as u64 + 3 {
        let error = bench.append(&verdict(1, seq)).unwrap_err();
        assert!(matches!(error, JournalError::Locked { .. }), "{error}");
    }
    assert_eq!(bench.journal.waiting(), MAX_WAITING);
    other.execute_batch("COMMIT").unwrap();
    bench.journal.flush().unwrap();
    assert_eq!(bench.lines(&Query::default())[..3], ["v 1 1", "lost 1 2-3", "v 1 4"]);
}
