//! `andond backup` and `andond restore`: a station comes back as it was, and neither a running line nor a damaged archive is ever restored over.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_learn::job_file::JobFile;
use andon_tests::line::{Line, Settings, andond};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A line that has judged something and is still running, and a backup that was made meanwhile.
fn backed_up() -> (Line, PathBuf) {
    let mut line = Line::new(Settings::live());
    let mut watcher = line.up();
    watcher.until("verdicts", |watcher| watcher.verdicts.len() > 2);
    let archive = line.path("station.tar");
    let output = line.command("backup", &[archive.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    (line, archive)
}

fn restore(archive: &Path, more: &[&str]) -> Output {
    Command::new(andond()).arg("restore").arg(archive).args(more).output().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A file of the station, without its directory of sockets and without logs.
fn contents(line: &Line, name: &str) -> Vec<u8> {
    std::fs::read(line.path(name)).unwrap()
}

#[test]
fn a_station_that_is_lost_comes_back_with_configuration_job_and_journal() {
    let (mut line, archive) = backed_up();
    let rows = line.journal().verdicts();
    line.stop();
    let (job, configuration) = (contents(&line, "job.toml"), contents(&line, "station.toml"));
    for name in ["job.toml", "station.toml", "journal.sqlite", "journal.sqlite-wal", "journal.sqlite-shm"] {
        let _ = std::fs::remove_file(line.path(name));
    }
    let output = restore(&archive, &[]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!((contents(&line, "job.toml"), contents(&line, "station.toml")), (job, configuration));
    let restored = line.journal().verdicts();
    assert!(!restored.is_empty() && rows.starts_with(&restored), "{restored:?} of {rows:?}");
    let audit = String::from_utf8(line.command("history", &["--audit"]).stdout).unwrap();
    assert!(audit.contains("restored from") && audit.contains("user "), "{audit}");
    let mut watcher = line.up();
    watcher.until("verdicts of the restored line", |watcher| watcher.verdicts.len() > 1);
}

#[test]
fn nothing_is_restored_while_the_line_runs() {
    let (line, archive) = backed_up();
    let before = contents(&line, "job.toml");
    let output = restore(&archive, &["--replace"]);
    assert_eq!(output.status.code(), Some(70), "{}", stderr(&output));
    assert!(stderr(&output).contains("systemctl stop"), "{}", stderr(&output));
    assert_eq!(contents(&line, "job.toml"), before);
}

#[test]
fn files_that_differ_are_named_and_replaced_only_on_request() {
    let (mut line, archive) = backed_up();
    line.stop();
    let job = contents(&line, "job.toml");
    std::fs::write(line.path("job.toml"), "taught since").unwrap();
    let output = restore(&archive, &[]);
    assert_eq!(output.status.code(), Some(64), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("job.toml") && stderr(&output).contains("--replace"),
        "{}",
        stderr(&output)
    );
    assert_eq!(contents(&line, "job.toml"), b"taught since");
    assert_eq!(restore(&archive, &["--replace"]).status.code(), Some(0));
    assert_eq!(contents(&line, "job.toml"), job);
}

#[test]
fn an_archive_that_is_damaged_cut_or_something_else_changes_nothing() {
    let (mut line, archive) = backed_up();
    line.stop();
    let whole = std::fs::read(&archive).unwrap();
    for name in ["job.toml", "station.toml"] {
        std::fs::write(line.path(name), "as it is").unwrap();
    }
    let position = |needle: &[u8]| whole.windows(needle.len()).position(|bytes| bytes == needle).unwrap();
    let flipped = |at: usize| {
        let mut bytes = whole.clone();
        bytes[at] ^= 1;
        bytes
    };
    // In a job, in the journal, in the list of hashes, in a name; cut at several places; no archive at all.
    let mut damaged = vec![
        flipped(position(b"andon.job")),
        flipped(position(b"SQLite format 3")),
        flipped(position(b"\"sha256\": \"") + 14),
        flipped(position(b"\"station\": \"") + 13),
        b"no archive".to_vec(),
        Vec::new(),
    ];
    damaged.extend([1, 2, 3, 5].map(|part| whole[..whole.len() * part / 6].to_vec()));
    for (number, bytes) in damaged.into_iter().enumerate() {
        std::fs::write(&archive, bytes).unwrap();
        let output = restore(&archive, &["--replace"]);
        assert_eq!(output.status.code(), Some(64), "{number}: {}", stderr(&output));
        assert!(stderr(&output).contains("nothing was changed"), "{number}: {}", stderr(&output));
        for name in ["job.toml", "station.toml"] {
            assert_eq!(contents(&line, name), b"as it is", "{number}");
        }
    }
}

#[test]
fn an_archive_is_listed_and_laid_out_elsewhere_without_touching_the_station() {
    let (mut line, archive) = backed_up();
    let output = restore(&archive, &["--list"]);
    let listed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success() && listed.contains("job.toml") && listed.contains("journal.sqlite"),
        "{listed}"
    );
    line.stop();
    let into = line.path("elsewhere");
    let output = restore(&archive, &["--into", into.to_str().unwrap()]);
    assert!(output.status.success(), "{}", stderr(&output));
    let job = into.join(line.path("job.toml").strip_prefix("/").unwrap());
    assert_eq!(std::fs::read(job).unwrap(), contents(&line, "job.toml"));
}

#[test]
fn what_was_made_for_an_engineer_is_backed_up_without_pictures_of_the_bench_and_these_are_forgotten() {
    let line = Line::new(Settings::live());
    line.reconfigure("[plc]\n", "[executor]\npath = \"made\"\n\n[plc]\n");
    let kept = [
        "reports/job.html",
        "markers/line-markers.pdf",
        "versions/job.0123456789abcdef.toml",
        "stations/b.toml",
    ];
    let pictures = ["look.png", "seen.jpg", "calibrated.jpg"];
    let at = |name: &str| line.path("made").join(name);
    for name in kept.iter().chain(&pictures).chain(&["calibration.toml", "films/run.mp4"]) {
        std::fs::create_dir_all(at(name).parent().unwrap()).unwrap();
        std::fs::write(at(name), name).unwrap();
    }
    let archive = line.path("station.tar");
    let backed_up = line.command("backup", &[archive.to_str().unwrap()]);
    let listed = String::from_utf8_lossy(&backed_up.stdout).into_owned();
    assert!(backed_up.status.success(), "{}", stderr(&backed_up));
    for name in pictures.iter().chain(&["films/run.mp4"]) {
        assert!(!listed.contains(name), "{listed}");
    }
    for name in kept.iter().chain(&["calibration.toml"]) {
        std::fs::remove_file(at(name)).unwrap();
    }
    let output = restore(&archive, &[]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for name in kept.iter().chain(&["calibration.toml"]) {
        assert_eq!(std::fs::read_to_string(at(name)).unwrap(), *name);
    }
    let forget = |what: &[&str]| {
        let output = line.command("forget", what);
        assert!(output.status.success(), "{}", stderr(&output));
        pictures.iter().filter(|name| at(name).exists()).count()
    };
    assert_eq!(forget(&["--before", "1h"]), 3, "they are newer");
    assert_eq!(forget(&["--before", "2199-01-01T00:00:00Z"]), 0);
    std::fs::write(at("seen.jpg"), "jpeg").unwrap();
    assert_eq!(forget(&["--part", "SN-7"]), 0, "it may show the part");
    let audit = String::from_utf8(line.command("history", &["--audit"]).stdout).unwrap();
    assert!(audit.contains("0 recordings and 3 pictures of the bench to be removed: from before"), "{audit}");
    assert!(audit.contains("0 recordings and 1 pictures of the bench to be removed: of part"), "{audit}");
}

#[test]
fn pictures_of_steps_are_backed_up_with_their_job_and_those_of_another_job_go() {
    let line = Line::new(Settings::live());
    let job = JobFile::parse("job.toml", &contents(&line, "job.toml")).unwrap();
    let own = format!("job.{:016x}.step-1.jpg", job.model_hash());
    let other = "job.0123456789abcdef.step-1.jpg";
    for (name, bytes) in [(own.as_str(), "own"), (other, "other")] {
        std::fs::write(line.path(name), bytes).unwrap();
    }
    let archive = line.path("station.tar");
    let backed_up = line.command("backup", &[archive.to_str().unwrap()]);
    let listed = String::from_utf8_lossy(&backed_up.stdout).into_owned();
    assert!(listed.contains(&own) && !listed.contains(other), "{listed}{}", stderr(&backed_up));
    std::fs::remove_file(line.path(&own)).unwrap();
    let output = restore(&archive, &[]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(contents(&line, &own), b"own");
    assert!(!line.path(other).exists(), "nobody looks for it again");
    // It is replaced as any other file is.
    std::fs::write(line.path(&own), "changed").unwrap();
    let output = restore(&archive, &[]);
    assert!(output.status.code() == Some(64) && stderr(&output).contains(&own), "{}", stderr(&output));
    assert_eq!(restore(&archive, &["--replace"]).status.code(), Some(0));
    assert_eq!(contents(&line, &own), b"own");
    // It is as old as its job, which was taught today.
    let forget = |before: &str| {
        let output = line.command("forget", &["--before", before]);
        assert!(output.status.success(), "{}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    forget("3d");
    assert!(line.path(&own).exists());
    assert!(forget("2199-01-01T00:00:00Z").contains(&own) && !line.path(&own).exists());
    let kept = String::from_utf8(line.command("history", &["--audit"]).stdout).unwrap();
    assert!(kept.contains("0 recordings and 1 pictures of steps to be removed: from before 2199"), "{kept}");
}
