//! Databases that are full, removed, replaced or damaged.

use super::*;

#[test]
fn on_a_full_disk_nothing_is_confirmed_and_the_queue_is_written_when_there_is_room() {
    let mut bench = Bench::new();
    let pages: u32 = bench.journal.connection.query_row("PRAGMA page_count", [], |row| row.get(0)).unwrap();
    bench.journal.connection.pragma_update(None, "max_page_count", pages + 3).unwrap();
    let mut seq = 0;
    let error = loop {
        seq += 1;
        match bench.append(&verdict(1, seq)) {
            Ok(()) => assert_eq!(bench.journal.newest(), Some(MessageId { epoch: 1, seq })),
            Err(error) => break error,
        }
    };
    assert!(matches!(error, JournalError::Full { waiting: 1, .. }), "{error}");
    assert!(bench.append(&verdict(1, seq + 1)).is_err());
    assert_eq!(bench.journal.newest(), Some(MessageId { epoch: 1, seq: seq - 1 }));
    bench.journal.connection.pragma_update(None, "max_page_count", 1_000_000).unwrap();
    bench.journal.flush().unwrap();
    assert_eq!(bench.journal.newest(), Some(MessageId { epoch: 1, seq: seq + 1 }));
    assert_eq!(bench.lines(&Query::default()).len() as u64, seq + 1, "every one, and no gap");
}

#[test]
fn a_database_that_is_removed_under_its_writer_confirms_nothing_more_and_a_new_one_begins_with_a_gap() {
    let mut bench = Bench::new();
    bench.send(1, 1..=3);
    for name in ["j.sqlite", "j.sqlite-wal", "j.sqlite-shm"] {
        let _ = std::fs::remove_file(bench.dir.path().join(name));
    }
    let error = bench.append(&verdict(1, 4)).unwrap_err();
    assert!(matches!(error, JournalError::Removed { .. }), "{error}");
    assert_eq!(bench.journal.newest(), Some(MessageId { epoch: 1, seq: 3 }), "4 is not confirmed");
    let identity = bench.journal.identity();
    assert_eq!(bench.journal.begin_anew().unwrap(), None);
    assert_ne!(bench.journal.identity(), identity, "its rows are others");
    bench.journal.flush().unwrap();
    bench.send(1, [5]);
    assert_eq!(bench.lines(&Query::default()), ["removed 1 1-3", "v 1 4", "v 1 5"]);
    assert_eq!(bench.journal.lost(), 0, "what was on disk was not lost on its way");
}

#[test]
fn a_database_that_is_replaced_by_another_is_noticed_before_anything_more_is_confirmed() {
    let mut bench = Bench::new();
    bench.send(1, 1..=3);
    let other = Bench::new();
    drop(Journal::open(&other.path(), KEEP).unwrap());
    std::fs::rename(bench.path(), bench.dir.path().join("moved")).unwrap();
    std::fs::copy(other.path(), bench.path()).unwrap();
    assert!(matches!(bench.append(&verdict(1, 4)), Err(JournalError::Removed { .. })));
}

#[test]
fn a_log_that_is_removed_is_noticed_and_what_was_in_it_is_saved() {
    let mut bench = Bench::new();
    bench.send(1, 1..=3);
    std::fs::remove_file(bench.dir.path().join("j.sqlite-wal")).unwrap();
    assert!(matches!(bench.append(&verdict(1, 4)), Err(JournalError::Removed { .. })));
    bench.journal.begin_anew().unwrap();
    bench.journal.flush().unwrap();
    bench.send(1, [5]);
    assert_eq!(bench.lines(&Query::default()), ["v 1 1", "v 1 2", "v 1 3", "v 1 4", "v 1 5"]);
}

#[test]
fn a_damaged_database_is_put_aside_whole_and_a_new_one_begins_with_a_gap() {
    let bench = Bench::new();
    let path = bench.path();
    drop(bench.journal);
    std::fs::write(&path, [b'x'; 5000]).unwrap();
    let (mut journal, aside) = Journal::open_or_replace(&path, KEEP).unwrap();
    let aside = aside.unwrap();
    assert_eq!(std::fs::read(&aside).unwrap(), [b'x'; 5000]);
    assert!(aside.to_string_lossy().contains("j.sqlite.damaged-2"), "{}", aside.display());
    journal.push(&verdict(3, 1));
    journal.flush().unwrap();
    let bench = Bench { dir: bench.dir, journal };
    assert_eq!(bench.lines(&Query::default()), ["damaged 0 1-?", "v 3 1"]);
}

#[test]
fn a_database_that_is_damaged_while_it_is_open_is_put_aside_and_nothing_that_waits_is_lost() {
    let mut bench = Bench::new();
    bench.send(1, 1..=40);
    bench.journal.connection.execute_batch("PRAGMA wal_checkpoint(TRUNCATE)").unwrap();
    let length = std::fs::metadata(bench.path()).unwrap().len() as usize;
    std::fs::write(bench.path(), vec![0xA5; length]).unwrap();
    // Without what it has in memory, it must read the file.
    bench.journal.connection.execute_batch("PRAGMA shrink_memory").unwrap();
    let mut seq = 40;
    let error = loop {
        seq += 1;
        assert!(seq < 200, "the damage is never noticed");
        if let Err(error) = bench.append(&verdict(1, seq)) {
            break error;
        }
    };
    assert!(matches!(error, JournalError::Damaged { .. }), "{error}");
    let aside = bench.journal.begin_anew().unwrap().unwrap();
    assert!(aside.exists());
    bench.journal.flush().unwrap();
    let lines = bench.lines(&Query::default());
    assert_eq!(lines, [format!("damaged 1 1-{}", seq - 1), format!("v 1 {seq}")]);
}
