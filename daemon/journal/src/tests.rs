#![allow(clippy::unwrap_used)]
use super::*;
use shm_schemas::{
    AuditKind, MessageId, NO_INDEX, PartId, VerdictLevel, VerdictMeasure, VerdictOutcome, VerdictReason,
};

const KEEP: Retention = Retention { keep_days: 36_500, keep_mb: 1000 };
const DAY_NS: u64 = 86_400_000_000_000;

fn verdict(epoch: u64, seq: u64) -> Verdict {
    let mut verdict = Verdict {
        level: VerdictLevel::Activity.code(),
        outcome: VerdictOutcome::Ok.code(),
        job_id: 3,
        distance: f32::NAN,
        threshold: 2.5,
        measured: f32::NAN,
        shown_min: f32::NAN,
        shown_max: f32::NAN,
        activity: 1,
        iu: NO_INDEX,
        decided_utc_ns: seq * 1_000_000_000,
        ..Default::default()
    };
    verdict.station[..6].copy_from_slice(b"bench1");
    (verdict.stamp.epoch, verdict.stamp.seq) = (epoch, seq);
    verdict
}

struct Bench {
    dir: tempfile::TempDir,
    journal: Journal,
}

impl Bench {
    fn new() -> Self {
        Self::keeping(KEEP)
    }

    fn keeping(retention: Retention) -> Self {
        let dir = tempfile::tempdir().unwrap();
        let journal = Journal::open(&dir.path().join("j.sqlite"), retention).unwrap();
        Self { dir, journal }
    }

    fn path(&self) -> PathBuf {
        self.dir.path().join("j.sqlite")
    }

    fn send(&mut self, epoch: u64, seqs: impl IntoIterator<Item = u64>) {
        for seq in seqs {
            self.append(&verdict(epoch, seq)).unwrap();
        }
    }

    /// Writes one verdict, as the role does when one has arrived.
    fn append(&mut self, verdict: &Verdict) -> Result<(), JournalError> {
        self.journal.push(verdict);
        self.journal.flush()
    }

    fn entries(&self, query: &Query) -> Vec<Entry> {
        let mut entries = Vec::new();
        let collect = |entry| {
            entries.push(entry);
            Ok(())
        };
        History::open(&self.path()).unwrap().visit(query, collect).unwrap();
        entries
    }

    /// One line per entry: `v EPOCH SEQ` or `WHY EPOCH FIRST-LAST`.
    fn lines(&self, query: &Query) -> Vec<String> {
        self.entries(query)
            .iter()
            .map(|entry| match entry {
                Entry::Verdict(record) => format!("v {} {}", record.epoch, record.seq),
                Entry::NotWatching(blind) => {
                    format!("blind {} {:?} {}", blind.began_utc_ns, blind.ended_utc_ns, blind.why)
                }
                Entry::Gap(gap) => {
                    let last = gap.last_seq.map_or("?".into(), |last| last.to_string());
                    format!("{} {} {}-{last}", gap.why, gap.epoch, gap.first_seq)
                }
            })
            .collect()
    }
}

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
    let [Entry::Verdict(record)] = entries.as_slice() else { unreachable!("{entries:?}") };
    assert_eq!(
        (record.level.as_str(), record.outcome.as_str(), record.reason.as_str()),
        ("activity", "anomaly", "Motion")
    );
    assert_eq!((record.epoch, record.model_hash.as_str()), (u64::MAX, "ffff000000000001"));
    assert_eq!((record.activity, record.iu, record.x_c), (Some(1), None, [1, 2, 2, 65535]));
    assert_eq!((record.distance, record.threshold, record.station.as_str()), (None, Some(2.5), "bench1"));
}

#[test]
fn a_journal_of_the_first_schema_opens_and_its_verdicts_have_level_and_outcome() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("j.sqlite");
    let old = Connection::open(&path).unwrap();
    old.execute_batch(schema::MIGRATIONS[0]).unwrap();
    old.pragma_update(None, "user_version", 1).unwrap();
    // A judged IU, an activity that was not judged, and a job that was not.
    for (seq, kind, ok, activity, iu) in [
        (1, "IuAnomaly", Some(false), Some(0), Some(2)),
        (2, "NotJudged", None, Some(0), None),
        (3, "NotJudged", None, None::<u16>, None),
    ] {
        old.execute(
            "INSERT INTO verdict (epoch, seq, kind, reason, ok, hand, station, job_id, model_hash, activity, iu, x_c0,
             x_c1, x_c2, x_c3, early, began_ns, ended_ns, decided_ns, decided_utc_ns, frame_seq, captured_ns, sent_ns)
             VALUES (1, ?1, ?2, 'None', ?3, 'None', 'bench1', 3, '', ?4, ?5, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0)",
            rusqlite::params![seq, kind, ok, activity, iu],
        )
        .unwrap();
    }
    drop(old);
    let mut bench = Bench { journal: Journal::open(&path, KEEP).unwrap(), dir };
    bench.append(&verdict(1, 4)).unwrap();
    let words: Vec<String> = bench
        .entries(&Query::default())
        .iter()
        .map(|entry| match entry {
            Entry::Verdict(record) => format!("{} {} {}", record.kind(), record.level, record.outcome),
            other => format!("{other:?}"),
        })
        .collect();
    assert_eq!(
        words,
        [
            "IuAnomaly iu anomaly",
            "NotJudged activity not_judged",
            "NotJudged job not_judged",
            "ActivityOk activity ok"
        ]
    );
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
fn queries_select_verdicts_and_never_hide_a_gap() {
    let mut bench = Bench::new();
    bench.send(1, [1, 2]);
    let mut nok = verdict(1, 5);
    nok.outcome = VerdictOutcome::Anomaly.code();
    (nok.job_id, nok.part) = (4, PartId::new(b"A-17").unwrap());
    bench.append(&nok).unwrap();
    let mut blind = verdict(1, 6);
    blind.outcome = VerdictOutcome::NotJudged.code();
    bench.append(&blind).unwrap();
    let all = Query::default();
    assert_eq!(bench.lines(&Query { nok: true, ..all }), ["lost 1 3-4", "v 1 5", "v 1 6"]);
    assert_eq!(bench.lines(&Query { job_id: Some(4), ..all }), ["lost 1 3-4", "v 1 5"]);
    assert_eq!(bench.lines(&Query { since_utc_ns: Some(6_000_000_000), ..all }), ["v 1 6"]);
    assert_eq!(bench.lines(&Query { part: Some(nok.part), ..all }), ["lost 1 3-4", "v 1 5"]);
    let without = bench.lines(&Query { part: Some(PartId::NONE), ..all });
    assert_eq!(without, ["v 1 1", "v 1 2", "lost 1 3-4", "v 1 6"]);
}

#[test]
fn the_csv_has_one_line_per_entry_and_the_same_columns_in_every_line() {
    let mut bench = Bench::new();
    bench.send(1, [1, 3]);
    let mut csv = Vec::new();
    History::open(&bench.path()).unwrap().write(&Query::default(), Format::Csv, &mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let lines: Vec<&str> = csv.split("\r\n").collect();
    assert_eq!(
        lines[1],
        "1970-01-01T00:00:01Z,verdict,ActivityOk,activity,ok,None,,bench1,3,0000000000000000,1,,0,0,0,0,0,,2.5,0,None,None,0,0,None,,,,0.000000000,\
         0.000000000,0.000000000,1,1,,,"
    );
    assert!(lines[2].starts_with("1970-01-01T00:00:03Z,gap,,,,lost,"));
    assert!(lines[2].ends_with(",1,2,2,,"));
    assert_eq!(lines.len(), 5);
    for line in &lines[..4] {
        assert_eq!(line.split(',').count(), 36, "{line}");
    }
}

#[test]
fn the_measure_that_was_out_of_its_bounds_is_in_the_history_in_words_and_in_columns() {
    let mut bench = Bench::new();
    let measure = VerdictMeasure::Strokes.code();
    bench
        .append(&Verdict { measure, measured: 4.0, shown_min: 6.0, shown_max: 6.0, ..verdict(1, 1) })
        .unwrap();
    let history = History::open(&bench.path()).unwrap();
    let text = |format| {
        let mut text = Vec::new();
        history.write(&Query::default(), format, &mut text).unwrap();
        String::from_utf8(text).unwrap()
    };
    assert!(text(Format::Csv).contains(",Strokes,4,6,6,"), "{}", text(Format::Csv));
    assert!(text(Format::Table).ends_with("  4 strokes, shown 6 to 6\n"), "{}", text(Format::Table));
}

#[test]
fn the_part_is_in_the_history_and_quoted_where_a_spreadsheet_would_cut_it() {
    let mut bench = Bench::new();
    for (seq, id) in [(1, "A-17"), (2, "4,\"5\""), (3, "")] {
        let part = PartId::new(id.as_bytes()).unwrap();
        bench.append(&Verdict { part, ..verdict(1, seq) }).unwrap();
    }
    let history = History::open(&bench.path()).unwrap();
    let text = |format| {
        let mut text = Vec::new();
        history.write(&Query::default(), format, &mut text).unwrap();
        String::from_utf8(text).unwrap()
    };
    let csv = text(Format::Csv);
    let ends: Vec<&str> = csv.lines().map(|line| line.splitn(36, ',').last().unwrap()).collect();
    assert_eq!(ends, ["part", "A-17", "\"4,\"\"5\"\"\"", ""]);
    let table = text(Format::Table);
    assert!(table.contains("  part A-17\n"), "{table}");
}

#[test]
fn a_journal_of_the_schema_without_parts_opens_and_its_verdicts_have_none() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("j.sqlite");
    let old = Connection::open(&path).unwrap();
    let before = schema::MIGRATIONS.iter().take_while(|migration| !migration.contains("COLUMN part"));
    let mut version = 0;
    for migration in before {
        old.execute_batch(migration).unwrap();
        version += 1;
    }
    old.pragma_update(None, "user_version", version).unwrap();
    old.execute(
        "INSERT INTO verdict (epoch, seq, level, outcome, reason, hand, station, job_id, model_hash, x_c0, x_c1, x_c2,
         x_c3, early, began_ns, ended_ns, decided_ns, decided_utc_ns, frame_seq, captured_ns, sent_ns)
         VALUES (1, 1, 'job', 'ok', 'None', '', 'bench1', 3, '', 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0)",
        [],
    )
    .unwrap();
    drop(old);
    let mut bench = Bench { journal: Journal::open(&path, KEEP).unwrap(), dir };
    let part = PartId::new(b"A-17").unwrap();
    bench.append(&Verdict { part, ..verdict(1, 2) }).unwrap();
    let parts: Vec<PartId> =
        bench.journal.rows_after(0, 10).unwrap().iter().map(|row| row.verdict.part).collect();
    assert_eq!(parts, [PartId::NONE, part]);
}

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

#[test]
fn a_journal_of_a_newer_andon_and_a_file_that_is_no_journal_are_refused_with_a_remedy() {
    let bench = Bench::new();
    bench.journal.connection.pragma_update(None, "user_version", 99).unwrap();
    let error = Journal::open(&bench.path(), KEEP).unwrap_err().to_string();
    assert!(error.contains("schema 99") && error.contains("install the newer Andon"), "{error}");

    let other = bench.dir.path().join("other");
    std::fs::write(&other, [b'x'; 5000]).unwrap();
    let error = Journal::open(&other, KEEP).unwrap_err().to_string();
    assert!(error.contains("no journal") && error.contains("sqlite3 .recover"), "{error}");
    let error = Journal::open(&bench.dir.path().join("no/dir"), KEEP).unwrap_err().to_string();
    assert!(error.contains("does its directory exist"), "{error}");
    let error = History::open(&bench.dir.path().join("none")).unwrap_err();
    assert!(matches!(error, JournalError::Open { .. }), "a reader makes no journal: {error}");
}

#[test]
fn a_time_without_sight_is_a_row_with_begin_and_end_before_the_verdict_that_follows_it() {
    let mut bench = Bench::new();
    bench.send(1, [1]);
    let row = bench.journal.stops_watching(1_500_000_000, shm_schemas::Sight::Black.name()).unwrap();
    bench.journal.watches_again(row, 1_900_000_000).unwrap();
    bench.send(1, [2]);
    bench.journal.stops_watching(2_500_000_000, shm_schemas::Sight::TooFewFrames.name()).unwrap();
    assert_eq!(
        bench.lines(&Query::default()),
        ["v 1 1", "blind 1500000000 Some(1900000000) Black", "v 1 2", "blind 2500000000 None TooFewFrames"]
    );
    let mut table = Vec::new();
    History::open(&bench.path()).unwrap().write(&Query::default(), Format::Table, &mut table).unwrap();
    let table = String::from_utf8(table).unwrap();
    assert!(table.contains("-- not watching until 1970-01-01T00:00:01Z: The picture is black."), "{table}");
    let mut csv = Vec::new();
    History::open(&bench.path()).unwrap().write(&Query::default(), Format::Csv, &mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let columns: Vec<usize> = csv.lines().map(|line| line.split(',').count()).collect();
    assert!(columns.iter().all(|count| *count == columns[0]), "{csv}");
    assert!(csv.contains(",1970-01-01T00:00:01.9Z,\r\n"), "{csv}");
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
fn the_account_of_the_plc_is_kept_and_before_the_first_it_says_where_the_journal_ends() {
    let mut bench = Bench::new();
    bench.send(4, 1..=3);
    let none = bench.journal.account().unwrap();
    assert_eq!((none.boot, none.row, none.epoch, none.seq), (0, 3, 4, 3));
    let mut account = Account {
        boot: 2,
        number: u64::MAX,
        row: 5,
        epoch: u64::MAX,
        seq: 6,
        sequence: u32::MAX,
        lost: 7,
        has_overrun: 1,
        error: 3,
        error_detail: 104,
        shown_row: 1,
        shown_sequence: 8,
        is_acknowledged: 1,
        wanted_job: 12,
        wanted_hash: u64::MAX,
        gives_parts: 1,
        part: PartId::new(b"A-17").unwrap(),
        journal: bench.journal.identity(),
        ..Account::default()
    };
    (account.waiting_rows[0], account.waiting_sequences[0]) = (2, 9);
    (account.waiting_rows[1], account.waiting_sequences[1]) = (4, 11);
    bench.journal.keep(&account).unwrap();
    let again = Journal::open(&bench.path(), KEEP).unwrap();
    assert_eq!(again.account().unwrap(), account);
    // To say that there is none is not the same as to say nothing.
    (account.number, account.part) = (1, PartId::NONE);
    bench.journal.keep(&account).unwrap();
    assert_eq!(bench.journal.account().unwrap(), account, "the newest takes the place of the one before");
}

#[test]
fn every_database_has_an_identity_of_its_own() {
    assert_ne!(Bench::new().journal.identity(), Bench::new().journal.identity());
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

#[test]
fn what_was_done_is_kept_once_with_who_and_when_and_a_change_names_what_was_before() {
    let mut bench = Bench::new();
    let mut audit = shm_schemas::Audit { utc_ns: 5, kind: AuditKind::Command.code(), ..Default::default() };
    (audit.stamp.epoch, audit.stamp.seq) = (9, 1);
    audit.say("192.0.2.7", "enable");
    bench.journal.record(&audit).unwrap();
    bench.journal.record(&audit).unwrap();
    for (at, what) in [(6, "hash 1"), (7, "hash 1"), (8, "hash 2")] {
        bench.journal.note_change(at, AuditKind::Configuration, "user 0", what).unwrap();
    }
    let history = History::open(&bench.path()).unwrap();
    let mut deeds = Vec::new();
    let collect = |deed: Deed| {
        deeds.push(format!("{} {} {}: {}", deed.utc_ns, deed.kind, deed.who, deed.what));
        Ok(())
    };
    history.visit_deeds(None, collect).unwrap();
    assert_eq!(deeds, ["5 command 192.0.2.7: enable", "8 configuration user 0: hash 2, before: hash 1"]);
    let mut csv = Vec::new();
    history.write_deeds(Some(6), Format::Csv, &mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    assert!(csv.ends_with(",configuration,\"user 0\",\"hash 2, before: hash 1\"\r\n"), "{csv}");
}

#[test]
fn a_copy_that_is_made_while_the_journal_is_written_is_a_whole_journal() {
    let mut bench = Bench::new();
    bench.send(1, 1..=5);
    let copy = bench.dir.path().join("copy.sqlite");
    History::open(&bench.path()).unwrap().copy_to(&copy).unwrap();
    bench.send(1, [6]);
    let mut count = 0;
    let visit = |_| {
        count += 1;
        Ok(())
    };
    History::open(&copy).unwrap().visit(&Query::default(), visit).unwrap();
    assert_eq!(count, 5);
    let journal = Journal::open(&copy, KEEP).unwrap();
    assert_eq!(
        (journal.identity(), journal.newest()),
        (bench.journal.identity(), Some(MessageId { epoch: 1, seq: 5 }))
    );
}
