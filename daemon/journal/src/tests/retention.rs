//! What is removed because it is too old or too much.

use super::*;

#[test]
fn verdicts_that_are_too_old_are_removed_and_a_gap_names_them() {
    let mut bench = Bench::keeping(Retention { keep_days: 2, ..KEEP });
    for seq in 1..=10 {
        let mut old = verdict(1, seq);
        old.decided_utc_ns = seq * DAY_NS;
        bench.append(&old).unwrap();
    }
    bench.journal = Journal::open(&bench.path(), Retention { keep_days: 2, ..KEEP }).unwrap();
    assert_eq!(bench.lines(&Query::default()), ["retention 1 1-7", "v 1 8", "v 1 9", "v 1 10"]);
    assert_eq!(bench.journal.removed(), 7);
    bench.journal = Journal::open(&bench.path(), Retention { keep_days: 1, ..KEEP }).unwrap();
    assert_eq!(bench.lines(&Query::default()), ["retention 1 1-8", "v 1 9", "v 1 10"]);
}

#[test]
fn a_database_that_is_too_large_shrinks_and_keeps_its_newest() {
    let mut bench = Bench::new();
    bench.journal.connection.pragma_update(None, "synchronous", "OFF").unwrap();
    bench.send(1, 1..=9000);
    drop(bench.journal);
    let size = || std::fs::metadata(bench.dir.path().join("j.sqlite")).unwrap().len();
    let before = size();
    assert!(before > 1 << 20, "{before}");
    let path = bench.dir.path().join("j.sqlite");
    let retention = Retention { keep_mb: 1, ..KEEP };
    for _ in 0..4 {
        drop(Journal::open(&path, retention).unwrap());
    }
    assert!(size() <= before / 2 + (1 << 20), "{} of {before}", size());
    let journal = Journal::open(&path, retention).unwrap();
    assert_eq!(journal.newest(), Some(MessageId { epoch: 1, seq: 9000 }));
}

#[test]
fn a_clock_that_jumps_ahead_does_not_empty_the_journal_at_once() {
    let mut bench = Bench::new();
    bench.journal.connection.pragma_update(None, "synchronous", "OFF").unwrap();
    bench.send(1, 1..=3000);
    let mut future = verdict(1, 3001);
    future.decided_utc_ns = 40_000 * DAY_NS;
    bench.append(&future).unwrap();
    bench.journal = Journal::open(&bench.path(), Retention { keep_days: 30, ..KEEP }).unwrap();
    assert_eq!(bench.lines(&Query::default()).len(), 1 + 1001);
}

/// Ten verdicts, one a day, of which a consumer has acknowledged this many.
fn acknowledged(row: u64, retention: Retention) -> Bench {
    let mut bench = Bench::keeping(KEEP);
    for seq in 1..=10 {
        let mut old = verdict(1, seq);
        old.decided_utc_ns = seq * DAY_NS;
        bench.append(&old).unwrap();
    }
    for (consumer, row) in [(RoleId::Plc, 10), (RoleId::Tool, row)] {
        let account = Account { boot: 1, row, ..Account::default() };
        bench.journal.keep(consumer, &account).unwrap();
    }
    bench.journal = Journal::open(&bench.path(), retention).unwrap();
    bench
}

#[test]
fn what_a_consumer_has_not_acknowledged_is_not_removed_for_its_age() {
    let bench = acknowledged(3, Retention { keep_days: 2, ..KEEP });
    assert_eq!(bench.lines(&Query::default())[..2], ["retention 1 1-3", "v 1 4"]);
    assert_eq!((bench.journal.removed(), bench.journal.unacknowledged()), (3, 0));
    // A consumer that the station does not have any more holds nothing.
    let bench = acknowledged(3, Retention { keep_days: 2, without: &[RoleId::Tool], ..KEEP });
    assert_eq!(bench.lines(&Query::default())[..2], ["retention 1 1-7", "v 1 8"]);
    assert_eq!(bench.journal.unacknowledged(), 0);
}

#[test]
fn a_database_that_is_too_large_loses_what_a_consumer_has_not_acknowledged_and_counts_it() {
    let bench = acknowledged(3, Retention { keep_mb: 0, ..KEEP });
    assert_eq!(bench.lines(&Query::default()), ["retention 1 1-9", "v 1 10"]);
    assert_eq!((bench.journal.removed(), bench.journal.unacknowledged()), (9, 6));
    let rows: Vec<u64> = bench.journal.rows_after(3, 9).unwrap().iter().map(|written| written.row).collect();
    assert_eq!(rows, [10], "the consumer finds them missing between the row that it has and the next one");
}
