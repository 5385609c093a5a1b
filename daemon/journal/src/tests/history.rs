//! What the history shows.

use super::*;
use shm_schemas::{AuditKind, PartId, VerdictMeasure};

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

fn csv_of(bench: &Bench) -> String {
    let mut csv = Vec::new();
    History::open(&bench.path()).unwrap().write_csv(&Query::default(), &mut csv).unwrap();
    String::from_utf8(csv).unwrap()
}

#[test]
fn a_row_gives_the_verdict_back_that_it_was_written_from() {
    let mut bench = Bench::new();
    let sent = Verdict {
        measure: VerdictMeasure::Strokes.code(),
        measured: 4.0,
        shown_min: 6.0,
        shown_max: 7.0,
        part: PartId::new(b"A-17").unwrap(),
        captured_percent: 90,
        seen_percent: 42,
        missing_hand: 1,
        missing_object: 7,
        missing_s: 1.5,
        nearest: 1,
        ..verdict(1, 1)
    };
    bench.append(&sent).unwrap();
    let Ok([Entry::Verdict(read)]) = <[Entry; 1]>::try_from(bench.entries(&Query::default())) else {
        unreachable!()
    };
    // A distance that there is not is not equal to itself.
    assert_eq!(format!("{read:?}"), format!("{sent:?}"));
}

#[test]
fn the_csv_has_one_line_per_entry_and_the_same_columns_in_every_line() {
    let mut bench = Bench::new();
    bench.send(1, [1, 3]);
    let mut csv = Vec::new();
    History::open(&bench.path()).unwrap().write_csv(&Query::default(), &mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let lines: Vec<&str> = csv.split("\r\n").collect();
    assert_eq!(
        lines[1],
        "1970-01-01T00:00:01Z,verdict,ActivityOk,activity,ok,None,,bench1,3,0000000000000000,1,,0,0,0,0,0,,2.5,0,None,None,0,0,None,,,,,,,,,,,0.000000000,\
         0.000000000,0.000000000,1,1,,,"
    );
    assert!(lines[2].starts_with("1970-01-01T00:00:03Z,gap,,,,lost,"));
    assert!(lines[2].ends_with(",1,2,2,,"));
    assert_eq!(lines.len(), 5);
    for line in &lines[1..4] {
        assert_eq!(line.split(',').count(), lines[0].split(',').count(), "{line}");
    }
}

#[test]
fn the_measure_that_was_out_of_its_bounds_is_in_the_history() {
    let mut bench = Bench::new();
    let measure = VerdictMeasure::Strokes.code();
    bench
        .append(&Verdict { measure, measured: 4.0, shown_min: 6.0, shown_max: 6.0, ..verdict(1, 1) })
        .unwrap();
    assert!(csv_of(&bench).contains(",Strokes,4,6,6,"), "{}", csv_of(&bench));
}

#[test]
fn the_part_is_in_the_history_and_quoted_where_a_spreadsheet_would_cut_it() {
    let mut bench = Bench::new();
    for (seq, id) in [(1, "A-17"), (2, "4,\"5\""), (3, "")] {
        let part = PartId::new(id.as_bytes()).unwrap();
        bench.append(&Verdict { part, ..verdict(1, seq) }).unwrap();
    }
    let csv = csv_of(&bench);
    let columns = csv.lines().next().unwrap().split(',').count();
    let ends: Vec<&str> = csv.lines().map(|line| line.splitn(columns, ',').last().unwrap()).collect();
    assert_eq!(ends, ["part", "A-17", "\"4,\"\"5\"\"\"", ""]);
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
    let mut csv = Vec::new();
    History::open(&bench.path()).unwrap().write_csv(&Query::default(), &mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let columns: Vec<usize> = csv.lines().map(|line| line.split(',').count()).collect();
    assert!(columns.iter().all(|count| *count == columns[0]), "{csv}");
    assert!(csv.contains(",1970-01-01T00:00:01.9Z,\r\n"), "{csv}");
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
    let mut audits = Vec::new();
    let collect = |audit: AuditEntry| {
        audits.push(format!("{} {} {}: {}", audit.utc_ns, audit.kind, audit.who, audit.what));
        Ok(())
    };
    history.visit_audit(None, collect).unwrap();
    assert_eq!(audits, ["5 command 192.0.2.7: enable", "8 configuration user 0: hash 2, before: hash 1"]);
    let newest = |count| -> Vec<u64> {
        history.newest_audit(count).unwrap().iter().map(|audit| audit.utc_ns).collect()
    };
    assert_eq!((newest(1), newest(9)), (vec![8], vec![8, 5]));
    let mut csv = Vec::new();
    history.write_audit_csv(Some(6), &mut csv).unwrap();
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

#[test]
fn what_is_no_file_is_called_so_and_not_waited_for() {
    let bench = Bench::new();
    let pipe = bench.dir.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for path in [pipe.as_path(), bench.dir.path()] {
        assert!(matches!(History::open(path), Err(JournalError::NotFile { .. })), "{}", path.display());
        assert!(matches!(Journal::open(path, KEEP), Err(JournalError::NotFile { .. })), "{}", path.display());
    }
}

fn asked(bench: &Bench, question: &str) -> Result<String, JournalError> {
    let clips =
        [(MessageId { epoch: u64::MAX, seq: 2 }, "/a, b.mcap"), (MessageId { epoch: 7, seq: 1 }, "gone")];
    let mut csv = Vec::new();
    History::open(&bench.path())?.write_sql(question, clips, &mut csv)?;
    Ok(String::from_utf8(csv).unwrap())
}

#[test]
fn a_question_in_sql_finds_the_clip_of_each_verdict() {
    let mut bench = Bench::new();
    bench.send(u64::MAX, [1, 2, 3]);
    let rows = asked(&bench, "SELECT seq, clip, activity FROM verdict WHERE clip IS NOT NULL").unwrap();
    assert_eq!(rows, "seq,clip,activity\r\n2,\"/a, b.mcap\",1\r\n");
    let all =
        asked(&bench, "SELECT count(*) AS all_of_them, count(clip), max(distance) FROM verdict").unwrap();
    assert_eq!(all, "all_of_them,count(clip),max(distance)\r\n3,1,\r\n");
    assert_eq!(asked(&bench, "SELECT why FROM gap").unwrap(), "why\r\n");
    assert_eq!(asked(&bench, "SELECT x'0aff' AS b, 1.5 AS c").unwrap(), "b,c\r\n0aff,1.5\r\n");
}

#[test]
fn a_question_in_sql_changes_nothing_and_one_that_is_none_is_refused_in_words() {
    let mut bench = Bench::new();
    bench.send(1, [1, 2]);
    let copy = bench.dir.path().join("copy.sqlite");
    for (question, words) in [
        ("DELETE FROM main.verdict", "would change the journal"),
        ("INSERT INTO clip VALUES (1, 1, 'x')", "would change the journal"),
        ("DROP TABLE gap", "would change the journal"),
        (&format!("VACUUM INTO '{}'", copy.display()), "would change the journal"),
        ("SELECT 1; DELETE FROM main.verdict", "Multiple statements"),
        ("SELECT colour FROM verdict", "no such column: colour"),
        ("how many", "syntax error"),
    ] {
        let error = asked(&bench, question).unwrap_err().to_string();
        assert!(error.starts_with("--sql: ") && error.contains(words), "{question}: {error}");
    }
    assert!(!copy.exists());
    assert_eq!(asked(&bench, "SELECT count(*) AS n FROM verdict").unwrap(), "n\r\n2\r\n");
}
