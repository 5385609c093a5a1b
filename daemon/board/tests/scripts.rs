//! The scripts of the pages: typed by their comments, and few.

#![allow(clippy::unwrap_used)]

use std::path::PathBuf;
use std::process::Command;

/// More would be a program of its own.
const MOST_LINES: usize = 1500;

fn scripts() -> Vec<PathBuf> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/page");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let scripts: Vec<PathBuf> =
        files.filter(|path| path.extension().is_some_and(|ending| ending == "js")).collect();
    assert!(scripts.len() >= 3, "{scripts:?}");
    scripts
}

#[test]
fn the_types_of_the_scripts_fit() {
    // Each is loaded by itself, so each is checked by itself.
    for script in scripts() {
        let output = Command::new("tsc")
            .args(["--noEmit", "--allowJs", "--checkJs", "--strict", "--noImplicitReturns"])
            .args(["--target", "es2022", "--lib", "dom,dom.iterable,es2022"])
            .arg(&script)
            .output()
            .expect("tsc is needed: run `make test-packages`");
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{}: {said}", script.display());
    }
}

#[test]
fn the_scripts_are_few_lines() {
    let lines = |script: &PathBuf| std::fs::read_to_string(script).unwrap().lines().count();
    let all: usize = scripts().iter().map(lines).sum();
    assert!(all < MOST_LINES, "{all} lines");
}
