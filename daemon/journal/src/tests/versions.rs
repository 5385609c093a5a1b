//! Journals of other versions, and files that are no journal.

use super::*;
use shm_schemas::{NO_PERCENT, PartId, VerdictMeasure, VerdictNote, verdict_kind};

/// A journal of the newest schema that has not seen the migration in which these words stand.
fn journal_before(path: &Path, words: &str) -> Connection {
    let old = Connection::open(path).unwrap();
    let before = schema::MIGRATIONS.iter().take_while(|migration| !migration.contains(words));
    let mut version = 0;
    for migration in before {
        old.execute_batch(migration).unwrap();
        version += 1;
    }
    old.pragma_update(None, "user_version", version).unwrap();
    old
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
            Entry::Verdict(verdict) => {
                let (level, outcome) = (verdict.level().unwrap(), verdict.outcome().unwrap());
                format!("{} {} {}", verdict_kind(level, outcome), level.name(), outcome.name())
            }
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
fn a_journal_of_the_schema_without_parts_opens_and_its_verdicts_have_none() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("j.sqlite");
    let old = journal_before(&path, "COLUMN part");
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

/// A field that is added to a verdict is a column that the journals in the field have not.
#[test]
fn a_column_that_a_journal_has_not_is_added_and_older_verdicts_have_nothing_in_it() {
    let whole = |seq| Verdict {
        seen_percent: 40,
        missing_s: 1.5,
        model_hash: 99,
        note: VerdictNote::Again.code(),
        ..verdict(1, seq)
    };
    let mut bench = Bench::new();
    bench.append(&whole(1)).unwrap();
    for column in ["seen_percent", "missing_s", "model_hash", "note"] {
        let drop = format!("ALTER TABLE verdict DROP COLUMN {column}");
        bench.journal.connection.execute_batch(&drop).unwrap();
    }
    bench.journal = Journal::open(&bench.path(), KEEP).unwrap();
    bench.append(&whole(2)).unwrap();
    let rows = bench.journal.rows_after(0, 10).unwrap();
    let values = |row: &Written| {
        let Verdict { seen_percent, missing_s, model_hash, note, .. } = row.verdict;
        (seen_percent, missing_s.is_nan(), model_hash, note)
    };
    assert_eq!(values(&rows[0]), (NO_PERCENT, true, 0, 0));
    assert_eq!(values(&rows[1]), (40, false, 99, VerdictNote::Again.code()));
}

#[test]
fn a_row_with_a_word_of_an_older_build_is_read_as_the_word_of_now() {
    let mut bench = Bench::new();
    let measure = VerdictMeasure::LateralDeviation.code();
    bench.append(&Verdict { measure, measured: 0.3, ..verdict(1, 1) }).unwrap();
    let older = "UPDATE verdict SET measure = 'Bow' WHERE measure = 'LateralDeviation'";
    assert_eq!(bench.journal.connection.execute(older, []).unwrap(), 1);
    let rows = bench.journal.rows_after(0, 10).unwrap();
    assert_eq!((rows[0].verdict.measure, rows[0].verdict.measured), (measure, 0.3));
}

#[test]
fn the_account_of_a_journal_with_one_account_is_that_of_the_plc() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("j.sqlite");
    let old = journal_before(&path, "new_account");
    old.execute(
        "INSERT INTO account VALUES (1, 4, 17, 9, 2, 8, 6, 1, 0, 0, 0, 7, 5, 0, '8:6', 3, 99, 'A-17')",
        [],
    )
    .unwrap();
    drop(old);
    let journal = Journal::open(&path, KEEP).unwrap();
    let account = journal.account(RoleId::Plc).unwrap();
    assert_eq!((account.boot, account.number, account.row, account.sequence), (4, 17, 9, 6));
    assert_eq!((account.shown_row, account.waiting_rows[0], account.wanted_hash), (7, 8, 99));
    assert_eq!(account.part, PartId::new(b"A-17").unwrap());
    assert_eq!(account.settled(), 6);
    assert_eq!(journal.consumers().unwrap(), [RoleId::Plc]);
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
