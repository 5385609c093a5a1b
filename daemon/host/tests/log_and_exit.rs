//! What a process logs, and how it ends: each test starts itself again as the process under test.

#![allow(clippy::unwrap_used, clippy::panic)]

use andon_host::log::{Level, code, index, last_error, log};
use std::process::{Command, Output};

/// Set in the process under test.
const INSIDE: &str = "ANDON_TEST_INSIDE";

fn is_inside() -> bool {
    std::env::var_os(INSIDE).is_some()
}

/// Runs one test of this file in a process of its own.
fn again(test: &str, levels: &str) -> Output {
    Command::new(std::env::current_exe().unwrap())
        .args([test, "--exact", "--nocapture"])
        .env(INSIDE, "1")
        .env("ANDON_LOG", levels)
        .env_remove("JOURNAL_STREAM")
        .output()
        .unwrap()
}

/// The lines of standard error that are log messages.
fn logged(output: &Output) -> Vec<String> {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    text.lines().filter(|line| line.contains(" judge ")).map(str::to_owned).collect()
}

#[test]
fn a_panic_in_any_thread_ends_the_process_with_72_and_a_line() {
    if is_inside() {
        andon_host::log::start("judge", "bench1", Level::Info).unwrap();
        andon_host::exit::exit_on_panic();
        let _ = std::thread::spawn(|| panic!("the table is on fire")).join();
        return;
    }
    let output = again("a_panic_in_any_thread_ends_the_process_with_72_and_a_line", "info");
    assert_eq!(output.status.code(), Some(72));
    let lines = logged(&output);
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert!(lines[0].contains("ERROR judge    AND-614 the table is on fire, at "), "{lines:?}");
}

#[test]
fn a_message_on_a_terminal_has_its_code_its_remedy_and_its_fields() {
    if is_inside() {
        andon_host::log::start("judge", "bench1", Level::Info).unwrap();
        log!(code::MARKER_COVERED, { object = 5, hidden_ms = 900 }, "the polisher's marker is covered");
        return;
    }
    let lines = logged(&again("a_message_on_a_terminal_has_its_code_its_remedy_and_its_fields", "info"));
    let expected = format!(
        " WARN judge    AND-201 the polisher's marker is covered. {} object=5 hidden_ms=900",
        code::MARKER_COVERED.remedy
    );
    assert!(lines.len() == 1 && lines[0].ends_with(&expected), "{lines:?}");
}

#[test]
fn the_variable_overrides_the_configured_level() {
    if is_inside() {
        andon_host::log::start("judge", "bench1", Level::Trace).unwrap();
        log!(code::JOB_OK, "the job was done right");
        log!(code::DISK_FULL, "seq 7 is not written");
        return;
    }
    let lines = logged(&again("the_variable_overrides_the_configured_level", "error"));
    assert!(lines.len() == 1 && lines[0].contains("AND-402"), "{lines:?}");
}

#[test]
fn the_last_error_is_the_newest_code_that_is_not_good_news() {
    if is_inside() {
        log!(code::CAMERA_GONE, "/dev/video0 does not answer");
        log!(code::CAMERA_BACK, "/dev/video0 answers again");
        assert_eq!(last_error(), 104);
        return;
    }
    assert!(again("the_last_error_is_the_newest_code_that_is_not_good_news", "info").status.success());
}

#[test]
fn codes_ascend_have_a_meaning_and_say_what_to_do_unless_they_are_news() {
    let numbers: Vec<u32> = code::ALL.iter().map(|code| code.number).collect();
    assert!(numbers.is_sorted_by(|a, b| a < b), "{numbers:?}");
    for code in code::ALL {
        assert_eq!(code.name, format!("AND-{}", code.number));
        assert!(!code.meaning.is_empty() && !code.meaning.ends_with('.'), "{code:?}");
        assert_eq!(code.remedy.is_empty(), code.level == tracing::Level::INFO, "{code:?}");
        assert!(!code.remedy.ends_with('.'), "{code:?}");
    }
}

#[test]
fn every_code_has_exactly_one_row_in_the_index() {
    let index = index();
    for code in code::ALL {
        let rows = index.matches(&format!("| {} |", code.name)).count();
        assert_eq!(rows, 1, "{} has {rows} rows: is its hundred in no group?", code.name);
    }
}

/// Every source file below a folder as one text, without the table of the codes and without unit tests.
fn sources(folder: &std::path::Path) -> String {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let text = |path: std::path::PathBuf| {
        if path.is_dir() {
            sources(&path)
        } else if path.ends_with("log/code.rs") || path.ends_with("log/mod.rs") {
            String::new()
        } else {
            let text = std::fs::read_to_string(path).unwrap();
            text.split("#[cfg(test)]\nmod tests").next().unwrap().to_owned()
        }
    };
    entries.map(text).collect()
}

#[test]
fn every_code_of_the_index_is_used_by_the_program() {
    let host = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let table = std::fs::read_to_string(host.join("src/log/code.rs")).unwrap();
    let program: String = ["src", "../andond/src", "../record/src", "../video/src"]
        .iter()
        .map(|folder| sources(&host.join(folder)))
        .collect();
    let mut declared = 0;
    for line in table.lines() {
        let mut words = line.split_whitespace();
        let (Some("INFO" | "WARN" | "ERROR"), Some(_), Some(name)) =
            (words.next(), words.next(), words.next())
        else {
            continue;
        };
        let Some(name) = name.strip_suffix(':') else { continue };
        declared += 1;
        let used = program.match_indices(&format!("code::{name}")).any(|(at, found)| {
            // Not the beginning of a longer name.
            !program[at + found.len()..].starts_with(|next: char| next == '_' || next.is_ascii_uppercase())
        });
        assert!(used, "{name} is in the index and nothing says it");
    }
    assert_eq!(declared, code::ALL.len());
}
